//! Positions: p = p₀ + Σ Bⱼ Δⱼ, and its derivatives.
//!
//! From differences of neighbours, and for acceleration from differences of those: what they have in common cancels
//! before it is rounded. Source: Sommer et al. (2020), section 3, with vectors for the group.

use super::basis::Weights;
use super::control::{Positions, Window};
use super::kinematics::Position;
use super::knots::{Knots, Place};
use crate::lanes::{self, Four};
use crate::{Error, Real};
use nalgebra::Vector3;

/// A curve of positions in the world frame, of [`Vector3`]s, [`Pose`](crate::se3::Pose)s or [`Knot`](super::Knot)s.
///
/// ```
/// use imu_core::nalgebra::Vector3;
/// use imu_core::spline::R3Spline;
/// // Falling for half a second: control points of a parabola are off by h²g/6 and give its acceleration exactly.
/// let points: [_; 6] = core::array::from_fn(|k| Vector3::new(0.0, 0.0, -4.905 * (0.1 * k as f64).powi(2)));
/// let fall = R3Spline::from_control_points(0, 100_000_000, &points)?;
/// assert!((fall.full(250_000_000)?.acceleration_w.z + 9.81).abs() < 1e-12);
/// # Ok::<(), imu_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct R3Spline<'a, T: Real, C> {
    knots: Knots<T>,
    points: &'a [C],
}

impl<'a, T: Real, C: Positions<T>> R3Spline<'a, T, C> {
    /// Of control points every `step_ns`, the first at `start_ns`; in m. They are no points of the curve:
    /// [`interpolate`](super::interpolate) and [`quasi_interpolant`](super::quasi_interpolant) make them of those.
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

    /// p, m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `t_ns`, outside the [`span`](Knots::span).
    #[inline]
    pub fn position(&self, t_ns: i64) -> Result<Vector3<T>, Error> {
        let (window, u) = self.window(t_ns)?;
        Ok(position(&window, u))
    }

    /// p, m, and v, m/s.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `t_ns`, outside the [`span`](Knots::span).
    #[inline]
    pub fn position_and_velocity(&self, t_ns: i64) -> Result<(Vector3<T>, Vector3<T>), Error> {
        let (window, u) = self.window(t_ns)?;
        Ok((position(&window, u), velocity(&window, u, self.knots.rate())))
    }

    /// p, v and a.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `t_ns`, outside the [`span`](Knots::span).
    #[inline]
    pub fn full(&self, t_ns: i64) -> Result<Position<T>, Error> {
        let (window, u) = self.window(t_ns)?;
        let rate = self.knots.rate();
        Ok(Position {
            position_w: position(&window, u),
            velocity_w: velocity(&window, u, rate),
            acceleration_w: acceleration(&window, u, rate),
        })
    }

    #[inline(always)]
    fn window(&self, t_ns: i64) -> Result<(Moves<T>, T), Error> {
        let place: Place<T> = self.knots.locate(t_ns)?;
        Ok((C::moves(place.window(self.points)?), place.u))
    }
}

type Moves<T> = Window<Vector3<T>, Vector3<T>>;

#[inline(always)]
pub(super) fn position<T: Real>(window: &Moves<T>, u: T) -> Vector3<T> {
    let moved = weighted::<T>(&window.steps, &Weights::cubic(u, T::ONE).value);
    lanes::to_vector(lanes::vector(&window.first) + moved)
}

#[inline(always)]
pub(super) fn velocity<T: Real>(window: &Moves<T>, u: T, rate: T) -> Vector3<T> {
    lanes::to_vector(weighted::<T>(&window.steps, &Weights::cubic(u, rate).rate))
}

/// ((1 − u)(Δ₂ − Δ₁) + u(Δ₃ − Δ₂))/h²
#[inline(always)]
pub(super) fn acceleration<T: Real>(window: &Moves<T>, u: T, rate: T) -> Vector3<T> {
    let [a, b, c] = window.steps.map(|step| lanes::vector(&step));
    let mixed = (b - a) * T::Four::all(T::ONE - u) + (c - b) * T::Four::all(u);
    lanes::to_vector(mixed * T::Four::all(rate * rate))
}

#[inline(always)]
fn weighted<T: Real>(steps: &[Vector3<T>; 3], weights: &[T; 3]) -> T::Four {
    let [a, b, c] = steps.map(|step| lanes::vector(&step));
    let [first, second, third] = weights.map(T::Four::all);
    a * first + b * second + c * third
}
