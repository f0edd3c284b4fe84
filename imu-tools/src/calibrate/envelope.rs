//! A signal of any length as at most 1024 columns of a picture: least, largest and mean of each.
//!
//! Columns begin with one sample; whenever they are full, neighbours are merged, so that memory
//! stays the same however long the recording is.

use serde::{Deserialize, Serialize};

use crate::recording::Event;

/// Columns are merged when there are so many.
const MOST: usize = 1024;

/// One column: some time of a signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Seconds after the first sample.
    pub from_s: f64,
    /// Seconds after the first sample.
    pub to_s: f64,
    /// Samples in it that are finite.
    pub samples: u64,
    /// The least of each axis.
    pub low: [f64; 3],
    /// The largest of each axis.
    pub high: [f64; 3],
    /// The mean of each axis.
    pub mean: [f64; 3],
}

/// Sums of a column.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
struct Sums {
    samples: u64,
    low: [f64; 3],
    high: [f64; 3],
    sum: [f64; 3],
}

impl Sums {
    const NONE: Self =
        Self { samples: 0, low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3], sum: [0.0; 3] };

    fn take(&mut self, values: &[[f64; 3]]) {
        for value in values {
            if !(value[0] + value[1] + value[2]).is_finite() {
                continue;
            }
            self.samples += 1;
            for (axis, &x) in value.iter().enumerate() {
                self.low[axis] = if x < self.low[axis] { x } else { self.low[axis] };
                self.high[axis] = if x > self.high[axis] { x } else { self.high[axis] };
                self.sum[axis] += x;
            }
        }
    }

    fn with(&self, next: &Self) -> Self {
        let mut both = *self;
        both.samples += next.samples;
        for axis in 0..3 {
            both.low[axis] = both.low[axis].min(next.low[axis]);
            both.high[axis] = both.high[axis].max(next.high[axis]);
            both.sum[axis] += next.sum[axis];
        }
        both
    }
}

/// Takes a signal as it comes.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Envelope {
    /// Samples a column.
    length: u64,
    columns: Vec<Sums>,
    open: Sums,
    /// Instants that have passed in the open column.
    passed: u64,
}

impl Envelope {
    pub(super) fn new() -> Self {
        Self { length: 1, columns: Vec::new(), open: Sums::NONE, passed: 0 }
    }

    /// Takes what the timeline says. A restart takes no time.
    pub(super) fn take(&mut self, event: Event<'_>) {
        match event {
            Event::Values(values) => {
                let mut rest = values;
                while !rest.is_empty() {
                    let room = usize::try_from(self.length - self.passed).unwrap_or(usize::MAX);
                    let (now, later) = rest.split_at(room.min(rest.len()));
                    self.open.take(now);
                    self.pass(now.len() as u64);
                    rest = later;
                }
            }
            Event::Missing(n) => {
                let mut left = n;
                while left > 0 {
                    let step = left.min(self.length - self.passed);
                    self.pass(step);
                    left -= step;
                }
            }
            Event::Restart => {}
        }
    }

    fn pass(&mut self, n: u64) {
        self.passed += n;
        if self.passed == self.length {
            self.columns.push(std::mem::replace(&mut self.open, Sums::NONE));
            self.passed = 0;
            if self.columns.len() == MOST {
                self.columns =
                    self.columns.chunks_exact(2).map(|pair| pair[0].with(&pair[1])).collect();
                self.length = self.length.saturating_mul(2);
            }
        }
    }

    /// The columns of samples `tau0_s` apart.
    pub(super) fn finish(mut self, tau0_s: f64) -> Vec<Column> {
        if self.passed > 0 {
            self.columns.push(self.open);
        }
        let length_s = self.length as f64 * tau0_s;
        self.columns
            .iter()
            .enumerate()
            .map(|(k, sums)| Column {
                from_s: k as f64 * length_s,
                to_s: (k + 1) as f64 * length_s,
                samples: sums.samples,
                low: sums.low,
                high: sums.high,
                mean: sums.sum.map(|sum| sum / sums.samples.max(1) as f64),
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_hold_range_and_mean() {
        let mut envelope = Envelope::new();
        let values: Vec<[f64; 3]> = (0..3000).map(|k| [f64::from(k), 1.0, f64::NAN]).collect();
        envelope.take(Event::Values(&values)); // not a number on one axis: no sample
        let values: Vec<[f64; 3]> = (0..3000).map(|k| [f64::from(k), -1.0, 0.5]).collect();
        envelope.take(Event::Values(&values[..1000]));
        envelope.take(Event::Missing(96));
        envelope.take(Event::Values(&values[1000..]));
        let columns = envelope.finish(0.5);
        assert_eq!(columns.iter().map(|c| c.samples).sum::<u64>(), 3000);
        assert_eq!((columns[0].to_s, columns.len()), (4.0, 762)); // 6096 instants, 8 a column
        let first = columns.iter().find(|c| c.samples == 8).unwrap();
        assert_eq!(
            (first.from_s, first.low, first.high),
            (1500.0, [0.0, -1.0, 0.5], [7.0, -1.0, 0.5])
        );
        assert_eq!(first.mean, [3.5, -1.0, 0.5]);
        // The hole: 4000 to 4096.
        assert!(columns[500..512].iter().all(|c| c.samples == 0));
    }
}
