//! Quantisation of increments: the quantisation noise Q of IEEE Std 952.
//!
//! A sensor that counts angle or velocity (a ring laser gyroscope's fringes, a pulse-rebalanced
//! accelerometer, any chip that delivers Δθ and Δv) rounds the *integral* of what it measures, and
//! reports differences of the rounded integral. The rounding error e_k of the integral at the k-th
//! sampling instant, uniform over one count Δ, has the standard deviation Q = Δ/√12; the rate that
//! is read carries
//!
//! (e_{k+1} − e_k)/dt.
//!
//! Errors cancel between neighbours, so the Allan variance is 3Q²/τ², slope −1, exactly at every
//! τ = m·dt (IEEE Std 952, annex C, equation C.17, for τ ≥ dt). Rounding of *readings* is another
//! thing: [`Quantisation`](super::Quantisation). Here e_k are independent uniform numbers: the limit of
//! a signal that moves over many counts in an interval.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, IncrementQuantisation, Sensor, Stage, Term};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let count: f64 = 1e-6; // rad
//! let term = IncrementQuantisation { quantisation_noise: count / 12_f64.sqrt() };
//! let mut stage = term.prepare(0.005, x).unwrap();
//! let angle: f64 = (0..1000).map(|_| stage.step(0.3) * 0.005).sum();
//! assert!((angle - 1000.0 * 0.3 * 0.005).abs() <= 1.000_001 * count); // no error accumulates
//! ```

use super::{Channel, Normal, Stage, Term, TermId, density, finite, interval};
use crate::Error;
use rand_core::Rng;

/// Quantisation noise of an integral, read as differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IncrementQuantisation<T> {
    /// Q, the standard deviation of the error of the integral: one count divided by √12, in the
    /// sensor's unit times seconds (rad, or m/s); not negative.
    pub quantisation_noise: T,
}

impl<T: Normal> Term<T> for IncrementQuantisation<T> {
    type Stage = IncrementQuantisationStage<T>;

    fn prepare(self, dt: T, channel: Channel) -> Result<IncrementQuantisationStage<T>, Error> {
        let sd = density("quantisation_noise", self.quantisation_noise)? / interval(dt)?;
        // A count is √12 standard deviations wide; a word of 32 bits spreads over it.
        let scale = sd * T::from_f64(3.464_101_615_137_754_6 / 4_294_967_296.0);
        finite("quantisation_noise / dt", sd * T::from_u32(8))?;
        let mut stage = IncrementQuantisationStage {
            last: T::ZERO,
            scale,
            rng: channel.stream(TermId::QUANTISATION),
        };
        stage.last = stage.error();
        Ok(stage)
    }
}

/// Quantisation of increments prepared for one sampling interval: 24 bytes in `f32`, 48 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IncrementQuantisationStage<T: Normal> {
    /// e_k/dt.
    last: T,
    /// One count, divided by dt and by 2³².
    scale: T,
    rng: T::Generator,
}

impl<T: Normal> IncrementQuantisationStage<T> {
    /// e/dt for a new e, uniform over a count and symmetric.
    #[inline(always)]
    fn error(&mut self) -> T {
        let word = i32::from_ne_bytes(self.rng.next_u32().to_ne_bytes());
        (T::from_i32(word) + T::from_f64(0.5)) * self.scale
    }
}

impl<T: Normal> Stage<T> for IncrementQuantisationStage<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        let next = self.error();
        let measured = truth + (next - self.last);
        self.last = next;
        measured
    }

    /// Zero: an error that the next sample takes back is no bias.
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
