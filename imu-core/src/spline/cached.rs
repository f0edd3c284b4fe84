//! Control points with what leads to the next one worked out beforehand: for knots that do not move any more.
//!
//! An evaluation then takes no logarithm. Differences are formed in the scalar of the poses, before they are rounded
//! to the scalar of the knots: `f32` knots of `f64` poses keep acceleration right to 10⁻⁴ m/s² at 100 knots a second,
//! where `f32` positions 20 m away give it to 3·10⁻² m/s².

use super::control::{Attitudes, ControlPoint, Positions, Screw, Screws, Sealed, Window};
use super::turn::Turn;
use crate::se3::{Pose, Twist};
use crate::{Error, Real};
use nalgebra::{Quaternion, Vector3};

/// A control pose, and the turn and the way to the next one. Made by [`cache`]; a default one is at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot<T: Real> {
    pose: Pose<T>,
    turn: Turn<T>,
    step: Vector3<T>,
}

impl<T: Real> Knot<T> {
    /// Turned and moved from one pose to the next; in `T` at last.
    pub(super) fn between<S: Real>(from: &Pose<S>, to: &Pose<S>) -> Self {
        let step = to.translation() - from.translation();
        Self {
            pose: from.cast(),
            turn: Turn::between(&from.rotation(), &to.rotation()).cast(),
            step: Vector3::from(<[S; 3]>::from(step).map(|x| T::from_f64(x.to_f64()))),
        }
    }

    /// The control pose itself.
    #[must_use]
    pub fn pose(&self) -> Pose<T> {
        self.pose
    }
}

impl<T: Real> Default for Knot<T> {
    fn default() -> Self {
        Self::between::<T>(&Pose::identity(), &Pose::identity())
    }
}

/// A control pose, and the screw to the next one. Made by [`cache_screws`]; a default one is at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScrewKnot<T: Real> {
    pose: Pose<T>,
    screw: Screw<T>,
}

impl<T: Real> ScrewKnot<T> {
    fn between<S: Real>(from: &Pose<S>, to: &Pose<S>) -> Self {
        let Twist { linear, angular } = Screw::between(from, to).twist;
        let cast =
            |v: Vector3<S>| Vector3::from(<[S; 3]>::from(v).map(|x| T::from_f64(x.to_f64())));
        let twist = Twist { linear: cast(linear), angular: cast(angular) };
        Self { pose: from.cast(), screw: Screw::new(twist) }
    }
}

impl<T: Real> Default for ScrewKnot<T> {
    fn default() -> Self {
        Self::between::<T>(&Pose::identity(), &Pose::identity())
    }
}

/// Fills knots for a [`SplitSpline`](super::SplitSpline) (or a symmetric one) of these control poses.
///
/// # Errors
/// [`Error::OutOfRange`], naming `knots` where there are not as many of them as poses, and `turn between neighbours`
/// where two are further apart than π − 10⁻³ rad.
pub fn cache<S: Real, T: Real>(poses: &[Pose<S>], knots: &mut [Knot<T>]) -> Result<(), Error> {
    fill(poses, knots, Knot::between)
}

/// Fills knots for an [`Se3Spline`](super::Se3Spline) of these control poses.
///
/// # Errors
/// As of [`cache`].
pub fn cache_screws<S: Real, T: Real>(
    poses: &[Pose<S>],
    knots: &mut [ScrewKnot<T>],
) -> Result<(), Error> {
    fill(poses, knots, ScrewKnot::between)
}

fn fill<S: Real, K>(
    poses: &[Pose<S>],
    knots: &mut [K],
    between: impl Fn(&Pose<S>, &Pose<S>) -> K,
) -> Result<(), Error> {
    if poses.len() != knots.len() {
        return Err(Error::OutOfRange("knots"));
    }
    Pose::check(poses)?;
    // Nothing leads on from the last one.
    let next = poses.iter().skip(1).chain(poses.last());
    for ((knot, from), to) in knots.iter_mut().zip(poses).zip(next) {
        *knot = between(from, to);
    }
    Ok(())
}

impl<T: Real> Sealed for Knot<T> {}

impl<T: Real> ControlPoint<T> for Knot<T> {
    /// Whoever made them has checked.
    fn check(_: &[Self]) -> Result<(), Error> {
        Ok(())
    }
}

impl<T: Real> Attitudes<T> for Knot<T> {
    #[inline(always)]
    fn turns([a, b, c, d]: &[Self; 4]) -> Window<Quaternion<T>, Turn<T>> {
        let steps = [a.turn, b.turn, c.turn];
        Window { first: a.pose.rotation(), steps, last: d.pose.rotation() }
    }
}

impl<T: Real> Positions<T> for Knot<T> {
    #[inline(always)]
    fn moves([a, b, c, d]: &[Self; 4]) -> Window<Vector3<T>, Vector3<T>> {
        let steps = [a.step, b.step, c.step];
        Window { first: a.pose.translation(), steps, last: d.pose.translation() }
    }
}

impl<T: Real> Sealed for ScrewKnot<T> {}

impl<T: Real> ControlPoint<T> for ScrewKnot<T> {
    /// Whoever made them has checked.
    fn check(_: &[Self]) -> Result<(), Error> {
        Ok(())
    }
}

impl<T: Real> Screws<T> for ScrewKnot<T> {
    #[inline(always)]
    fn screws([a, b, c, d]: &[Self; 4]) -> Window<Pose<T>, Screw<T>> {
        Window { first: a.pose, steps: [a.screw, b.screw, c.screw], last: d.pose }
    }
}
