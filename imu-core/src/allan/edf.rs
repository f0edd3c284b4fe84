//! Equivalent degrees of freedom of an Allan or Hadamard variance, and its confidence interval.
//!
//! The average of M squared differences scatters like a χ² variable over its number of degrees of
//! freedom, but because the differences are correlated, that number is not M:
//!
//! edf = M / (1 + 2 Σ_{j=1}^{M−1} (1 − j/M) r(j s/m)²)
//!
//! for blocks of m samples and differences started every s samples (s = m: disjoint; s = 1: every
//! overlapping one), with r the correlation of two differences x blocks apart. With the generating
//! function g of a noise, r(x) = Σ c_i g(x + i) / Σ c_i g(i), where c are the binomial weights of
//! the squared difference operator: (1, −4, 6, −4, 1) for Allan, (−1, 6, −15, 20, −15, 6, −1) for
//! Hadamard. White noise: g = |x|; flicker: x² ln|x|; random walk sampled once per step:
//! |x|³ − |x|/m², exact at every m (Greenhall & Riley 2003, "Uncertainty of stability variances
//! based on finite differences", uses the same functions in continuous time). A mixture has the
//! correlation of its terms weighted by their variances.
//!
//! White noise and random walk are exact: r ends at 2 blocks (Allan) or 3 (Hadamard). With flicker
//! the sum stops at 8 blocks, which makes the result at most 2e-4 of itself too large (the tail is
//! −0.361/x², Allan, and falls as 1/x⁴, Hadamard). Strides finer than m/512 are summed on a coarser
//! grid, off by at most 2e-5. So there are at most 4096 terms, whatever M is. At strides m, m/2 and
//! m/4 without flicker, from 8 differences on (Hadamard 12), there are none: the sum is a quadratic form in the two shares, whose
//! coefficients are worked out by the compiler.
//!
//! ```
//! use imu_core::allan::{Difference, Mixture, edf, interval};
//! // 100 disjoint differences of white noise: the closed form is 2M²/(3M − 1).
//! let white = Mixture { white: 1.0, ..Mixture::default() };
//! let nu = edf(Difference::Allan, 16, 16, 100, white);
//! assert!((nu - 20_000.0 / 299.0).abs() < 1e-9);
//! let (low, high) = interval(4e-6, nu, 0.9);
//! assert!(low < 4e-6 && 4e-6 < high);
//! ```

use super::chi_square_quantile;

/// Which difference of neighbouring block means is squared and averaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Difference {
    /// ȳ₁ − ȳ₀, averaged as ½⟨·²⟩.
    Allan,
    /// ȳ₂ − 2ȳ₁ + ȳ₀, averaged as ⅙⟨·²⟩: blind to a linear drift.
    Hadamard,
}

impl Difference {
    /// The number of blocks that one difference spans, and beyond which white noise and random walk
    /// leave no correlation.
    #[must_use]
    pub const fn blocks(self) -> u64 {
        match self {
            Self::Allan => 2,
            Self::Hadamard => 3,
        }
    }

    /// The weights c_0, c_1, c_2, c_3 of the squared difference operator (c_{−i} = c_i).
    const fn weights(self) -> [f64; 4] {
        match self {
            Self::Allan => [6.0, -4.0, 1.0, 0.0],
            Self::Hadamard => [20.0, -15.0, 6.0, -1.0],
        }
    }
}

/// What each noise contributes to the variance at the averaging time in question, on any common
/// scale. Shares that are negative or not finite count as nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mixture {
    /// White noise of rate or force (angle or velocity random walk).
    pub white: f64,
    /// Flicker (bias instability).
    pub flicker: f64,
    /// Random walk of rate or force, one step per sample.
    pub random_walk: f64,
}

/// Where the sum over a flicker's correlations stops, in blocks.
const FLICKER_REACH: f64 = 8.0;
/// A stride finer than half of this part of a block is made coarser: terms a block.
const GRID: f64 = 256.0;
/// No sum is longer: twice [`GRID`] terms a block over [`FLICKER_REACH`].
const TERMS: u32 = 4096;

