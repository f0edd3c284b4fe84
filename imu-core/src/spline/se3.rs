//! Poses on SE(3), attitude and position coupled: T = T₀ exp(B₁Ω₁) exp(B₂Ω₂) exp(B₃Ω₃).
//!
//! The curve of Lovegrove, Patron-Perez & Sibley (2013), "Spline Fusion: a continuous-time representation for visual-
//! inertial fusion with application to rolling shutter cameras", eqs. (4) to (6), by recurrence on the body's twist ξ in
//! place of products of 4×4 matrices: for each factor A = exp(BΩ), ξ ← Ad(A⁻¹)ξ + ḂΩ and ξ̇ ← Ad(A⁻¹)ξ̇ + B̈Ω + Ḃ
//! ad(ξ)Ω with the new ξ; then Ṫ = T ξ̂ and T̈ = T(ξ̂² + ξ̇^) (Sommer et al. (2020), theorems 4.1 and 4.2).

use super::basis::Weights;
use super::control::{Curve, Screw, Screws, Sealed, Window};
use super::kinematics::{Full, PoseAndVelocity, felt};
use super::knots::{Knots, Place};
use crate::sample::Sample;
use crate::se3::{Pose, Twist};
use crate::vector::cross;
use crate::{Error, Real, so3};
use nalgebra::Vector3;

/// A curve of poses `T_wb` on SE(3), of [`Pose`]s or [`ScrewKnot`](super::ScrewKnot)s.
///
/// ```
/// use imu_core::nalgebra::Vector3;
/// use imu_core::se3::{Twist, exp};
/// use imu_core::spline::Se3Spline;
/// // Control poses on a circle of 10 m, 0.2 rad/s: on the circle is the curve.
/// let along = |k: usize| Twist { linear: Vector3::new(0.2 * k as f64, 0.0, 0.0), angular: Vector3::new(0.0, 0.0, 0.02 * k as f64) };
/// let points: [_; 6] = core::array::from_fn(|k| exp(&along(k)));
/// let curve = Se3Spline::from_control_points(0, 100_000_000, &points)?;
/// let full = curve.full(210_000_000)?;
/// assert!(((full.pose.translation() - Vector3::new(0.0, 10.0, 0.0)).dot(&full.velocity_w)).abs() < 1e-12);
/// # Ok::<(), imu_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Se3Spline<'a, T: Real, C> {
    knots: Knots<T>,
    points: &'a [C],
}

impl<'a, T: Real, C: Screws<T>> Se3Spline<'a, T, C> {
    /// Of control poses every `step_ns`, the first at `start_ns`. They are no poses of the curve:
    /// [`quasi_interpolant_on_screws`](super::quasi_interpolant_on_screws) makes them of those.
    ///
    /// # Errors
    /// As of [`Knots::new`], and as the [`check`](super::ControlPoint::check) of the control points says.
    pub fn from_control_points(
        start_ns: i64,
        step_ns: u32,
        points: &'a [C],
    ) -> Result<Self, Error> {
        let knots = Knots::new(start_ns, step_ns, points.len())?;
        C::check(points)?;
        Ok(Self { knots, points })
    }

    /// When its control points are, and where there is a curve.
    #[must_use]
    pub fn knots(&self) -> &Knots<T> {
        &self.knots
    }

    /// `T_wb`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `t_ns`, outside the [`span`](Knots::span).
    #[inline]
    pub fn pose(&self, t_ns: i64) -> Result<Pose<T>, Error> {
        let (window, u) = self.window(self.knots.locate(t_ns)?)?;
        let parts = window.steps.iter().zip(Weights::cubic(u, T::ONE).value);
        Ok(parts.fold(window.first, |pose, (screw, b)| after(&pose, &screw.part(b))))
    }

