//! What a real sensor adds to the truth: error terms, composed at compile time.
//!
//! A *term* holds continuous-time parameters (the table below); a tuple of up to twelve terms is a
//! term. [`Term::prepare`] turns it, once, for a sampling interval, into a *stage*: a
//! small `Copy` value that turns truth into measurement with additions, multiplications and a
//! normal number, without exponential or square root outside the normal's rare branches. Every term
//! of every axis draws from its own stream ([`Channel`]), so that switching one never changes
//! another's numbers. The same stream gives other numbers in `f32` than in `f64`; each the same on
//! every target.
//!
//! | term | Allan variance |
//! | --- | --- |
//! | [`White`]: noise density N | N²/τ |
//! | [`RandomWalk`]: bias random walk K | K²τ/3 |
//! | [`Flicker`]: bias instability B | (2 ln 2/π)B², over the τ asked for |
//! | [`GaussMarkov`]: a bias that forgets after a correlation time | a hump, 0.617 σ high, at 1.89 T |
//! | [`IncrementQuantisation`]: Q, of a sensor that counts increments | 3Q²/τ² |
//! | [`Quantisation`]: readings rounded to a grid of step q | q²dt/(12τ), when the reading moves |
//! | [`RateRamp`]: a bias that grows by R a second | R²τ²/2 |
//! | [`ConstantBias`], [`TurnOnBias`]: known, and drawn once a run | 0 |
//! | [`TemperatureRamp`], [`WarmUp`]: a bias that follows the temperature | that of a ramp |
//! | [`Sinusoid`], [`BandVibration`]: vibration of one frequency, or of a band | peaks at 0.37/f |
//! | [`IntervalMean`] of any that is not constant: what an averaging sensor reads | at τ ≫ dt the same |
//!
//! ```
//! use imu_core::noise::{RandomWalk, Sensor, Stage, ThreeAxis, White};
//!
//! let dt: f64 = 1.0 / 200.0; // s
//! let terms = (White { noise_density: 0.019 }, RandomWalk { random_walk: 5e-4 });
//! let mut accelerometer = ThreeAxis::prepare([terms; 3], dt, 7, Sensor::ACCELEROMETER)?;
//!
//! let at_rest = [0.0, 0.0, 9.81]; // m/s²
//! for _ in 0..1000 {
//!     let bias = accelerometer.bias(); // the bias that this sample carries
//!     let measured = accelerometer.step(at_rest);
//!     assert!((measured[2] - at_rest[2] - bias[2]).abs() < 6.0 * 0.019 / dt.sqrt());
//! }
//! # Ok::<(), imu_core::Error>(())
//! ```

mod band_vibration;
mod compose;
mod constant_bias;
mod counter;
mod flicker;
mod gauss_markov;
mod increment_quantisation;
mod interval_mean;
mod normal;
mod nth;
mod quantisation;
mod random_walk;
mod rate_ramp;
mod sinusoid;
mod stream;
mod temperature_ramp;
mod turn_on_bias;
mod warm_up;
mod white;
mod xoshiro;
mod ziggurat_tables;

pub use band_vibration::{BandVibration, BandVibrationStage};
pub use compose::ThreeAxis;
pub use constant_bias::ConstantBias;
pub use flicker::{Flicker, FlickerStage};
pub use gauss_markov::{GaussMarkov, GaussMarkovStage, Start};
pub use increment_quantisation::{IncrementQuantisation, IncrementQuantisationStage};
pub use interval_mean::{BandVibrationMean, GaussMarkovMean, IntervalMean, RandomWalkMean};
pub use normal::Normal;
pub use nth::Nth;
pub use quantisation::{Quantisation, QuantisationStage};
pub use random_walk::{RandomWalk, RandomWalkStage};
pub use rate_ramp::{RateRamp, RateRampStage};
pub use sinusoid::{Sinusoid, SinusoidStage};
pub use stream::{Axis, Channel, Sensor, TermId};
pub use temperature_ramp::TemperatureRamp;
pub use turn_on_bias::TurnOnBias;
pub use warm_up::{WarmUp, WarmUpStage};
pub use white::{White, WhiteStage};
pub use xoshiro::{Xoshiro128PlusPlus, Xoshiro256PlusPlus};

use crate::{Error, Real};

/// An error term by its continuous-time parameters.
pub trait Term<T: Normal> {
    /// What it becomes for one sampling interval.
    type Stage: Stage<T> + Copy;

    /// Prepares the term for samples `dt` seconds apart on one axis of one sensor, at the beginning
    /// of its random stream.
    ///
    /// # Errors
    /// [`Error::NonFinite`] or [`Error::OutOfRange`], naming `dt` (which must be above zero) or the
    /// parameter at fault.
    fn prepare(self, dt: T, channel: Channel) -> Result<Self::Stage, Error>;
}

/// An error term at work: truth in, measurement out, one sample after the other.
///
/// `V` is a scalar, or `[T; 3]` for the three axes of a sensor.
pub trait Stage<V> {
    /// The measurement of `truth`, in the unit of the sensor; goes on to the next sample.
    fn step(&mut self, truth: V) -> V;

    /// The bias that the *next* sample carries: read it before its `step`.
    fn bias(&self) -> V;

    /// Turns a run of true values into measurements in place, with the bits of one
    /// [`step`](Stage::step) after the other, and faster on a desktop.
    #[inline]
    fn apply(&mut self, samples: &mut [V])
    where
        V: Copy,
    {
        for sample in samples {
            *sample = self.step(*sample);
        }
    }
}

/// `value` if it is finite and not negative.
pub(crate) fn density<T: Real>(name: &'static str, value: T) -> Result<T, Error> {
    if !value.is_finite() {
        Err(Error::NonFinite(name))
    } else if value < T::ZERO {
        Err(Error::OutOfRange(name))
    } else {
        Ok(value)
    }
}

/// `value` if it is finite.
pub(crate) fn finite<T: Real>(name: &'static str, value: T) -> Result<T, Error> {
    if value.is_finite() { Ok(value) } else { Err(Error::NonFinite(name)) }
}

/// `value` if it is finite and above zero.
pub(crate) fn positive<T: Real>(name: &'static str, value: T) -> Result<T, Error> {
    if density(name, value)? > T::ZERO { Ok(value) } else { Err(Error::OutOfRange(name)) }
}

/// `dt` if it is finite and above zero.
pub(crate) fn interval<T: Real>(dt: T) -> Result<T, Error> {
    positive("dt", dt)
}

#[cfg(test)]
mod terms_tests;
