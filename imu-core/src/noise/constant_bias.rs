//! Constant bias: an offset that every sample carries.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, ConstantBias, Sensor, Stage, Term};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let mut bias = ConstantBias { constant_bias: 0.25 }.prepare(0.005, x).unwrap();
//! assert_eq!(bias.step(1.0_f32), 1.25);
//! ```

use super::{Channel, Normal, Stage, Term, interval};
use crate::Error;

/// A constant offset; prepared, it is its own stage. It draws no random number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantBias<T> {
    /// The offset, in the sensor's unit, of either sign.
    pub constant_bias: T,
}

impl<T: Normal> Term<T> for ConstantBias<T> {
    type Stage = Self;

    fn prepare(self, dt: T, _: Channel) -> Result<Self, Error> {
        interval(dt)?;
        if self.constant_bias.is_finite() {
            Ok(self)
        } else {
            Err(Error::NonFinite("constant_bias"))
        }
    }
}

impl<T: Normal> Stage<T> for ConstantBias<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        truth + self.constant_bias
    }

    #[inline(always)]
    fn bias(&self) -> T {
        self.constant_bias
    }
}
