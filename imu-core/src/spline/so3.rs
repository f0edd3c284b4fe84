//! Attitudes: R = R₀ exp(B₁d₁) exp(B₂d₂) exp(B₃d₃), with angular rate and acceleration by a recurrence.
//!
//! For each factor A = exp(Bd): ω ← Aᵀω + Ḃd, α ← Aᵀα + B̈d + Ḃ(ω×d) with the new ω, R ← RA. Three exponentials,
//! three products and eight rotations for all three; nothing of it is a matrix. Source: Sommer, Usenko, Schubert,
//! Demmel & Cremers (2020), "Efficient derivative computation for cumulative B-splines on Lie groups", theorems 4.1
//! and 4.2; the curve is that of Kim, Kim & Shin (1995).

use super::basis::Weights;
use super::control::{Attitudes, Sealed, Window};
use super::kinematics::Attitude;
use super::knots::Knots;
use super::symmetric::TimeSymmetric;
use super::turn::Turn;
use crate::lanes::{self, Four};
use crate::{Error, Real};
use core::marker::PhantomData;
use nalgebra::{Quaternion, Vector3};

/// How an attitude follows from four neighbours: [`OneSided`] or [`TimeSymmetric`]. The same control points give two
/// curves, close to each other but not the same.
pub trait Form<T: Real>: Sealed + Copy {
    #[doc(hidden)]
    fn attitude(window: &Turns<T>, u: T) -> Quaternion<T>;
    #[doc(hidden)]
    fn attitude_and_rate(window: &Turns<T>, u: T, rate: T) -> (Quaternion<T>, Vector3<T>);
    #[doc(hidden)]
    fn full(window: &Turns<T>, u: T, rate: T) -> Attitude<T>;
}

pub(super) type Turns<T> = Window<Quaternion<T>, Turn<T>>;

/// The product from the first control point on: what every published cumulative spline is. Run backwards, the same
/// control points give another curve, and its error falls with the third power of the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OneSided;

impl Sealed for OneSided {}

impl<T: Real> Form<T> for OneSided {
    #[inline(always)]
    fn attitude(window: &Turns<T>, u: T) -> Quaternion<T> {
        lanes::to_quaternion::<T>(attitude(
            &window.first,
            &window.steps,
            &Weights::cubic(u, T::ONE),
        ))
    }

    #[inline(always)]
    fn attitude_and_rate(window: &Turns<T>, u: T, rate: T) -> (Quaternion<T>, Vector3<T>) {
        let weights = Weights::cubic(u, rate);
        let (attitude, rate) = attitude_and_rate(&window.first, &window.steps, &weights);
        (lanes::to_quaternion::<T>(attitude), lanes::to_vector(rate))
    }

    #[inline(always)]
    fn full(window: &Turns<T>, u: T, rate: T) -> Attitude<T> {
        Attitude::of_lanes(full(&window.first, &window.steps, &Weights::cubic(u, rate)))
    }
}

impl<T: Real> Attitude<T> {
    #[inline(always)]
    pub(super) fn of_lanes(turning: Turning<T::Four>) -> Self {
        Self {
            attitude_wb: lanes::to_quaternion::<T>(turning.attitude),
            angular_rate: lanes::to_vector(turning.rate),
            angular_acceleration: lanes::to_vector(turning.acceleration),
        }
    }
}

/// A fold with its first two steps written out: round a loop, a compiler keeps in memory what fits into registers.
macro_rules! fold_written_out {
    ($items:expr, $begin:expr, $step:path) => {{
        let (mut items, mut state) = ($items, $begin);
        if let Some(item) = items.next() {
            state = $step(state, item);
        }
        if let Some(item) = items.next() {
            state = $step(state, item);
        }
        for item in items {
            state = $step(state, item);
        }
        state
    }};
}

/// Attitude, ω and α in lanes.
#[derive(Clone, Copy)]
pub(super) struct Turning<F> {
    pub(super) attitude: F,
    pub(super) rate: F,
    pub(super) acceleration: F,
}

#[inline(always)]
pub(super) fn attitude<T: Real, const K: usize>(
    first: &Quaternion<T>,
    turns: &[Turn<T>; K],
    weights: &Weights<T, K>,
) -> T::Four {
    #[inline(always)]
    fn turned<T: Real>(q: T::Four, part: &T::Four) -> T::Four {
        lanes::product(q, *part)
    }
    let parts = Turn::parts(turns, &weights.value);
    fold_written_out!(parts.iter(), lanes::quaternion(first), turned::<T>)
}

#[inline(always)]
pub(super) fn attitude_and_rate<T: Real, const K: usize>(
    first: &Quaternion<T>,
    turns: &[Turn<T>; K],
    weights: &Weights<T, K>,
) -> (T::Four, T::Four) {
    type Factor<'a, T> = ((&'a <T as Real>::Four, &'a Turn<T>), &'a T);
    #[inline(always)]
    fn turned<T: Real>(
        (q, rate): (T::Four, T::Four),
        ((part, turn), b1): Factor<'_, T>,
    ) -> (T::Four, T::Four) {
        (lanes::product(q, *part), lanes::rotate_back(*part, rate) + turn.times(*b1))
    }
    let parts = Turn::parts(turns, &weights.value);
    let mut factors = parts.iter().zip(turns).zip(&weights.rate);
    let first = lanes::quaternion(first);
    let Some(((part, turn), b1)) = factors.next() else {
        return (first, T::Four::all(T::ZERO));
    };
    fold_written_out!(factors, (lanes::product(first, *part), turn.times(*b1)), turned::<T>)
}

