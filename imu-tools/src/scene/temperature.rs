//! The temperature of a scene: constant, a ramp, a warm-up, or both.
//!
//! T(t) = start + rate·t + rise·(1 − e^(−t/t_c)); a sensor's bias is its coefficient times what T lies
//! above the temperature at which it was calibrated ([`imu_core::noise::TemperatureRamp`],
//! [`imu_core::noise::WarmUp`]).

use imu_core::noise::{TemperatureRamp, WarmUp};
use serde::Deserialize;

/// How the temperature of both sensors goes.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct Temperature {
    /// T₀, where the bias of temperature is zero, °C.
    pub calibrated_c: f64,
    /// T at the start, °C; `None` is T₀.
    pub start_c: Option<f64>,
    /// r: a steady rise, K/s.
    pub rate_k_s: f64,
    /// What a warm-up adds in the end, K.
    pub rise_k: f64,
    /// t_c of the warm-up, s.
    pub time_constant_s: Option<f64>,
}

impl Default for Temperature {
    /// Constant at the 25 °C of data sheets.
    fn default() -> Self {
        Self {
            calibrated_c: 25.0,
            start_c: None,
            rate_k_s: 0.0,
            rise_k: 0.0,
            time_constant_s: None,
        }
    }
}

impl Temperature {
    /// T, °C, `t_s` after the start.
    pub(super) fn at(&self, t_s: f64) -> f64 {
        let warm = match self.time_constant_s {
            Some(time_constant) => -self.rise_k * libm::expm1(-t_s / time_constant),
            None => 0.0,
        };
        self.start() + self.rate_k_s * t_s + warm
    }

    fn start(&self) -> f64 {
        self.start_c.unwrap_or(self.calibrated_c)
    }

    /// What temperature but for a warm-up does to a sensor of this coefficient, if anything.
    pub(super) fn ramp(&self, coefficient: f64) -> Option<TemperatureRamp<f64>> {
        let start = self.start() - self.calibrated_c;
        let changes = coefficient != 0.0 && (start != 0.0 || self.rate_k_s != 0.0);
        changes.then_some(TemperatureRamp { coefficient, start, rate: self.rate_k_s })
    }

    /// What a warm-up does, if there is one.
    pub(super) fn warm_up(&self, coefficient: f64) -> Option<WarmUp<f64>> {
        let time_constant = self.time_constant_s?;
        let warm_up = WarmUp { coefficient, start: 0.0, rise: self.rise_k, time_constant };
        (coefficient != 0.0).then_some(warm_up)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use imu_core::noise::{Axis, Channel, Sensor, Stage, Term};

    /// What is written as the temperature is what the bias follows, over two time constants: rounding of
    /// 20 000 decrements.
    #[test]
    fn the_bias_follows_the_temperature() {
        let temperature = Temperature {
            start_c: Some(-5.0),
            rate_k_s: 0.02,
            rise_k: 30.0,
            time_constant_s: Some(100.0),
            ..Temperature::default()
        };
        let x = Channel::new(1, Sensor::GYROSCOPE, Axis::X);
        let terms = (temperature.ramp(2e-3).unwrap(), temperature.warm_up(2e-3).unwrap());
        let mut stage = terms.prepare(0.01, x).unwrap();
        for k in 0..20_000 {
            let expected = 2e-3 * (temperature.at(0.01 * f64::from(k)) - 25.0);
            assert!((stage.step(0.0) - expected).abs() < 1e-13, "{k}");
        }
        assert!(Temperature::default().ramp(1.0).is_none());
    }
}
