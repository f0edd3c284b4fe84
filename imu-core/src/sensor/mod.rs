//! What a real sensor makes of a motion, in the order in which it happens.
//!
//! 1. motion → [`LeverArm`]: the sensor is not where the motion is described;
//! 2. → [`ScaleMisalignment`], and for a gyroscope [`GSensitivity`]: what its axes are;
//! 3. → bias and noise: any term of [`noise`](crate::noise), or a tuple of them;
//! 4. → bandwidth: [`OnePole`] or [`TwoPole`];
//! 5. → [`Saturation`];
//! 6. → [`Quantisation`](crate::noise::Quantisation) of the readings.
//!
//! [`Imperfections`] holds one of each, or `()` for what is left out: that costs no byte, no
//! instruction and no random number, and with everything left out the reading is the truth to the
//! bit. From 3 on each axis goes its own way; those stages are terms like the noise, and may also be
//! used in a tuple of [`noise`](crate::noise) alone.
//!
//! ```
//! use imu_core::noise::{Quantisation, RandomWalk, Sensor, White};
//! use imu_core::sensor::{GSensitivity, Imperfections, Kinematics, OnePole, Saturation};
//! use imu_core::sensor::ScaleMisalignment;
//!
//! let imperfections = Imperfections {
//!     lever_arm: (),
//!     scale_misalignment: ScaleMisalignment::scale([0.002, -0.001, 0.0]),
//!     g_sensitivity: GSensitivity { matrix: [[1e-5, 0.0, 0.0]; 3] }, // rad/s per m/s²
//!     noise: [(White { noise_density: 1e-4 }, RandomWalk { random_walk: 1e-6 }); 3],
//!     bandwidth: [OnePole { cutoff: 80.0, start: 0.0, noise_density: 1e-4 }; 3], // Hz
//!     saturation: Saturation { range: 34.9 }, // 2000 °/s
//!     quantisation: Quantisation { step: 34.9 / 32768.0 },
//! };
//! let mut gyroscope = imperfections.gyroscope(0.001, 7, Sensor::GYROSCOPE)?;
//! let spin = Kinematics { angular_rate: [50.0, 0.0, 0.0], ..Kinematics::default() };
//! let mut rate = [0.0; 3];
//! for _ in 0..100 {
//!     rate = gyroscope.measure(&spin);
//! }
//! assert!((rate[0] - 34.9_f64).abs() < 0.01); // saturated
//! # Ok::<(), imu_core::Error>(())
//! ```

mod g_sensitivity;
mod imperfections;
mod lever_arm;
mod one_pole;
mod saturation;
mod scale_misalignment;
mod two_pole;

pub use g_sensitivity::{ForceCoupling, GSensitivity};
pub use imperfections::{Accelerometer, Gyroscope, Imperfections};
pub use lever_arm::{LeverArm, Placement};
pub use one_pole::{OnePole, OnePoleStage};
pub use saturation::Saturation;
pub use scale_misalignment::{AxisMap, ScaleMisalignment};
pub use two_pole::{TwoPole, TwoPoleStage};

use crate::{Error, Real};

/// What an inertial sensor can feel of a motion, at one place and one instant, in body axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kinematics<T> {
    /// ω, rad/s.
    pub angular_rate: [T; 3],
    /// α = dω/dt, rad/s²; only a lever arm asks for it.
    pub angular_acceleration: [T; 3],
    /// f, m/s².
    pub specific_force: [T; 3],
}

/// `matrix` if every element is finite.
fn finite_matrix<T: Real>(name: &'static str, matrix: &[[T; 3]; 3]) -> Result<(), Error> {
    let finite = matrix.iter().flatten().all(|x| x.is_finite());
    if finite { Ok(()) } else { Err(Error::NonFinite(name)) }
}

/// A matrix, row by row, times a vector.
#[inline(always)]
fn product<T: Real>(matrix: &[[T; 3]; 3], [x, y, z]: [T; 3]) -> [T; 3] {
    matrix.map(|[a, b, c]| a * x + b * y + c * z)
}

/// a + b.
#[inline(always)]
fn sum<T: Real>([a, b, c]: [T; 3], [x, y, z]: [T; 3]) -> [T; 3] {
    [a + x, b + y, c + z]
}

/// a × b.
#[inline(always)]
fn cross<T: Real>([a, b, c]: [T; 3], [x, y, z]: [T; 3]) -> [T; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

#[cfg(test)]
mod tests;
