//! The exact batch estimator: Allan and Hadamard variance of a whole record in memory, at any
//! averaging time, over any stride of windows.
//!
//! For comparison with the streaming ladder of `imu-core`, which keeps O(log n) numbers instead of
//! O(n) and reads only octaves. One prefix sum of the values less their mean serves every averaging
//! time in O(n); it is kept in two doubles a point (TwoSum, Knuth 1969), so that neither a large
//! offset nor a drift costs digits: results are exact to a few rounding errors of the values.
//!
//! Definitions (IEEE Std 952; Riley 2008, NIST SP 1065): with block means ȳ over m samples,
//! AVAR = ½⟨(ȳ₁ − ȳ₀)²⟩ and HVAR = ⅙⟨(ȳ₂ − 2ȳ₁ + ȳ₀)²⟩, windows started every `stride` samples:
//! stride 1 gives Stable32's OADEV and OHDEV, stride m its ADEV and HDEV.
//!
//! ```
//! use imu_core::allan::Difference;
//! use imu_tools::calibrate::batch::Batch;
//! // Riley 2008, p. 107: nine frequencies; their OADEV at τ = 2 is 85.95287.
//! let y = [892.0, 809.0, 823.0, 798.0, 671.0, 644.0, 883.0, 903.0, 677.0];
//! let batch = Batch::new(&y).unwrap();
//! let reading = batch.reading(Difference::Allan, 2, 1).unwrap();
//! assert!((reading.deviation() - 85.95287).abs() < 5e-6);
//! ```

use std::ops::Sub;

use imu_core::Error;
use imu_core::allan::{Difference, Mixture, edf};

/// A record made ready for readings: 16 bytes a sample.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Sums of the first 0, 1, 2, … values less their mean, rounded …
    sum: Vec<f64>,
    /// … and what the rounding lost.
    rest: Vec<f64>,
}

/// One variance: the averaging time is `block` sampling intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The difference that was squared and averaged.
    pub difference: Difference,
    /// Samples in a block.
    pub block: usize,
    /// Samples from the start of one window to the next.
    pub stride: usize,
    /// Squared differences averaged, at least one.
    pub differences: usize,
    /// Allan or Hadamard variance, in the values' unit squared.
    pub variance: f64,
}

impl Reading {
    /// The square root of the variance: Allan or Hadamard deviation, in the values' unit.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        self.variance.sqrt()
    }

    /// Equivalent degrees of freedom if the noise at this averaging time is `mixture`.
    #[must_use]
    pub fn edf(&self, mixture: Mixture) -> f64 {
        let [block, stride, count] = [self.block, self.stride, self.differences].map(|n| n as u64);
        edf(self.difference, block, stride, count, mixture)
    }
}

impl Batch {
    /// Sums up the values of one axis, sampled evenly and without gaps, in any unit.
    ///
    /// # Errors
    /// [`Error::NonFinite`] if one of them is infinite or not a number, and
    /// [`Error::OutOfRange`] if their sum is no longer a number.
    pub fn new(values: &[f64]) -> Result<Self, Error> {
        if !values.iter().all(|v| v.is_finite()) {
            return Err(Error::NonFinite("values"));
        }
        let mut total = Pair::default();
        values.iter().for_each(|&v| total.add(v));
        let mean = total.high / values.len().max(1) as f64;
        let mut batch = Self {
            sum: Vec::with_capacity(values.len() + 1),
            rest: Vec::with_capacity(values.len() + 1),
        };
        let mut running = Pair::default();
        batch.push(running);
        for &value in values {
            let (residual, lost) = two_sum(value, -mean);
            running.add(residual);
            running.low += lost;
            batch.push(running);
        }
        if running.high.is_finite() && running.low.is_finite() {
            Ok(batch)
        } else {
            Err(Error::OutOfRange("values"))
        }
    }

    fn push(&mut self, sum: Pair) {
        let (high, low) = two_sum(sum.high, sum.low);
        self.sum.push(high);
        self.rest.push(low);
    }

