//! Blocks in which both sensors reach equally far.
//!
//! A reader ends a block where one sensor's list is full, so that two samples of one instant may lie
//! in two blocks, and a recording may hold one sensor's samples long before the other's of the same
//! time. A writer that makes one row of both wants them in one block. So what one sensor is ahead by
//! is held back, up to a bound: a sensor that is silent for long does not stop the other.

use super::{BLOCK_SAMPLES, Block, Sample};

/// Samples of a sensor that wait for the other, at most.
const HELD: usize = 4 * BLOCK_SAMPLES;

/// What waits for the other sensor.
#[derive(Debug, Default)]
pub struct Aligner {
    held: Block,
    /// What was handed on last; its memory is used again.
    ready: Block,
}

impl Aligner {
    /// Takes the next block, and gives what is complete by now: each sensor's samples in order.
    pub fn take(&mut self, block: &Block) -> &Block {
        self.held.gyroscope.extend_from_slice(&block.gyroscope);
        self.held.accelerometer.extend_from_slice(&block.accelerometer);
        let end = |list: &[Sample]| list.last().map(|sample| sample.stamp_ns);
        let both = end(&self.held.gyroscope).zip(end(&self.held.accelerometer));
        let until = both.map(|(g, a)| g.min(a));
        self.ready.clear();
        move_until(&mut self.held.gyroscope, until, &mut self.ready.gyroscope);
        move_until(&mut self.held.accelerometer, until, &mut self.ready.accelerometer);
        &self.ready
    }

    /// What still waits, at the end.
    pub fn finish(self) -> Block {
        self.held
    }
}

/// Moves the samples up to the last one that is not later than `until`, and those too many to wait.
fn move_until(held: &mut Vec<Sample>, until: Option<i64>, ready: &mut Vec<Sample>) {
    let in_time = |until| held.iter().rposition(|sample: &Sample| sample.stamp_ns <= until);
    let complete = until.and_then(in_time).map_or(0, |last| last + 1);
    let too_many = held.len().saturating_sub(HELD);
    ready.extend(held.drain(..complete.max(too_many)));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(stamps: impl IntoIterator<Item = i64>) -> Vec<Sample> {
        stamps
            .into_iter()
            .map(|stamp_ns| Sample { stamp_ns, value: [stamp_ns as f64; 3] })
            .collect()
    }

    /// Aligns blocks, and gives the streams, and how many instants of both were in one block.
    fn aligned(blocks: &[Block]) -> (Block, usize) {
        let (mut aligner, mut all, mut together) = (Aligner::default(), Block::default(), 0);
        let mut take = |block: &Block| {
            let both = |s: &&Sample| block.accelerometer.iter().any(|a| a.stamp_ns == s.stamp_ns);
            together += block.gyroscope.iter().filter(both).count();
            all.gyroscope.extend_from_slice(&block.gyroscope);
            all.accelerometer.extend_from_slice(&block.accelerometer);
        };
        for block in blocks {
            take(aligner.take(block));
        }
        take(&aligner.finish());
        (all, together)
    }

    #[test]
    fn a_gyroscope_that_runs_ahead_by_a_block_meets_its_accelerometer() {
        let n = BLOCK_SAMPLES as i64;
        let blocks: Vec<Block> = (0..6)
            .map(|i| Block {
                gyroscope: if i < 5 { samples(i * n..(i + 1) * n) } else { Vec::new() },
                accelerometer: if i > 0 { samples((i - 1) * n..i * n) } else { Vec::new() },
                ..Block::default()
            })
            .collect();
        let (all, together) = aligned(&blocks);
        assert_eq!(all.gyroscope, samples(0..5 * n));
        assert_eq!(all.accelerometer, samples(0..5 * n));
        assert_eq!(together, 5 * BLOCK_SAMPLES);
    }

    #[test]
    fn a_silent_sensor_holds_up_a_bounded_number_of_samples() {
        let mut aligner = Aligner::default();
        let n = BLOCK_SAMPLES as i64;
        let mut given = 0;
        for i in 0..20 {
            let block = Block { gyroscope: samples(i * n..(i + 1) * n), ..Block::default() };
            given += aligner.take(&block).gyroscope.len();
            assert!(aligner.held.gyroscope.len() <= HELD);
        }
        assert_eq!(given + aligner.finish().gyroscope.len(), 20 * BLOCK_SAMPLES);
    }

    #[test]
    fn a_clock_that_is_set_back_loses_nothing() {
        let blocks = [0..100, 20..120].map(|stamps| Block {
            gyroscope: samples(stamps.clone()),
            accelerometer: samples(stamps),
            ..Block::default()
        });
        let (all, _) = aligned(&blocks);
        assert_eq!(all.gyroscope, samples((0..100).chain(20..120)));
        assert_eq!(all.accelerometer, all.gyroscope);
    }
}
