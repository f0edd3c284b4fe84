//! Coning: an axis that goes round a cone, the classic trial of strapdown attitude.

use super::waves::Instant;
use super::{GRAVITY, Motion, Trajectory, sin_cos};
use crate::Real;
use crate::sensor::Kinematics;
use core::f64::consts::PI;
use nalgebra::{Quaternion, Vector3};

/// Turned by a = 1° about an axis that goes round 25 times a second, at one place:
/// q = (cos a/2, sin a/2 cos wt, sin a/2 sin wt, 0) (Bortz, 1971; Miller, 1983).
///
/// No axis turns on the whole, and yet the z gyroscope reads −w(1 − cos a): what a rule makes of that is its error.
///
/// ```
/// use imu_core::trajectory::{Coning, Motion, Trajectory};
/// let motion: Motion<f64> = Coning::default().at(10_000_000);
/// assert!((motion.angular_rate.z + 0.023_924).abs() < 1e-6); // rad/s
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coning {
    /// g, m/s².
    pub gravity: f64,
}

impl Default for Coning {
    /// Under [`GRAVITY`].
    fn default() -> Self {
        Self { gravity: GRAVITY }
    }
}

impl Coning {
    fn instant(&self, t: f64) -> Instant {
        const RATE: f64 = 50.0 * PI;
        const CONE: f64 = PI / 180.0;
        let ((sin_a, cos_a), (sin_h, cos_h)) = (sin_cos(CONE), sin_cos(0.5 * CONE));
        let (sin, cos) = sin_cos(RATE * t);
        let still = Vector3::new(0.0, 0.0, 0.0);
        let motion = Motion {
            position_w: still,
            velocity_w: still,
            attitude_wb: Quaternion::new(cos_h, sin_h * cos, sin_h * sin, 0.0),
            angular_rate: Vector3::new(-sin_a * sin, sin_a * cos, cos_a - 1.0) * RATE,
            // R(q)ᵀ(0, 0, g), of a rotation by a about (cos wt, sin wt, 0).
            specific_force: Vector3::new(-sin_a * sin, sin_a * cos, cos_a) * self.gravity,
        };
        let angular_acceleration = Vector3::new(-cos, -sin, 0.0) * (sin_a * RATE * RATE);
        Instant { motion, angular_acceleration }
    }
}

impl<T: Real> Trajectory<T> for Coning {
    fn at(&self, t_ns: i64) -> Motion<T> {
        self.instant(t_ns as f64 / 1e9).motion.cast()
    }

    fn kinematics(&self, t_ns: i64, offset_s: f64) -> Kinematics<T> {
        self.instant(t_ns as f64 / 1e9 + offset_s).felt()
    }
}
