//! Control points with what leads to the next one worked out beforehand: for knots that do not move any more.
//!
//! An evaluation then takes no logarithm. Differences are formed in the scalar of the poses, before they are rounded
//! to the scalar of the knots: `f32` knots of `f64` poses keep acceleration right to 10⁻⁴ m/s² at 100 knots a second,
//! where `f32` positions 20 m away give it to 3·10⁻² m/s². ([`ScrewKnot`]s to 2·10⁻⁴: what they keep is a twist, and
//! the motion is a product of its parts.)

use super::control::{Attitudes, ControlPoint, Positions, Screw, Screws, Sealed, Window};
use super::turn::Turn;
use crate::se3::{Pose, Twist};
use crate::vector::within;
use crate::{Error, Real, so3};
use nalgebra::{Quaternion, Vector3};

/// A control pose, and the turn and the way to the next one. Made by [`cache`]; a default one waits for that, and makes no
/// curve.
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
        let nowhere = Vector3::from([T::from_f64(f64::NAN); 3]);
        Self { pose: Pose::identity(), turn: Turn::new(nowhere), step: nowhere }
    }
}

/// A control pose, and the screw to the next one. Made by [`cache_screws`]; a default one waits for that, and makes no
/// curve.
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

impl<T: Real> ScrewKnot<T> {
    /// The control pose itself.
    #[must_use]
    pub fn pose(&self) -> Pose<T> {
        self.pose
    }
}

impl<T: Real> Default for ScrewKnot<T> {
    fn default() -> Self {
        let nowhere = Vector3::from([T::from_f64(f64::NAN); 3]);
        let screw = Screw::new(Twist { linear: nowhere, angular: nowhere });
        Self { pose: Pose::identity(), screw }
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

/// Of poses and where each one's knot leads: that it is the next pose, but for the roundings of either. (Poses may be
/// products of many, and off from unit length by more than one rounding.)
fn all_lead_on<T: Real>(mut knots: impl Iterator<Item = (Pose<T>, Pose<T>)>) -> Result<(), Error> {
    let roundings = T::from_f64(64.0) * T::EPSILON;
    let Some((_, mut led)) = knots.next() else { return Ok(()) };
    let leads_on = |(pose, next): (Pose<T>, Pose<T>)| {
        let (a, b) = (led.rotation().coords, pose.rotation().coords);
        // Both signs are the same attitude.
        let near = |x: &T| x.abs() <= roundings;
        let is_turned = (a - b).iter().all(near) || (a + b).iter().all(near);
        let (p, q) = (led.translation(), pose.translation());
        let far = p.iter().chain(q.iter()).fold(T::ONE, |far, x| far + x.abs());
        led = next;
        is_turned && within(&(p - q), roundings * far)
    };
    if knots.all(leads_on) { Ok(()) } else { Err(Error::OutOfRange("points")) }
}

impl<T: Real> Sealed for Knot<T> {}

impl<T: Real> ControlPoint<T> for Knot<T> {
    /// Refuses, naming `points`, knots that do not lead to the next one: not all filled, reversed, or of two curves.
    fn check(points: &[Self]) -> Result<(), Error> {
        all_lead_on(points.iter().map(|knot| {
            let there = so3::product(&knot.pose.rotation(), &so3::exp(knot.turn.vector));
            (knot.pose, Pose::of_unit(there, knot.pose.translation() + knot.step))
        }))
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
    /// As of [`Knot`].
    fn check(points: &[Self]) -> Result<(), Error> {
        all_lead_on(points.iter().map(|knot| (knot.pose, knot.pose.then(&knot.screw.part(T::ONE)))))
    }
}

impl<T: Real> Screws<T> for ScrewKnot<T> {
    #[inline(always)]
    fn screws([a, b, c, d]: &[Self; 4]) -> Window<Pose<T>, Screw<T>> {
        Window { first: a.pose, steps: [a.screw, b.screw, c.screw], last: d.pose }
    }
}
