//! Standing still and level at the origin: ω = 0, f = (0, 0, g).

use super::{GRAVITY, Motion, Trajectory};
use crate::Real;
use crate::sensor::Kinematics;
use nalgebra::{Quaternion, Vector3};

/// A body at rest, level, at the world's origin.
///
/// ```
/// use imu_core::nalgebra::Vector3;
/// use imu_core::trajectory::{Motion, Rest, Trajectory};
/// let motion: Motion<f32> = Rest::default().at(1_000_000_000);
/// assert_eq!(motion.specific_force, Vector3::new(0.0, 0.0, 9.81));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// g, m/s².
    pub gravity: f64,
}

impl Default for Rest {
    /// At rest under [`GRAVITY`].
    fn default() -> Self {
        Self { gravity: GRAVITY }
    }
}

impl<T: Real> Trajectory<T> for Rest {
    fn at(&self, _: i64) -> Motion<T> {
        let zero = Vector3::from([T::ZERO; 3]);
        Motion {
            position_w: zero,
            velocity_w: zero,
            attitude_wb: Quaternion::new(T::ONE, T::ZERO, T::ZERO, T::ZERO),
            angular_rate: zero,
            specific_force: Vector3::new(T::ZERO, T::ZERO, T::from_f64(self.gravity)),
        }
    }

    fn kinematics(&self, _: i64, _: f64) -> Kinematics<T> {
        Kinematics {
            specific_force: [T::ZERO, T::ZERO, T::from_f64(self.gravity)],
            ..Kinematics::default()
        }
    }
}
