//! A recording of any length as at most 2¹⁶ means of blocks: what maximum likelihood works on.
//!
//! A slow random walk loses nothing when samples are averaged over blocks far shorter than N/K (white noise
//! does: as many blocks as there are tell of it, and no more). Blocks begin with one sample; whenever 2¹⁶
//! are full, neighbours are merged, so that memory stays at 2 MB however long the recording is. A block keeps the number of samples
//! that were there, and a hole is blocks with none: time goes on in it.
//!
//! A sample that is not finite counts as missing.
//!
//! ```
//! use imu_tools::calibrate::block_means::BlockMeans;
//!
//! let mut means = BlockMeans::new();
//! means.extend(&[[0.1, 0.2, 9.8]; 1000]);
//! means.missing(24);
//! assert_eq!((means.length(), means.blocks()), (1, 1024));
//! assert_eq!(means.merged(200).length(), 256); // samples a block
//! ```

use serde::{Deserialize, Serialize};

/// Blocks are merged when there are so many.
const MOST: usize = 1 << 16;

/// The three axes of a sensor as means of blocks of samples.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct BlockMeans {
    length: u64,
    /// Stretches between restarts, the last one growing. All but that have two blocks at least.
    segments: Vec<Vec<Block>>,
    /// Blocks in all of them.
    blocks: usize,
    /// The block being filled, and how many instants of it have passed.
    open: Block,
    passed: u64,
    /// Samples are kept relative to this, so that a large offset costs no digits.
    reference: [f64; 3],
    /// All samples since the last [`next_record`](Self::next_record).
    record: Block,
}

/// The samples of one block.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq)]
pub(super) struct Block {
    /// How many were there.
    pub samples: u64,
    /// Their sum, relative to the reference.
    pub sum: [f64; 3],
}

impl Block {
    /// These samples, one after the other.
    #[inline]
    fn of<'a>(samples: impl Iterator<Item = &'a [f64; 3]>, reference: &[f64; 3]) -> Self {
        let mut block = Self::default();
        for sample in samples {
            for axis in 0..3 {
                block.sum[axis] += sample[axis] - reference[axis];
            }
            block.samples += 1;
        }
        block
    }

    #[inline]
    fn add(&mut self, more: &Self) {
        self.samples += more.samples;
        for (sum, more) in self.sum.iter_mut().zip(more.sum) {
            *sum += more;
        }
    }

    fn merge(pair: &[Self]) -> Self {
        let mut both = Self::default();
        pair.iter().for_each(|block| both.add(block));
        both
    }
}

impl Default for BlockMeans {
    fn default() -> Self {
        Self::new()
    }
}

impl BlockMeans {
    /// Memory for blocks, at most, bytes.
    pub const LARGEST_BYTES: usize = MOST * size_of::<Block>();

    /// Nothing collected yet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            length: 1,
            segments: vec![Vec::new()],
            blocks: 0,
            open: Block::default(),
            passed: 0,
            reference: [0.0; 3],
            record: Block::default(),
        }
    }

    /// Takes consecutive samples.
    pub fn extend(&mut self, samples: &[[f64; 3]]) {
        let mut rest = samples;
        while !rest.is_empty() {
            let room = usize::try_from(self.length - self.passed).unwrap_or(usize::MAX);
            let (now, later) = rest.split_at(room.min(rest.len()));
            let mut piece = Block::of(now.iter(), &self.reference);
            if !finite(&piece.sum) {
                piece = Block::of(now.iter().filter(|sample| finite(sample)), &self.reference);
            }
            self.open.add(&piece);
            self.record.add(&piece);
            self.pass(now.len() as u64);
            rest = later;
        }
    }

    /// `n` samples did not come: their time passes.
    pub fn missing(&mut self, n: u64) {
        self.pass(n);
    }

    /// A new beginning: nothing is known of the time since the last sample.
    pub fn restart(&mut self) {
        self.open = Block::default();
        self.passed = 0;
        if let Some(last) = self.segments.last_mut() {
            if last.len() < 2 {
                self.blocks -= last.len();
                last.clear();
            } else {
                self.segments.push(Vec::new());
            }
        }
    }

    /// A [`restart`](Self::restart) after which samples lie about `reference`.
    pub fn next_record(&mut self, reference: [f64; 3]) {
        self.restart();
        self.reference = reference;
        self.record = Block::default();
    }

    /// Mean of all samples of the record, and how many.
    pub(super) fn record_mean(&self) -> ([f64; 3], u64) {
        let count = self.record.samples.max(1) as f64;
        let mean = [0, 1, 2].map(|axis| self.reference[axis] + self.record.sum[axis] / count);
        (mean, self.record.samples)
    }

    /// Samples a block, a power of two.
    #[must_use]
    pub fn length(&self) -> u64 {
        self.length
    }

    /// How many blocks are full.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.blocks
    }

    /// The same record in blocks of at least `samples` samples (of all of it, if that is less).
    #[must_use]
    pub fn merged(&self, samples: u64) -> Self {
        let mut merged = self.clone();
        while merged.length < samples && merged.blocks() > 2 {
            merged.double();
        }
        merged
    }

    /// The stretches between restarts; nothing links one with the next.
    pub(super) fn segments(&self) -> &[Vec<Block>] {
        &self.segments
    }

    /// Lets the time of `n` samples pass.
    #[inline]
    fn pass(&mut self, mut n: u64) {
        while n > 0 {
            let step = n.min(self.length - self.passed);
            self.passed += step;
            n -= step;
            if self.passed == self.length && !self.close() {
                return;
            }
        }
    }

    /// Puts the block being filled to the others; `false` if there is nothing to keep time for.
    fn close(&mut self) -> bool {
        let block = std::mem::take(&mut self.open);
        self.passed = 0;
        let Some(last) = self.segments.last_mut() else { return false };
        if last.is_empty() && block.samples == 0 {
            return false;
        }
        last.push(block);
        self.blocks += 1;
        if self.blocks >= MOST {
            self.double();
        }
        true
    }

    /// Merges neighbours. What is left at the end of a finished stretch is dropped.
    fn double(&mut self) {
        if let Some(last) = self.segments.last_mut()
            && last.len() % 2 == 1
            && let Some(odd) = last.pop()
        {
            self.open = Block::merge(&[odd, self.open]);
            self.passed += self.length;
        }
        self.length = self.length.saturating_mul(2);
        let growing = self.segments.len() - 1;
        for segment in &mut self.segments {
            *segment = segment.chunks_exact(2).map(Block::merge).collect();
        }
        let mut index = 0;
        self.segments.retain(|segment| {
            index += 1;
            index > growing || segment.len() >= 2
        });
        self.blocks = self.segments.iter().map(Vec::len).sum();
    }
}

