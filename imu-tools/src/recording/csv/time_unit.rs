//! The unit of time, from the times themselves.

use std::ops::Range;

use super::number::nanoseconds;
use crate::recording::TimeUnit;

const UNITS: [TimeUnit; 4] =
    [TimeUnit::Seconds, TimeUnit::Milliseconds, TimeUnit::Microseconds, TimeUnit::Nanoseconds];

/// The years 2000 to 2100 as nanoseconds since 1970: they do not overlap with each other's
/// thousandfold.
const DATES: Range<i64> = 946_684_800_000_000_000..4_102_444_800_000_000_000;

/// Sampling intervals of any IMU, from 32 kHz to 1 Hz and a little more, in nanoseconds.
const INTERVALS: Range<i64> = 25_000..1_500_000_000;

/// Those of most, from 8.3 kHz to 8.3 Hz: a factor of a thousand, so that just one unit fits.
const USUAL_INTERVALS: Range<i64> = 120_000..120_000_000;

/// Intervals of about a second and above.
const SECONDS: Range<i64> = 500_000_000..i64::MAX;

/// The unit in which these fields have the spacing of an IMU. Of several such units it is the one in
/// which they are a date, or whole seconds that are written with a decimal point, or else that of the
/// usual rates. Seconds where nothing can be told.
pub fn from_data(times: &[&[u8]]) -> TimeUnit {
    let dated = |unit: &TimeUnit| {
        let first = times.iter().find_map(|time| nanoseconds(time, unit.exponent()));
        first.is_some_and(|t| DATES.contains(&t))
    };
    let spaced = |unit: &TimeUnit, intervals: &Range<i64>| {
        usual_step(times, *unit).is_some_and(|step| intervals.contains(&step))
    };
    let fit: Vec<TimeUnit> = UNITS.into_iter().filter(|unit| spaced(unit, &INTERVALS)).collect();
    let of = |wanted: &dyn Fn(&TimeUnit) -> bool| fit.iter().copied().find(wanted);
    let found = of(&dated)
        .or_else(|| of(&|unit| spaced(unit, &SECONDS)).filter(|_| are_whole_with_point(times)))
        .or_else(|| of(&|unit| spaced(unit, &USUAL_INTERVALS)))
        .or_else(|| fit.first().copied())
        .or_else(|| UNITS.into_iter().find(dated));
    found.unwrap_or(TimeUnit::Seconds)
}

/// The median of the steps forward between these fields in nanoseconds.
fn usual_step(times: &[&[u8]], unit: TimeUnit) -> Option<i64> {
    let times: Vec<i64> =
        times.iter().filter_map(|time| nanoseconds(time, unit.exponent())).collect();
    let steps = times.iter().zip(times.iter().skip(1)).map(|(a, b)| b.saturating_sub(*a));
    let mut steps: Vec<i64> = steps.filter(|step| *step > 0).collect();
    steps.sort_unstable();
    steps.get(steps.len() / 2).copied()
}

/// Whether all fields are like `12.0` or `12.000`: somebody who counts in thousandths writes `12`.
fn are_whole_with_point(times: &[&[u8]]) -> bool {
    times.iter().all(|time| {
        let point = memchr::memchr(b'.', time);
        let places = point.and_then(|at| time.get(at + 1..));
        places.is_some_and(|places| places.iter().all(|&digit| digit == b'0'))
    })
}

/// Why these times cannot be an IMU's in this unit, with the unit that they fit; `None` when they
/// can.
pub fn refusal(name: &str, times: &[&[u8]], unit: TimeUnit) -> Option<String> {
    let rate = implausible_rate(times, unit)?;
    let better = match from_data(times) {
        other if other == unit => String::new(),
        other => format!(" ({} would fit)", other.symbol()),
    };
    Some(format!(
        "{name} would have {rate:.2e} samples a second with time in {}: name the unit of its time \
         with --time-unit{better}",
        unit.symbol()
    ))
}

