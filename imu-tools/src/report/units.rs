//! Units of the noise parameters, and what datasheets call them.

use imu_core::allan::Parameter;

use crate::calibrate::{AxisNoise, SensorKind, SensorNoise};

/// A noise parameter of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// N: white noise.
    NoiseDensity(SensorKind),
    /// K: random walk of the bias.
    RandomWalk(SensorKind),
    /// B: flicker.
    BiasInstability(SensorKind),
    /// Q: quantisation of the integral.
    Quantisation(SensorKind),
    /// R: a steady drift.
    RateRamp(SensorKind),
}

/// The unit that datasheets use, and the factor to it from SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twin {
    /// The unit.
    pub unit: &'static str,
    /// How many of it one SI unit is.
    pub per_si: f64,
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;
const MICRO_G: f64 = 1e6 / 9.806_65;

/// Where a parameter stands in the noise of an axis; `None` of one that was not asked for.
pub type Of = fn(&AxisNoise) -> Option<Parameter>;

impl Quantity {
    /// All parameters of a sensor, and where they stand in the noise of an axis.
    #[must_use]
    pub fn all(kind: SensorKind) -> [(Self, Of); 5] {
        [
            (Self::NoiseDensity(kind), |axis| Some(axis.noise_density)),
            (Self::RandomWalk(kind), |axis| Some(axis.random_walk)),
            (Self::BiasInstability(kind), |axis| axis.bias_instability),
            (Self::Quantisation(kind), |axis| axis.quantisation),
            (Self::RateRamp(kind), |axis| axis.rate_ramp),
        ]
    }

    /// Those of them that some axis of a sensor, or all axes together, have.
    pub fn fitted(sensor: &SensorNoise) -> impl Iterator<Item = (Self, Of)> {
        Self::all(sensor.kind).into_iter().filter(|(_, of)| {
            sensor.axes.iter().chain([&sensor.pooled]).any(|axis| of(axis).is_some())
        })
    }

