//! What is usual of a sensor at rest, in windows of about a second: how large its variance is, and
//! how far neighbouring means lie apart.
//!
//! Both from quantiles in the lower half, where disturbances are not: for a Gaussian quantity the
//! quantiles at 5 % and 25 % are 1.645 and 0.674 standard deviations below the mean, and the
//! quartile of its absolute value, when the mean is zero, is 0.319 standard deviations.
//!
//! An axis is *lively* if it takes [`VALUES`] different values and more in a window, as one does whose
//! noise is half of its resolution at least. Of such an axis equal values for a second are no accident.
//! A coarser one may rest in the middle of a step for an hour, and then leave it.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::limits::Limits;

/// Windows of which the usual is learnt later on.
const RING: usize = 512;
/// Spreads from the usual beyond which a window is disturbed: for Gaussian noise, less than one of
/// 10¹⁴; real noise changes a little with time and temperature.
const BEYOND: f64 = 8.0;
/// Windows of a weak disturbance that are judged together.
pub(super) const GROUP: usize = 8;
/// Standard deviations below the mean of a Gaussian's quantile at 25 %, and from there to 5 %.
const QUARTILE: f64 = 0.674_490;
const TO_TWENTIETH: f64 = 1.644_854 - QUARTILE;
/// The same for the quartile of its absolute value.
const HALF_QUARTILE: f64 = 0.318_639;
/// A variance that is less than this many times the usual condemns no window by itself.
const LEAST_RATIO: f64 = 1.5;
/// Spreads from which on two levels are not the same. A restart where none was needed costs little,
/// a step that is taken for random walk costs K.
const OTHER_LEVEL: f64 = 3.5;
/// Different values that are told apart.
const VALUES: usize = 4;
/// Lively windows that show a lively axis, at least; and one of so many.
const FEWEST_LIVELY: usize = 16;
const ONE_LIVELY_OF: usize = 8;
/// Windows of two or three values, where an axis is lively: one of so many lively ones at most.
const ONE_DULL_OF: usize = 16;
/// Spread of the variance of lively windows, over that of white noise, that is not rest any more.
const WIDE: f64 = 5.0;
/// A variance so many times less than the usual is none.
const STILL: f64 = 100.0;
/// Pairs of levels that show what is usual of them, at least.
const PAIRS: usize = 64;

/// Mean and variance of the samples of a window.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
pub(super) struct WindowStatistics {
    pub(super) mean: [f64; 3],
    log_variance: [f64; 3],
    /// Different values, [`VALUES`] at most.
    values: [usize; 3],
    samples: usize,
}

impl WindowStatistics {
    /// Of the samples within limits, if they are half of `full` at least.
    pub(super) fn of(values: &[[f64; 3]], full: usize, limits: &Limits) -> Option<Self> {
        let within = limits.hold_all(values);
        let (origin, samples, sum, squares, different) = if within {
            let origin = values.first()?;
            let (sum, squares) = moments(values.iter(), origin);
            (origin, values.len(), sum, squares, different(|| values.iter()))
        } else {
            let within = || values.iter().filter(|value| limits.hold(value));
            let origin = within().next()?;
            let (sum, squares) = moments(within(), origin);
            (origin, within().count(), sum, squares, different(within))
        };
        if samples < (full / 2).max(2) {
            return None;
        }
        let count = samples as f64;
        let mean = [0, 1, 2].map(|axis| origin[axis] + sum[axis] / count);
        let log_variance = [0, 1, 2].map(|axis| {
            let about = squares[axis] - sum[axis] * sum[axis] / count;
            (about / (count - 1.0)).max(f64::MIN_POSITIVE).ln()
        });
        Some(Self { mean, log_variance, values: different, samples })
    }
}

/// How many different values each axis takes, [`VALUES`] at most: where there are many, the first few
/// samples show them.
fn different<'a, I: Iterator<Item = &'a [f64; 3]>>(values: impl Fn() -> I) -> [usize; 3] {
    [0, 1, 2].map(|axis| {
        let mut seen = [0.0; VALUES];
        let mut count = 0;
        for value in values() {
            let x = value[axis];
            if !seen.iter().take(count).any(|seen| *seen == x) {
                seen[count] = x;
                count += 1;
                if count == VALUES {
                    break;
                }
            }
        }
        count
    })
}

