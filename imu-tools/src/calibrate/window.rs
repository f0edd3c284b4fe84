//! The part of each record between --from and --to.

use std::ops::Range;

use super::Options;
use crate::recording::{Block, Sample};

/// Cuts blocks to it.
pub(super) struct Window {
    from_ns: i64,
    to_ns: i64,
    first: Option<i64>,
}

impl Window {
    pub(super) fn new(options: &Options) -> Self {
        let ns = |s: f64| (s * 1e9) as i64; // saturates
        Self {
            from_ns: options.from_s.map_or(i64::MIN, ns),
            to_ns: options.to_s.map_or(i64::MAX, ns),
            first: None,
        }
    }

    /// Notes where the recording begins.
    pub(super) fn open(&mut self, block: &Block) {
        if self.first.is_none() {
            self.first = block.first_ns();
        }
    }

    /// Which samples of a block lie within.
    pub(super) fn cut(&self, samples: &[Sample]) -> Range<usize> {
        let everything = self.from_ns == i64::MIN && self.to_ns == i64::MAX;
        let Some(first) = self.first.filter(|_| !everything) else { return 0..samples.len() };
        let within = |sample: &Sample| {
            let at = sample.stamp_ns.saturating_sub(first);
            at >= self.from_ns && at <= self.to_ns
        };
        let start = samples.iter().position(within).unwrap_or(samples.len());
        let end = samples.iter().rposition(within).map_or(start, |last| last + 1);
        start..end
    }
}
