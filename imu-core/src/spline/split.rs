//! Poses as positions beside attitudes, SO(3) × R³: each on a curve of its own.
//!
//! Cheaper than the coupled form and in every case that Ovrén & Forssén (2019), "Trajectory representation and landmark
//! projection for continuous-time structure from motion", tried, better.

use super::control::{Attitudes, Curve, Positions, Sealed, Window};
use super::kinematics::{Full, PoseAndVelocity, felt};
use super::knots::{Knots, Place};
use super::r3::{acceleration, position, velocity};
use super::so3::{Form, OneSided, Turns};
use super::symmetric::TimeSymmetric;
use crate::sample::Sample;
use crate::se3::Pose;
use crate::{Error, Real};
use core::marker::PhantomData;
use nalgebra::Vector3;

/// A curve of poses, position and attitude apart, its attitude of one of two forms: see [`SplitSpline`] and
/// [`SymmetricSplitSpline`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitCurve<'a, T: Real, C, F> {
    knots: Knots<T>,
    points: &'a [C],
    form: PhantomData<F>,
}

/// A curve of poses `T_wb`: positions, and beside them attitudes by the cumulative product. Of
/// [`Pose`](crate::se3::Pose)s or [`Knot`](super::Knot)s.
pub type SplitSpline<'a, T, C> = SplitCurve<'a, T, C, OneSided>;

/// A curve of poses `T_wb`: positions, and beside them attitudes of the [`TimeSymmetric`] form. Another curve than
/// [`SplitSpline`]'s.
pub type SymmetricSplitSpline<'a, T, C> = SplitCurve<'a, T, C, TimeSymmetric>;

impl<'a, T: Real, C: Attitudes<T> + Positions<T>, F: Form<T>> SplitCurve<'a, T, C, F> {
    /// Of control poses every `step_ns`, the first at `start_ns`. They are no poses of the curve:
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
        Ok(Self::of_checked(knots, points))
    }

    /// Of as many control poses as there are knots, of which [`from_control_points`](Self::from_control_points) made a
    /// curve before: at no cost, where control points are owned and the curve, which borrows them, cannot be kept.
    ///
    /// Nothing is checked. Of other control points an evaluation is wrong or not a number, or an error where they are
    /// fewer than the knots.
    #[must_use]
    #[inline]
    pub fn of_checked(knots: Knots<T>, points: &'a [C]) -> Self {
        Self { knots, points, form: PhantomData }
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
        let Acting { turns, moves, u } = self.window(self.knots.locate(t_ns)?)?;
        Ok(Pose::of_unit(F::attitude(&turns, u), position(&moves, u)))
    }

    /// `T_wb`, v and ω.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `t_ns`, outside the [`span`](Knots::span).
    #[inline]
    pub fn pose_and_velocity(&self, t_ns: i64) -> Result<PoseAndVelocity<T>, Error> {
        let rate = self.knots.rate();
        let Acting { turns, moves, u } = self.window(self.knots.locate(t_ns)?)?;
        let (attitude, angular_rate) = F::attitude_and_rate(&turns, u, rate);
        Ok(PoseAndVelocity {
            pose: Pose::of_unit(attitude, position(&moves, u)),
            velocity_w: velocity(&moves, u, rate),
            angular_rate,
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
        let rate = self.knots.rate();
        let Acting { turns, moves, u } = self.window(self.knots.locate(t_ns)?)?;
        let (attitude, angular_rate) = F::attitude_and_rate(&turns, u, rate);
        felt(&attitude, angular_rate, &acceleration(&moves, u, rate), gravity_w)
    }

    #[inline(always)]
    fn full_at(&self, place: Place<T>) -> Result<Full<T>, Error> {
        let rate = self.knots.rate();
        let Acting { turns, moves, u } = self.window(place)?;
        let attitude = F::full(&turns, u, rate);
        Ok(Full {
            pose: Pose::of_unit(attitude.attitude_wb, position(&moves, u)),
            velocity_w: velocity(&moves, u, rate),
            acceleration_w: acceleration(&moves, u, rate),
            angular_rate: attitude.angular_rate,
            angular_acceleration: attitude.angular_acceleration,
        })
    }

    #[inline(always)]
    fn window(&self, place: Place<T>) -> Result<Acting<T>, Error> {
        let four = place.window(self.points)?;
        Ok(Acting { turns: C::turns(four), moves: C::moves(four), u: place.u })
    }
}

impl<T: Real, C: Attitudes<T> + Positions<T>, F: Form<T>> Sealed for SplitCurve<'_, T, C, F> {}

impl<T: Real, C: Attitudes<T> + Positions<T>, F: Form<T>> Curve<T> for SplitCurve<'_, T, C, F> {
    fn knots(&self) -> &Knots<T> {
        &self.knots
    }

    fn full_between(&self, t_ns: i64, offset_s: T) -> Result<Full<T>, Error> {
        self.full_at(self.knots.locate_between(t_ns, offset_s)?)
    }
}

/// What acts on one interval, and how far along it is.
struct Acting<T: Real> {
    turns: Turns<T>,
    moves: Window<Vector3<T>, Vector3<T>>,
    u: T,
}
