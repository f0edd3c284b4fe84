//! The first samples of a ladder teach it its reference and its bound.
//!
//! They wait in the history, which is empty until then, and then go the way of all samples: nothing
//! of them is lost. A median and a median absolute deviation withstand glitches among them.

use super::ladder::Ladder;
use crate::Real;

/// How many samples teach a ladder its reference and bound, if they are not given.
pub(super) const LEARN: usize = 15;
/// `held` of a ladder that has learnt.
pub(super) const LEARNT: u8 = u8::MAX;
/// A learnt bound is this many times the median absolute deviation of the first samples.
const BOUND_IN_DEVIATIONS: f64 = 4096.0;

impl<T: Real, const AXES: usize, const LEVELS: usize, const WINDOWS: usize, const ORDER: usize>
    Ladder<T, AXES, LEVELS, WINDOWS, ORDER>
{
    /// How many samples wait before the ladder has learnt.
    pub(super) const WAIT: usize =
        if LEVELS * ORDER * WINDOWS < LEARN { LEVELS * ORDER * WINDOWS } else { LEARN };

    /// A sample came that counts as missing.
    #[cold]
    #[inline(never)]
    pub(super) fn reject(&mut self) {
        self.rejected = self.rejected.saturating_add(1);
        self.pass(1);
    }

    /// Lets the time of `n` samples pass that a learnt or a learning ladder does not see.
    pub(super) fn pass(&mut self, n: u64) {
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

    /// Keeps a sample until there are enough to learn from.
    #[cold]
    pub(super) fn learn(&mut self, sample: &[T; AXES]) {
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
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle() {
        let mut values = [9.0; LEARN];
        values[..5].copy_from_slice(&[3.0, -1.0, 8.0, 2.0, 2.0]);
        assert_eq!(median(values, 5), 2.0);
        assert_eq!(median(values, 4), 2.0);
        assert_eq!(median(values, 0), 0.0);
    }
}
