//! The mean of band vibration over each interval.
//!
//! The vibration is u = ẋ/ω₀, so its mean over an interval is (x₁ − x₀)/(ω₀ dt), exactly: the same
//! states and numbers as [`BandVibration`]'s, read as a difference. It telescopes: no mean over a longer
//! time exceeds what x reaches.

use super::IntervalMean;
use crate::Error;
use crate::noise::{
    BandVibration, BandVibrationStage, Channel, Normal, Stage, Term, finite, interval,
};
use core::f64::consts::TAU;

impl<T: Normal> Term<T> for IntervalMean<BandVibration<T>> {
    type Stage = BandVibrationMean<T>;

    fn prepare(self, dt: T, channel: Channel) -> Result<BandVibrationMean<T>, Error> {
        let states = self.0.prepare(dt, channel)?;
        let angle = TAU * self.0.frequency.to_f64() * interval(dt)?.to_f64();
        let inverse = finite("1 / (frequency * dt)", T::from_f64(1.0 / angle))?;
        Ok(BandVibrationMean { states, inverse })
    }
}

/// Means of band vibration, prepared for one sampling interval: 56 bytes in `f32`, 112 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandVibrationMean<T: Normal> {
    states: BandVibrationStage<T>,
    /// 1/(ω₀ dt).
    inverse: T,
}

impl<T: Normal> Stage<T> for BandVibrationMean<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        truth + self.states.advance() * self.inverse
    }

    /// Zero: vibration is no bias.
    #[inline(always)]
    fn bias(&self) -> T {
        T::ZERO
    }

    #[inline]
    fn apply(&mut self, samples: &mut [T]) {
        // A copy of the generator stays in registers over the loop.
        let mut stage = *self;
        for sample in samples {
            *sample = stage.step(*sample);
        }
        *self = stage;
    }
}
