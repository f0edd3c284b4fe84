//! The first fit of a grid: period and phase from a few thousand stamps at once.

use super::grid::{Grid, Verdict};
use crate::recording::Sample;

/// Stamps farther than this many times the median distance from the line are left out of it.
const OUTLIER: f64 = 10.0;

/// Fits the grid to the first samples; `None` where no two stamps differ.
///
/// A rough period tells which samples are consecutive; a line through their stamps, by least
/// squares, then gives period and phase: to σ√12/n^(3/2), 1e-5 of a period for n = 4096 and a
/// jitter σ of a whole period.
pub fn grid(samples: &[Sample]) -> Option<Grid> {
    let first = samples.first()?;
    let origin = first.stamp_ns;
    let period = rough_period(samples)?;
    let points = index(samples, Grid::new(origin, period, 0.0, 0.0), period);
    let longest = points.chunk_by(|a, b| a.stretch == b.stretch).max_by_key(|s| s.len())?;
    let (_, fitted) = line(longest).unwrap_or((0.0, period));
    let period = if fitted > 0.0 { fitted } else { period };
    let start = points.chunk_by(|a, b| a.stretch == b.stretch).next()?;
    let phase = center(start.iter().map(|p| p.time - period * p.index).collect());
    let error = |p: &Point| (p.time - period * p.index - phase).clamp(-2.0 * period, 2.0 * period);
    let jitter = start.iter().map(|p| error(p) * error(p)).sum::<f64>() / start.len() as f64;
    Some(Grid::new(origin, period, phase, jitter))
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

/// The median step where most steps agree with it; otherwise, where stamps jitter or come in
/// bunches, the median slope over an eighth of the samples.
fn rough_period(samples: &[Sample]) -> Option<f64> {
    let step = |a: &Sample, b: &Sample| b.stamp_ns.saturating_sub(a.stamp_ns) as f64;
    let over = |n: usize| samples.iter().zip(samples.iter().skip(n)).map(move |(a, b)| step(a, b));
    let steps: Vec<f64> = over(1).collect();
    let usual = median(steps.iter().copied().filter(|d| *d > 0.0).collect())?;
    let agree = steps.iter().filter(|d| (*d - usual).abs() <= 0.2 * usual).count();
    if agree * 5 >= steps.len() * 3 && !bunched(&steps, usual) {
        return Some(usual);
    }
    let span = (samples.len() / 8).max(1);
    let slope = median(over(span).collect()).map(|d| d / span as f64);
    slope.filter(|slope| *slope > 0.0).or(Some(usual))
}

/// Whether the long steps are the pauses between bunches: more than one step in a hundred, and most
/// of them many usual steps long, or no whole number of them. Losses as frequent as that are short.
fn bunched(steps: &[f64], usual: f64) -> bool {
    let multiples: Vec<f64> = steps.iter().map(|d| d / usual).filter(|m| *m > 1.5).collect();
    let odd = multiples.iter().filter(|m| **m > 4.0 || (*m - m.round()).abs() > 0.2).count();
    multiples.len() >= 8 && multiples.len() * 100 > steps.len() && odd * 2 > multiples.len()
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