/// Sums of the values less `origin`, and of their squares.
#[inline]
fn moments<'a>(
    values: impl Iterator<Item = &'a [f64; 3]>,
    origin: &[f64; 3],
) -> ([f64; 3], [f64; 3]) {
    let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
    for value in values {
        for axis in 0..3 {
            let offset = value[axis] - origin[axis];
            sum[axis] += offset;
            squares[axis] += offset * offset;
        }
    }
    (sum, squares)
}

/// What is usual of one axis.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
struct Axis {
    /// Centre and spread of the logarithm of the variance.
    centre: f64,
    spread: f64,
    /// Spread of the difference of neighbouring means.
    step: f64,
    /// Equal values for a window are no accident.
    lively: bool,
}

impl Default for Axis {
    /// Nothing is unusual.
    fn default() -> Self {
        Self { centre: f64::INFINITY, spread: 1.0, step: f64::INFINITY, lively: false }
    }
}

/// The last windows, and what is usual of them.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub(super) struct Usual {
    /// Statistics of a window, and whether it stands apart from the one before it.
    ring: VecDeque<(WindowStatistics, bool)>,
    /// So many of the last ones lie in the future of who is asked about the last.
    ahead: usize,
    axes: [Axis; 3],
}

impl Usual {
    pub(super) fn push(&mut self, statistics: WindowStatistics, apart: bool) {
        if self.ring.len() == RING {
            self.ring.pop_front();
        }
        self.ring.push_back((statistics, apart));
    }

    /// Goes back to before the last `windows`, to go through them one [`step`](Self::step) at a time.
    pub(super) fn rewind(&mut self, windows: usize) {
        self.ahead = windows;
    }

    pub(super) fn step(&mut self) {
        self.ahead = self.ahead.saturating_sub(1);
    }

    /// The window `back` before the one that is asked about.
    fn at(&self, back: usize) -> Option<&(WindowStatistics, bool)> {
        let index = self.ring.len().checked_sub(1 + self.ahead + back)?;
        self.ring.get(index)
    }

    /// Windows that say what is usual.
    pub(super) fn len(&self) -> usize {
        self.ring.len()
    }

    /// Forgets the windows, but not what is usual.
    pub(super) fn forget(&mut self) {
        self.ring.clear();
    }

    /// Learns what is usual from all windows of the ring.
    pub(super) fn learn(&mut self) {
        let samples = self.ring.iter().map(|(w, _)| w.samples).max().unwrap_or(2);
        // The logarithm of a variance of n samples of white noise has this spread.
        let white = (2.0 / (samples.max(2) - 1) as f64).sqrt();
        let (mut dull, mut lively) = ([0; 3], [0; 3]);
        for (window, _) in &self.ring {
            for (axis, &values) in window.values.iter().enumerate() {
                dull[axis] += usize::from((2..VALUES).contains(&values));
                lively[axis] += usize::from(values == VALUES);
            }
        }
        self.axes = [0, 1, 2].map(|axis| self.axis(axis, white, dull[axis], lively[axis]));
    }

    /// What is usual of an axis with so many windows of two or three values, and of more.
    fn axis(&self, axis: usize, white: f64, dull: usize, lively: usize) -> Axis {
        let often = FEWEST_LIVELY.max(self.ring.len() / ONE_LIVELY_OF);
        if lively >= often && ONE_DULL_OF * dull <= lively {
            let usual = self.axis_of(axis, white, |w| w.values[axis] == VALUES);
            if usual.spread <= WIDE * white {
                return Axis { lively: true, ..usual };
            }
        }
        self.axis_of(axis, white, |_| true)
    }

    /// What is usual of an axis in windows of some kind.
    fn axis_of(&self, axis: usize, white: f64, of: impl Fn(&WindowStatistics) -> bool) -> Axis {
        let windows = self.ring.iter().filter(|(w, _)| of(w));
        let mut logs: Vec<f64> = windows.map(|(w, _)| w.log_variance[axis]).collect();
        let quartile = quantile(&mut logs, 0.25);
        if quartile <= f64::MIN_POSITIVE.ln() + 1.0 {
            // It hardly ever changes: a change says nothing.
            return Axis::default();
        }
        let spread = ((quartile - quantile(&mut logs, 0.05)) / TO_TWENTIETH).max(white);
        let mut steps: Vec<f64> = self
            .ring
            .iter()
            .zip(self.ring.iter().skip(1))
            .filter(|((a, _), (b, apart))| !apart && of(a) && of(b))
            .map(|((a, _), (b, _))| (b.mean[axis] - a.mean[axis]).abs())
            .collect();
        let step = quantile(&mut steps, 0.25) / HALF_QUARTILE;
        Axis { centre: quartile + QUARTILE * spread, spread, step, lively: false }
    }

