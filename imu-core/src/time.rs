//! Time between samples: integer nanoseconds, made ready for arithmetic once.
//!
//! Time is never summed in floating point: at 1 kHz an `f32` clock stops after 7 hours. Stamps are integers, a
//! [`Step`] is the difference of two of them, and holds what the hot path needs of it: its seconds. While the sensor
//! keeps its rate the same step serves every sample, and no conversion or division stands between two samples.
//!
//! ```
//! use imu_core::time::Step;
//! let step = Step::<f32>::from_nanoseconds(5_000_000)?; // 200 Hz
//! assert_eq!(step.seconds(), 0.005);
//! assert!(Step::<f32>::between(1_000, 1_000).is_err()); // two samples of one instant
//! # Ok::<(), imu_core::Error>(())
//! ```

use crate::{Error, Real};

/// The time from one sample to the next: from 1 ns to 4.29 s.
///
/// What is longer is not a step of an integration but a hole in a recording: begin anew behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<T: Real> {
    nanoseconds: u32,
    seconds: T,
}

impl<T: Real> Step<T> {
    /// A step of so many nanoseconds.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `dt`, below 1 and above 4 294 967 295 ns.
    pub fn from_nanoseconds(nanoseconds: i64) -> Result<Self, Error> {
        match u32::try_from(nanoseconds) {
            Ok(nanoseconds @ 1..) => Ok(Self { nanoseconds, seconds: seconds(nanoseconds.into()) }),
            _ => Err(Error::OutOfRange("dt")),
        }
    }

    /// The step from one stamp to a later one, both in nanoseconds since any beginning.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming `dt`, where the second is not later, or later by more than 4.29 s.
    pub fn between(earlier_ns: i64, later_ns: i64) -> Result<Self, Error> {
        later_ns
            .checked_sub(earlier_ns)
            .ok_or(Error::OutOfRange("dt"))
            .and_then(Self::from_nanoseconds)
    }

    /// Its length in nanoseconds.
    #[must_use]
    #[inline]
    pub fn nanoseconds(&self) -> u32 {
        self.nanoseconds
    }

    /// Its length in seconds, rounded once in `f64`, twice in `f32`.
    #[must_use]
    #[inline]
    pub fn seconds(&self) -> T {
        self.seconds
    }
}

/// Nanoseconds as seconds, without a 64-bit conversion: that is a subroutine on a Cortex-M.
#[inline]
pub(crate) fn seconds<T: Real>(nanoseconds: i64) -> T {
    let (high, low) = ((nanoseconds >> 32) as i32, nanoseconds as u32);
    let part = T::from_u32(low) / T::from_u32(1_000_000_000);
    // Not even a zero of the wrong sign is added to what stands alone.
    if high == 0 { part } else { T::from_i32(high) * T::from_f64(4.294_967_296) + part }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_step_is_longer_than_nothing_and_shorter_than_a_hole() {
        for wrong in [0, -1, i64::MIN, i64::MAX, 1 << 32, 3_600_000_000_000] {
            assert_eq!(Step::<f64>::from_nanoseconds(wrong), Err(Error::OutOfRange("dt")));
        }
        assert!(Step::<f64>::between(i64::MIN, i64::MAX).is_err());
        assert!(Step::<f64>::between(7, 7).is_err() && Step::<f64>::between(8, 7).is_err());
        assert_eq!(Step::<f64>::from_nanoseconds(1).unwrap().seconds(), 1e-9);
        let longest = Step::<f32>::from_nanoseconds(u32::MAX.into()).unwrap();
        assert_eq!(longest.seconds(), (4.294_967_295_f64) as f32);
    }

    proptest! {
        /// A step of less than 4.29 s is rounded once; a longer time thrice, each time by half a unit.
        #[test]
        fn seconds_are_right_to_rounding(nanoseconds in any::<i64>(), step in 1..u32::MAX) {
            prop_assert_eq!(seconds::<f64>(step.into()), f64::from(step) / 1e9);
            let exact = nanoseconds as f64 / 1e9;
            prop_assert!((seconds::<f64>(nanoseconds) - exact).abs() <= 4.0 * f64::EPSILON * exact.abs());
            let single = f64::from(seconds::<f32>(nanoseconds));
            prop_assert!((single - exact).abs() <= 3.0 * f64::from(f32::EPSILON) * (exact.abs() + 4.3));
        }
    }
}
