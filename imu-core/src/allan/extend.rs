//! A slice of samples at once: the same bits as pushing them one by one, faster.
//!
//! Samples go through the ladder in chunks of 64, a level at a time over the whole chunk, so that
//! a level's totals stay in registers and its loop is one that compilers vectorise. A chunk that
//! does not start at a multiple of 64, that has a value to reject, or that follows missing samples
//! is pushed.

use super::carry::{Block, difference, pairwise};
use super::ladder::Ladder;
use super::learn::LEARNT;
use super::total::{SETTLE, Total};
use crate::Real;

/// Samples a chunk: a power of two, so that chunks and blocks of all levels begin together.
const CHUNK: usize = 64;
/// A chunk's blocks of one level, after the blocks of the past that they are compared with.
type Rows<T, const AXES: usize> = [[T; AXES]; CHUNK + 8];

impl<T: Real, const AXES: usize, const LEVELS: usize, const WINDOWS: usize, const ORDER: usize>
    Ladder<T, AXES, LEVELS, WINDOWS, ORDER>
{
    /// Takes samples in order: the same as [`push`](Self::push) of each, to the bit.
    ///
    /// Needs about 2·72·`AXES` scalars of stack.
    pub fn extend(&mut self, samples: &[[T; AXES]]) {
        let mut rest = samples;
        while !rest.is_empty() {
            rest = self.climb_all(rest);
            let to_boundary = CHUNK - (self.position as usize & (CHUNK - 1));
            let (now, after) = rest.split_at(to_boundary.min(rest.len()));
            now.iter().for_each(|sample| self.push(sample));
            rest = after;
        }
    }

    /// Takes whole chunks as long as they can be taken as such. Returns the samples that are left.
    fn climb_all<'a>(&mut self, samples: &'a [[T; AXES]]) -> &'a [[T; AXES]] {
        let at_boundary = self.position & (CHUNK as u64 - 1) == 0;
        if samples.len() < CHUNK
            || !at_boundary
            || self.held != LEARNT
            || !self.lower_levels_are_whole()
        {
            return samples;
        }
        let mut scratch = [[[T::ZERO; AXES]; CHUNK + 8]; 2];
        let mut rest = samples;
        while let Some((chunk, after)) = rest.split_first_chunk() {
            if !self.climb(chunk, &mut scratch) {
                break;
            }
            rest = after;
        }
        rest
    }

    /// How many blocks of a level end within a chunk.
    #[inline(always)]
    const fn blocks(level: usize) -> usize {
        CHUNK >> Self::stride_log2(level)
    }

    /// How many blocks of the past a level's first blocks of a chunk are compared with.
    #[inline(always)]
    const fn past(level: usize) -> usize {
        Self::lag(level) * ORDER
    }

    /// Whether the blocks that a chunk's are compared with have all their samples. A chunk that is
    /// taken as a whole leaves it so.
    fn lower_levels_are_whole(&self) -> bool {
        self.counts.iter().enumerate().take_while(|&(level, _)| Self::passes(level)).all(
            |(level, counts)| {
                counts
                    .iter()
                    .all(|age| age.iter().take(Self::lag(level)).all(|&c| c == 1_u32 << level))
            },
        )
    }

    /// Whether a chunk goes through this level as a whole: it has two blocks' length of it.
    const fn passes(level: usize) -> bool {
        level < LEVELS && level < CHUNK.trailing_zeros() as usize
    }

    /// Takes a chunk through the levels. Does nothing and returns `false` if a value is out of
    /// bounds or not finite.
    #[inline]
    fn climb(&mut self, chunk: &[[T; AXES]; CHUNK], scratch: &mut [Rows<T, AXES>; 2]) -> bool {
        let [rows, above] = scratch;
        if !self.center(chunk, rows) {
            return false;
        }
        let start = self.position;
        let (mut rows, mut above) = (rows, above);
        let mut level = 0;
        while Self::passes(level) {
            self.pass_level(level, rows, above);
            let end = (start as u32).wrapping_add(CHUNK as u32) >> Self::stride_log2(level);
            if end & (SETTLE - 1) == 0 {
                self.settle(level);
            }
            core::mem::swap(&mut rows, &mut above);
            level += 1;
        }
        if level < LEVELS {
            let stride = 1_u64 << Self::stride_log2(level);
            for row in rows.iter().skip(Self::past(level)).take(Self::blocks(level)) {
                self.position = self.position.wrapping_add(stride);
                self.carry(level, Block { sum: *row, count: 1_u32 << level });
            }
        }
        self.position = start.wrapping_add(CHUNK as u64);
        true
    }

    /// The samples less the reference, as blocks of level 0; whether all are within the bound.
    #[inline]
    fn center(&self, chunk: &[[T; AXES]; CHUNK], rows: &mut Rows<T, AXES>) -> bool {
        // A maximum finds what is out of bounds, but forgets a NaN; a sum does not.
        let mut furthest = [T::ZERO; AXES];
        let mut sum = [T::ZERO; AXES];
        for (row, sample) in rows.iter_mut().skip(Self::past(0)).zip(chunk) {
            for i in 0..AXES {
                row[i] = sample[i] - self.reference[i];
                let distance = row[i].abs();
                furthest[i] = if distance > furthest[i] { distance } else { furthest[i] };
                sum[i] += distance;
            }
        }
        furthest.iter().zip(&self.bound).all(|(furthest, bound)| furthest <= bound)
            && sum.iter().all(|sum| sum.is_finite())
    }

    /// All of a chunk's blocks of one level: their differences into the totals, the sums of
    /// neighbours into `above`, the last blocks into the history.
    #[inline]
    fn pass_level(&mut self, level: usize, rows: &mut Rows<T, AXES>, above: &mut Rows<T, AXES>) {
        let (lag, past, blocks) = (Self::lag(level), Self::past(level), Self::blocks(level));
        // Slots go on with every block: a chunk's first is in slot 1, as in `carry`.
        let slot = |k: usize| (k + 1) & (lag - 1) & (WINDOWS - 1);
        let (Some(history), Some(squares), Some(differences)) = (
            self.history.get_mut(level),
            self.squares.get_mut(level),
            self.differences.get_mut(level),
        ) else {
            return;
        };
        for (age, history) in history.iter().rev().enumerate() {
            for k in 0..lag {
                if let Some(row) = rows.get_mut(age * lag + k) {
                    *row = history[slot(k)];
                }
            }
        }

        let (Some(now), Some(before), Some(oldest), Some(sums)) = (
            rows.get(past..past + blocks),
            rows.get(past - lag..past - lag + blocks),
            rows.get(..blocks),
            above.get_mut(Self::past(level + 1)..),
        ) else {
            return;
        };
        let mut totals = squares.each_ref().map(Total::fine);
        // A block of the level above ends with every second block here, or with every one where
        // the stride is the same.
        if Self::stride_log2(level + 1) == Self::stride_log2(level) {
            let blocks = now.iter().zip(before).zip(oldest);
            for (((now, before), oldest), sum) in blocks.zip(sums) {
                add_squares::<T, AXES, ORDER>(&mut totals, now, before, oldest);
                *sum = pairwise(now, before);
            }
        } else {
            let (now, before, oldest) =
                (now.as_chunks::<2>().0, before.as_chunks::<2>().0, oldest.as_chunks::<2>().0);
            for (((now, before), oldest), sum) in now.iter().zip(before).zip(oldest).zip(sums) {
                add_squares::<T, AXES, ORDER>(&mut totals, &now[0], &before[0], &oldest[0]);
                add_squares::<T, AXES, ORDER>(&mut totals, &now[1], &before[1], &oldest[1]);
                *sum = pairwise(&now[1], &before[1]);
            }
        }
        for (square, total) in squares.iter_mut().zip(totals) {
            square.set_fine(total);
        }
        *differences = differences.wrapping_add(blocks as u64);

        for (age, history) in history.iter_mut().rev().enumerate() {
            for k in 0..lag {
                if let Some(row) = rows.get(blocks + age * lag + k) {
                    history[slot(k)] = *row;
                }
            }
        }
    }
}

/// Adds the squared differences of a block and those before it.
#[inline(always)]
fn add_squares<T: Real, const AXES: usize, const ORDER: usize>(
    totals: &mut [T; AXES],
    now: &[T; AXES],
    before: &[T; AXES],
    oldest: &[T; AXES],
) {
    for i in 0..AXES {
        let d = difference::<T, ORDER>(now[i], before[i], oldest[i]);
        totals[i] += d * d;
    }
}
