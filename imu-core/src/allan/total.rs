//! A running total of squares that stays right over 10⁹ terms.
//!
//! In double precision a plain sum does: its rounding errors are unbiased and grow with the square
//! root of the number of terms. In single precision a plain sum stalls after 2²⁴ equal terms, so
//! there the total has two stages: terms go to `fine`, and every [`SETTLE`] blocks `fine` goes to
//! `coarse`. 10⁹ terms then pass 2.4·10⁵ additions of similar size: relative error below 1e-5,
//! for the price of one addition a term. Beyond about 10¹⁰ terms the second stage stalls too.

/// After how many blocks of a level its totals are settled.
pub(super) const SETTLE: u32 = 4096;

/// A sum of many terms ≥ 0, one scalar wide for `f64` and two for `f32`.
pub trait Total<T>: Copy + core::fmt::Debug + PartialEq + Send + Sync + 'static {
    /// Nothing summed yet.
    const ZERO: Self;
    /// Adds a term.
    fn add(&mut self, term: T);
    /// The part that terms are added to.
    fn fine(&self) -> T;
    /// Replaces that part, after terms were added to it.
    fn set_fine(&mut self, fine: T);
    /// Moves what has gathered to where large sums are kept.
    fn settle(&mut self);
    /// Adds another total.
    fn merge(&mut self, other: &Self);
    /// The sum.
    fn value(&self) -> f64;
    /// The eight bytes that hold it, little-endian.
    fn to_bytes(self) -> [u8; 8];
    /// The total that [`Total::to_bytes`] wrote.
    fn from_bytes(bytes: [u8; 8]) -> Self;
}

impl Total<f64> for f64 {
    const ZERO: Self = 0.0;
    #[inline(always)]
    fn add(&mut self, term: f64) {
        *self += term;
    }
    #[inline(always)]
    fn fine(&self) -> f64 {
        *self
    }
    #[inline(always)]
    fn set_fine(&mut self, fine: f64) {
        *self = fine;
    }
    #[inline(always)]
    fn settle(&mut self) {}
    fn merge(&mut self, other: &Self) {
        *self += other;
    }
    fn value(&self) -> f64 {
        *self
    }
    fn to_bytes(self) -> [u8; 8] {
        self.to_le_bytes()
    }
    fn from_bytes(bytes: [u8; 8]) -> Self {
        f64::from_le_bytes(bytes)
    }
}

/// The two-stage total of single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoStage {
    fine: f32,
    coarse: f32,
}

impl Total<f32> for TwoStage {
    const ZERO: Self = Self { fine: 0.0, coarse: 0.0 };

    #[inline(always)]
    fn add(&mut self, term: f32) {
        self.fine += term;
    }
    #[inline(always)]
    fn fine(&self) -> f32 {
        self.fine
    }
    #[inline(always)]
    fn set_fine(&mut self, fine: f32) {
        self.fine = fine;
    }
    #[inline(always)]
    fn settle(&mut self) {
        self.coarse += self.fine;
        self.fine = 0.0;
    }
    fn merge(&mut self, other: &Self) {
        self.settle();
        self.coarse += other.coarse;
        self.fine = other.fine;
    }
    fn value(&self) -> f64 {
        f64::from(self.fine) + f64::from(self.coarse)
    }
    fn to_bytes(self) -> [u8; 8] {
        let [a, b, c, d] = self.fine.to_le_bytes();
        let [e, f, g, h] = self.coarse.to_le_bytes();
        [a, b, c, d, e, f, g, h]
    }
    fn from_bytes([a, b, c, d, e, f, g, h]: [u8; 8]) -> Self {
        Self { fine: f32::from_le_bytes([a, b, c, d]), coarse: f32::from_le_bytes([e, f, g, h]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2³⁰ equal terms: a plain f32 sum stalls at 2²⁴ of them, this one is off by rounding only.
    #[test]
    fn a_billion_single_precision_terms() {
        let mut total = TwoStage::ZERO;
        for _ in 0..(1_u32 << 30) / SETTLE {
            for _ in 0..SETTLE {
                total.add(0.1);
            }
            total.settle();
        }
        let exact = f64::from(0.1_f32) * f64::from(1 << 30);
        // Worst case: SETTLE additions to fine plus 2¹⁸ to coarse, half an ulp (2⁻²⁵) each, all of
        // one sign (equal terms are the worst there is): (2¹² + 2¹⁸)·2⁻²⁵ = 0.8 %; for equal terms
        // half of the roundings cancel over a binade.
        assert!((total.value() / exact - 1.0).abs() < 0.008, "{}", total.value() / exact);
    }
}
