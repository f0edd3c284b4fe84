//! A slice of samples at once: the same bits as pushing them one by one, faster.
//!
//! Samples go through the ladder in chunks of 64, a level at a time over the whole chunk, so that
//! a level's totals stay in registers and its loop is one that compilers vectorise. A chunk that
//! does not start at a multiple of 64, that has a value to reject, or that follows missing samples
//! is pushed.

use super::ladder::{LEARNT, Ladder, pairwise};
use super::total::Total;
use crate::Real;

/// Samples a chunk: a power of two, so that chunks and blocks of all levels begin together.
const CHUNK: usize = 64;
/// A chunk's blocks of one level, after the blocks of the past that they are compared with.
const ROWS: usize = CHUNK + 8;

impl<T: Real, const AXES: usize, const LEVELS: usize, const WINDOWS: usize, const ORDER: usize>
    Ladder<T, AXES, LEVELS, WINDOWS, ORDER>
{
    /// Takes samples in order: the same as [`push`](Self::push) of each, to the bit.
    ///
    /// Needs about 2·72·`AXES` scalars of stack.
    pub fn extend(&mut self, samples: &[[T; AXES]]) {
        let mut rest = samples;
        while !rest.is_empty() {
            let to_boundary = CHUNK - (self.position as usize & (CHUNK - 1));
            if to_boundary == CHUNK
                && self.held == LEARNT
                && let Some((chunk, after)) = rest.split_first_chunk::<CHUNK>()
                && self.lower_levels_are_whole()
                && self.climb(chunk)
            {
                rest = after;
                continue;
            }
            let (now, after) = rest.split_at(to_boundary.min(rest.len()));
            now.iter().for_each(|sample| self.push(sample));
            rest = after;
        }
    }

    /// How many blocks of a level end within a chunk.
    const fn blocks(level: usize) -> usize {
        CHUNK >> Self::stride_log2(level)
    }

    /// How many of them there must be for a pass over the level; fewer are carried one by one.
    const fn past(level: usize) -> usize {
        Self::lag(level) * ORDER
    }

    /// Whether the blocks that a chunk's are compared with have all their samples.
    fn lower_levels_are_whole(&self) -> bool {
        self.counts.iter().enumerate().take_while(|&(level, _)| Self::passes(level)).all(
            |(level, counts)| {
                counts
                    .iter()
                    .all(|age| age.iter().take(Self::lag(level)).all(|&c| c == 1_u32 << level))
            },
        )
    }

    /// Whether a chunk goes through this level as a whole.
    const fn passes(level: usize) -> bool {
        level < LEVELS && level < CHUNK.trailing_zeros() as usize
    }

    /// Takes a chunk through the levels. Does nothing and returns `false` if a value is out of
    /// bounds or not finite.
    #[inline]
    fn climb(&mut self, chunk: &[[T; AXES]; CHUNK]) -> bool {
        let mut one = [[T::ZERO; AXES]; ROWS];
        let mut good = [true; AXES];
        for (row, sample) in one.iter_mut().skip(Self::past(0)).zip(chunk) {
            for i in 0..AXES {
                row[i] = sample[i] - self.reference[i];
                good[i] &= row[i].abs() <= self.bound[i];
            }
        }
        if good.contains(&false) {
            return false;
        }

        let start = self.position;
        let mut other = [[T::ZERO; AXES]; ROWS];
        let (mut rows, mut above) = (&mut one, &mut other);
        let mut level = 0;
        while Self::passes(level) {
            self.pass_level(level, start, rows, above);
            core::mem::swap(&mut rows, &mut above);
            level += 1;
        }
        if level < LEVELS {
            let stride = 1_u64 << Self::stride_log2(level);
            for row in rows.iter().skip(Self::past(level)).take(Self::blocks(level)) {
                self.position = self.position.wrapping_add(stride);
                self.carry(level, *row, 1_u32 << level);
            }
        }
        self.position = start.wrapping_add(CHUNK as u64);
        true
    }

    /// All of a chunk's blocks of one level: their differences into the totals, the sums of
    /// neighbours into `above`, the last blocks into the history.
    #[inline]
    fn pass_level(
        &mut self,
        level: usize,
        start: u64,
        rows: &mut [[T; AXES]; ROWS],
        above: &mut [[T; AXES]; ROWS],
    ) {
        let (lag, past, blocks) = (Self::lag(level), Self::past(level), Self::blocks(level));
        // Blocks end at multiples of the stride; the slot of the first, as in `carry`.
        let first = ((start as u32 >> Self::stride_log2(level)) as usize).wrapping_add(1);
        let slot = |k: usize| first.wrapping_add(k) & (lag - 1) & (WINDOWS - 1);
        let (Some(history), Some(squares), Some(differences)) = (
            self.history.get_mut(level),
            self.squares.get_mut(level),
            self.differences.get_mut(level),
        ) else {
            return;
        };

        let mut room = rows.iter_mut();
        for age in history.iter().rev() {
            for k in 0..lag {
                if let Some(row) = room.next() {
                    *row = age[slot(k)];
                }
            }
        }

        let oldest = rows.iter();
        let before = rows.iter().skip(lag);
        let now = rows.iter().skip(past).take(blocks);
        let mut totals = *squares;
        if ORDER == 1 {
            for (now, before) in now.zip(oldest) {
                for i in 0..AXES {
                    let d = now[i] - before[i];
                    totals[i].add(d * d);
                }
            }
        } else {
            for ((now, before), oldest) in now.zip(before).zip(oldest) {
                for i in 0..AXES {
                    let d = (now[i] - before[i]) - (before[i] - oldest[i]);
                    totals[i].add(d * d);
                }
            }
        }
        *squares = totals;
        *differences = differences.wrapping_add(blocks as u64);

        // A block of the level above ends with every second block here, or with every one where
        // the stride is the same.
        let step = 1_usize << (Self::stride_log2(level + 1) - Self::stride_log2(level));
        let second = rows.iter().skip(past).take(blocks).skip(step - 1).step_by(step);
        let first_half = rows.iter().skip(past - lag).skip(step - 1).step_by(step);
        let sums = above.iter_mut().skip(Self::past(level + 1));
        for (sum, (b, a)) in sums.zip(second.zip(first_half)) {
            *sum = pairwise(b, a);
        }

        for (age, history) in history.iter_mut().enumerate() {
            for k in 0..lag {
                // The last `lag` blocks, or for age 1 the `lag` before them.
                if let Some(row) = rows.get(past + blocks - lag * (age + 1) + k) {
                    history[slot(blocks - lag + k)] = *row;
                }
            }
        }
        let end = (start as u32).wrapping_add(CHUNK as u32) >> Self::stride_log2(level);
        if end & (super::total::SETTLE - 1) == 0 {
            self.settle(level);
        }
    }
}
