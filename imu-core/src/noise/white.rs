//! White noise: independent normal numbers, one a sample.
//!
//! A continuous white noise of density N (rad/s/√Hz for a gyroscope, m/s²/√Hz for an accelerometer;
//! the angle or velocity random walk) averaged over the sampling interval `dt` has the standard
//! deviation N/√dt (IEEE Std 952, annex C; Crassidis & Junkins (2004)). Its Allan variance is N²/τ
//! at every τ.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, Sensor, Stage, Term, White};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let mut noise = White { noise_density: 0.015 }.prepare(0.005, x).unwrap(); // 0.212 rad/s
//! let rate = noise.step(0.5);
//! assert!((rate - 0.5_f64).abs() < 5.0 * 0.212);
//! ```

use super::{Channel, Normal, Stage, Term, TermId, density, interval};
use crate::Error;

/// White noise of a continuous-time density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct White<T> {
    /// N, in the sensor's unit per √Hz; not negative.
    pub noise_density: T,
}

impl<T: Normal> Term<T> for White<T> {
    type Stage = WhiteStage<T>;

    fn prepare(self, dt: T, channel: Channel) -> Result<WhiteStage<T>, Error> {
        let sd = density("noise_density", self.noise_density)? / interval(dt)?.sqrt();
        let sd = density("noise_density / sqrt(dt)", sd)?;
        Ok(WhiteStage { sd, rng: channel.stream(TermId::WHITE) })
    }
}

/// White noise prepared for one sampling interval: 20 bytes in `f32`, 40 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WhiteStage<T: Normal> {
    sd: T,
    rng: T::Generator,
}

impl<T: Normal> Stage<T> for WhiteStage<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        truth + self.sd * T::standard_normal(&mut self.rng)
    }

    /// Zero: white noise is no bias.
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
