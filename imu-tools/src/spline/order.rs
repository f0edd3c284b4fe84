//! Whether the columns of poses are in the order in which they were read.
//!
//! Whatever a sensor's mounting, gravity stays near one direction of its own axes while it turns about the vertical;
//! read in another order, the same quaternions let it wander about. The mean direction of the vertical in body axes,
//! whose length is 1 where it does not move at all, tells one reading from the other. (Angles between neighbours do
//! not: they are the same in both orders.) Which of two wrong orders it was, scalar first for last or last for first,
//! does not show: the two readings differ by the vertical's sign in body z, and neither sign is wrong.

use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::so3;

use super::TimedPose;

/// A reading in which gravity stays as near as this is one to believe in …
const STEADY: f64 = 0.9;
/// … if it strays by less than this part of what it strays in the reading that was taken, …
const STEADIER: f64 = 0.2;
/// … and does stray there.
const UNSTEADY: f64 = 0.98;

/// The mean over poses of the world's vertical in body axes: times g, what an accelerometer reads of gravity.
fn vertical(
    poses: &[TimedPose],
    read: impl Fn(Quaternion<f64>) -> Quaternion<f64>,
) -> Vector3<f64> {
    let up = Vector3::new(0.0, 0.0, 1.0);
    let sum = poses.iter().fold(Vector3::zeros(), |sum, pose| {
        sum + so3::rotate(&so3::inverse(&read(pose.pose.rotation())), &up)
    });
    sum / (poses.len() as f64).max(1.0)
}

fn length(v: Vector3<f64>) -> f64 {
    v.x.hypot(v.y).hypot(v.z)
}

/// What to tell of poses that look better in another order.
pub(super) fn suspicion(poses: &[TimedPose]) -> Option<String> {
    // What was read as x, y, z, w was w, x, y, z.
    let other_end =
        |q: Quaternion<f64>| Quaternion::new(q.coords.x, q.coords.y, q.coords.z, q.coords.w);
    let here = vertical(poses, |q| q);
    let steady = length(here);
    let (other, what) = [
        (
            vertical(poses, other_end),
            "the scalar of its quaternions stood at their other end (qw qx qy qz for qx qy qz qw, or the reverse)",
        ),
        (vertical(poses, |q| so3::inverse(&q)), "it held the world's poses as the body sees them"),
    ]
    .into_iter()
    .map(|(v, what)| (length(v), what))
    .max_by(|(a, _), (b, _)| a.total_cmp(b))?;
    (other > STEADY && steady < UNSTEADY && 1.0 - other < STEADIER * (1.0 - steady)).then(|| {
        let [x, y, z] = <[f64; 3]>::from(here);
        format!(
            "are the columns in the right order? As they are read, gravity wanders about the body: an accelerometer \
             would show a mean of {x:.2}, {y:.2}, {z:.2} g, {steady:.2} g long; if {what}, it would be {other:.2} g"
        )
    })
}