fn finite(sample: &[f64; 3]) -> bool {
    sample.iter().all(|x| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sample k of a record: three different, exactly representable values.
    fn row(k: u64) -> [f64; 3] {
        let k = (k * 37 % 101) as f64;
        [k, 2.0 * k - 7.0, 0.5 * k + 3.0]
    }

    fn means(block: &Block, reference: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| reference[i] + block.sum[i] / block.samples as f64)
    }

    #[test]
    fn blocks_hold_the_means_of_their_samples() {
        // 2¹⁸ + 5 samples: blocks of 8, then of 16.
        let mut collected = BlockMeans::new();
        let rows: Vec<_> = (0..(1 << 18) + 5).map(row).collect();
        rows.chunks(1000).for_each(|chunk| collected.extend(chunk));
        assert_eq!((collected.length(), collected.blocks()), (8, 1 << 15));
        let merged = collected.merged(16);
        assert_eq!((merged.length(), merged.blocks()), (16, 1 << 14));
        for (k, block) in merged.segments()[0].iter().enumerate() {
            let rows = &rows[16 * k..][..16];
            let expected = [0, 1, 2].map(|i| rows.iter().map(|row| row[i]).sum::<f64>() / 16.0);
            assert_eq!(means(block, merged.reference), expected);
        }
    }

    #[test]
    fn holes_pass_time_and_what_is_no_number_is_a_hole() {
        let mut collected = BlockMeans::new();
        collected.missing(10); // before the first sample: nothing to keep
        for k in 0..4096 {
            match k {
                3 => collected.extend(&[[f64::NEG_INFINITY, 0.0, 0.0]]),
                100 => collected.extend(&[[0.0, f64::NAN, 0.0]]),
                500 => collected.extend(&[row(499), [0.0, 0.0, f64::INFINITY], row(501)]),
                499 | 501 => {}
                1000..1100 => collected.missing(1),
                _ => collected.extend(&[row(k)]),
            }
        }
        assert_eq!(collected.blocks(), 4096);
        let there = |k: usize| collected.segments()[0][k].samples == 1;
        for k in 0..4096 {
            assert_eq!(there(k), !matches!(k, 3 | 100 | 500 | 1000..1100), "sample {k}");
        }
        let merged = collected.merged(128);
        assert_eq!(merged.segments()[0][7].samples, 128 - 24); // 896…1023
        assert_eq!(merged.segments()[0][0].samples, 126);
    }

    #[test]
    fn memory_is_bounded_whatever_comes() {
        let mut collected = BlockMeans::new();
        for k in 0..20_000 {
            collected.extend(&(0..30).map(|i| row(k + i)).collect::<Vec<_>>());
            collected.restart();
        }
        assert!(collected.blocks() <= MOST && collected.segments.len() <= MOST / 2 + 1);
        collected.extend(&[row(1)]);
        collected.missing(u64::MAX);
        collected.extend(&[row(2)]);
        assert!(collected.blocks() <= MOST);
    }

    /// Sums of a few thousand integers and halves, relative to an integer, are exact.
    #[test]
    fn the_mean_of_a_record_is_of_all_its_samples() {
        let mut collected = BlockMeans::new();
        assert_eq!(collected.record_mean(), ([0.0; 3], 0));
        for (reference, first) in [([0.0; 3], 0), ([1e6, -1e6, 9.0], 7)] {
            collected.next_record(reference);
            assert_eq!(collected.record_mean(), (reference, 0));
            let rows: Vec<_> =
                (first..first + 101).map(|k| [0, 1, 2].map(|i| reference[i] + row(k)[i])).collect();
            // What a restart drops, what a hole leaves out and what is no number: the first two do not
            // change the mean.
            collected.extend(&rows[..30]);
            collected.restart();
            collected.extend(&rows[30..50]);
            collected.missing(1000);
            collected.extend(&[[f64::NAN; 3]]);
            collected.extend(&rows[50..]);
            // k·37 mod 101 takes each value 0…100 once.
            let expected = [50.0, 93.0, 28.0];
            let (mean, samples) = collected.record_mean();
            assert_eq!((mean, samples), ([0, 1, 2].map(|i| reference[i] + expected[i]), 101));
        }
    }

    #[test]
    fn nothing_spans_a_restart() {
        let mut collected = BlockMeans::new();
        let rows: Vec<_> = (0..100).map(row).collect();
        collected.extend(&rows);
        collected.restart();
        collected.extend(&rows[..33]);
        let merged = collected.merged(32);
        let lengths: Vec<usize> = merged.segments().iter().map(Vec::len).collect();
        assert_eq!(lengths, [3, 1]);
    }
}
