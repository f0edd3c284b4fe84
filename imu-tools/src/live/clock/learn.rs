//! What the first two seconds of a stretch say: what counts, by how much, how fast, and since when.

use super::reading::{Reading, Source};
use super::track::{Start, Track};
use crate::live::Message;

/// Two seconds of bursts show a rate to this part, stalls included. What is known from elsewhere
/// (ticks in a second, the stretch before) is better if it is not further off.
const KNOWN: f64 = 4e-3;

/// And only if it was seen for so long, ns, in so many bursts: what is read faster had waited for its
/// reader, and shows how fast that is.
const SEEN_NS: i64 = 1_500_000_000;
const SEEN_BURSTS: usize = 16;

/// A unit of ticks that is this much longer or shorter than what it is called is another: real clocks are off by
/// a few per cent at most, a unit that was guessed by a factor of a thousand.
const OTHER_UNIT: f64 = 2.0;

/// Fewer readings show no counter.
const FEWEST_READINGS: usize = 4;

/// A counter that got so far ahead of the host, ns, was set, or began anew.
const AHEAD_NS: f64 = 1e9;

/// This part of the steps is as good as all.
const NEARLY_ALL: f64 = 0.9;

/// Whether a message continues those that are held back: its counter goes on, and not faster than
/// time.
pub(super) fn goes_on(held: &[(i64, Message)], arrival_ns: i64, message: &Message) -> bool {
    let (Some((first_ns, _)), Some((_, before))) = (held.first(), held.last()) else { return true };
    let (Some(ticks), Some(now), Some(before)) =
        (message.ticks, Reading::of(Source::Ticks, message), Reading::of(Source::Ticks, before))
    else {
        return true;
    };
    let elapsed = arrival_ns.saturating_sub(*first_ns) as f64;
    let sensor_ns = |units: u64| units as f64 * 1e9 / ticks.per_second.max(1) as f64;
    now.since(before).is_some_and(|units| sensor_ns(units) <= elapsed + AHEAD_NS)
}

/// The track on which the messages lie; `None` where there are none.
pub(super) fn from(held: &[(i64, Message)], before: Option<&Track>) -> Option<Track> {
    let (origin_ns, first) = held.first()?;
    let source = source(held);
    let steps = steps(held, source);
    let Steps { stride, grain } = Steps::of(&steps, source);
    let passed = steps.iter().map(|step| step.map_or(stride, |step| step as f64));
    let points: Vec<(f64, f64)> = held
        .iter()
        .zip(std::iter::once(0.0).chain(passed).scan(0.0, |units, step| {
            *units += step;
            Some(*units)
        }))
        .map(|((arrival_ns, _), units)| (units, arrival_ns.saturating_sub(*origin_ns) as f64))
        .collect();
    let per_second = held.iter().find_map(|(_, m)| Reading::of(source, m)?.per_second);
    let tick_ns = per_second.map(|ticks| 1e9 / ticks.max(1) as f64);
    let known = before.filter(|b| b.source() == source && b.per_second() == per_second);
    let known = known.map(Track::unit_ns);
    let known = known.or(tick_ns);
    let ends = ends_of_bursts(&points);
    let measured = slope(&ends);
    let seen_ns = held.last().map_or(0, |(last_ns, _)| last_ns.saturating_sub(*origin_ns));
    let is_seen = seen_ns >= SEEN_NS && ends.len() >= SEEN_BURSTS;
    let unit_ns = match (known, measured) {
        (Some(known), Some(measured)) if is_seen && (measured / known - 1.0).abs() > KNOWN => {
            measured
        }
        (Some(known), _) => known,
        (None, Some(measured)) => measured,
        (None, None) => 1e9 / stride,
    };
    let earliest =
        points.iter().map(|(units, at)| at - units * unit_ns).fold(f64::INFINITY, f64::min);
    let reading = Reading::of(source, first);
    Some(Track::new(Start {
        source,
        origin_ns: *origin_ns,
        stride,
        learnt_from: held.len() as u64,
        grain,
        unit_ns,
        // A unit that was guessed and is another says nothing of how long the sensor took.
        tick_ns: tick_ns.filter(|ns| unit_ns < OTHER_UNIT * ns && *ns < OTHER_UNIT * unit_ns),
        per_second,
        reading,
        offset_ns: earliest,
    }))
}

