//! What noise makes of a delta: densities in, a covariance out, as plain data.

use crate::{Error, Real};
use nalgebra::Matrix3;

/// Continuous-time densities of an IMU's noise, the same on each axis of a sensor.
///
/// The numbers of a calibration: `imu calibrate`, Kalibr's `imu.yaml`, or a datasheet, not multiplied by the root of
/// any rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseDensities<T: Real> {
    /// N_g, white noise of the gyroscope (angle random walk), rad/s/√Hz.
    pub gyro_noise_density: T,
    /// N_a, white noise of the accelerometer (velocity random walk), m/s²/√Hz.
    pub accel_noise_density: T,
    /// K_g, random walk of the gyroscope's bias, rad/s²/√Hz.
    pub gyro_random_walk: T,
    /// K_a, random walk of the accelerometer's bias, m/s³/√Hz.
    pub accel_random_walk: T,
}

/// The largest density: its square is far from overflow in `f32`, and no sensor is so bad.
const LIMIT: f64 = 1e6;

impl<T: Real> NoiseDensities<T> {
    /// The squares: power spectral densities.
    pub(super) fn squared(&self) -> Result<Self, Error> {
        let square = |density: T, what| {
            // NaN is not in it.
            if (T::ZERO..=T::from_f64(LIMIT)).contains(&density) {
                Ok(density * density)
            } else {
                Err(Error::OutOfRange(what))
            }
        };
        Ok(Self {
            gyro_noise_density: square(self.gyro_noise_density, "gyro_noise_density")?,
            accel_noise_density: square(self.accel_noise_density, "accel_noise_density")?,
            gyro_random_walk: square(self.gyro_random_walk, "gyro_random_walk")?,
            accel_random_walk: square(self.accel_random_walk, "accel_random_walk")?,
        })
    }
}

/// Covariance of a delta's errors (δθ, δv, δp): the six blocks on and above the diagonal.
///
/// δθ perturbs the rotation on the right, R Exp(δθ), in the frame at the end, rad; δv in m/s and δp in m are in the
/// frame at the beginning. A block below the diagonal is the transpose of its twin above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covariance<T: Real> {
    /// E\[δθ δθᵀ\], rad².
    pub rotation: Matrix3<T>,
    /// E\[δθ δvᵀ\], rad m/s.
    pub rotation_velocity: Matrix3<T>,
    /// E\[δθ δpᵀ\], rad m.
    pub rotation_position: Matrix3<T>,
    /// E\[δv δvᵀ\], m²/s².
    pub velocity: Matrix3<T>,
    /// E\[δv δpᵀ\], m²/s.
    pub velocity_position: Matrix3<T>,
    /// E\[δp δpᵀ\], m².
    pub position: Matrix3<T>,
}
