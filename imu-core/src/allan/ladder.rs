//! The octave ladder: Allan or Hadamard variance at every τ = 2ᴸ samples, one sample at a time.
//!
//! A block of 2ᴸ⁺¹ samples is the sum of two neighbouring blocks of 2ᴸ, so level L needs no more
//! of the past than its last blocks: the state is a few words a level and axis, whatever the length
//! of the record. A new block is compared with the block that ends where it begins, its square goes
//! to the level's total, and with that same neighbour it makes the block of the level above. With
//! `WINDOWS` = 1 the blocks of a level are disjoint; with 4 a block begins every quarter of its
//! length, which is statistically as good as every possible overlap (MATHS: Greenhall & Riley 2003).
//!
//! ```
//! use imu_core::allan::AllanLadder;
//!
//! let mut ladder: AllanLadder<f64, 1, 16, 4> = AllanLadder::new();
//! for k in 0..1000 {
//!     ladder.push(&[if k % 2 == 0 { 1.0 } else { -1.0 }]); // alternating
//! }
//! let octaves = ladder.octaves(0);
//! assert_eq!(octaves[0].variance, 2.0); // ½⟨(±2)²⟩ over single samples
//! assert_eq!(octaves[1].variance, 0.0); // pairs cancel
//! ```

use super::Octave;
use super::total::{SETTLE, Total};
use crate::{Error, Real};

/// How many samples teach a ladder its reference and bound, if they are not given.
pub(super) const LEARN: usize = 15;
/// `held` of a ladder that has learnt.
pub(super) const LEARNT: u8 = u8::MAX;
/// A learnt bound is this many times the median absolute deviation of the first samples.
const BOUND_IN_DEVIATIONS: f64 = 4096.0;

/// Ladder of Allan variances (first differences of block means).
///
/// Axes, octaves of τ, windows per τ (1 or 4).
pub type AllanLadder<T, const AXES: usize, const LEVELS: usize, const WINDOWS: usize = 1> =
    Ladder<T, AXES, LEVELS, WINDOWS, 1>;

/// Ladder of Hadamard variances (second differences of block means, blind to a linear drift).
///
/// Axes, octaves of τ, windows per τ (1 or 4).
pub type HadamardLadder<T, const AXES: usize, const LEVELS: usize, const WINDOWS: usize = 1> =
    Ladder<T, AXES, LEVELS, WINDOWS, 2>;

/// Streaming sums for the Allan (`ORDER` = 1) or Hadamard (`ORDER` = 2) variance of `AXES` signals
/// at τ = 1, 2, 4, … 2^(`LEVELS` − 1) samples, from 1 or 4 `WINDOWS` a τ.
///
/// Any unit: a variance comes in the signal's unit squared. A sample is all axes at one time.
///
/// - [`push`](Self::push) is amortised O(1): two (`WINDOWS` = 1) or four level visits a sample, at
///   worst one visit a level. [`extend`](Self::extend) gives the same bits, faster.
/// - Values are taken relative to a *reference* near them, so an offset costs no digits, and a
///   sample with an axis beyond a *bound* around it, or not finite, counts as missing. Both are
///   given ([`with_reference`](Self::with_reference)) or learnt from the first 15 samples: their
///   median, and 4096 times their median absolute deviation (no bound but
///   [`limit`](Self::limit) where that is zero: a coarse signal's first samples may be equal). A
///   signal that lies still at first and then moves a great deal wants a given bound.
/// - [`missing`](Self::missing) lets time go on: a block keeps its sum and count, and counts as
///   long as half of it is there.
///
/// The state is plain data, `size_of` bytes of it; [`write_to`](Self::write_to) stores it.
/// A level's count of differences is exact up to 2⁶⁴; f32 totals hold to about 10¹⁰ differences.
#[derive(Clone, Debug, PartialEq)]
pub struct Ladder<
    T: Real,
    const AXES: usize,
    const LEVELS: usize,
    const WINDOWS: usize,
    const ORDER: usize,
