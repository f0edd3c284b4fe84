//! Saturation: a reading ends at the full scale of the sensor.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, Sensor, Stage, Term};
//! use imu_core::sensor::Saturation;
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let mut limit = Saturation { range: 35.0 }.prepare(0.005, x).unwrap();
//! assert_eq!([34.0_f32, 36.0, -50.0].map(|rate| limit.step(rate)), [34.0, 35.0, -35.0]);
//! ```

use crate::noise::{Channel, Normal, Stage, Term, interval, positive};
use crate::{Error, Real};

/// Full scale of a sensor, the same to both sides. It draws no random number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saturation<T> {
    /// The largest reading, in the sensor's unit; above zero.
    pub range: T,
}

impl<T: Normal> Term<T> for Saturation<T> {
    type Stage = Self;

    fn prepare(self, dt: T, _: Channel) -> Result<Self, Error> {
        interval(dt)?;
        positive("range", self.range)?;
        Ok(self)
    }
}

impl<T: Normal> Stage<T> for Saturation<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        if truth > self.range {
            self.range
        } else if truth < -self.range {
            -self.range
        } else {
            truth
        }
    }

    /// Zero: what it does to a bias is no bias of its own.
    #[inline(always)]
    fn bias(&self) -> T {
        <T as Real>::ZERO
    }
}
