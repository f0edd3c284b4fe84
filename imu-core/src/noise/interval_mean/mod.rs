//! The mean over the sampling interval: a term as a sensor reads it that averages, or integrates.
//!
//! A reading may be the value at an instant, or the mean over the interval that ends there, as of a
//! sensor that delivers increments Δθ = mean·dt. `IntervalMean(term)` is the second, exact in law for
//! any `dt`: the state at the end of the interval and the mean over it are drawn together. A constant,
//! white noise (which *is* a mean, of N/√dt) and flicker (defined by its Allan deviation alone) need no
//! wrapper. What changes:
//!
//! | term | mean over the interval |
//! | --- | --- |
//! | [`RandomWalk`] | Allan variance K²τ/3 at every τ, without the 1 + 1/(2m²) of samples |
//! | [`GaussMarkov`] | the closed form of a continuous process at every τ |
//! | [`BandVibration`] | (x₁ − x₀)/(ω₀ dt): less of it, and nothing folded down |
//! | [`Sinusoid`] | sin(πf dt)/(πf dt) of it, half an interval late |
//! | [`RateRamp`], [`TemperatureRamp`] | half an interval late |
//! | [`WarmUp`] | the mean of its exponential |
//!
//! A walk starts at zero where the first interval begins.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, IntervalMean, RateRamp, Sensor, Stage, Term};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let mut ramp = IntervalMean(RateRamp { rate_ramp: 1.0 }).prepare(0.5, x).unwrap();
//! assert_eq!([ramp.step(0.0_f64), ramp.step(0.0)], [-0.25, 0.25]); // over −½ … 0, and 0 … ½ s
//! ```

mod band_vibration;
mod deterministic;
mod gauss_markov;
mod random_walk;

pub use band_vibration::BandVibrationMean;
pub use gauss_markov::GaussMarkovMean;
pub use random_walk::RandomWalkMean;

#[cfg(doc)]
use super::{BandVibration, GaussMarkov, RandomWalk, RateRamp, Sinusoid, TemperatureRamp, WarmUp};

/// The mean of a term over the interval that ends at each sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalMean<P>(pub P);
