//! The errors of a sensor, as a scene has them: public fields, and the keys of its table in a file.

use serde::Deserialize;
use serde::de::{self, Deserializer};

use super::axes::{Axes, matrix, maybe_matrix, three};

/// The errors of one sensor on its axes x, y, z; a zero, or `None`, is one left out.
///
/// What they are and in which order they act: [`imu_core::noise`], [`imu_core::sensor`].
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SensorErrors {
    /// r, from the point that the motion describes to the sensor, in body axes, m. A gyroscope feels it
    /// by its g-sensitivity alone.
    pub lever_arm_m: [f64; 3],
    /// Relative errors of scale.
    #[serde(deserialize_with = "three")]
    pub scale_error: [f64; 3],
    /// Small angles of the sensor's axes, rad: of x towards (y, z), of y towards (x, z), of z towards
    /// (x, y).
    pub misalignment_rad: [[f64; 2]; 3],
    /// M in the place of both: what the axes read is M times the true vector.
    #[serde(deserialize_with = "maybe_matrix")]
    pub scale_misalignment: Option<[[f64; 3]; 3]>,
    /// G, of gyroscopes: what the axes read of specific force, rad/s per m/s².
    #[serde(deserialize_with = "matrix")]
    pub g_sensitivity: [[f64; 3]; 3],
    /// N, in the sensor's unit per √Hz.
    #[serde(deserialize_with = "three")]
    pub noise_density: [f64; 3],
    /// K, in the sensor's unit per second per √Hz.
    #[serde(deserialize_with = "three")]
    pub random_walk: [f64; 3],
    /// A constant offset, in the sensor's unit.
    #[serde(deserialize_with = "three")]
    pub constant_bias: [f64; 3],
    /// Standard deviation of an offset that is drawn once, in the sensor's unit.
    #[serde(deserialize_with = "three")]
    pub turn_on_bias: [f64; 3],
    /// R: growth of the bias, in the sensor's unit per second.
    #[serde(deserialize_with = "three")]
    pub rate_ramp: [f64; 3],
    /// A bias that wanders and forgets.
    pub gauss_markov: Option<GaussMarkovTerm>,
    /// Bias instability.
    pub flicker: Option<FlickerTerm>,
    /// Growth of the bias with the scene's temperature, in the sensor's unit per kelvin.
    #[serde(deserialize_with = "three")]
    pub temperature_coefficient: [f64; 3],
    /// Vibration of one frequency.
    pub vibration: Option<VibrationTerm>,
    /// Vibration of a band.
    pub band_vibration: Option<BandVibrationTerm>,
    /// Cut-off of a low-pass before the sampling, Hz.
    pub lowpass_hz: Option<f64>,
    /// How steep it is.
    pub lowpass_poles: Poles,
    /// Full scale, in the sensor's unit.
    pub saturation: Option<f64>,
    /// One count of the integral, in the sensor's unit times seconds: √12 Q.
    pub increment_quantisation: Option<f64>,
    /// One count of the readings, in the sensor's unit.
    pub quantisation: Option<f64>,
}

/// A first-order Gauss-Markov bias ([`imu_core::noise::GaussMarkov`]).
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct GaussMarkovTerm {
    /// σ, in the sensor's unit.
    pub standard_deviation: Axes,
    /// T, s.
    pub correlation_time_s: f64,
}

/// Bias instability ([`imu_core::noise::Flicker`]).
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct FlickerTerm {
    /// B, in the sensor's unit.
    pub bias_instability: Axes,
    /// The shortest averaging time of the flat, s.
    pub shortest_tau_s: f64,
    /// The longest, s: up to six decades more.
    pub longest_tau_s: f64,
}

/// A sinusoid ([`imu_core::noise::Sinusoid`]).
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct VibrationTerm {
    /// The peak, in the sensor's unit.
    pub amplitude: Axes,
    /// Hz.
    pub frequency_hz: f64,
}

/// Vibration in a band ([`imu_core::noise::BandVibration`]).
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct BandVibrationTerm {
    /// Root mean square, in the sensor's unit.
    pub standard_deviation: Axes,
    /// The middle of the band, Hz.
    pub frequency_hz: f64,
    /// The width of the band at half power, Hz.
    pub bandwidth_hz: f64,
}

/// The poles of a low-pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Poles {
    /// 20 dB a decade ([`imu_core::sensor::OnePole`]).
    #[default]
    One,
    /// 40 dB a decade, Butterworth ([`imu_core::sensor::TwoPole`]).
    Two,
}

impl<'de> Deserialize<'de> for Poles {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        match u64::deserialize(from)? {
            1 => Ok(Self::One),
            2 => Ok(Self::Two),
            other => {
                Err(de::Error::custom(format!("{other} poles cannot be simulated: give 1 or 2")))
            }
        }
    }
}
