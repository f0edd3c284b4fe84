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
use super::learn::{LEARN, LEARNT};
use super::total::Total;
use crate::{Error, Real};

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
///   given ([`with_reference`](Self::with_reference)) or learnt from the first 7 samples: their
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
    /// differences. Disturbs nothing. Samples that wait while the ladder learns (the first 7) are
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

#[cfg(test)]
#[path = "ladder_tests.rs"]
mod tests;