    /// The number of samples.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.sum.len() - 1
    }

    /// The variance over blocks of `block` samples, windows started every `stride` samples from the
    /// first: 1 for every overlapping window, `block` for disjoint blocks.
    ///
    /// `None` if the record is too short for one difference, or `block` or `stride` is 0.
    #[must_use]
    pub fn reading(&self, difference: Difference, block: usize, stride: usize) -> Option<Reading> {
        let blocks = difference.blocks() as usize;
        let spare = self.samples().checked_sub(blocks.checked_mul(block)?)?;
        if block == 0 {
            return None;
        }
        let differences = spare.checked_div(stride)? + 1;
        let norm = match difference {
            Difference::Allan => 2.0,
            Difference::Hadamard => 6.0,
        };
        let m = block as f64;
        let squares = self.squares(difference, block, stride, differences);
        let variance = squares / (norm * m * m * differences as f64);
        Some(Reading { difference, block, stride, differences, variance })
    }

    /// 1, 2, 4, …: every block length of a power of two for which there is a difference.
    pub fn octaves(&self, difference: Difference) -> impl Iterator<Item = usize> + use<> {
        let longest = self.samples() / difference.blocks() as usize;
        (0..usize::BITS).map(|k| 1 << k).take_while(move |&block| block <= longest)
    }

    /// The sum of the squared differences of block *sums*.
    fn squares(&self, difference: Difference, m: usize, stride: usize, count: usize) -> f64 {
        let mut buffer = [0.0; CHUNK];
        let mut total = Pair::default();
        for first in (0..count).step_by(CHUNK) {
            let chunk = &mut buffer[..CHUNK.min(count - first)];
            let start = first * stride;
            let reach = (chunk.len() - 1) * stride + 1;
            let edge = |k: usize| {
                let from = start + k * m;
                (&self.sum[from..from + reach], &self.rest[from..from + reach])
            };
            match difference {
                Difference::Allan => {
                    fill(chunk, stride, [0, 1, 2].map(edge), |[a, b, c]| (c - b) - (b - a));
                }
                Difference::Hadamard => {
                    fill(chunk, stride, [0, 1, 2, 3].map(edge), |[a, b, c, d]| {
                        let middle = c - b;
                        ((d - c) - middle) - (middle - (b - a))
                    });
                }
            }
            total.add(sum_of_squares(chunk));
        }
        total.high + total.low
    }
}

/// What `difference` makes of every `stride`th set of points on the `edges` of a window's blocks;
/// stride 1 apart, so that it compiles to vector instructions.
#[inline(always)]
fn fill<const N: usize>(
    out: &mut [f64],
    stride: usize,
    edges: [(&[f64], &[f64]); N],
    difference: impl Fn([Pair; N]) -> f64,
) {
    let at = |edges: [(&[f64], &[f64]); N], i: usize| {
        difference(edges.map(|(high, low)| Pair { high: high[i], low: low[i] }))
    };
    if stride == 1 {
        let n = out.len();
        let edges = edges.map(|(high, low)| (&high[..n], &low[..n]));
        out.iter_mut().enumerate().for_each(|(i, v)| *v = at(edges, i));
    } else {
        out.iter_mut().enumerate().for_each(|(i, v)| *v = at(edges, i * stride));
    }
}

/// Differences taken at a time: the buffer stays in the first-level cache.
const CHUNK: usize = 512;

/// Eight running sums, added up at the end: an error of 64 roundings at most.
fn sum_of_squares(values: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let chunks = values.chunks_exact(8);
    let tail: f64 = chunks.remainder().iter().map(|v| v * v).sum();
    for chunk in chunks {
        for (lane, v) in lanes.iter_mut().zip(chunk) {
            *lane += v * v;
        }
    }
    lanes.iter().sum::<f64>() + tail
}

/// An unevaluated sum of two doubles.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    high: f64,
    low: f64,
}

impl Pair {
    fn add(&mut self, value: f64) {
        let (high, lost) = two_sum(self.high, value);
        self.high = high;
        self.low += lost;
    }
}

impl Sub for Pair {
    type Output = f64;

    fn sub(self, other: Self) -> f64 {
        (self.high - other.high) + (self.low - other.low)
    }
}

