//! The first samples of a ladder teach it its reference and its bound.
//!
//! They wait in the history, which is empty until then, and then go the way of all samples: nothing
//! of them is lost. A median and a median absolute deviation withstand glitches among them.

use super::ladder::Ladder;
use crate::Real;

/// How many samples teach a ladder its reference and bound, if they are not given.
pub(super) const LEARN: usize = 7;
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
        if let Some(row) = self.waiting().get_mut(held) {
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
    fn waiting(&mut self) -> &mut [[T; AXES]] {
        self.history.as_flattened_mut().as_flattened_mut()
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
            let (middle, deviation) = median_and_deviation(waiting.map(|row| row[i]), held);
            let bound = deviation * T::from_f64(BOUND_IN_DEVIATIONS);
            self.reference[i] = middle;
            self.bound[i] = if bound > T::ZERO && bound < T::LIMIT { bound } else { T::LIMIT };
        }
        let gaps = self.gaps;
        for (k, (sample, gap)) in waiting.iter().zip(gaps).take(held).enumerate() {
            if k > 0 && gap > 0 {
                self.skip(u64::from(gap));
            }
            self.accept(sample);
        }
        if let Some(&gap) = gaps.get(held) {
            self.skip(u64::from(gap));
        }
    }
}

/// Sorts by a network of 16 comparisons, the fewest for seven values (Knuth, The Art of Computer
/// Programming 3, 5.3.4): always the same time, and no bounds to check.
fn sort<T: Real>([a, b, c, d, e, f, g]: &mut [T; LEARN]) {
    let order = |x: &mut T, y: &mut T| {
        (*x, *y) = if *y < *x { (*y, *x) } else { (*x, *y) };
    };
    order(b, c);
    order(d, e);
    order(f, g);
    order(a, c);
    order(d, f);
    order(e, g);
    order(a, b);
    order(e, f);
    order(c, g);
    order(a, e);
    order(b, f);
    order(a, d);
    order(c, f);
    order(b, d);
    order(c, e);
    order(c, d);
}

/// The median of the first `n` values and the median of their distances from it (the lower one if
/// there are two); zeros of none.
fn median_and_deviation<T: Real>(values: [T; LEARN], n: usize) -> (T, T) {
    let mut sorted = [T::MAX; LEARN];
    for (place, value) in sorted.iter_mut().zip(values).take(n) {
        *place = value;
    }
    sort(&mut sorted);
    let half = n.saturating_sub(1) / 2;
    let (lower, upper) = sorted.split_at(half.min(LEARN / 2));
    let Some((&middle, upper)) = upper.split_first().filter(|_| n > 0) else {
        return (T::ZERO, T::ZERO);
    };
    // From the middle outward, nearest first; half of the values are no further than the last.
    let (mut below, mut above) = (lower.iter().rev().peekable(), upper.iter().peekable());
    let mut deviation = T::ZERO;
    for _ in 0..half {
        let down = below.peek().map_or(T::MAX, |x| middle - **x);
        let up = above.peek().map_or(T::MAX, |x| **x - middle);
        let nearest =
            if down <= up { below.next().map(|_| down) } else { above.next().map(|_| up) };
        deviation = nearest.unwrap_or(deviation);
    }
    (middle, deviation)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    /// A network of comparisons that sorts all zeros and ones sorts everything (Knuth, The Art of
    /// Computer Programming 3, 5.3.4, theorem Z); the distances are compared with the definition.
    #[test]
    fn the_median_is_the_middle() {
        let lower_median = |values: &[f32]| {
            let mut sorted = values.to_vec();
            sorted.sort_by(f32::total_cmp);
            sorted.get(sorted.len().saturating_sub(1) / 2).copied().unwrap_or_default()
        };
        let mut state = 1_u32;
        for bits in 0..4096_u32 {
            let values: [f32; LEARN] = core::array::from_fn(|i| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let small = (state >> 28) as f32 - 8.0; // with ties
                if bits < 1 << LEARN { (bits >> i & 1) as f32 } else { small }
            });
            for n in 0..=LEARN {
                let middle = lower_median(&values[..n]);
                let distances: Vec<f32> = values[..n].iter().map(|x| (x - middle).abs()).collect();
                let expected = (middle, lower_median(&distances));
                assert_eq!(median_and_deviation(values, n), expected, "{values:?} {n}");
            }
        }
    }
}
