//! Control points: what four neighbours of each kind give an evaluation, and what is refused.

use super::kinematics::Full;
use super::knots::Knots;
use super::turn::Turn;
use crate::se3::{Pose, Twist, log};
use crate::vector::{dot, within};
use crate::{Error, Real, so3};
use nalgebra::{Quaternion, Vector3};

/// cos of half the largest turn between neighbours, which is π − 10⁻³ rad: at π a turn has no direction.
const LEAST_COS: f64 = 5e-4;

/// What neighbours that are too far apart are called in an error.
const APART: Error = Error::OutOfRange("turn between neighbours");

pub(super) mod sealed {
    /// What acts on one interval: the base, what leads from each of the four to the next, and for attitudes the end.
    #[derive(Clone, Copy, Debug)]
    pub struct Window<B, S> {
        pub(in crate::spline) first: B,
        pub(in crate::spline) steps: [S; 3],
        pub(in crate::spline) last: B,
    }

    pub trait Sealed {}
}

pub(super) use sealed::{Sealed, Window};

/// What a spline may be made of: a value that can be checked beside its neighbours.
pub trait ControlPoint<T: Real>: Sealed + Copy {
    /// Looks at all of a caller's control points.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming what is wrong.
    fn check(points: &[Self]) -> Result<(), Error>;
}

/// Control points that have an attitude.
pub trait Attitudes<T: Real>: ControlPoint<T> {
    #[doc(hidden)]
    fn turns(four: &[Self; 4]) -> Window<Quaternion<T>, Turn<T>>;
}

/// Control points that have a position.
pub trait Positions<T: Real>: ControlPoint<T> {
    #[doc(hidden)]
    fn moves(four: &[Self; 4]) -> Window<Vector3<T>, Vector3<T>>;
}

/// Control points that have a screw to the next one.
pub trait Screws<T: Real>: ControlPoint<T> {
    #[doc(hidden)]
    fn screws(four: &[Self; 4]) -> Window<Pose<T>, Screw<T>>;
}

/// A curve of poses of any kind, for whoever does not mind which: what a trajectory is made of.
pub trait Curve<T: Real>: Sealed {
    /// When its control points are, and where there is a curve.
    fn knots(&self) -> &Knots<T>;

    /// `T_wb`, v, ω, a and α `offset_s` seconds after an instant: also between nanoseconds.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the argument, outside the [`span`](Knots::span) by half a nanosecond or more.
    fn full_between(&self, t_ns: i64, offset_s: T) -> Result<Full<T>, Error>;
}

/// A twist with the square of its angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screw<T: Real> {
    pub(super) twist: Twist<T>,
    square: T,
}

impl<T: Real> Screw<T> {
    #[inline]
    pub(super) fn new(twist: Twist<T>) -> Self {
        Self { twist, square: dot(&twist.angular, &twist.angular) }
    }

    /// log(T_a⁻¹ T_b)
    pub(super) fn between(a: &Pose<T>, b: &Pose<T>) -> Self {
        let back = so3::inverse(&a.rotation());
        let rotation = so3::product(&back, &b.rotation());
        let translation = so3::rotate(&back, &(b.translation() - a.translation()));
        Self::new(log(&Pose::of_unit(rotation, translation)))
    }

    /// exp(weight·Ω)
    #[inline(always)]
    pub(super) fn part(&self, weight: T) -> Pose<T> {
        crate::se3::exp_of_squared(&(self.twist * weight), self.square * (weight * weight))
    }
}

/// Whether two attitudes are closer than π − 10⁻³ rad.
pub(super) fn are_neighbours<T: Real>(a: &Quaternion<T>, b: &Quaternion<T>) -> Result<(), Error> {
    let (a, b) = (&a.coords, &b.coords);
    let cos = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
    if cos.abs() >= T::from_f64(LEAST_COS) { Ok(()) } else { Err(APART) }
}

fn all_are_neighbours<T: Real>(
    mut attitudes: impl Iterator<Item = Quaternion<T>>,
) -> Result<(), Error> {
    let Some(mut before) = attitudes.next() else { return Ok(()) };
    attitudes.try_for_each(|next| {
        are_neighbours(&before, &next)?;
        before = next;
        Ok(())
    })
}

impl<T: Real> Sealed for Vector3<T> {}

impl<T: Real> ControlPoint<T> for Vector3<T> {
    /// Refuses components that are not numbers or beyond ±10⁹ m, naming `points`.
    fn check(points: &[Self]) -> Result<(), Error> {
        let fine = points.iter().all(|point| within(point, T::from_f64(1e9)));
        if fine { Ok(()) } else { Err(Error::OutOfRange("points")) }
    }
}

impl<T: Real> Positions<T> for Vector3<T> {
    #[inline(always)]
    fn moves([a, b, c, d]: &[Self; 4]) -> Window<Vector3<T>, Vector3<T>> {
        Window { first: *a, steps: [b - a, c - b, d - c], last: *d }
    }
}

impl<T: Real> Sealed for Quaternion<T> {}

impl<T: Real> ControlPoint<T> for Quaternion<T> {
    /// Refuses, naming `points`, what is not of unit length to eight roundings: nothing here can make it so, and a
    /// [`Pose`] does. Refuses neighbours further apart than π − 10⁻³ rad. Signs do not matter.
    fn check(points: &[Self]) -> Result<(), Error> {
        let off = T::from_f64(8.0) * T::EPSILON;
        let fine = points.iter().all(|q| (so3::length(q) - T::ONE).abs() <= off);
        if fine {
            all_are_neighbours(points.iter().copied())
        } else {
            Err(Error::OutOfRange("points"))
        }
    }
}

impl<T: Real> Attitudes<T> for Quaternion<T> {
    #[inline(always)]
    fn turns([a, b, c, d]: &[Self; 4]) -> Window<Quaternion<T>, Turn<T>> {
        let steps = [Turn::between(a, b), Turn::between(b, c), Turn::between(c, d)];
        Window { first: *a, steps, last: *d }
    }
}

impl<T: Real> Sealed for Pose<T> {}

impl<T: Real> ControlPoint<T> for Pose<T> {
    /// Refuses neighbours turned further apart than π − 10⁻³ rad.
    fn check(points: &[Self]) -> Result<(), Error> {
        all_are_neighbours(points.iter().map(Pose::rotation))
    }
}

impl<T: Real> Attitudes<T> for Pose<T> {
    #[inline(always)]
    fn turns(four: &[Self; 4]) -> Window<Quaternion<T>, Turn<T>> {
        Attitudes::turns(&four.map(|pose| pose.rotation()))
    }
}

impl<T: Real> Positions<T> for Pose<T> {
    #[inline(always)]
    fn moves(four: &[Self; 4]) -> Window<Vector3<T>, Vector3<T>> {
        Positions::moves(&four.map(|pose| pose.translation()))
    }
}

impl<T: Real> Screws<T> for Pose<T> {
    #[inline(always)]
    fn screws([a, b, c, d]: &[Self; 4]) -> Window<Pose<T>, Screw<T>> {
        let steps = [Screw::between(a, b), Screw::between(b, c), Screw::between(c, d)];
        Window { first: *a, steps, last: *d }
    }
}
