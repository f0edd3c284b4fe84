//! How far a curve is from the poses it was fitted to.

use imu_core::spline::{Form, Knots, SplitCurve};
use imu_core::{Error, se3::Pose, so3};

use super::TimedPose;

/// Distances between poses and the curve at their instants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Root mean square, m.
    pub rms_position_m: f64,
    /// The largest, m.
    pub largest_position_m: f64,
    /// Where that is, ns.
    pub largest_position_at_ns: i64,
    /// Root mean square of the angle, rad.
    pub rms_rotation_rad: f64,
    /// The largest angle, rad.
    pub largest_rotation_rad: f64,
    /// Where that is, ns.
    pub largest_rotation_at_ns: i64,
}

impl Distance {
    /// Of a curve from poses within its span.
    pub(super) fn of<F: Form<f64>>(
        poses: &[TimedPose],
        knots: &Knots<f64>,
        control: &[Pose<f64>],
    ) -> Result<Self, Error> {
        let curve =
            SplitCurve::<_, _, F>::from_control_points(knots.start_ns(), knots.step_ns(), control)?;
        let begin = knots.start_ns();
        let (mut position, mut rotation) = (Largest::at(begin), Largest::at(begin));
        for TimedPose { stamp_ns, pose } in poses {
            let (metres, radians) = between(&curve.pose(*stamp_ns)?, pose);
            position.add(metres, *stamp_ns);
            rotation.add(radians, *stamp_ns);
        }
        let rms = |sum: f64| (sum / poses.len() as f64).sqrt();
        Ok(Self {
            rms_position_m: rms(position.squares),
            largest_position_m: position.largest,
            largest_position_at_ns: position.at_ns,
            rms_rotation_rad: rms(rotation.squares),
            largest_rotation_rad: rotation.largest,
            largest_rotation_at_ns: rotation.at_ns,
        })
    }
}

/// From one pose to another: m, and rad.
pub(super) fn between(a: &Pose<f64>, b: &Pose<f64>) -> (f64, f64) {
    let length = |[x, y, z]: [f64; 3]| x.hypot(y).hypot(z);
    let turn = so3::product(&so3::inverse(&a.rotation()), &b.rotation());
    (length((b.translation() - a.translation()).into()), length(so3::log(&turn).into()))
}

/// The largest of some distances, and the sum of their squares.
struct Largest {
    largest: f64,
    at_ns: i64,
    squares: f64,
}

impl Largest {
    fn at(at_ns: i64) -> Self {
        Self { largest: 0.0, at_ns, squares: 0.0 }
    }

    fn add(&mut self, distance: f64, at_ns: i64) {
        self.squares += distance * distance;
        if distance > self.largest {
            (self.largest, self.at_ns) = (distance, at_ns);
        }
    }
}
