//! A bias that follows a temperature which rises or falls at a constant rate.
//!
//! A climate chamber's ramp, or a flight into colder air: T(t) − T₀ = ΔT + r·t, and the bias is
//! c·(T(t) − T₀), with c the temperature coefficient of a data sheet (for example 0.02 °/s/K) and T₀
//! the temperature at which the sensor was calibrated. So it is a [`ConstantBias`] of c·ΔT and a
//! [`RateRamp`] of c·r, whose Allan variance is (c r)²τ²/2. Temperatures that settle:
//! [`WarmUp`](super::WarmUp).
//!
//! ```
//! use imu_core::noise::{Axis, Channel, Sensor, Stage, TemperatureRamp, Term};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let ramp = TemperatureRamp { coefficient: 2e-4, start: 5.0, rate: 0.5 }; // rad/s/K, K, K/s
//! let mut ramp = ramp.prepare(1.0, x).unwrap();
//! assert_eq!(ramp.bias(), 1e-3_f64);
//! ramp.step(0.0);
//! assert!((ramp.bias() - 1.1e-3).abs() < 1e-15);
//! ```

use super::{Channel, ConstantBias, Normal, RateRamp, RateRampStage, Term};
use crate::Error;

/// A bias proportional to a temperature that changes at a constant rate. It draws no random number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TemperatureRamp<T> {
    /// c, in the sensor's unit per kelvin, of either sign.
    pub coefficient: T,
    /// ΔT = T(0) − T₀, in kelvin.
    pub start: T,
    /// r, in kelvin per second.
    pub rate: T,
}

impl<T: Normal> Term<T> for TemperatureRamp<T> {
    type Stage = (ConstantBias<T>, RateRampStage<T>);

    fn prepare(self, dt: T, channel: Channel) -> Result<Self::Stage, Error> {
        super::finite("coefficient", self.coefficient)?;
        super::finite("start", self.start)?;
        super::finite("rate", self.rate)?;
        let constant = ConstantBias { constant_bias: self.coefficient * self.start };
        let ramp = RateRamp { rate_ramp: self.coefficient * self.rate };
        Ok((constant.prepare(dt, channel)?, ramp.prepare(dt, channel)?))
    }
}