> {
    /// Sums of the last blocks of each level: `[level][age][phase]`. While the ladder learns, no
    /// block is complete, and the first samples wait here.
    pub(super) history: [[[[T; AXES]; WINDOWS]; ORDER]; LEVELS],
    /// How many samples each of those blocks holds; 0: nothing to compare with.
    pub(super) counts: [[[u32; WINDOWS]; ORDER]; LEVELS],
    /// Σ of squared differences of block sums.
    pub(super) squares: [[T::Total; AXES]; LEVELS],
    /// How many differences.
    pub(super) differences: [u64; LEVELS],
    /// Σ over differences of how much more white noise they carry for samples missing in them.
    pub(super) excess: [T::Total; LEVELS],
    /// Samples since the start or the last restart, missing ones included.
    pub(super) position: u64,
    pub(super) missing: u64,
    pub(super) rejected: u64,
    pub(super) reference: [T; AXES],
    pub(super) bound: [T; AXES],
    /// Missing samples before each sample that waits.
    pub(super) gaps: [u8; LEARN],
    /// How many samples wait, or `LEARNT`.
    pub(super) held: u8,
}

impl<T: Real, const AXES: usize, const LEVELS: usize, const WINDOWS: usize, const ORDER: usize>
    Default for Ladder<T, AXES, LEVELS, WINDOWS, ORDER>
{
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const AXES: usize, const LEVELS: usize, const WINDOWS: usize, const ORDER: usize>
    Ladder<T, AXES, LEVELS, WINDOWS, ORDER>
{
    const VALID: () = {
        assert!(AXES >= 1, "a ladder has at least one axis");
        assert!(LEVELS >= 1 && LEVELS <= 32, "a ladder has 1 to 32 levels");
        assert!(WINDOWS == 1 || WINDOWS == 4, "a ladder has 1 or 4 windows a τ");
        assert!(ORDER == 1 || ORDER == 2, "Allan is of order 1, Hadamard of order 2");
    };

    /// How many samples wait before the ladder has learnt.
    pub(super) const WAIT: usize =
        if LEVELS * ORDER * WINDOWS < LEARN { LEVELS * ORDER * WINDOWS } else { LEARN };

    /// An empty ladder that learns its reference and bound from the first samples.
    pub const fn new() -> Self {
        const { Self::VALID };
        Self {
            history: [[[[T::ZERO; AXES]; WINDOWS]; ORDER]; LEVELS],
            counts: [[[0; WINDOWS]; ORDER]; LEVELS],
            squares: [[T::Total::ZERO; AXES]; LEVELS],
            differences: [0; LEVELS],
            excess: [T::Total::ZERO; LEVELS],
            position: 0,
            missing: 0,
            rejected: 0,
            reference: [T::ZERO; AXES],
            bound: [T::LIMIT; AXES],
            gaps: [0; LEARN],
            held: 0,
        }
    }

    /// An empty ladder for values near `reference`: a sample with an axis further from it than
    /// `bound` is rejected. Both in the unit of the signal, one for each axis.
    ///
    /// # Errors
    /// [`Error::NonFinite`] for a reference or bound that is not finite, [`Error::OutOfRange`] for
    /// a bound that is not positive or is beyond [`limit`](Self::limit).
    pub fn with_reference(reference: [T; AXES], bound: [T; AXES]) -> Result<Self, Error> {
        if !reference.iter().all(|r| r.is_finite()) {
            return Err(Error::NonFinite("reference"));
        }
        if !bound.iter().all(|b| b.is_finite()) {
            return Err(Error::NonFinite("bound"));
        }
        if !bound.iter().all(|&b| b > T::ZERO && b <= T::LIMIT) {
            return Err(Error::OutOfRange("bound"));
        }
        Ok(Self { reference, bound, held: LEARNT, ..Self::new() })
    }

    /// The largest bound: values further from the reference could overflow a sum of squares
    /// (10¹² in single, 10¹⁰⁰ in double precision).
    pub const fn limit() -> T {
        T::LIMIT
    }

    /// Takes a sample. One that is not finite or out of bounds counts as missing and as rejected.
    #[inline]
    pub fn push(&mut self, sample: &[T; AXES]) {
        if self.held == LEARNT {
            self.accept(sample);
        } else {
            self.learn(sample);
        }
    }

    /// `n` samples did not come: their time passes, and blocks that miss a part of themselves go
    /// on with the rest. O(levels) for any `n`.
    pub fn missing(&mut self, n: u64) {
        self.missing = self.missing.saturating_add(n);
        self.pass(n);
    }

    /// A new beginning (after a reboot, say): what is gathered stays, no difference spans the break,
    /// and blocks that were incomplete are dropped.
    pub fn restart(&mut self) {
        self.finish_learning();
        self.history = [[[[T::ZERO; AXES]; WINDOWS]; ORDER]; LEVELS];
        self.counts = [[[0; WINDOWS]; ORDER]; LEVELS];
        self.position = 0;
    }

    /// [`restart`](Self::restart), then everything that `right` saw. From then on the ladder
    /// continues `right`, with its reference and bound.
    ///
    /// Exact to rounding, but for the blocks that were incomplete here.
    pub fn append(&mut self, right: &Self) {
        self.finish_learning();
        let left = self.clone();
        *self = right.clone();
        self.gather(&left);
    }

    /// Adds the sums and counts of `other`: a record of another day, or of another device of a
    /// fleet. Commutative but for what comes next: this ladder goes on with its own blocks.
    pub fn pool(&mut self, other: &Self) {
        if other.held == LEARNT {
            self.gather(other);
        } else {
            let mut other = other.clone();
            other.finish_learning();
            self.gather(&other);
        }
    }

    /// What every τ shows of one axis now, shortest first; an axis that does not exist shows no
    /// differences. Disturbs nothing. Samples that wait while the ladder learns (the first 15) are
    /// not in it yet.
    pub fn octaves(&self, axis: usize) -> [Octave; LEVELS] {
        let mut level = 0_u32;
        let mut rows = self.squares.iter().zip(&self.differences).zip(&self.excess);
        [(); LEVELS].map(|()| {
            let samples = 1_u64 << (level & 31);
            level += 1;
            let mut octave = Octave { samples, differences: 0, variance: 0.0, white_gain: 1.0 };
            if let Some(((squares, &differences), excess)) = rows.next()
                && let Some(total) = squares.get(axis)
                && differences > 0
            {
                let n = differences as f64;
                let m = samples as f64;
                octave.differences = differences;
                octave.variance = total.value() / (Self::NORM * n) / (m * m);
                octave.white_gain = 1.0 + excess.value() / n;
            }
            octave
        })
    }

    /// Samples since the start or the last restart, missing ones included.
    pub fn position(&self) -> u64 {
        self.position
    }

    /// Samples that were announced as missing.
    pub fn missing_samples(&self) -> u64 {
        self.missing
    }

    /// Samples that were pushed and counted as missing: not finite, or out of bounds.
    pub fn rejected_samples(&self) -> u64 {
        self.rejected
    }

    /// The value that all samples of an axis are taken relative to, once it is known.
    pub fn reference(&self) -> Option<&[T; AXES]> {
        (self.held == LEARNT).then_some(&self.reference)
    }

    /// ⟨d²⟩ of unit white noise: 2 for first differences, 6 for second.
    pub(super) const NORM: f64 = if ORDER == 1 { 2.0 } else { 6.0 };

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
        for i in 0..AXES {
            value[i] -= self.reference[i];
            good &= value[i].abs() <= self.bound[i]; // false for a NaN
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

    /// A sample came that counts as missing.
    #[cold]
    #[inline(never)]
    fn reject(&mut self) {
        self.rejected = self.rejected.saturating_add(1);
        self.pass(1);
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

    /// Lets the time of `n` samples pass that a learnt or a learning ladder does not see.
    fn pass(&mut self, n: u64) {
        if self.held != LEARNT {
            if self.held == 0 {
                self.position = self.position.saturating_add(n);
                return;
            }
            if let Some(gap) = self.gaps.get_mut(usize::from(self.held))
                && let Ok(gap_and_n) = u8::try_from(n.saturating_add(u64::from(*gap)))
            {
                *gap = gap_and_n;
                return;
            }
            self.finish_learning();
        }
        self.skip(n);
    }

    /// Time goes on without samples. Only levels that still hold some are visited, at the ends of
    /// their blocks: a level soon holds nothing more, so this is O(levels) for any `n`.
    fn skip(&mut self, n: u64) {
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

    /// Keeps a sample until there are enough to learn from.
    #[cold]
    fn learn(&mut self, sample: &[T; AXES]) {
        if !sample.iter().all(|x| x.abs() <= T::LIMIT) {
            self.reject();
            return;
        }
        let held = usize::from(self.held);
        if let Some(row) = self.waiting().nth(held) {
            *row = *sample;
        }
        self.held += 1;
        if usize::from(self.held) >= Self::WAIT {
            self.finish_learning();
        } else if let Some(gap) = self.gaps.get_mut(usize::from(self.held)) {
            *gap = 0;
        }
    }

    /// The rows where samples wait: the history, which is empty while the ladder learns.
    fn waiting(&mut self) -> impl Iterator<Item = &mut [T; AXES]> {
        self.history.iter_mut().flatten().flatten().take(LEARN)
    }

    /// Takes reference and bound from the samples that wait, then takes those samples.
    #[cold]
    pub(super) fn finish_learning(&mut self) {
        if self.held == LEARNT || self.held == 0 {
            return;
        }
        let held = usize::from(self.held);
        let mut waiting = [[T::ZERO; AXES]; LEARN];
        for (copy, row) in waiting.iter_mut().zip(self.waiting()) {
            *copy = *row;
            *row = [T::ZERO; AXES];
        }
        self.held = LEARNT;
        for i in 0..AXES {
            let column = waiting.map(|row| row[i]);
            let middle = median(column, held);
            let deviation = median(column.map(|x| (x - middle).abs()), held);
            let bound = deviation * T::from_f64(BOUND_IN_DEVIATIONS);
            self.reference[i] = middle;
            self.bound[i] = if bound > T::ZERO && bound < T::LIMIT { bound } else { T::LIMIT };
        }
        let gaps = self.gaps;
        for (k, (sample, gap)) in waiting.iter().zip(gaps).take(held).enumerate() {
            if k > 0 {
                self.skip(u64::from(gap));
            }
            self.accept(sample);
        }
        if let Some(&gap) = gaps.get(held) {
            self.skip(u64::from(gap));
        }
    }

    /// Adds the totals of another ladder, which has learnt or holds nothing.
    fn gather(&mut self, other: &Self) {
        for (mine, theirs) in self.squares.iter_mut().flatten().zip(other.squares.iter().flatten())
        {
            mine.merge(theirs);
        }
        for (mine, theirs) in self.excess.iter_mut().zip(&other.excess) {
            mine.merge(theirs);
        }
        for (mine, theirs) in self.differences.iter_mut().zip(&other.differences) {
            *mine = mine.saturating_add(*theirs);
        }
        self.missing = self.missing.saturating_add(other.missing);
        self.rejected = self.rejected.saturating_add(other.rejected);
    }
}

/// A block of samples: their sum, less the reference, and how many of them came.
pub(super) struct Block<T, const AXES: usize> {
    pub(super) sum: [T; AXES],
    pub(super) count: u32,
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

/// The median of the first `n` values (the lower of two); 0 of none.
fn median<T: Real>(mut values: [T; LEARN], n: usize) -> T {
    let mut smallest = T::ZERO;
    for _ in 0..n.div_ceil(2) {
        // Take the smallest, and put it out of the way.
        let mut found: Option<&mut T> = None;
        for x in values.iter_mut().take(n) {
            if found.as_ref().is_none_or(|least| *x < **least) {
                found = Some(x);
            }
        }
        if let Some(least) = found {
            smallest = core::mem::replace(least, T::MAX);
        }
    }
    smallest
}

#[cfg(test)]
#[path = "ladder_tests.rs"]
mod tests;