/// Ticks where some messages up to the last one have them and most of those differ; else counts; else nothing.
/// The first messages may lack them: the unit of a text's time is not known yet, a cycle was cut.
fn source(held: &[(i64, Message)]) -> Source {
    let shows = |source: Source| {
        let readings = || held.iter().filter_map(move |(_, m)| Reading::of(source, m));
        let moved = readings().zip(readings().skip(1)).filter(|(a, b)| a.value != b.value).count();
        let last = held.last().and_then(|(_, message)| Reading::of(source, message));
        let count = readings().count();
        count >= FEWEST_READINGS.min(held.len()) && last.is_some() && 2 * (moved + 1) >= count
    };
    let found = [Source::Ticks, Source::Count].into_iter().find(|source| shows(*source));
    found.unwrap_or(Source::Arrival)
}

/// Units from each message to the next, where both have a reading.
fn steps(held: &[(i64, Message)], source: Source) -> Vec<Option<u64>> {
    let readings = || held.iter().map(|(_, message)| Reading::of(source, message));
    let step = |(before, now): (Option<Reading>, Option<Reading>)| {
        before.zip(now).map(|(before, now)| now.since(before).unwrap_or(0))
    };
    readings().zip(readings().skip(1)).map(step).collect()
}

/// What units from message to message show.
struct Steps {
    /// Units from a message to the next, on average.
    stride: f64,
    /// What readings are whole numbers of: a text's milliseconds, in nanoseconds; 0 of what counts messages.
    grain: u64,
}

impl Steps {
    /// The median or, of ticks, which may be coarse, the mean of those that rounding and half a period explain.
    fn of(steps: &[Option<u64>], source: Source) -> Self {
        let moved = || steps.iter().flatten().copied().filter(|step| *step > 0);
        // Two messages of one instant have no step between them.
        let usual = median(steps.iter().flatten().copied()).filter(|step| *step > 0);
        let usual = usual.or(median(moved())).unwrap_or(1);
        if source != Source::Ticks {
            return Self { stride: usual as f64, grain: 0 };
        }
        let grain = moved().fold(0, gcd).max(1);
        let near = || {
            let explained = |step: &u64| step.abs_diff(usual) <= (usual / 2).max(grain);
            steps.iter().flatten().copied().filter(explained)
        };
        let (count, same) = (near().count(), near().filter(|step| *step == usual).count());
        // Where nearly all are one and the same, the others are late, or miss a message.
        if count == 0 || (usual == grain && same as f64 >= NEARLY_ALL * count as f64) {
            return Self { stride: usual as f64, grain: 1 };
        }
        Self { stride: near().map(|step| step as f64).sum::<f64>() / count as f64, grain }
    }
}

/// The greatest common divisor (Euclid).
fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// The latest message of each burst, which waited least.
fn ends_of_bursts(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let last_of_burst = |pair: &[(f64, f64)]| match pair {
        [a, b] if a.1 < b.1 => Some(*a),
        _ => None,
    };
    let mut ends: Vec<(f64, f64)> = points.windows(2).filter_map(last_of_burst).collect();
    ends.extend(points.last());
    ends
}

/// Host time of a unit, ns: the median slope between the ends of bursts in the first and the last third
/// (Theil 1950).
fn slope(ends: &[(f64, f64)]) -> Option<f64> {
    let third = ends.len().div_ceil(3);
    let (early, late) = (ends.get(..third)?, ends.get(ends.len() - third..)?);
    // A few dozen of each are enough, and few enough to be compared all with all.
    let some = |part: &[(f64, f64)]| {
        part.iter().step_by(part.len().div_ceil(40).max(1)).copied().collect::<Vec<_>>()
    };
    let (early, late) = (some(early), some(late));
    let slopes = early
        .iter()
        .flat_map(|a| late.iter().filter(|b| b.0 > a.0).map(move |b| (b.1 - a.1) / (b.0 - a.0)));
    let mut slopes: Vec<f64> = slopes.filter(|slope| *slope > 0.0).collect();
    slopes.sort_unstable_by(f64::total_cmp);
    slopes.get(slopes.len() / 2).copied()
}

fn median(values: impl Iterator<Item = u64>) -> Option<u64> {
    let mut values: Vec<u64> = values.collect();
    values.sort_unstable();
    values.get(values.len() / 2).copied()
}
