//! A fast spin under hard vibration, as on a spinning shell or behind a cracked propeller.

use super::waves::{Channel, Instant};
use super::{GRAVITY, Motion, Trajectory};
use crate::Real;
use crate::sensor::Kinematics;
use core::f64::consts::PI;

/// 2000 °/s of roll at 10 m/s, pitching by 30° and yawing by 1 rad/s, shaken at 80 Hz by 5 g and half a degree.
///
/// ```
/// use imu_core::trajectory::{Motion, Spin, Trajectory};
/// let motion: Motion<f64> = Spin::default().at(0);
/// assert!(motion.angular_rate.x > 34.0); // rad/s
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin {
    /// g, m/s².
    pub gravity: f64,
}

impl Default for Spin {
    /// Under [`GRAVITY`].
    fn default() -> Self {
        Self { gravity: GRAVITY }
    }
}

impl Spin {
    fn instant(&self, t: f64) -> Instant {
        const DEGREE: f64 = PI / 180.0;
        const SHAKE: f64 = 160.0 * PI;
        const HALF: f64 = 0.5 * DEGREE;
        /// The amplitude of 5 g.
        const REACH: f64 = 5.0 * GRAVITY / (SHAKE * SHAKE);
        let position = [
            Channel::new(0.0, 10.0, &[(REACH, SHAKE, 0.0)]),
            Channel::new(0.0, 0.0, &[(3.0, 2.0, 0.0), (REACH, SHAKE, 1.0)]),
            Channel::new(0.0, 0.0, &[(2.0, 3.0, 0.0), (REACH, SHAKE, 2.0)]),
        ];
        let angles = [
            Channel::new(0.0, 2000.0 * DEGREE, &[(HALF, SHAKE, 0.0)]),
            Channel::new(0.0, 0.0, &[(30.0 * DEGREE, 4.0, 0.0), (HALF, SHAKE, 0.5 * PI)]),
            Channel::new(0.0, 1.0, &[(0.2 * DEGREE, SHAKE, 1.0)]),
        ];
        Instant::of(&position, &angles, t, self.gravity)
    }
}

impl<T: Real> Trajectory<T> for Spin {
    fn at(&self, t_ns: i64) -> Motion<T> {
        self.instant(t_ns as f64 / 1e9).motion.cast()
    }

    fn kinematics(&self, t_ns: i64, offset_s: f64) -> Kinematics<T> {
        self.instant(t_ns as f64 / 1e9 + offset_s).felt()
    }
}
