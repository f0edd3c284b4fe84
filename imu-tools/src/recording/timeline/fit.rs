//! The first fit of a grid: period and phase from a few thousand stamps at once.

use super::grid::{Grid, Verdict};
use crate::recording::Sample;

/// Stamps farther than this many times the median distance from the line are left out of it.
const OUTLIER: f64 = 10.0;

/// A period that is off by a few per cent counts some samples wrongly; the line through most of them
/// is better, and the next count with it.
const PASSES: usize = 3;

/// Jitter (rms, periods) from which on stamps are often not in their place.
const COARSE: f64 = 0.3;

/// No period is shorter, in ns: of stamps that go back and forth a line has no more slope than its
/// rounding errors.
const SHORTEST: f64 = 1.0;

/// Fits the grid to the first samples; `None` where no two stamps differ.
///
/// A rough period tells which samples are consecutive; a line through their stamps, by least
/// squares, then gives period and phase: to σ√12/n^(3/2), 1e-5 of a period for n = 4096 and a
/// jitter σ of a whole period.
pub fn grid(samples: &[Sample]) -> Option<Grid> {
    let first = samples.first()?;
    let origin = first.stamp_ns;
    let Rough { period, jitter } = rough(samples)?;
    let mut period = period.max(SHORTEST);
    let in_place = if jitter < COARSE * period { 1.0 } else { 0.0 };
    let mut points = Vec::new();
    for _ in 0..PASSES {
        points = index(samples, Grid::new(origin, period, 0.0, jitter * jitter, in_place), period);
        let longest = points.chunk_by(|a, b| a.stretch == b.stretch).max_by_key(|s| s.len())?;
        if let Some((_, fitted)) = line(longest).filter(|(_, fitted)| *fitted >= SHORTEST) {
            period = fitted;
        }
    }
    let start = points.chunk_by(|a, b| a.stretch == b.stretch).next()?;
    let phase = center(start.iter().map(|p| p.time - period * p.index).collect());
    let error = |p: &Point| (p.time - period * p.index - phase).clamp(-2.0 * period, 2.0 * period);
    let jitter = start.iter().map(|p| error(p) * error(p)).sum::<f64>() / start.len() as f64;
    let in_place = start.iter().filter(|p| error(p).abs() <= 0.5 * period).count();
    let in_place = in_place as f64 / start.len() as f64;
    Some(Grid::new(origin, period, phase, jitter, in_place))
}

/// A stamp and its place, after the origin.
#[derive(Clone, Copy, Debug)]
struct Point {
    stretch: u32,
    index: f64,
    time: f64,
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied()
}

/// Mean of the values that are not far from their median.
fn center(values: Vec<f64>) -> f64 {
    let Some(middle) = median(values.clone()) else { return 0.0 };
    let spread = median(values.iter().map(|v| (v - middle).abs()).collect()).unwrap_or(0.0);
    let kept = values.iter().filter(|v| (*v - middle).abs() <= OUTLIER * spread);
    let (sum, count) = kept.fold((0.0, 0.0), |(sum, count), v| (sum + (v - middle), count + 1.0));
    middle + if count > 0.0 { sum / count } else { 0.0 }
}

/// A first guess of the period, and of the jitter (rms), in ns.
struct Rough {
    period: f64,
    jitter: f64,
}

/// What most stamps say, in the order in which they can be trusted: that they are a clock's ticks;
/// their usual step; the least step, of which all others are multiples; and where stamps come in
/// bunches or in a jitter of their period, the median slope over an eighth of the samples.
fn rough(samples: &[Sample]) -> Option<Rough> {
    let over = |n: usize| {
        let step = |a: &Sample, b: &Sample| b.stamp_ns.saturating_sub(a.stamp_ns) as f64;
        samples.iter().zip(samples.iter().skip(n)).map(move |(a, b)| step(a, b))
    };
    let steps: Vec<f64> = over(1).collect();
    let positive = || steps.iter().copied().filter(|d| *d > 0.0);
    let usual = median(positive().collect())?;
    if let Some(rough) = ticks(samples, usual) {
        return Some(rough);
    }
    let bunched = bunched(&steps, usual);
    let distance = median(steps.iter().map(|d| (d - usual).abs()).collect()).unwrap_or(0.0);
    // Of a normal distribution; a step has the jitter of two stamps.
    let jitter = 1.4826 * distance / std::f64::consts::SQRT_2;
    if !bunched && let Some(period) = least(&steps, usual) {
        return Some(Rough { period, jitter: 0.0 });
    }
    if !bunched && jitter < COARSE * usual {
        return Some(Rough { period: usual, jitter });
    }
    let span = (samples.len() / 8).max(1);
    let slope = median(over(span).collect()).map(|d| d / span as f64);
    let period = slope.filter(|slope| *slope > 0.0).unwrap_or(usual);
    Some(Rough { period, jitter: if bunched { period } else { jitter } })
}