#[inline(always)]
pub(super) fn full<T: Real, const K: usize>(
    first: &Quaternion<T>,
    turns: &[Turn<T>; K],
    weights: &Weights<T, K>,
) -> Turning<T::Four> {
    type Factor<'a, T> = ((&'a <T as Real>::Four, &'a Turn<T>), (&'a T, &'a T));
    #[inline(always)]
    fn turned<T: Real>(
        before: Turning<T::Four>,
        ((part, turn), (b1, b2)): Factor<'_, T>,
    ) -> Turning<T::Four> {
        let carried = lanes::rotate_back(*part, before.rate);
        let along = turn.times(*b1);
        Turning {
            attitude: lanes::product(before.attitude, *part),
            rate: carried + along,
            // The new rate crossed with d: its own part along d falls out.
            acceleration: lanes::rotate_back(*part, before.acceleration)
                + turn.times(*b2)
                + lanes::cross(carried, along),
        }
    }
    let parts = Turn::parts(turns, &weights.value);
    let rates = weights.rate.iter().zip(&weights.acceleration);
    let mut factors = parts.iter().zip(turns).zip(rates);
    let first = lanes::quaternion(first);
    let Some(((part, turn), (b1, b2))) = factors.next() else {
        let zero = T::Four::all(T::ZERO);
        return Turning { attitude: first, rate: zero, acceleration: zero };
    };
    let begin = Turning {
        attitude: lanes::product(first, *part),
        rate: turn.times(*b1),
        acceleration: turn.times(*b2),
    };
    fold_written_out!(factors, begin, turned::<T>)
}

/// A curve of attitudes, of one of two forms: see [`So3Spline`] and [`SymmetricSo3Spline`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct So3Curve<'a, T: Real, C, F> {
    knots: Knots<T>,
    points: &'a [C],
    form: PhantomData<F>,
}

/// A curve of attitudes q_wb: the cumulative product. Of unit [`Quaternion`]s, [`Pose`](crate::se3::Pose)s or
/// [`Knot`](super::Knot)s.
///
/// ```
/// use imu_core::nalgebra::Vector3;
/// use imu_core::so3;
/// use imu_core::spline::So3Spline;
/// let points: [_; 5] = core::array::from_fn(|k| so3::exp(Vector3::new(0.0, 0.1 * k as f64, 0.0)));
/// let pitching = So3Spline::from_control_points(0, 50_000_000, &points)?;
/// let (_, rate) = pitching.attitude_and_rate(120_000_000)?;
/// assert!((rate.y - 2.0).abs() < 1e-14); // 0.1 rad every 50 ms
/// # Ok::<(), imu_core::Error>(())
/// ```
pub type So3Spline<'a, T, C> = So3Curve<'a, T, C, OneSided>;

/// A curve of attitudes q_wb of order 4: the [`TimeSymmetric`] form. Another curve than [`So3Spline`]'s.
pub type SymmetricSo3Spline<'a, T, C> = So3Curve<'a, T, C, TimeSymmetric>;

impl<'a, T: Real, C: Attitudes<T>, F: Form<T>> So3Curve<'a, T, C, F> {
    /// Of control points every `step_ns`, the first at `start_ns`. They are no attitudes of the curve:
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
        Ok(Self { knots, points, form: PhantomData })
    }

    /// When its control points are, and where there is a curve.
    #[must_use]
    pub fn knots(&self) -> &Knots<T> {
        &self.knots
    }

    /// q_wb.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `t_ns`, outside the [`span`](Knots::span).
    #[inline]
    pub fn attitude(&self, t_ns: i64) -> Result<Quaternion<T>, Error> {
        let (window, u) = self.window(t_ns)?;
        Ok(F::attitude(&window, u))
    }

    /// q_wb, and ω in rad/s.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `t_ns`, outside the [`span`](Knots::span).
    #[inline]
    pub fn attitude_and_rate(&self, t_ns: i64) -> Result<(Quaternion<T>, Vector3<T>), Error> {
        let (window, u) = self.window(t_ns)?;
        Ok(F::attitude_and_rate(&window, u, self.knots.rate()))
    }

    /// q_wb, ω and α.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `t_ns`, outside the [`span`](Knots::span).
    #[inline]
    pub fn full(&self, t_ns: i64) -> Result<Attitude<T>, Error> {
        let (window, u) = self.window(t_ns)?;
        Ok(F::full(&window, u, self.knots.rate()))
    }

    #[inline(always)]
    fn window(&self, t_ns: i64) -> Result<(Turns<T>, T), Error> {
        let place = self.knots.locate(t_ns)?;
        Ok((C::turns(place.window(self.points)?), place.u))
    }
}