/// Equivalent degrees of freedom of the average of `differences` squared differences of block means
/// over `block` samples, started `stride` samples apart, of the noise `mixture`.
///
/// The module's text has the formula and its error. Finite for all arguments: 0 when there are no
/// differences, otherwise from 1 to `differences`. A mixture without any share counts as white
/// noise; a `block` or `stride` of 0 as 1.
#[must_use]
pub fn edf(
    difference: Difference,
    block: u64,
    stride: u64,
    differences: u64,
    mixture: Mixture,
) -> f64 {
    if differences == 0 {
        return 0.0;
    }
    let m = block.max(1) as f64;
    let step = stride.max(1) as f64 / m;
    let count = differences as f64;
    let kernel = Kernel::new(difference, m, mixture);
    if let Some(sums) = kernel.sums(difference, block, stride, differences) {
        return (count / (1.0 + 2.0 * sums.at(kernel.linear, kernel.cubic, count)))
            .clamp(1.0, count);
    }
    let reach = if kernel.flicker == 0.0 { difference.blocks() as f64 } else { FLICKER_REACH };
    let coarse = step * libm::floor(1.0 / (step * GRID)).max(1.0);
    let length = count * step;
    let mut sum = 0.5;
    for j in 1..=TERMS {
        let x = f64::from(j) * coarse;
        if x >= reach || x >= length {
            break;
        }
        let r = kernel.at(x);
        sum += (1.0 - x / length) * r * r;
    }
    // Trapezoidal rule in x: both grids sum to the same integral.
    (0.5 * length / (coarse * sum)).clamp(1.0, count)
}

/// The interval that holds the true variance with probability `confidence`, around an estimate
/// `variance` of `edf` equivalent degrees of freedom: s²·edf/χ² at the two tails, in the units of
/// `variance`. The deviation's interval is its square root.
///
/// (0, ∞), which is all that can be said, where `variance` is negative or not finite, `edf` is below
/// 0.1 or not finite, or `confidence` is not within 0…1.
#[must_use]
pub fn interval(variance: f64, edf: f64, confidence: f64) -> (f64, f64) {
    let known = (0.0..=f64::MAX).contains(&variance)
        && (0.1..=f64::MAX).contains(&edf)
        && (0.0..1.0).contains(&confidence);
    if !known {
        return (0.0, f64::INFINITY);
    }
    let tail = 0.5 * (1.0 - confidence);
    let upper = chi_square_quantile(1.0 - tail, edf);
    let lower = chi_square_quantile(tail, edf);
    let high = if lower > 0.0 { variance * (edf / lower) } else { f64::INFINITY };
    (variance * (edf / upper), high)
}

/// Σ_j r(js/m)² and Σ_j j r(js/m)² of r = linear·L + cubic·C, where L and C are Σ c_i |x + i| and
/// Σ c_i |x + i|³: coefficients of linear², 2 linear cubic and cubic².
struct Sums {
    all: [f64; 3],
    by_lag: [f64; 3],
}

impl Sums {
    /// With s = m/`per_block`.
    const fn of(difference: Difference, per_block: u32) -> Self {
        let weights = difference.weights();
        let mut sums = Self { all: [0.0; 3], by_lag: [0.0; 3] };
        let mut j = 1;
        while j < per_block * difference.blocks() as u32 {
            let x = j as f64 / per_block as f64;
            let (mut linear, mut cubic) = (0.0, 0.0);
            let mut i = -3;
            while i <= 3_i32 {
                let u = (x + i as f64).abs();
                let weight = weights[i.unsigned_abs() as usize];
                linear += weight * u;
                cubic += weight * u * u * u;
                i += 1;
            }
            let products = [linear * linear, linear * cubic, cubic * cubic];
            let mut k = 0;
            while k < 3 {
                sums.all[k] += products[k];
                sums.by_lag[k] += j as f64 * products[k];
                k += 1;
            }
            j += 1;
        }
        sums
    }

