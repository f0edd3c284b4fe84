//! What a real sensor adds to the truth: error terms, composed at compile time.
//!
//! A *term* holds continuous-time parameters ([`White`], [`RandomWalk`], [`ConstantBias`]); a tuple
//! of terms is a term. [`Term::prepare`] turns it, once, for a sampling interval, into a *stage*: a
//! small `Copy` value that turns truth into measurement with additions, multiplications and a
//! normal number, without exponential or square root outside the normal's rare branches. Every term
//! of every axis draws from its own stream ([`Channel`]), so that switching one never changes
//! another's numbers. The same stream gives other numbers in `f32` than in `f64`; each the same on
//! every target.
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

mod compose;
mod constant_bias;
mod normal;
mod random_walk;
mod stream;
mod white;
mod xoshiro;
mod ziggurat_tables;

pub use compose::ThreeAxis;
pub use constant_bias::ConstantBias;
pub use normal::Normal;
pub use random_walk::{RandomWalk, RandomWalkStage};
pub use stream::{Axis, Channel, Sensor, TermId};
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
fn density<T: Real>(name: &'static str, value: T) -> Result<T, Error> {
    if !value.is_finite() {
        Err(Error::NonFinite(name))
    } else if value < T::ZERO {
        Err(Error::OutOfRange(name))
    } else {
        Ok(value)
    }
}

/// `dt` if it is finite and above zero.
fn interval<T: Real>(dt: T) -> Result<T, Error> {
    if density("dt", dt)? > T::ZERO { Ok(dt) } else { Err(Error::OutOfRange("dt")) }
}
