//! From stamps to a uniform grid: which samples are consecutive, and how many are missing between.
//!
//! Stamps jitter, come in bunches, drift with the host's clock, are lost, doubled and set back. An
//! Allan ladder wants consecutive readings and the number of those that did not come. So the grid
//! of the sensor's own clock is fitted to the first [`PREFIX`] stamps by least squares and then
//! followed slowly, in phase and period. A sample belongs to the next grid point, whatever its
//! stamp, unless the stamps that follow stay away from the grid as well: a late stamp is followed by
//! others in their places, a lost sample is not. The rules are those of `grid.rs`. With a jitter (rms)
//! of a fifth of the period and more than one sample of fifty lost, a loss may be placed late or
//! missed.
//!
//! ```
//! use imu_tools::recording::{Event, Sample, Timeline};
//! let mut timeline = Timeline::new();
//! let (mut values, mut missing) = (0, 0);
//! let mut count = |event: Event<'_>| match event {
//!     Event::Values(list) => values += list.len(),
//!     Event::Missing(n) => missing += n,
//!     Event::Restart => {}
//! };
//! for i in (0..1000).filter(|i| !(500..510).contains(i)) {
//!     timeline.push(&[Sample { stamp_ns: i * 5_000_000, value: [0.0; 3] }], &mut count);
//! }
//! let summary = timeline.finish(&mut count);
//! assert_eq!((values, missing), (990, 10));
//! assert!((summary.rate_hz - 200.0).abs() < 1e-9);
//! ```

mod fit;
mod grid;

use serde::{Deserialize, Serialize};

use super::Sample;
use grid::{Grid, Verdict};

/// The first samples are held back until there are so many, or the recording ends.
pub const PREFIX: usize = 4096;

/// What the samples of one sensor say to a ladder, in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event<'a> {
    /// Readings at consecutive instants of the grid (non-finite ones included).
    Values(&'a [[f64; 3]]),
    /// So many instants of the grid have no reading.
    Missing(u64),
    /// The clock was set back, or more than an hour is missing: no difference spans this.
    Restart,
}

/// A stretch without readings.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
pub struct Gap {
    /// Seconds from the first sample to the last one before the gap.
    pub at_s: f64,
    /// Samples that did not come.
    pub missing: u64,
}

/// A clock that was set while samples went on.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
pub struct ClockStep {
    /// Seconds from the first sample.
    pub at_s: f64,
    /// By how much, s; negative: it was set back.
    pub by_s: f64,
}

/// What is known of a sensor's stamps.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
pub struct Summary {
    /// Samples handed on.
    pub samples: u64,
    /// Rate in Hz, fitted over the whole recording; 0 where fewer than two stamps differ.
    pub rate_hz: f64,
    /// Its standard deviation, Hz, as far as jitter of the first and last stamp makes it.
    pub rate_sd_hz: f64,
    /// Seconds from the first sample to the last, without what a [`Event::Restart`] spans.
    pub span_s: f64,
    /// The first gaps, at most [`Summary::GAPS_LISTED`].
    pub gaps: Vec<Gap>,
    /// The longest gap, the first of equal ones, listed or not.
    pub longest_gap: Option<Gap>,
    /// All gaps, listed or not.
    pub gap_count: u64,
    /// Samples missing in all gaps.
    pub missing: u64,
    /// Samples with the stamp of the one before: dropped where the reading is the same as well,
    /// handed on where it is another one.
    pub duplicates: u64,
    /// Stamps earlier than the one before.
    pub backward: u64,
    /// Times that the clock was set by up to a second while samples went on, the first ones.
    pub clock_steps: Vec<ClockStep>,
    /// Times that the timeline was started anew.
    pub restarts: u64,
    /// Where, and by how much stamps jumped there: backwards, or forwards by more than an hour. The
    /// first ones.
    pub breaks: Vec<ClockStep>,
    /// Root mean square of stamp minus grid, seconds.
    pub jitter_s: f64,
}

impl Summary {
    /// So many gaps (and clock steps) are listed one by one; the others are only counted.
    pub const GAPS_LISTED: usize = 1000;
}

