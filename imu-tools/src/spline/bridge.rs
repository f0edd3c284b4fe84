//! Long holes: no pose decides the curve there, and over hundreds of control points "as smooth as possible" takes more
//! digits than there are, and is no answer at all for rotations, which do not add up.
//!
//! So the straight way and the shortest turn from one side to the other, at an even rate, stand in for the poses that
//! are missing, but for a margin at both ends in which the curve finds from its own motion into that one.

use std::borrow::Cow;

use imu_core::se3::Pose;
use imu_core::so3;

use super::TimedPose;

/// Holes of more than this many steps are bridged.
const LONG: i64 = 16;
/// Steps at both ends of a hole that are left to the curve.
const MARGIN: i64 = 6;

/// How many holes are bridged.
pub(super) fn count(poses: &[TimedPose], step_ns: u32) -> usize {
    let step = i64::from(step_ns);
    poses.windows(2).filter(|two| steps_between(&two[0], &two[1], step) > LONG).count()
}

/// The poses, with more of them in every long hole, one a step.
pub(super) fn bridged(poses: &[TimedPose], step_ns: u32) -> Cow<'_, [TimedPose]> {
    let step = i64::from(step_ns);
    if count(poses, step_ns) == 0 {
        return Cow::Borrowed(poses);
    }
    let mut all = Vec::with_capacity(poses.len());
    for two in poses.windows(2) {
        let [a, b] = [two[0], two[1]];
        all.push(a);
        let steps = steps_between(&a, &b, step);
        if steps > LONG {
            let (from, to) = (a.pose.rotation(), b.pose.rotation());
            let turn = so3::log(&so3::product(&so3::inverse(&from), &to));
            let way = b.pose.translation() - a.pose.translation();
            all.extend((MARGIN..steps - MARGIN).filter_map(|k| {
                let share = k as f64 / steps as f64;
                let rotation = so3::product(&from, &so3::exp(turn * share));
                let pose = Pose::new(rotation, a.pose.translation() + way * share).ok()?;
                Some(TimedPose { stamp_ns: a.stamp_ns.checked_add(k.checked_mul(step)?)?, pose })
            }));
        }
    }
    all.extend(poses.last());
    Cow::Owned(all)
}

fn steps_between(a: &TimedPose, b: &TimedPose, step: i64) -> i64 {
    b.stamp_ns.saturating_sub(a.stamp_ns) / step.max(1)
}
