//! Rate ramp: a bias that grows at a constant rate.
//!
//! Slow deterministic drift: ageing, or a temperature that has not settled. Sample k carries
//! b_k = R·dt·k, with R in the sensor's unit per second, of either sign. Its Allan variance is
//! R²τ²/2, slope +1 (IEEE Std 952, annex C). Samples are counted and not the bias accumulated, so b
//! is right within 2 units in the last place however long the run.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, RateRamp, Sensor, Stage, Term};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let mut ramp = RateRamp { rate_ramp: 1e-6 }.prepare(0.5, x).unwrap();
//! assert_eq!(ramp.step(1.0_f64), 1.0);
//! assert_eq!(ramp.step(1.0), 1.0 + 0.5e-6);
//! ```

use super::counter::Line;
use super::{Channel, Normal, Stage, Term, finite, interval};
use crate::Error;

/// A bias that starts at zero and grows at a constant rate. It draws no random number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateRamp<T> {
    /// R, in the sensor's unit per second, of either sign.
    pub rate_ramp: T,
}

impl<T: Normal> Term<T> for RateRamp<T> {
    type Stage = RateRampStage<T>;

    fn prepare(self, dt: T, _: Channel) -> Result<RateRampStage<T>, Error> {
        let step = finite("rate_ramp", self.rate_ramp)? * interval(dt)?;
        Ok(RateRampStage { line: Line::new(finite("rate_ramp * dt", step)?) })
    }
}

/// A rate ramp prepared for one sampling interval: 16 bytes in `f32`, 24 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateRampStage<T> {
    line: Line<T>,
}

impl<T: Normal> Stage<T> for RateRampStage<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        let measured = truth + self.line.value();
        self.line.advance();
        measured
    }

    #[inline(always)]
    fn bias(&self) -> T {
        self.line.value()
    }
}
