//! Something held in the hand of a walker: steps, swings of the arm, and a tremor.

use super::waves::{Channel, Instant};
use super::{GRAVITY, Motion, Trajectory};
use crate::Real;
use crate::sensor::Kinematics;
use core::f64::consts::PI;

/// 1.2 m/s ahead and a slow turn of 0.1 rad/s, with two steps and one stride a second, swings of 5° to 8°, and a
/// tremor of 6 Hz of 2 mm and 1°.
///
/// ```
/// use imu_core::trajectory::{Gait, Motion, Trajectory};
/// let motion: Motion<f64> = Gait::default().at(60_000_000_000);
/// assert!((motion.position_w.x - 72.0).abs() < 0.1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gait {
    /// g, m/s².
    pub gravity: f64,
}

impl Default for Gait {
    /// Under [`GRAVITY`].
    fn default() -> Self {
        Self { gravity: GRAVITY }
    }
}

impl Gait {
    fn instant(&self, t: f64) -> Instant {
        const DEGREE: f64 = PI / 180.0;
        const STRIDE: f64 = 2.0 * PI;
        const STEP: f64 = 4.0 * PI;
        const TREMOR: f64 = 12.0 * PI;
        let position = [
            Channel::new(0.0, 1.2, &[(0.02, STEP, 0.3)]),
            Channel::new(0.0, 0.0, &[(0.03, STRIDE, 0.1), (0.002, TREMOR, 0.0)]),
            Channel::new(1.2, 0.0, &[(0.025, STEP, 0.0), (0.002, TREMOR, 1.0)]),
        ];
        let angles = [
            Channel::new(0.0, 0.0, &[(5.0 * DEGREE, STRIDE, 0.0), (DEGREE, TREMOR, 0.4)]),
            Channel::new(0.0, 0.0, &[(5.0 * DEGREE, STEP, 1.0), (DEGREE, TREMOR, 1.2)]),
            Channel::new(0.0, 0.1, &[(8.0 * DEGREE, STRIDE, 2.0)]),
        ];
        Instant::of(&position, &angles, t, self.gravity)
    }
}

impl<T: Real> Trajectory<T> for Gait {
    fn at(&self, t_ns: i64) -> Motion<T> {
        self.instant(t_ns as f64 / 1e9).motion.cast()
    }

    fn kinematics(&self, t_ns: i64, offset_s: f64) -> Kinematics<T> {
        self.instant(t_ns as f64 / 1e9 + offset_s).felt()
    }
}