/// Snaps the stamps of one sensor to the grid of its rate.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Timeline {
    summary: Summary,
    /// Samples whose place is not decided.
    pending: Vec<Sample>,
    last: Option<Sample>,
    values: Vec<[f64; 3]>,
    grid: Option<Grid>,
    /// Grid intervals and nanoseconds of the stretches before the last restart.
    intervals: f64,
    nanoseconds: f64,
    /// Sum of squared errors (ns²) of the records before this one, and their number.
    squares: f64,
    accepted: u64,
}

/// Sampling rate in Hz by the first [`PREFIX`] stamps; `None` where they do not show one.
pub(crate) fn rate(samples: &[Sample]) -> Option<f64> {
    /// Fewer stamps than this leave a jittering rate too uncertain.
    const FEWEST: usize = 64;
    let samples = samples.get(..PREFIX).unwrap_or(samples);
    let grid = if samples.len() < FEWEST { None } else { fit::grid(samples) };
    grid.map(|grid| 1e9 / grid.period())
}

impl Timeline {
    /// A timeline that has seen nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes the next samples and hands on what can be decided: the first [`PREFIX`] samples are
    /// held back until the rate is known, later ones only where a gap may begin. Into how many calls
    /// samples are divided makes no difference.
    pub fn push(&mut self, samples: &[Sample], mut to: impl FnMut(Event<'_>)) {
        let mut rest = samples;
        while self.grid.is_none() && !rest.is_empty() {
            let (now, later) = rest.split_at(self.room().min(rest.len()));
            self.take_in(now);
            if self.pending.len() >= PREFIX {
                self.decide(false, &mut to);
            }
            rest = later;
        }
        let rest = self.follow(rest);
        self.take_in(rest);
        if self.grid.is_some() {
            if self.pending.is_empty() {
                self.hand_on(&mut to);
            } else {
                self.decide(false, &mut to);
            }
        }
    }

    /// How many samples it takes at most until the first ones are handed on; `usize::MAX` when they
    /// were.
    pub(crate) fn room(&self) -> usize {
        match self.grid {
            Some(_) => usize::MAX,
            None => PREFIX.saturating_sub(self.pending.len()).max(1),
        }
    }

    /// Places samples as long as each is where it belongs, as most are, without holding them back
    /// first. Returns those that are left.
    fn follow<'a>(&mut self, samples: &'a [Sample]) -> &'a [Sample] {
        let (Some(grid), Some(last)) = (&mut self.grid, self.last) else { return samples };
        if !self.pending.is_empty() {
            return samples;
        }
        let (placed, rest) = samples.split_at(grid.follow(samples, last.stamp_ns));
        self.values.extend(placed.iter().map(|sample| sample.value));
        self.last = placed.last().copied().or(self.last);
        rest
    }

    /// Appends to the pending samples what is not there twice.
    fn take_in(&mut self, samples: &[Sample]) {
        self.pending.reserve(samples.len());
        let mut before = self.last;
        let mut backward = 0;
        for sample in samples {
            let step = before.map_or(1, |last| sample.stamp_ns.saturating_sub(last.stamp_ns));
            backward += u64::from(step < 0);
            let last = before.replace(*sample);
            if step == 0 {
                self.summary.duplicates += 1;
                let bits = |sample: Sample| sample.value.map(f64::to_bits);
                if last.map(bits) == Some(bits(*sample)) {
                    continue;
                }
            }
            self.pending.push(*sample);
        }
        self.last = before;
        self.summary.backward += backward;
    }

    /// Hands on what was held back: another record follows, whose first stamps show phase and period
    /// anew. No difference spans the break, and it is not counted among the restarts.
    pub fn next_record(&mut self, mut to: impl FnMut(Event<'_>)) {
        self.close_record(&mut to);
        if self.last.take().is_some() {
            to(Event::Restart);
        }
    }

    /// Hands on what was held back, and says what the stamps were like.
    pub fn finish(mut self, mut to: impl FnMut(Event<'_>)) -> Summary {
        self.close_record(&mut to);
        if self.accepted > 0 {
            self.summary.jitter_s = (self.squares / self.accepted as f64).sqrt() * 1e-9;
        }
        if self.nanoseconds > 0.0 {
            self.summary.rate_hz = 1e9 * self.intervals / self.nanoseconds;
            let ends = std::f64::consts::SQRT_2 * self.summary.jitter_s;
            self.summary.rate_sd_hz = self.summary.rate_hz * ends * 1e9 / self.nanoseconds;
        }
        self.summary.span_s = self.nanoseconds * 1e-9;
        self.summary
    }

    /// Places all that is pending, and adds the record to the totals.
    fn close_record(&mut self, to: &mut impl FnMut(Event<'_>)) {
        self.decide(true, to);
        if let Some(grid) = self.grid.take() {
            self.close_stretch(&grid);
            let (squares, accepted) = grid.squared_errors();
            self.squares += squares;
            self.accepted += accepted;
        }
    }

    /// Adds the stretch that ends here to the totals.
    fn close_stretch(&mut self, grid: &Grid) {
        self.intervals += grid.intervals();
        self.nanoseconds += grid.elapsed();
    }

    /// Places the pending samples, all of them at the end of the recording.
    fn decide(&mut self, at_end: bool, to: &mut impl FnMut(Event<'_>)) {
        let pending = std::mem::take(&mut self.pending);
        let mut grid = match self.grid.take() {
            Some(grid) => grid,
            None => match fit::grid(&pending) {
                Some(grid) => grid,
                None => {
                    // No two stamps differ: the readings are all there is.
                    self.values.extend(pending.iter().map(|sample| sample.value));
                    self.hand_on(to);
                    return;
                }
            },
        };
        self.values.reserve(pending.len());
        let mut placed = 0;
        while let Some((sample, after)) = pending.get(placed..).and_then(|p| p.split_first()) {
            let error = grid.error(sample.stamp_ns);
            let verdict = if grid.near(error) {
                Verdict::Next
            } else {
                match grid.judge(sample.stamp_ns, after, at_end) {
                    Some(verdict) => verdict,
                    None => break,
                }
            };
            match verdict {
                Verdict::Next => {}
                Verdict::Missing { count, shift } => {
                    self.missing(count, grid.elapsed(), to);
                    grid.miss(count, shift);
                }
                Verdict::Adjusted { shift } => {
                    if self.summary.clock_steps.len() < Summary::GAPS_LISTED {
                        let at_s = (self.nanoseconds + grid.elapsed()) * 1e-9;
                        self.summary.clock_steps.push(ClockStep { at_s, by_s: shift * 1e-9 });
                    }
                    grid.adjust(shift);
                }
                Verdict::Restart { shift } => {
                    self.hand_on(to);
                    to(Event::Restart);
                    self.summary.restarts += 1;
                    if self.summary.breaks.len() < Summary::GAPS_LISTED {
                        let at_s = (self.nanoseconds + grid.elapsed()) * 1e-9;
                        self.summary.breaks.push(ClockStep { at_s, by_s: shift * 1e-9 });
                    }
                    self.close_stretch(&grid);
                    grid.restart(shift);
                }
            }
            let missed = grid.accept(grid.error(sample.stamp_ns));
            if missed > 0 {
                self.missing(missed, grid.elapsed(), to);
            }
            self.values.push(sample.value);
            placed += 1;
        }
        self.hand_on(to);
        self.grid = Some(grid);
        self.pending = pending;
        self.pending.drain(..placed);
    }

    /// Hands on the readings before a gap, and the gap.
    fn missing(&mut self, count: u64, elapsed: f64, to: &mut impl FnMut(Event<'_>)) {
        self.hand_on(to);
        to(Event::Missing(count));
        self.summary.gap_count += 1;
        self.summary.missing += count;
        let gap = Gap { at_s: (self.nanoseconds + elapsed) * 1e-9, missing: count };
        if self.summary.longest_gap.is_none_or(|longest| longest.missing < count) {
            self.summary.longest_gap = Some(gap);
        }
        if self.summary.gaps.len() < Summary::GAPS_LISTED {
            self.summary.gaps.push(gap);
        }
    }

    fn hand_on(&mut self, to: &mut impl FnMut(Event<'_>)) {
        if !self.values.is_empty() {
            self.summary.samples += self.values.len() as u64;
            to(Event::Values(&self.values));
            self.values.clear();
        }
    }
}

#[cfg(test)]
mod tests;
