//! The unit of time, from the times themselves.

use super::number::nanoseconds;
use crate::recording::TimeUnit;

const UNITS: [TimeUnit; 4] =
    [TimeUnit::Seconds, TimeUnit::Milliseconds, TimeUnit::Microseconds, TimeUnit::Nanoseconds];

/// The years 2000 to 2100 as nanoseconds since 1970: they do not overlap with each other's
/// thousandfold, so that a date decides.
const DATES: std::ops::Range<i64> = 946_684_800_000_000_000..4_102_444_800_000_000_000;

/// Sampling intervals from 8.3 kHz to 8.3 Hz, in nanoseconds: a factor of a thousand, so that just
/// one unit fits.
const INTERVALS: std::ops::Range<i64> = 120_000..120_000_000;

/// The unit in which these fields are a date or have the spacing of an IMU; seconds where nothing
/// can be told.
pub fn from_data(times: &[&[u8]]) -> TimeUnit {
    let in_unit = |unit: TimeUnit| -> Vec<i64> {
        times.iter().filter_map(|time| nanoseconds(time, unit.exponent())).collect()
    };
    let dated = |unit: &TimeUnit| in_unit(*unit).first().is_some_and(|t| DATES.contains(t));
    let spaced = |unit: &TimeUnit| {
        let times = in_unit(*unit);
        let mut steps: Vec<i64> =
            times.iter().zip(times.iter().skip(1)).map(|(a, b)| b.saturating_sub(*a)).collect();
        steps.retain(|step| *step > 0);
        steps.sort_unstable();
        steps.get(steps.len() / 2).is_some_and(|step| INTERVALS.contains(step))
    };
    let found = UNITS.into_iter().find(dated).or_else(|| UNITS.into_iter().find(spaced));
    found.unwrap_or(TimeUnit::Seconds)
}

/// The rate in Hz, where no IMU has one like it: its stamps are in another unit.
pub fn implausible_rate(times: &[&[u8]], unit: TimeUnit) -> Option<f64> {
    let times: Vec<i64> =
        times.iter().filter_map(|time| nanoseconds(time, unit.exponent())).collect();
    let steps = times.iter().zip(times.iter().skip(1));
    let mut steps: Vec<f64> = steps.map(|(a, b)| b.saturating_sub(*a) as f64).collect();
    // Bunches make single steps short, and a clock that is set makes one of them long.
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    steps.retain(|step| *step > 0.0);
    steps.sort_unstable_by(f64::total_cmp);
    let usual = *steps.get(steps.len() / 2)?;
    let fast = (mean > 0.0 && mean < 1e3).then_some(1e9 / mean);
    fast.or((usual > 1e13).then_some(1e9 / usual))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_and_spacings() {
        for (times, unit) in [
            (&["1403636579763555584", "1403636579768555584"][..], TimeUnit::Nanoseconds),
            (&["1700000000.005", "1700000000.010"], TimeUnit::Seconds),
            (&["1700000000005", "1700000000010"], TimeUnit::Milliseconds),
            (&["1700000000005000", "1700000000010000"], TimeUnit::Microseconds),
            (&["0.000", "0.005", "0.010"], TimeUnit::Seconds),
            (&["0", "5", "10"], TimeUnit::Milliseconds),
            (&["0", "5000", "10000"], TimeUnit::Microseconds),
            (&["0", "5000000", "10000000"], TimeUnit::Nanoseconds),
            (&["0", "0.1", "0.2"], TimeUnit::Seconds),
            (&["7"], TimeUnit::Seconds),
            (&[], TimeUnit::Seconds),
        ] {
            let fields: Vec<&[u8]> = times.iter().map(|t| t.as_bytes()).collect();
            assert_eq!(from_data(&fields), unit, "{times:?}");
            assert_eq!(implausible_rate(&fields, unit), None, "{times:?}");
        }
    }

    #[test]
    fn rates_of_no_imu() {
        let rate = |times: &[&str], unit| {
            let fields: Vec<&[u8]> = times.iter().map(|t| t.as_bytes()).collect();
            implausible_rate(&fields, unit)
        };
        assert_eq!(rate(&["10", "20", "30"], TimeUnit::Nanoseconds), Some(1e8));
        assert_eq!(rate(&["0", "100000", "200000"], TimeUnit::Seconds), Some(1e-5));
        // A bunch, and a clock that is set by fifty years.
        assert_eq!(rate(&["0", "0.0000001", "0.01", "0.0100001"], TimeUnit::Seconds), None);
        assert_eq!(rate(&["0", "0.01", "1600000000", "1600000000.01"], TimeUnit::Seconds), None);
    }
}
