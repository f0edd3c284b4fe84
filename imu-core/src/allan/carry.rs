//! One sample up the levels of a ladder: blocks are compared, summed in pairs and handed on.
//!
//! A block ends at its level every stride: a quarter of its length with 4 windows, all of it with 1.
//! It is compared with the block that ends where it begins, `lag` blocks back, which waits in the
//! slot that the new one takes.

use super::ladder::Ladder;
use super::total::{SETTLE, Total};
use crate::Real;

/// A block of samples: their sum, less the reference, and how many of them came.
pub(super) struct Block<T, const AXES: usize> {
    pub(super) sum: [T; AXES],
    pub(super) count: u32,
}

impl<T: Real, const AXES: usize, const LEVELS: usize, const WINDOWS: usize, const ORDER: usize>
    Ladder<T, AXES, LEVELS, WINDOWS, ORDER>
{
    /// log₂ of the distance between the ends of neighbouring blocks of a level.
    #[inline(always)]
    pub(super) const fn stride_log2(level: usize) -> u32 {
        (level as u32).saturating_sub(WINDOWS.trailing_zeros())
    }

    /// How many blocks of a level begin within one of them.
    #[inline(always)]
    pub(super) const fn lag(level: usize) -> usize {
        if WINDOWS == 1 || level == 0 {
            1
        } else if level == 1 {
            2
        } else {
            WINDOWS
        }
    }

    /// Takes a sample of a ladder that has learnt.
    #[inline]
    pub(super) fn accept(&mut self, sample: &[T; AXES]) {
        let mut value = *sample;
        let mut good = true;
        for ((value, reference), bound) in value.iter_mut().zip(&self.reference).zip(&self.bound) {
            *value -= *reference;
            good &= value.abs() <= *bound; // false for a NaN
        }
        if good {
            self.position = self.position.wrapping_add(1);
            if let Some(above) = self.visit(0, &Block { sum: value, count: 1 }) {
                self.carry(1, above);
            }
        } else {
            self.reject();
        }
    }

    /// A block of `level` is complete at `position`: takes it up the levels as far as blocks are
    /// complete there.
    pub(super) fn carry(&mut self, level: usize, block: Block<T, AXES>) {
        let mut block = block;
        for level in level..LEVELS {
            match self.visit(level, &block) {
                Some(above) => block = above,
                None => break,
            }
        }
    }

    /// Compares a complete block with those before it, and puts it in their row. Returns the block
    /// of the level above that it completes.
    #[inline(always)]
    fn visit(&mut self, level: usize, block: &Block<T, AXES>) -> Option<Block<T, AXES>> {
        let end = self.position as u32; // phases want no more than its low bits
        let full = 1_u32 << (level & 31);
        let phase = end >> Self::stride_log2(level);
        let slot = phase as usize & (Self::lag(level) - 1) & (WINDOWS - 1);

        // This block, the one before, and (Hadamard) the one before that.
        let (history, counts) = (self.history.get(level)?, self.counts.get(level)?);
        let (before, oldest) = (&history[0][slot], &history[ORDER - 1][slot]);
        let held = [block.count, counts[0][slot], counts[ORDER - 1][slot]];
        if held.iter().all(|&count| count == full) {
            add_squares::<T, AXES, ORDER>(self.squares.get_mut(level)?, &block.sum, before, oldest);
            let differences = self.differences.get_mut(level)?;
            *differences = differences.wrapping_add(1);
        } else if held.iter().all(|&count| count > 0 && count >= full - full / 2) {
            self.compare_partial(level, [block.sum, *before, *oldest], held);
        }
        if phase & (SETTLE - 1) == 0 {
            self.settle(level);
        }

        // The level above has a block here if this is one of its ends, and if the first half of
        // that block lies within the record.
        let (history, counts) = (self.history.get_mut(level)?, self.counts.get_mut(level)?);
        let ends = end & 1_u32.wrapping_shl(Self::stride_log2(level + 1)).wrapping_sub(1) == 0;
        let above = if ends && (WINDOWS == 1 || self.position >= 2 * u64::from(full)) {
            let sum = pairwise(&block.sum, &history[0][slot]);
            Some(Block { sum, count: block.count.wrapping_add(counts[0][slot]) })
        } else {
            None
        };
        if ORDER == 2 {
            history[1][slot] = history[0][slot];
            counts[1][slot] = counts[0][slot];
        }
        history[0][slot] = block.sum;
        counts[0][slot] = block.count;
        above
    }

    /// Compares blocks that miss samples, each scaled to a full one.
    #[cold]
    #[inline(never)]
    fn compare_partial(&mut self, level: usize, mut blocks: [[T; AXES]; 3], held: [u32; 3]) {
        let excess = rescale::<T, AXES, ORDER>(&mut blocks, held, 1_u32 << (level & 31));
        let [now, before, oldest] = &blocks;
        if let Some(squares) = self.squares.get_mut(level) {
            add_squares::<T, AXES, ORDER>(squares, now, before, oldest);
        }
        if let Some(differences) = self.differences.get_mut(level) {
            *differences = differences.wrapping_add(1);
        }
        if let Some(total) = self.excess.get_mut(level) {
            total.add(excess);
        }
    }

    /// Brings the totals of a level to where large sums are kept.
    #[inline]
    pub(super) fn settle(&mut self, level: usize) {
        if let (Some(squares), Some(excess)) =
            (self.squares.get_mut(level), self.excess.get_mut(level))
        {
            squares.iter_mut().for_each(Total::settle);
            excess.settle();
        }
    }

    /// Time goes on without samples. Only levels that still hold some are visited, at the ends of
    /// their blocks: a level soon holds nothing more, so this is O(levels) for any `n`.
    pub(super) fn skip(&mut self, n: u64) {
        let end = self.position.saturating_add(n);
        let mut level = 0;
        while let Some(counts) = self.counts.get(level) {
            if counts.iter().flatten().all(|&count| count == 0) {
                level += 1;
                continue;
            }
            let stride = 1_u64 << Self::stride_log2(level);
            let Some(next) = (self.position | (stride - 1)).checked_add(1) else { break };
            if next > end {
                break;
            }
            self.position = next;
            self.carry(level, Block { sum: [T::ZERO; AXES], count: 0 });
        }
        self.position = end;
    }
}

