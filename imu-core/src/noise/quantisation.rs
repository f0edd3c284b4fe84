//! Quantisation of readings: each is rounded to the grid of the converter.
//!
//! What a rate or force sensor with a digital output does: the reading is the nearest multiple of
//! one count q (of two equally near ones, the even). When the signal moves over several counts from
//! sample to sample, which noise of half a count is enough for, the error is uniform and white, of
//! variance q²/12 (Widrow & Kollár (2008), Quantization Noise): an Allan variance of q²dt/(12τ),
//! white noise of density q√(dt/12). When it does not, the reading sticks at one count and the error
//! is whatever the signal makes it. This is *not* the quantisation noise Q of IEEE Std 952, which is
//! [`IncrementQuantisation`](super::IncrementQuantisation).
//!
//! It rounds the measurement as it comes, so it is the last of a tuple.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, Quantisation, Sensor, Stage, Term};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let mut counts = Quantisation { step: 0.25 }.prepare(0.005, x).unwrap();
//! assert_eq!([0.1_f32, 0.2, -0.3].map(|rate| counts.step(rate)), [0.0, 0.25, -0.25]);
//! ```

use super::{Channel, Normal, Stage, Term, interval, positive};
use crate::Error;

/// Rounding of readings to multiples of a step. It draws no random number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantisation<T> {
    /// q, one count, in the sensor's unit; above zero, and its inverse finite.
    pub step: T,
}

impl<T: Normal> Term<T> for Quantisation<T> {
    type Stage = QuantisationStage<T>;

    fn prepare(self, dt: T, _: Channel) -> Result<QuantisationStage<T>, Error> {
        interval(dt)?;
        let step = positive("step", self.step)?;
        Ok(QuantisationStage { step, inverse: super::finite("1 / step", T::ONE / step)? })
    }
}

/// Rounding prepared: 8 bytes in `f32`, 16 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuantisationStage<T> {
    step: T,
    inverse: T,
}

impl<T: Normal> Stage<T> for QuantisationStage<T> {
    /// A reading too large for `f32` counts (more than the largest number of steps) is an infinity;
    /// saturate before.
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        (truth * self.inverse).round_ties_even() * self.step
    }

    /// Zero: rounding is no bias.
    #[inline(always)]
    fn bias(&self) -> T {
        T::ZERO
    }
}
