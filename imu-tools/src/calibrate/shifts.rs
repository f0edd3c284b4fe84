//! A small lasting change of the mean: a sensor that tips over a little, slowly, and stays so.
//!
//! Means of windows of about a second come in order, of windows at rest only. At each place the
//! average of [`LONG`] windows (or of [`SHORT`]) before it is compared with that of as many after it,
//! a [`TRANSITION`] between. They differ by white noise of 2N²/m and by the random walk, and how much
//! is usual of them is learnt: the median difference of such averages further apart, never less than
//! what neighbouring windows explain. A place is a shift where the difference
//!
//! - is beyond [`BEYOND`] of those spreads, and
//! - stays beyond [`BEYOND_TREND`] of its own when the slope within the averages is taken off: a
//!   warm-up is no shift;
//! - and is the largest for [`PEAK`] places around.
//!
//! For white noise a spread is N√(2/m): a shift of 2.5 standard deviations of a 1 s mean shows, of 5
//! where only eight windows are there. Memory: some 80 sums of means and [`BLOCKS`] averages of eight.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// Windows an average.
const SHORT: usize = 8;
const LONG: usize = 32;
/// Windows between the averages, in which the mean goes from one level to the other.
const TRANSITION: usize = 4;
/// Spreads that two levels of a sensor at rest never differ by.
const BEYOND: f64 = 8.0;
/// The same of what is left without a slope, which scatters more.
const BEYOND_TREND: f64 = 4.0;
/// Places after the largest difference that must show no larger one.
const PEAK: usize = 8;
/// Averages of eight windows that show what is usual: an hour.
const BLOCKS: usize = 512;
/// Differences of those that show it at least.
const FEWEST: usize = 8;
/// The usual is learnt anew when there are new ones, one for so many that are kept.
const RELEARN: usize = 8;
/// Median of the absolute value of a standard normal quantity, and the error of one that was learnt
/// from n values, relative, over 1/√n.
const HALF: f64 = 0.674_490;
const ERROR_OF_MEDIAN: f64 = 1.17;

/// What is usual of the difference of two averages, on each axis.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
struct Spread {
    windows: usize,
    axes: [f64; 3],
}

/// A place whose averages are too far apart.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
struct Candidate {
    score: f64,
    place: u64,
}

/// Looks for shifts.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub(super) struct Shifts {
    /// Number of each window, and the sum of the means before it, since the last break.
    sums: VecDeque<(u64, [f64; 3])>,
    total: [f64; 3],
    /// Windows before the first of `sums` since the last break.
    pruned: u64,
    best: Option<Candidate>,
    /// Averages of eight windows, and in which stretch between breaks.
    blocks: VecDeque<([f64; 3], u64)>,
    open: ([f64; 3], usize),
    stretch: u64,
    /// Blocks since the usual was learnt.
    new: usize,
    spreads: [Option<Spread>; 2],
}

impl Shifts {
    /// Shows a mean, of which the usual is learnt. `step` is the spread of the difference of
    /// neighbouring means.
    pub(super) fn show(&mut self, mean: [f64; 3], step: [f64; 3]) {
        self.open.0 = [0, 1, 2].map(|axis| self.open.0[axis] + mean[axis]);
        self.open.1 += 1;
        if self.open.1 == SHORT {
            if self.blocks.len() == BLOCKS {
                self.blocks.pop_front();
            }
            self.blocks.push_back((self.open.0.map(|sum| sum / SHORT as f64), self.stretch));
            self.open = ([0.0; 3], 0);
            self.new += 1;
            if RELEARN * self.new >= self.blocks.len().max(RELEARN * RELEARN) {
                self.learn(step);
            }
        }
    }

    /// The windows shown so far and those to come are not neighbours.
    pub(super) fn show_break(&mut self) {
        self.open = ([0.0; 3], 0);
        self.stretch += 1;
    }

    /// Learns what is usual.
    pub(super) fn learn(&mut self, step: [f64; 3]) {
        self.new = 0;
        let blocks = &*self.blocks.make_contiguous();
        self.spreads = [SHORT, LONG].map(|windows| spread(blocks, windows, step));
    }

    /// Takes the mean of window `number`; the first and the last window of a shift that shows by it.
    pub(super) fn push(&mut self, number: u64, mean: [f64; 3]) -> Option<(u64, u64)> {
        self.sums.push_back((number, self.total));
        self.total = [0, 1, 2].map(|axis| self.total[axis] + mean[axis]);
        let place = self.end().checked_sub((TRANSITION + LONG) as u64)?;
        let found = self.judge(place);
        while self.pruned + (LONG as u64) < self.first_held() && self.sums.pop_front().is_some() {
            self.pruned += 1;
        }
        found
    }

    /// What comes next is no neighbour; the first and last window of each shift that still shows.
    pub(super) fn end_stretch(&mut self) -> Vec<(u64, u64)> {
        let mut found = Vec::new();
        let mut place = (self.end() + 1).saturating_sub((TRANSITION + LONG) as u64);
        while place <= self.end() {
            found.extend(self.judge(place));
            place += 1;
        }
        let best = self.best.take();
        found.extend(best.and_then(|best| self.cut(best.place)));
        self.sums.clear();
        self.total = [0.0; 3];
        self.pruned = 0;
        found
    }

