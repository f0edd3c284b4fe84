//! What becomes of the readings of a sensor at rest: variances, means of blocks, and the mean.

use serde::{Deserialize, Serialize};

use super::block_means::BlockMeans;
use super::limits::Limits;
use super::{SensorKind, SensorLadder};
use crate::recording::Event;

/// What becomes of values on the grid.
#[derive(Clone, Deserialize, Serialize)]
pub(super) struct Taken {
    kind: SensorKind,
    /// Known when the first values of a record show what is normal.
    limits: Option<Limits>,
    #[serde(with = "super::ladder_bytes")]
    ladder: SensorLadder,
    /// What the ladders of the records before this one gathered.
    #[serde(with = "super::ladder_bytes::optional")]
    pub(super) earlier: Option<SensorLadder>,
    pub(super) means: BlockMeans,
    /// Mean and count of the records before this one; a record without a sample has no count.
    pub(super) records: Vec<([f64; 3], u64)>,
}

impl Taken {
    pub(super) fn new(kind: SensorKind) -> Self {
        Self {
            kind,
            limits: None,
            ladder: SensorLadder::new(),
            earlier: None,
            means: BlockMeans::new(),
            records: Vec::new(),
        }
    }

    /// The mean of all records.
    pub(super) fn mean(&self) -> [f64; 3] {
        let count = self.records.iter().map(|(_, count)| count).sum::<u64>().max(1) as f64;
        let mut mean = [0.0; 3];
        for (of_record, samples) in &self.records {
            let share = *samples as f64 / count;
            for (mean, of_record) in mean.iter_mut().zip(of_record) {
                *mean += share * of_record;
            }
        }
        mean
    }

    /// Puts the record at hand beside those before it; the next one has limits of its own.
    pub(super) fn close_record(&mut self) {
        if self.limits.take().is_none() {
            self.records.push(([0.0; 3], 0));
            return;
        }
        let ladder = std::mem::take(&mut self.ladder);
        match &mut self.earlier {
            Some(earlier) => earlier.pool(&ladder),
            None => self.earlier = Some(ladder),
        }
        self.records.push(self.means.record_mean());
    }

    /// The limits, learnt from the first values.
    pub(super) fn limits(&mut self, event: Event<'_>) -> Option<Limits> {
        if self.limits.is_none()
            && let Event::Values(values) = event
        {
            let limits = Limits::of(self.kind, values);
            self.ladder =
                SensorLadder::with_reference(limits.reference, limits.bound).unwrap_or_default();
            self.means.next_record(limits.reference);
            self.limits = Some(limits);
        }
        self.limits
    }

    pub(super) fn take(&mut self, event: Event<'_>) {
        let Some(limits) = self.limits else { return };
        match event {
            Event::Values(values) => {
                let rejected = self.ladder.rejected_samples();
                self.ladder.extend(values);
                if self.ladder.rejected_samples() == rejected {
                    self.means.extend(values);
                } else {
                    for value in values {
                        if limits.hold(value) {
                            self.means.extend(std::slice::from_ref(value));
                        } else {
                            self.means.missing(1);
                        }
                    }
                }
            }
            Event::Missing(n) => {
                self.ladder.missing(n);
                self.means.missing(n);
            }
            Event::Restart => {
                self.ladder.restart();
                self.means.restart();
            }
        }
    }
}
