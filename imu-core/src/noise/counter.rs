//! Samples counted, times a step: a straight line in time without accumulated rounding.
//!
//! k·s is formed as (k div 2¹⁶)·(2¹⁶ s) + (k mod 2¹⁶)·s: two exact integers and two products, so
//! three roundings at any k up to 2⁴⁸ (a thousand years at 8 kHz), where a sum of steps loses
//! 0.1 % in an hour at 8 kHz in `f32`.

use super::Normal;

/// k·s for k = 0, 1, 2, …: 16 bytes in `f32`, 24 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line<T> {
    step: T,
    /// (k div 2¹⁶)·2¹⁶ s.
    base: T,
    /// k mod 2¹⁶.
    low: u32,
    /// k div 2¹⁶.
    high: u32,
}

impl<T: Normal> Line<T> {
    const BLOCK: u32 = 1 << 16;

    /// The line of this step, at zero.
    pub(super) const fn new(step: T) -> Self {
        Self { step, base: T::ZERO, low: 0, high: 0 }
    }

    /// k·s.
    #[inline(always)]
    pub(super) fn value(&self) -> T {
        self.base + T::from_u32(self.low) * self.step
    }

    /// k ← k + 1.
    #[inline(always)]
    pub(super) fn advance(&mut self) {
        self.low += 1;
        if self.low == Self::BLOCK {
            self.low = 0;
            self.high = self.high.saturating_add(1);
            self.base = T::from_u32(self.high) * (T::from_u32(Self::BLOCK) * self.step);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_right_after_a_hundred_million_samples() {
        let step = 1.2345e-9_f32;
        let mut line = Line::new(step);
        for _ in 0..100_000_000 {
            line.advance();
        }
        let exact = 1e8 * f64::from(step);
        assert!((f64::from(line.value()) / exact - 1.0).abs() < 2.0 * f64::from(f32::EPSILON));
        line.high = u32::MAX;
        line.low = Line::<f32>::BLOCK - 1;
        line.advance();
        assert!(line.value().is_finite());
    }
}