/// Sums of neighbouring blocks.
#[inline(always)]
pub(super) fn pairwise<T: Real, const AXES: usize>(a: &[T; AXES], b: &[T; AXES]) -> [T; AXES] {
    let mut sum = *a;
    for i in 0..AXES {
        sum[i] += b[i];
    }
    sum
}

/// Adds the squared differences of a block, the one before, and (Hadamard) the one before that.
#[inline(always)]
fn add_squares<T: Real, const AXES: usize, const ORDER: usize>(
    totals: &mut [T::Total; AXES],
    now: &[T; AXES],
    before: &[T; AXES],
    oldest: &[T; AXES],
) {
    for i in 0..AXES {
        let d = difference::<T, ORDER>(now[i], before[i], oldest[i]);
        totals[i].add(d * d);
    }
}

/// The first difference of two blocks, or the second of three.
#[inline(always)]
pub(super) fn difference<T: Real, const ORDER: usize>(now: T, before: T, oldest: T) -> T {
    if ORDER == 1 { now - before } else { (now - before) - (before - oldest) }
}

/// Scales blocks of `held` samples to `full` ones. Returns the relative excess of white noise in
/// their difference: Σ cᵢ² full/heldᵢ / Σ cᵢ² − 1, c = (1, −1) or (1, −2, 1).
fn rescale<T: Real, const AXES: usize, const ORDER: usize>(
    blocks: &mut [[T; AXES]; 3],
    held: [u32; 3],
    full: u32,
) -> T {
    let squared = if ORDER == 1 { [1, 1, 0] } else { [1, 4, 1] };
    let mut gain = T::ZERO;
    let mut norm = T::ZERO;
    for ((block, count), square) in blocks.iter_mut().zip(held).zip(squared) {
        let weight = T::from_u32(full) / T::from_u32(count);
        block.iter_mut().for_each(|x| *x *= weight);
        gain += weight * T::from_u32(square);
        norm += T::from_u32(square);
    }
    gain / norm - T::ONE
}
