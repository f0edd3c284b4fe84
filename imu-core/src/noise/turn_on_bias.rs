//! Turn-on bias: an offset that is another in every run, and constant within one.
//!
//! What a data sheet calls bias repeatability (run to run): drawn once from a normal law of standard
//! deviation σ, in the sensor's unit, when the term is prepared; thereafter a
//! [`ConstantBias`]. A constant has no Allan variance (IEEE Std 952 lists it under bias, not under
//! noise).
//!
//! ```
//! use imu_core::noise::{Axis, Channel, Sensor, Stage, Term, TurnOnBias};
//! let run = |seed| {
//!     let x = Channel::new(seed, Sensor::GYROSCOPE, Axis::X);
//!     TurnOnBias { standard_deviation: 1e-3_f64 }.prepare(0.005, x).unwrap().bias()
//! };
//! assert_eq!(run(1), run(1));
//! assert_ne!(run(1), run(2));
//! ```

use super::{Channel, ConstantBias, Normal, Term, TermId, density, finite, interval};
use crate::Error;

/// A constant offset drawn once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnOnBias<T> {
    /// σ, in the sensor's unit; not negative.
    pub standard_deviation: T,
}

impl<T: Normal> Term<T> for TurnOnBias<T> {
    type Stage = ConstantBias<T>;

    fn prepare(self, dt: T, channel: Channel) -> Result<ConstantBias<T>, Error> {
        interval(dt)?;
        let sd = density("standard_deviation", self.standard_deviation)?;
        let mut rng: T::Generator = channel.stream(TermId::TURN_ON_BIAS);
        let constant_bias = finite("standard_deviation", sd * T::standard_normal(&mut rng))?;
        Ok(ConstantBias { constant_bias })
    }
}