    /// `T_wb`, v and ω.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `t_ns`, outside the [`span`](Knots::span).
    #[inline]
    pub fn pose_and_velocity(&self, t_ns: i64) -> Result<PoseAndVelocity<T>, Error> {
        let (window, u) = self.window(self.knots.locate(t_ns)?)?;
        let weights = Weights::cubic(u, self.knots.rate());
        let factors = window.steps.iter().zip(weights.value).zip(weights.rate);
        let begin = (window.first, Twist::zero());
        let (pose, twist) = factors.fold(begin, |(pose, twist), ((screw, b), b1)| {
            let part = screw.part(b);
            (after(&pose, &part), part.twist_inside(&twist) + screw.twist * b1)
        });
        Ok(PoseAndVelocity {
            pose,
            velocity_w: so3::rotate(&pose.rotation(), &twist.linear),
            angular_rate: twist.angular,
        })
    }

    /// `T_wb`, v, ω, a and α.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `t_ns`, outside the [`span`](Knots::span).
    #[inline]
    pub fn full(&self, t_ns: i64) -> Result<Full<T>, Error> {
        self.full_at(self.knots.locate(t_ns)?)
    }

    /// What an ideal gyroscope and accelerometer at the body's origin read, ω and Rᵀ(a − g), under this gravity in
    /// m/s²: (0, 0, −9.81) where z points up.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `t_ns`, outside the [`span`](Knots::span); as of [`Sample::new`] for what no sensor
    /// reads.
    #[inline]
    pub fn imu(&self, t_ns: i64, gravity_w: &Vector3<T>) -> Result<Sample<T>, Error> {
        let Full { pose, angular_rate, acceleration_w, .. } = self.full(t_ns)?;
        felt(&pose.rotation(), angular_rate, &acceleration_w, gravity_w)
    }

    #[inline(always)]
    fn full_at(&self, place: Place<T>) -> Result<Full<T>, Error> {
        let (window, u) = self.window(place)?;
        let (pose, twist, change) =
            recurrence(&window.first, &window.steps, &Weights::cubic(u, self.knots.rate()));
        let rotation = pose.rotation();
        Ok(Full {
            pose,
            velocity_w: so3::rotate(&rotation, &twist.linear),
            acceleration_w: so3::rotate(
                &rotation,
                &(cross(&twist.angular, &twist.linear) + change.linear),
            ),
            angular_rate: twist.angular,
            angular_acceleration: change.angular,
        })
    }

    #[inline(always)]
    fn window(&self, place: Place<T>) -> Result<(Acting<T>, T), Error> {
        Ok((C::screws(place.window(self.points)?), place.u))
    }
}

impl<T: Real, C: Screws<T>> Sealed for Se3Spline<'_, T, C> {}

impl<T: Real, C: Screws<T>> Curve<T> for Se3Spline<'_, T, C> {
    fn knots(&self) -> &Knots<T> {
        &self.knots
    }

    fn full_between(&self, t_ns: i64, offset_s: T) -> Result<Full<T>, Error> {
        self.full_at(self.knots.locate_between(t_ns, offset_s)?)
    }
}

type Acting<T> = Window<Pose<T>, Screw<T>>;

/// T, ξ and ξ̇.
#[inline(always)]
fn recurrence<T: Real, const K: usize>(
    first: &Pose<T>,
    screws: &[Screw<T>; K],
    weights: &Weights<T, K>,
) -> (Pose<T>, Twist<T>, Twist<T>) {
    let rates = weights.rate.iter().zip(&weights.acceleration);
    let factors = screws.iter().zip(&weights.value).zip(rates);
    let begin = (*first, Twist::zero(), Twist::zero());
    factors.fold(begin, |(pose, twist, change), ((screw, b), (b1, b2))| {
        let part = screw.part(*b);
        let carried = part.twist_inside(&twist);
        let along = screw.twist * *b1;
        // The bracket of Ω with itself is zero: the old part of the twist alone counts.
        let turned = carried.bracket(&along);
        (
            after(&pose, &part),
            carried + along,
            part.twist_inside(&change) + screw.twist * *b2 + turned,
        )
    })
}

/// A product of few poses, of unit length up to rounding.
#[inline(always)]
fn after<T: Real>(pose: &Pose<T>, part: &Pose<T>) -> Pose<T> {
    let rotation = so3::product(&pose.rotation(), &part.rotation());
    Pose::of_unit(rotation, pose.point(&part.translation()))
}

#[cfg(test)]
#[path = "se3_tests.rs"]
mod tests;