/// Stamps in whole ticks of a coarse clock, such as milliseconds: where four of ten runs of 64
/// stamps lie on a line by their mere number, to a tick, nothing is lost in them.
fn ticks(samples: &[Sample], usual: f64) -> Option<Rough> {
    /// Ticks shorter than this part of a step are no matter.
    const SHORTEST: f64 = 0.05;
    const RUN: usize = 64;
    let first = samples.first()?.stamp_ns;
    let tick = samples.iter().try_fold(0, |tick, sample| {
        let tick = divisor(tick, sample.stamp_ns.wrapping_sub(first).unsigned_abs());
        (tick as f64 >= SHORTEST * usual || tick == 0).then_some(tick)
    })? as f64;
    let runs = samples.chunks_exact(RUN);
    let slopes = runs.clone().filter_map(|run| {
        let points = run.iter().enumerate().map(|(k, sample)| Point {
            stretch: 0,
            index: k as f64,
            time: sample.stamp_ns.saturating_sub(first) as f64,
        });
        let points: Vec<Point> = points.collect();
        let (intercept, slope) = least_squares(points.iter())?;
        let fits = |p: &Point| (p.time - intercept - slope * p.index).abs() <= 0.75 * tick;
        (slope > 0.0 && points.iter().all(fits)).then_some(slope)
    });
    let slopes: Vec<f64> = slopes.collect();
    if slopes.is_empty() || slopes.len() * 10 < runs.len() * 4 {
        return None;
    }
    Some(Rough { period: median(slopes)?, jitter: tick / 12_f64.sqrt() })
}

/// The greatest common divisor (Euclid).
fn divisor(mut a: u64, mut b: u64) -> u64 {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// The least step, where a fifth of the steps is such and the others are multiples of it: samples
/// are lost, be it most of them.
fn least(steps: &[f64], usual: f64) -> Option<f64> {
    let mut sorted = steps.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let least = *sorted.get(sorted.len() / 20)?;
    if least < usual / 8.0 {
        return None;
    }
    let near = |d: f64, multiple: f64| (d / least - multiple).abs() <= 0.1;
    let ones: Vec<f64> = steps.iter().copied().filter(|d| near(*d, 1.0)).collect();
    let whole = steps.iter().filter(|d| near(**d, (**d / least).round().max(1.0))).count();
    if ones.len() * 5 < steps.len() || whole * 10 < steps.len() * 9 {
        return None;
    }
    median(ones)
}

/// Whether the long steps are the pauses between bunches: the usual step is less than the mean, and
/// of the long ones, which are more than one in a hundred, most are many usual steps long, or no whole
/// number of them. Losses as frequent as that are short.
fn bunched(steps: &[f64], usual: f64) -> bool {
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    let multiples: Vec<f64> = steps.iter().map(|d| d / usual).filter(|m| *m > 1.5).collect();
    let odd = multiples.iter().filter(|m| **m > 4.0 || (*m - m.round()).abs() > 0.2).count();
    let often = multiples.len() >= 8 && multiples.len() * 100 > steps.len();
    often && mean > 1.2 * usual && odd * 2 > multiples.len()
}

/// Which samples are consecutive, by a grid that follows the stamps fast.
fn index(samples: &[Sample], mut grid: Grid, period: f64) -> Vec<Point> {
    /// Part of an error by which the phase is corrected.
    const GAIN: f64 = 0.1;
    let mut points = Vec::with_capacity(samples.len());
    let (mut stretch, mut index, mut at) = (0, 0.0, 0);
    let origin = samples.first().map_or(0, |s| s.stamp_ns);
    while let Some((sample, after)) = samples.get(at..).and_then(|s| s.split_first()) {
        let error = grid.error(sample.stamp_ns);
        let verdict = if grid.near(error) {
            Verdict::Next
        } else {
            grid.judge(sample.stamp_ns, after, true).unwrap_or(Verdict::Next)
        };
        match verdict {
            Verdict::Next => {}
            Verdict::Missing { count, shift } => {
                index += count as f64;
                grid.adjust(shift);
            }
            // A stretch of its own: one line cannot go through both.
            Verdict::Adjusted { shift } | Verdict::Restart { shift } => {
                stretch += 1;
                index = 0.0;
                grid.adjust(shift);
            }
        }
        let error = grid.error(sample.stamp_ns);
        grid.adjust(period + if grid.near(error) { GAIN * error } else { 0.0 });
        let time = sample.stamp_ns.saturating_sub(origin) as f64;
        points.push(Point { stretch, index, time });
        index += 1.0;
        at += 1;
    }
    points
}

/// Intercept and slope by least squares, without outliers.
fn line(points: &[Point]) -> Option<(f64, f64)> {
    let all = least_squares(points.iter())?;
    let distance =
        |(intercept, slope): (f64, f64), p: &Point| (p.time - intercept - slope * p.index).abs();
    let spread = median(points.iter().map(|p| distance(all, p)).collect())?;
    least_squares(points.iter().filter(|p| distance(all, p) <= OUTLIER * spread)).or(Some(all))
}

fn least_squares<'a>(points: impl Iterator<Item = &'a Point> + Clone) -> Option<(f64, f64)> {
    let (mut n, mut index, mut time) = (0.0, 0.0, 0.0);
    for p in points.clone() {
        n += 1.0;
        index += p.index;
        time += p.time;
    }
    let (index, time) = (index / n, time / n);
    let (mut square, mut product) = (0.0, 0.0);
    for p in points {
        square += (p.index - index) * (p.index - index);
        product += (p.index - index) * (p.time - time);
    }
    (square > 0.0).then(|| (time - product / square * index, product / square))
}