    /// What it is called, with its letter.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NoiseDensity(SensorKind::Gyroscope) => "angle random walk N",
            Self::NoiseDensity(SensorKind::Accelerometer) => "velocity random walk N",
            Self::RandomWalk(SensorKind::Gyroscope) => "rate random walk K",
            Self::RandomWalk(SensorKind::Accelerometer) => "acceleration random walk K",
            Self::BiasInstability(_) => "bias instability B",
            Self::Quantisation(SensorKind::Gyroscope) => "angle quantisation Q",
            Self::Quantisation(SensorKind::Accelerometer) => "velocity quantisation Q",
            Self::RateRamp(SensorKind::Gyroscope) => "rate ramp R",
            Self::RateRamp(SensorKind::Accelerometer) => "acceleration ramp R",
        }
    }

    /// Its SI unit; of N and K that of a continuous-time density.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::NoiseDensity(SensorKind::Gyroscope) => "rad/s/√Hz",
            Self::NoiseDensity(SensorKind::Accelerometer) => "m/s²/√Hz",
            Self::RandomWalk(kind) => kind.walk_unit(),
            Self::BiasInstability(kind) => kind.unit(),
            Self::Quantisation(SensorKind::Gyroscope) => "rad",
            Self::Quantisation(SensorKind::Accelerometer) => "m/s",
            Self::RateRamp(SensorKind::Gyroscope) => "rad/s²",
            Self::RateRamp(SensorKind::Accelerometer) => "m/s³",
        }
    }

    /// Further units that datasheets use for it.
    #[must_use]
    pub const fn further_twins(self) -> &'static [Twin] {
        match self {
            Self::NoiseDensity(SensorKind::Gyroscope) => &[
                Twin { unit: "°/s/√Hz", per_si: DEGREES },
                Twin { unit: "mdps/√Hz", per_si: DEGREES * 1000.0 },
            ],
            Self::NoiseDensity(SensorKind::Accelerometer) => {
                &[Twin { unit: "m/s/√h", per_si: 60.0 }]
            }
            _ => &[],
        }
    }

    /// Its unit in datasheets: 1 rad/s/√Hz is 1 rad/√s = 60 rad/√h; a rate walks by K·√h in an hour.
    #[must_use]
    pub const fn twin(self) -> Twin {
        match self {
            Self::NoiseDensity(SensorKind::Gyroscope) => {
                Twin { unit: "°/√h", per_si: DEGREES * 60.0 }
            }
            Self::NoiseDensity(SensorKind::Accelerometer) => {
                Twin { unit: "µg/√Hz", per_si: MICRO_G }
            }
            Self::RandomWalk(SensorKind::Gyroscope) => {
                Twin { unit: "°/h/√h", per_si: DEGREES * 3600.0 * 60.0 }
            }
            Self::RandomWalk(SensorKind::Accelerometer) => {
                Twin { unit: "µg/√h", per_si: MICRO_G * 60.0 }
            }
            Self::BiasInstability(SensorKind::Gyroscope) => {
                Twin { unit: "°/h", per_si: DEGREES * 3600.0 }
            }
            Self::BiasInstability(SensorKind::Accelerometer) => {
                Twin { unit: "µg", per_si: MICRO_G }
            }
            Self::Quantisation(SensorKind::Gyroscope) => {
                Twin { unit: "arcsec", per_si: DEGREES * 3600.0 }
            }
            Self::Quantisation(SensorKind::Accelerometer) => Twin { unit: "mm/s", per_si: 1000.0 },
            Self::RateRamp(SensorKind::Gyroscope) => {
                Twin { unit: "°/h/h", per_si: DEGREES * 3600.0 * 3600.0 }
            }
            Self::RateRamp(SensorKind::Accelerometer) => {
                Twin { unit: "µg/h", per_si: MICRO_G * 3600.0 }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn datasheet_twins() {
        // 1 °/√h = π/180/60 rad/√s; 1 µg/√Hz = 9.80665e-6 m/s²/√Hz.
        let gyro = Quantity::NoiseDensity(SensorKind::Gyroscope).twin();
        assert!((std::f64::consts::PI / 180.0 / 60.0 * gyro.per_si - 1.0).abs() < 1e-12);
        let accel = Quantity::NoiseDensity(SensorKind::Accelerometer).twin();
        assert!((9.806_65e-6 * accel.per_si - 1.0).abs() < 1e-12);
        // 0.005 °/s/√Hz = 5 mdps/√Hz = 0.3 °/√h.
        let n = 0.3 / gyro.per_si;
        let further = Quantity::NoiseDensity(SensorKind::Gyroscope).further_twins();
        assert!((n * further[0].per_si - 0.005).abs() < 1e-15);
        assert!((n * further[1].per_si - 5.0).abs() < 1e-12);
        // K = 1 °/h/√h walks the rate by 1 °/h (4.848e-6 rad/s) in an hour: K·√3600 s.
        let walk = Quantity::RandomWalk(SensorKind::Gyroscope).twin();
        let k = 1.0 / walk.per_si;
        assert!((k * 60.0 - (1.0_f64 / 3600.0).to_radians()).abs() < 1e-18);
        // A ramp of 1 °/h/h changes the rate by 1 °/h in an hour; B is a rate, Q an angle of 1/3600 °.
        let of = |quantity: Quantity| 1.0 / quantity.twin().per_si;
        let hourly = (1.0_f64 / 3600.0).to_radians();
        let kind = SensorKind::Gyroscope;
        assert!((of(Quantity::RateRamp(kind)) * 3600.0 - hourly).abs() < 1e-18);
        assert!((of(Quantity::BiasInstability(kind)) - hourly).abs() < 1e-18);
        assert!((of(Quantity::Quantisation(kind)) - hourly).abs() < 1e-18);
    }
}