    /// Σ_j (1 − j/M) r², for M = `count`.
    fn at(&self, linear: f64, cubic: f64, count: f64) -> f64 {
        let form = |[ll, lc, cc]: &[f64; 3]| {
            linear * (linear * ll + 2.0 * cubic * lc) + cubic * cubic * cc
        };
        form(&self.all) - form(&self.by_lag) / count
    }
}

/// At strides m, m/2, m/4.
static ALLAN: [Sums; 3] = [
    Sums::of(Difference::Allan, 1),
    Sums::of(Difference::Allan, 2),
    Sums::of(Difference::Allan, 4),
];
static HADAMARD: [Sums; 3] = [
    Sums::of(Difference::Hadamard, 1),
    Sums::of(Difference::Hadamard, 2),
    Sums::of(Difference::Hadamard, 4),
];

/// The correlation r(x) of a mixture: one generating function
/// G(u) = u (linear + cubic u² + flicker u ln u), scaled so that Σ c_i G(i) = 1.
struct Kernel {
    weights: [f64; 4],
    linear: f64,
    cubic: f64,
    flicker: f64,
}

impl Kernel {
    fn new(difference: Difference, m: f64, mixture: Mixture) -> Self {
        let share = |v: f64| if v > 0.0 && v <= f64::MAX { v } else { 0.0 };
        let shares = [mixture.white, mixture.flicker, mixture.random_walk].map(share);
        // Scaled by the largest, so that the sum cannot overflow.
        let largest = shares.iter().copied().fold(0.0, f64::max);
        let [white, flicker, walk] =
            if largest > 0.0 { shares.map(|v| v / largest) } else { [1.0, 0.0, 0.0] };
        let total = white + flicker + walk;
        let weights = difference.weights();
        let inverse_square = 1.0 / (m * m);
        let kernel = |linear, cubic, flicker| Self { weights, linear, cubic, flicker };
        let white = white / (total * kernel(1.0, 0.0, 0.0).at(0.0));
        let walk = walk / (total * kernel(-inverse_square, 1.0, 0.0).at(0.0));
        let flicker = match flicker {
            0.0 => 0.0,
            _ => flicker / (total * kernel(0.0, 0.0, 1.0).at(0.0)),
        };
        kernel(white - walk * inverse_square, walk, flicker)
    }

    /// The sums that make [`at`](Self::at) needless, where there are some.
    fn sums(
        &self,
        difference: Difference,
        block: u64,
        stride: u64,
        differences: u64,
    ) -> Option<&'static Sums> {
        let table = match difference {
            Difference::Allan => &ALLAN,
            Difference::Hadamard => &HADAMARD,
        };
        // All differences that are correlated at stride m/4 are there.
        if self.flicker != 0.0 || differences < difference.blocks() * 4 {
            return None;
        }
        let strides = [1, 2, 4].map(|per_block| stride.checked_mul(per_block) == Some(block));
        let k = strides.iter().position(|&is_it| is_it)?;
        table.get(k)
    }

    /// Σ c_i G(x + i), which is r(x).
    fn at(&self, x: f64) -> f64 {
        let [c0, c1, c2, c3] = self.weights;
        let pair = |i: f64| self.generating((x - i).abs()) + self.generating(x + i);
        let outer = if c3 == 0.0 { 0.0 } else { c3 * pair(3.0) };
        c0 * self.generating(x) + c1 * pair(1.0) + c2 * pair(2.0) + outer
    }

    /// G(u), u ≥ 0.
    fn generating(&self, u: f64) -> f64 {
        let mut sum = self.linear + self.cubic * u * u;
        if self.flicker != 0.0 && u > 0.0 {
            sum += self.flicker * u * libm::log(u);
        }
        sum * u
    }
}

#[cfg(test)]
#[path = "edf_tests.rs"]
mod tests;