    /// The axes that stand still in a window and otherwise never do.
    pub(super) fn frozen(&self, window: &WindowStatistics) -> [bool; 3] {
        [0, 1, 2].map(|i| {
            let axis = &self.axes[i];
            let quieter = axis.centre - window.log_variance[i];
            axis.lively
                && (window.values[i] == 1 || quieter > (BEYOND * axis.spread).max(STILL.ln()))
        })
    }

    /// The spread of the difference of neighbouring means, on each axis.
    pub(super) fn steps(&self) -> [f64; 3] {
        self.axes.map(|axis| axis.step)
    }

    /// Whether the last window is beyond what is usual.
    pub(super) fn last_is_disturbed(&self) -> bool {
        let Some((last, apart)) = self.at(0) else { return false };
        let before = self.at(1).filter(|_| !apart).map(|(before, _)| before);
        self.axes.iter().enumerate().any(|(i, axis)| {
            let louder = last.log_variance[i] - axis.centre;
            let step = before.map_or(0.0, |before| (last.mean[i] - before.mean[i]).abs());
            louder > (BEYOND * axis.spread).max(LEAST_RATIO.ln())
                || (axis.step > 0.0 && step > BEYOND * axis.step)
        })
    }

    /// Whether the last eight windows together are. No window counts for more than half of what
    /// condemns it alone, so that a strong disturbance does not condemn what comes after it.
    pub(super) fn group_is_disturbed(&self) -> bool {
        let group = || (0..GROUP).filter_map(|back| self.at(back));
        group().count() == GROUP
            && self.axes.iter().enumerate().any(|(i, axis)| {
                let most = 0.5 * BEYOND * axis.spread;
                let louder = |w: &WindowStatistics| (w.log_variance[i] - axis.centre).min(most);
                let mean = group().map(|(w, _)| louder(w)).sum::<f64>() / GROUP as f64;
                mean > BEYOND * axis.spread / (GROUP as f64).sqrt()
            })
    }

    /// Whether the averages of `many` means before and after a stretch of `apart` windows are as
    /// near to each other as was usual at that distance; the last `recent` windows, after the
    /// stretch or in it, do not say what was usual.
    pub(super) fn same_level(
        &self,
        before: impl Iterator<Item = [f64; 3]> + Clone,
        after: impl Iterator<Item = [f64; 3]> + Clone,
        many: usize,
        apart: usize,
        recent: usize,
    ) -> bool {
        let usual = self.ring.len().saturating_sub(recent);
        // As far apart as the ring shows, scaled beyond that as a random walk wanders.
        let Some(shown) = usual.checked_sub(2 * many + PAIRS) else { return false };
        let shown = shown.min(apart);
        let beyond = ((many + apart) as f64 / (many + shown) as f64).sqrt();
        let average = |means: &mut dyn Iterator<Item = f64>| means.sum::<f64>() / many as f64;
        (0..3).all(|axis| {
            let column: Vec<f64> =
                self.ring.iter().take(usual).map(|(w, _)| w.mean[axis]).collect();
            let mut usual: Vec<f64> = column
                .windows(2 * many + shown)
                .filter_map(|span| {
                    let (first, last) = (span.get(..many)?, span.get(many + shown..)?);
                    let difference =
                        average(&mut last.iter().copied()) - average(&mut first.iter().copied());
                    Some(difference.abs())
                })
                .collect();
            let spread = quantile(&mut usual, 0.25) / HALF_QUARTILE * beyond;
            let now = average(&mut after.clone().map(|mean| mean[axis]))
                - average(&mut before.clone().map(|mean| mean[axis]));
            now.abs() <= OTHER_LEVEL * spread
        })
    }
}

/// The value below which a fraction `p` of the values lies; 0 of none.
fn quantile(values: &mut [f64], p: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let index = (p * (values.len() - 1) as f64) as usize;
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}
