//! When each sample is due: t₀ + round(i·10⁹/rate) nanoseconds, in integers, for any length.

use crate::error::Error;

/// Nanoseconds a second times micro-hertz a hertz.
const NS_UHZ: u64 = 1_000_000_000_000_000;

/// A sampling rate, held in whole micro-hertz so that stamps are exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    micro_hz: u64,
}

impl Rate {
    /// 200 Hz.
    pub(super) const DEFAULT: Self = Self { micro_hz: 200_000_000 };

    /// The rate nearest to `hz` in steps of 1 µHz.
    ///
    /// # Errors
    /// Outside 0.001 Hz to 1 MHz.
    pub fn from_hz(hz: f64) -> Result<Self, Error> {
        if (1e-3..=1e6).contains(&hz) {
            Ok(Self { micro_hz: (hz * 1e6).round() as u64 })
        } else {
            Err(Error::usage(format!(
                "a rate of {hz} Hz cannot be simulated: give one from 0.001 to 1000000"
            )))
        }
    }

    /// Samples a second.
    #[must_use]
    pub fn hz(self) -> f64 {
        self.micro_hz as f64 / 1e6
    }

    /// Seconds between samples.
    #[must_use]
    pub fn interval_s(self) -> f64 {
        1e6 / self.micro_hz as f64
    }

    /// The offsets of samples 0, 1, 2, … from the first, ns.
    pub fn offsets(self) -> impl Iterator<Item = i64> {
        Ticks::new(self)
    }

    /// Whether a sample is due this long after the first and no earlier: `samples_in` does not count it.
    pub(super) fn is_due_at(self, offset_ns: u64) -> bool {
        let (exact, rate) = (u128::from(offset_ns) * u128::from(self.micro_hz), u128::from(NS_UHZ));
        let sample = u128::from(self.samples_in(offset_ns));
        // Its exact time is not before this one, and less than half a nanosecond after it.
        2 * (sample * rate - exact) < u128::from(self.micro_hz)
    }

    /// Samples due in `[0, duration)`: 4 h at 200 Hz are 2 880 000.
    #[must_use]
    pub fn samples_in(self, duration_ns: u64) -> u64 {
        let exact = u128::from(duration_ns) * u128::from(self.micro_hz);
        u64::try_from(exact.div_ceil(u128::from(NS_UHZ))).unwrap_or(u64::MAX)
    }
}

/// The offsets of samples 0, 1, 2, … from the first, one after the other without a division.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ticks {
    offset_ns: i64,
    /// Twice the fraction of a nanosecond left over (plus one half, for rounding) in units of
    /// 1/rate: below `2·rate`.
    rest: u64,
    rate: Rate,
}

impl Ticks {
    pub(super) const fn new(rate: Rate) -> Self {
        Self { offset_ns: 0, rest: rate.micro_hz, rate }
    }
}

impl Iterator for Ticks {
    type Item = i64;

    #[inline]
    fn next(&mut self) -> Option<i64> {
        let now = self.offset_ns;
        let rate = self.rate.micro_hz;
        self.rest += 2 * (NS_UHZ % rate);
        let carry = self.rest >= 2 * rate;
        self.rest -= if carry { 2 * rate } else { 0 };
        let step = (NS_UHZ / rate) as i64 + i64::from(carry);
        self.offset_ns = now.saturating_add(step);
        Some(now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn four_hours_at_200_hz_are_exactly_2_880_000() {
        let rate = Rate::from_hz(200.0).unwrap();
        let duration = 4 * 3600 * 1_000_000_000;
        assert_eq!(rate.samples_in(duration), 2_880_000);
        assert_eq!(rate.samples_in(duration + 1), 2_880_001);
        assert_eq!(rate.samples_in(0), 0);
        assert!(rate.is_due_at(duration) && rate.is_due_at(0) && !rate.is_due_at(duration + 1));
        let third = Rate::from_hz(3.0).unwrap();
        let due = |offset_ns| third.is_due_at(offset_ns);
        assert!(due(333_333_333) && !due(333_333_334) && !due(666_666_666) && due(1_000_000_000));
        assert_eq!(Ticks::new(rate).nth(2_879_999), Some(14_400_000_000_000 - 5_000_000));
    }

    #[test]
    fn a_third_of_a_second_is_rounded_and_never_drifts() {
        let ticks = Ticks::new(Rate::from_hz(3.0).unwrap());
        let expected = [0, 333_333_333, 666_666_667, 1_000_000_000, 1_333_333_333];
        assert!(ticks.take(5).eq(expected));
    }

    #[test]
    fn rates_that_cannot_be_are_refused() {
        for hz in [0.0, -200.0, f64::NAN, f64::INFINITY, 1e7] {
            assert!(Rate::from_hz(hz).is_err(), "{hz}");
        }
    }

    proptest! {
        #[test]
        fn every_offset_is_the_rounded_quotient(micro_hz in 1_000_u64..1_000_000_000_000) {
            let rate = Rate { micro_hz };
            for (i, offset) in Ticks::new(rate).take(100).enumerate() {
                let (n, d) = (i as u128 * u128::from(NS_UHZ), u128::from(micro_hz));
                prop_assert_eq!(offset as u128, (2 * n + d) / (2 * d));
            }
        }
    }
}
