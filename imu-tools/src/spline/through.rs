//! A curve through every pose, where their stamps are as good as equally spaced: rounded to microseconds, say.
//!
//! Poses at the instants of knots are interpolated by the core. Where a stamp is beside its knot, what the curve lacks
//! of the pose there is added to what is interpolated at the knot, until nothing is lacking: each round leaves at most
//! a quarter of it for stamps within an eighth of a step. (Least squares would do it as well, but for the ends: their
//! two free control points would follow the smoothest way, and not the motion.)

use imu_core::Error;
use imu_core::nalgebra::Vector3;
use imu_core::se3::Pose;
use imu_core::so3;
use imu_core::spline::{Form, Knots, SplitCurve, interpolate};

use super::TimedPose;

/// Stamps may be so far from their knots, in steps: one part in this.
const PART: i128 = 8;
/// So near a curve goes through a pose: rad, and parts of the largest distance from the first pose (or of 1 m).
const THROUGH: f64 = 1e-12;
/// Rounds, at most: 4⁻³⁰ is beyond the digits.
const MOST_ROUNDS: usize = 30;

/// Whether a knot each is near every pose, and the last one not before its knot's end of the curve.
pub(super) fn are_near(poses: &[TimedPose], step_ns: u32) -> bool {
    let (Some(first), Some(last)) = (poses.first(), poses.last()) else { return false };
    let since = |pose: &TimedPose| i128::from(pose.stamp_ns) - i128::from(first.stamp_ns);
    let step = i128::from(step_ns);
    let near =
        |(k, pose): (usize, &TimedPose)| (since(pose) - k as i128 * step).abs() * PART <= step;
    since(last) <= (poses.len() as i128 - 1) * step && poses.iter().enumerate().all(near)
}

/// Control points of a curve through poses that [`are_near`] their knots; none where they turn so far that sweeps or
/// rounds do not end at the poses.
///
/// # Errors
/// As of [`interpolate`].
pub(super) fn control<F: Form<f64>>(
    poses: &[TimedPose],
    knots: &Knots<f64>,
) -> Result<Option<Vec<Pose<f64>>>, Error> {
    // From the first pose: the digits of a place far from home would be lost between rounds.
    let home = poses[0].pose.translation();
    let from_home = |pose: &Pose<f64>| Pose::new(pose.rotation(), pose.translation() - home);
    let poses = poses
        .iter()
        .map(|TimedPose { stamp_ns, pose }| {
            Ok(TimedPose { stamp_ns: *stamp_ns, pose: from_home(pose)? })
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let mut at_knots: Vec<_> = poses.iter().map(|pose| pose.pose).collect();
    let mut control = vec![Pose::identity(); knots.count()];
    let mut scratch = vec![Vector3::zeros(); poses.len()];
    let mut error = interpolate::<_, F>(&at_knots, &mut control, &mut scratch)?.rotation_error;
    let is_at = |(k, pose): (usize, &TimedPose)| {
        i128::from(pose.stamp_ns)
            == i128::from(knots.start_ns()) + (k as i128 + 1) * i128::from(knots.step_ns())
    };
    if !poses.iter().enumerate().all(is_at) {
        let scale =
            poses.iter().fold(1.0_f64, |m, pose| m.max(pose.pose.translation().abs().max()));
        let mut before = f64::INFINITY;
        for _ in 0..MOST_ROUNDS {
            error = lacking::<F>(&poses, knots, &control, &mut at_knots, scale)?;
            // Down to rounding, which does not fall any more.
            if error >= 0.5 * before {
                break;
            }
            before = error;
            interpolate::<_, F>(&at_knots, &mut control, &mut scratch)?;
        }
    }
    if error > THROUGH {
        return Ok(None);
    }
    let back = |pose: &Pose<f64>| Pose::new(pose.rotation(), pose.translation() + home);
    control.iter().map(back).collect::<Result<_, _>>().map(Some)
}

/// Adds what the curve lacks of every pose to what is interpolated at its knot; the largest of it, rad, or parts of
/// `scale`, m.
fn lacking<F: Form<f64>>(
    poses: &[TimedPose],
    knots: &Knots<f64>,
    control: &[Pose<f64>],
    at_knots: &mut [Pose<f64>],
    scale: f64,
) -> Result<f64, Error> {
    let curve =
        SplitCurve::<_, _, F>::from_control_points(knots.start_ns(), knots.step_ns(), control)?;
    let mut largest = 0.0_f64;
    for (at_knot, TimedPose { stamp_ns, pose }) in at_knots.iter_mut().zip(poses) {
        let there = curve.pose(*stamp_ns)?;
        let moved = pose.translation() - there.translation();
        let turned = so3::log(&so3::product(&so3::inverse(&there.rotation()), &pose.rotation()));
        largest = largest.max(moved.abs().max() / scale).max(turned.abs().max());
        let rotation = so3::product(&at_knot.rotation(), &so3::exp(turned));
        *at_knot = Pose::new(rotation, at_knot.translation() + moved)?;
    }
    Ok(largest)
}