    /// The first window that may still be one of a shift.
    pub(super) fn holds(&self) -> Option<u64> {
        self.sums.get(self.first_held().checked_sub(self.pruned)? as usize).map(|sum| sum.0)
    }

    /// Windows since the last break.
    fn end(&self) -> u64 {
        self.pruned + self.sums.len() as u64
    }

    fn first_held(&self) -> u64 {
        let next = (self.end() + 1).saturating_sub((TRANSITION + LONG) as u64).max(SHORT as u64);
        self.best.map_or(next, |best| best.place)
    }

    /// Compares what is before and after a place; a shift that is beyond doubt by now.
    fn judge(&mut self, place: u64) -> Option<(u64, u64)> {
        let score = self.spreads.iter().flatten().filter_map(|spread| self.score(place, spread));
        let score = score.fold(0.0, f64::max);
        if score > self.best.map_or(1.0, |best| best.score) {
            self.best = Some(Candidate { score, place });
        }
        let best = self.best.filter(|best| place >= best.place + PEAK as u64)?;
        self.best = None;
        self.cut(best.place)
    }

    /// How far apart the averages before and after a place are, over what they may be.
    fn score(&self, place: u64, spread: &Spread) -> Option<f64> {
        let (many, gap) = (spread.windows, TRANSITION);
        let at = |offset: isize| {
            let index = place.checked_sub(self.pruned)?.checked_add_signed(offset as i64)? as usize;
            if index == self.sums.len() {
                Some(&self.total)
            } else {
                self.sums.get(index).map(|sum| &sum.1)
            }
        };
        let (m, g) = (many as isize, gap as isize);
        let (first, middle, next, end) = (at(-m)?, at(0)?, at(g)?, at(g + m)?);
        let beyond = |axis: usize| {
            let way = end[axis] - next[axis] - middle[axis] + first[axis];
            way.abs() > BEYOND * many as f64 * spread.axes[axis]
        };
        // Hardly ever is there more to look at.
        if !(0..3).any(beyond) {
            return None;
        }
        let before = [first, at(-m / 2)?, middle];
        let after = [next, at(g + m / 2)?, end];
        let (m, g) = (many as f64, gap as f64);
        // What white noise does to the difference without the slope, over what it does with it.
        let wider = (1.0 + 4.0 * ((m + g) / m).powi(2)).sqrt();
        let of_axis = |axis: usize| {
            let halves = [before, after].map(|[a, b, c]| {
                [(b[axis] - a[axis]) / (0.5 * m), (c[axis] - b[axis]) / (0.5 * m)]
            });
            let [[a, b], [c, d]] = halves;
            let way = 0.5 * (c + d - a - b);
            let slope = 0.5 * ((b - a) + (d - c)) / (0.5 * m);
            let left = (way - (m + g) * slope) * way.signum();
            let limit = spread.axes[axis];
            if limit > 0.0 {
                (way.abs() / (BEYOND * limit)).min(left / (BEYOND_TREND * wider * limit))
            } else {
                0.0
            }
        };
        Some((0..3).map(of_axis).fold(0.0, f64::max))
    }

    /// Forgets what is before a shift; its first and last window.
    fn cut(&mut self, place: u64) -> Option<(u64, u64)> {
        let index = place.checked_sub(self.pruned)? as usize;
        let first = self.sums.get(index)?.0;
        let last = self.sums.get(index + TRANSITION - 1)?.0;
        self.sums.drain(..index + TRANSITION);
        self.pruned = 0;
        Some((first, last))
    }
}

/// How far averages of `windows` windows usually differ, from averages of eight and the stretch of each.
fn spread(blocks: &[([f64; 3], u64)], windows: usize, step: [f64; 3]) -> Option<Spread> {
    let many = windows / SHORT;
    // One block between them is more than a transition.
    let span = 2 * many + 1;
    let pairs = || {
        let spans = blocks.windows(span);
        spans.filter(|span| span.first().map(|b| b.1) == span.last().map(|b| b.1))
    };
    let count = pairs().count();
    if count < FEWEST * many {
        return None;
    }
    let unsure = 1.0 + 2.0 * ERROR_OF_MEDIAN / (count as f64 / many as f64).sqrt();
    let axes = [0, 1, 2].map(|axis| {
        let sum =
            |blocks: &[([f64; 3], u64)]| blocks.iter().map(|block| block.0[axis]).sum::<f64>();
        let way = |span: &[([f64; 3], u64)]| {
            let (before, after) = span.split_at(many);
            (sum(after.get(1..).unwrap_or_default()) - sum(before)).abs() / many as f64
        };
        let mut usual: Vec<f64> = pairs().map(way).collect();
        let middle = usual.len() / 2;
        let median = *usual.select_nth_unstable_by(middle, f64::total_cmp).1;
        (median / HALF * unsure).max(step[axis] / (windows as f64).sqrt())
    });
    Some(Spread { windows, axes })
}

#[cfg(test)]
#[path = "shifts_tests.rs"]
mod tests;