/// a + b rounded, and the rounding error exactly (Knuth 1969, TwoSum).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The definition, word by word, from block means.
    fn by_definition(values: &[f64], kind: Difference, m: usize, stride: usize) -> Option<f64> {
        let mean = |from: usize| values[from..from + m].iter().sum::<f64>() / m as f64;
        let blocks = kind.blocks() as usize;
        let starts = (0..).step_by(stride).take_while(|from| from + blocks * m <= values.len());
        let squares: Vec<f64> = starts
            .map(|from| match kind {
                Difference::Allan => (mean(from + m) - mean(from)).powi(2) / 2.0,
                Difference::Hadamard => {
                    (mean(from + 2 * m) - 2.0 * mean(from + m) + mean(from)).powi(2) / 6.0
                }
            })
            .collect();
        (!squares.is_empty()).then(|| squares.iter().sum::<f64>() / squares.len() as f64)
    }

    proptest! {
        #[test]
        fn equals_the_definition(
            values in prop::collection::vec(-1.0..1.0_f64, 0..1300),
            m in 1..40_usize,
            stride in 1..50_usize,
            hadamard: bool,
        ) {
            let kind = if hadamard { Difference::Hadamard } else { Difference::Allan };
            let want = by_definition(&values, kind, m, stride);
            let got = Batch::new(&values).unwrap().reading(kind, m, stride);
            prop_assert_eq!(want.is_some(), got.is_some());
            if let (Some(want), Some(got)) = (want, got) {
                // The oracle's own roundings, of 1.1e-16 each: m in a mean of values below 1, and one
                // for each square that is summed.
                let squares = values.len() as f64;
                let roundings = 4e-16 * m as f64 * want.sqrt() + 1.2e-16 * squares * want;
                prop_assert!((want - got.variance).abs() < roundings + 1e-28);
            }
        }

        #[test]
        fn neither_an_offset_nor_its_sign_is_seen(seed in 1..1000_i32) {
            // Multiples of 2⁻⁴⁰: taking them from 4096.75 is exact.
            let noise: Vec<f64> = (0..2000_i64)
                .map(|i| ((i * i * i + i64::from(seed) * 7919 * i) % 65_521) as f64 / 2_f64.powi(40))
                .collect();
            let offset = 2_f64.powi(12) + 0.75;
            let plain = Batch::new(&noise).unwrap();
            let shifted = Batch::new(&noise.iter().map(|v| offset - v).collect::<Vec<_>>()).unwrap();
            for m in [1, 7, 64] {
                let [a, b] = [&plain, &shifted].map(|batch| {
                    batch.reading(Difference::Allan, m, 1).unwrap().variance
                });
                // Both means are rounded, and cancel; what is left are roundings of the sums.
                prop_assert!((a / b - 1.0).abs() < 1e-13, "{} {}", a, b);
            }
        }
    }

    /// Uniform deviates of the NBS14 generator, centred.
    fn uniform(n: usize) -> Vec<f64> {
        let mut state = 1_234_567_890_u64;
        let mut next = || {
            state = 16_807 * state % 2_147_483_647;
            state as f64 / 2_147_483_647.0 - 0.5
        };
        (0..n).map(|_| next()).collect()
    }

    #[test]
    fn noise_of_a_millionth_survives_an_offset_of_a_million() {
        let noisy: Vec<f64> = uniform(100_000).iter().map(|v| 1e6 + 1e-6 * v).collect();
        // Exact (Sterbenz): the noise that is really in the values.
        let bare: Vec<f64> = noisy.iter().map(|v| v - 1e6).collect();
        let [noisy, bare] = [noisy, bare].map(|v| Batch::new(&v).unwrap());
        for m in [1, 10, 1000, 30_000] {
            let [got, want] =
                [&noisy, &bare].map(|b| b.reading(Difference::Allan, m, 1).unwrap().variance);
            // Sums are exact to 106 bits: what is left is the rounding of differences and squares.
            assert!((got / want - 1.0).abs() < 1e-13, "{m}: {got} {want}");
            // White, variance 1/12, and a grain of 1.2e-10 beside 1e-6 (1e-8 of the variance). Edf
            // are at least 1.5 n/m less a few, so this is more than 5 standard deviations.
            let white = 1e-12 / (12.0 * m as f64);
            let scatter = 7.0 * (2.0 * m as f64 / (1.5 * 100_000.0)).sqrt();
            assert!((want / white - 1.0).abs() < scatter.max(1e-2), "{m}: {want} {white}");
        }
    }

    #[test]
    fn a_drift_a_billion_times_the_noise_costs_no_digits() {
        // Whole numbers: drift 1000 a sample, noise 0 or 1, sums up to 5e16 beyond 2⁵³.
        let n = 10_000_000_usize;
        let step = |i: usize| f64::from(u8::from(i % 7 == 3 || i % 5 == 1));
        let values: Vec<f64> = (0..n).map(|i| 1000.0 * i as f64 + step(i)).collect();
        let batch = Batch::new(&values).unwrap();
        let got = batch.reading(Difference::Hadamard, 1, 1).unwrap().variance;
        let want =
            (0..n - 2).map(|i| (step(i + 2) - 2.0 * step(i + 1) + step(i)).powi(2)).sum::<f64>()
                / (6.0 * (n - 2) as f64);
        // Values up to 1e10 have a unit in the last place of 1.9e-6 after the mean (which is no
        // whole number) is taken off; it is kept, and only sums of low parts round.
        assert!((got / want - 1.0).abs() < 1e-9, "{got} {want}");
    }

    #[test]
    fn too_short_a_record_has_no_reading() {
        let batch = Batch::new(&[1.0, 2.0, 4.0]).unwrap();
        assert_eq!(batch.samples(), 3);
        assert!(batch.reading(Difference::Allan, 1, 1).is_some());
        assert!(batch.reading(Difference::Allan, 2, 1).is_none());
        assert!(batch.reading(Difference::Hadamard, 1, 1).is_some());
        assert!(batch.reading(Difference::Allan, 0, 1).is_none());
        assert!(batch.reading(Difference::Allan, 1, 0).is_none());
        assert!(batch.reading(Difference::Allan, usize::MAX, usize::MAX).is_none());
        assert_eq!(batch.octaves(Difference::Allan).collect::<Vec<_>>(), [1]);
        let empty = Batch::new(&[]).unwrap();
        assert_eq!(empty.samples(), 0);
        assert!(empty.reading(Difference::Allan, 1, 1).is_none());
        assert_eq!(empty.octaves(Difference::Allan).count(), 0);
    }

    #[test]
    fn values_that_are_no_numbers_are_refused() {
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(Batch::new(&[0.0, bad]).unwrap_err(), Error::NonFinite("values"));
        }
        assert_eq!(Batch::new(&[f64::MAX; 3]).unwrap_err(), Error::OutOfRange("values"));
    }
}
