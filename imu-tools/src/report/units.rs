//! Units of the noise parameters, and what datasheets call them.

use crate::calibrate::SensorKind;

/// A noise parameter of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// N: white noise.
    NoiseDensity(SensorKind),
    /// K: random walk of the bias.
    RandomWalk(SensorKind),
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

impl Quantity {
    /// What it is called, with its letter.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NoiseDensity(SensorKind::Gyroscope) => "angle random walk N",
            Self::NoiseDensity(SensorKind::Accelerometer) => "velocity random walk N",
            Self::RandomWalk(SensorKind::Gyroscope) => "rate random walk K",
            Self::RandomWalk(SensorKind::Accelerometer) => "acceleration random walk K",
        }
    }

    /// Its SI unit, as a continuous-time density.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::NoiseDensity(SensorKind::Gyroscope) => "rad/s/√Hz",
            Self::NoiseDensity(SensorKind::Accelerometer) => "m/s²/√Hz",
            Self::RandomWalk(SensorKind::Gyroscope) => "rad/s²/√Hz",
            Self::RandomWalk(SensorKind::Accelerometer) => "m/s³/√Hz",
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
        // K = 1 °/h/√h walks the rate by 1 °/h (4.848e-6 rad/s) in an hour: K·√3600 s.
        let walk = Quantity::RandomWalk(SensorKind::Gyroscope).twin();
        let k = 1.0 / walk.per_si;
        assert!((k * 60.0 - (1.0_f64 / 3600.0).to_radians()).abs() < 1e-18);
    }
}