/// The rate in Hz, where no IMU has one like it: its stamps are in another unit.
fn implausible_rate(times: &[&[u8]], unit: TimeUnit) -> Option<f64> {
    let usual = usual_step(times, unit)? as f64;
    let times: Vec<i64> =
        times.iter().filter_map(|time| nanoseconds(time, unit.exponent())).collect();
    let steps = times.iter().zip(times.iter().skip(1));
    let steps: Vec<f64> = steps.map(|(a, b)| b.saturating_sub(*a) as f64).collect();
    // Bunches make single steps short, and a clock that is set makes one of them long.
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    let fast = (mean > 0.0 && mean < 1e3).then_some(1e9 / mean);
    fast.or((usual > 1e11).then_some(1e9 / usual))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields<'a>(times: &[&'a str]) -> Vec<&'a [u8]> {
        times.iter().map(|time| time.as_bytes()).collect()
    }

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
            // A date that comes once a second.
            (&["1700000000", "1700000001", "1700000002"], TimeUnit::Seconds),
            (&["1700000000", "1700000000", "1700000001"], TimeUnit::Seconds),
            (&["1700000000"], TimeUnit::Seconds),
            (&["1700000000000"], TimeUnit::Milliseconds),
            (&["7"], TimeUnit::Seconds),
            (&[], TimeUnit::Seconds),
        ] {
            let fields = fields(times);
            assert_eq!(from_data(&fields), unit, "{times:?}");
            assert_eq!(implausible_rate(&fields, unit), None, "{times:?}");
        }
    }

    /// Half an hour to an hour after a start, microseconds have as many digits as the seconds of a
    /// date, and nanoseconds as its milliseconds.
    #[test]
    fn spacing_outweighs_a_date() {
        for (rate_hz, first_s) in [(8000, 3600), (4000, 1800), (1000, 1000), (200, 3600)] {
            for (unit, in_s) in
                [(TimeUnit::Microseconds, 1_000_000_u64), (TimeUnit::Nanoseconds, 1_000_000_000)]
            {
                let stamp = |i: u64| (first_s * in_s + i * in_s / rate_hz).to_string();
                let times: Vec<String> = (0..100).map(stamp).collect();
                let fields: Vec<&[u8]> = times.iter().map(|time| time.as_bytes()).collect();
                assert_eq!(from_data(&fields), unit, "{rate_hz} Hz after {first_s} s");
                assert_eq!(implausible_rate(&fields, unit), None);
            }
        }
    }

    #[test]
    fn whole_seconds_are_written_with_a_point() {
        for (times, unit) in [
            (&["0.0", "1.0", "2.0"][..], TimeUnit::Seconds),
            (&["0.000000000", "1.000000000", "2.000000000"], TimeUnit::Seconds),
            (&["0.000", "1000.000", "2000.000"], TimeUnit::Milliseconds),
            (&["0.0", "5.0", "10.0"], TimeUnit::Milliseconds),
            (&["0", "1", "2"], TimeUnit::Milliseconds),
        ] {
            assert_eq!(from_data(&fields(times)), unit, "{times:?}");
        }
    }

    #[test]
    fn rates_of_no_imu() {
        let rate = |times: &[&str], unit| implausible_rate(&fields(times), unit);
        assert_eq!(rate(&["10", "20", "30"], TimeUnit::Nanoseconds), Some(1e8));
        assert_eq!(rate(&["0", "100000", "200000"], TimeUnit::Seconds), Some(1e-5));
        // A bunch, and a clock that is set by fifty years.
        assert_eq!(rate(&["0", "0.0000001", "0.01", "0.0100001"], TimeUnit::Seconds), None);
        assert_eq!(rate(&["0", "0.01", "1600000000", "1600000000.01"], TimeUnit::Seconds), None);
        let said = refusal("a.csv", &fields(&["0", "5000", "10000"]), TimeUnit::Seconds).unwrap();
        assert!(said.ends_with("with --time-unit (µs would fit)"), "{said}");
    }
}
