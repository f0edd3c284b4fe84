//! `Real`: the scalar of every formula here, `f32` or `f64`.
//!
//! A sealed trait of our own instead of nalgebra's `RealField`: it offers only operations that
//! have one definition on every target (IEEE 754 arithmetic, comparison, and the pure-Rust `libm`
//! crate), so the same input gives the same bits on a laptop and on a Cortex-M, whatever features
//! cargo unifies elsewhere in a build.
//!
//! ```
//! use imu_core::Real;
//! fn density<T: Real>(sd: T, dt: T) -> T {
//!     sd * dt.sqrt()
//! }
//! assert_eq!(density(0.5_f32, 4.0), 1.0);
//! ```

use crate::allan::{Total, TwoStage};
use crate::lanes::{Four, Plain, Single};
use core::fmt::{Debug, Display};
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A scalar with one definition everywhere: `f32` or `f64`.
///
/// Not promised to be the same bits everywhere: the payload of a NaN, flush-to-zero modes, x87.
pub trait Real:
    sealed::Sealed
    + Copy
    + Debug
    + Display
    + Default
    + PartialEq
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// A running total of many terms ≥ 0 that stays right over 10⁹ of them.
    type Total: Total<Self>;
    /// Four of them, in one register where there is one for four.
    #[doc(hidden)]
    type Four: Four<Self>;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The largest finite value.
    const MAX: Self;
    /// The largest value whose square may be summed 10⁹ times over without overflow.
    const LIMIT: Self;
    /// The distance from 1 to the next larger value.
    const EPSILON: Self;

    /// The nearest value to `x`.
    fn from_f64(x: f64) -> Self;
    /// The nearest value to the integer `n`.
    fn from_u32(n: u32) -> Self;
    /// The nearest value to the integer `n`, of either sign.
    fn from_i32(n: i32) -> Self;
    /// The same number in double precision (exact).
    fn to_f64(self) -> f64;
    /// |x|: clears the sign bit, so also of a NaN.
    fn abs(self) -> Self;
    /// Square root, correctly rounded; NaN below zero.
    fn sqrt(self) -> Self;
    /// eˣ − 1 without cancellation near zero, within 1 unit in the last place (`libm`).
    fn exp_m1(self) -> Self;
    /// The nearest whole number, of two equally near ones the even one.
    fn round_ties_even(self) -> Self;
    /// Sine and cosine of an angle in radians, within 1 unit in the last place (`libm`).
    fn sin_cos(self) -> (Self, Self);
    /// The angle of the point (`x`, `self`) in radians, −π to π, within 1 unit in the last place (`libm`).
    fn atan2(self, x: Self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// The bits of its IEEE 754 form, the lower 32 for an `f32`.
    fn bits(self) -> u64;
    /// The value that [`bits`](Self::bits) gave.
    fn from_bits(bits: u64) -> Self;
}

macro_rules! real {
    ($T:ident, $Total:ty, $Four:ty, $limit:literal, $sqrt:path, $expm1:path, $rint:path,
     $sincos:path, $atan2:path) => {
        impl Real for $T {
            type Total = $Total;
            type Four = $Four;

            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const MAX: Self = $T::MAX;
            const LIMIT: Self = $limit;
            const EPSILON: Self = $T::EPSILON;

            #[inline(always)]
            fn from_f64(x: f64) -> Self {
                x as $T
            }
            #[inline(always)]
            fn from_u32(n: u32) -> Self {
                n as $T
            }
            #[inline(always)]
            fn from_i32(n: i32) -> Self {
                n as $T
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $T::abs(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline]
            fn exp_m1(self) -> Self {
                $expm1(self)
            }
            #[inline]
            fn round_ties_even(self) -> Self {
                $rint(self)
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                $sincos(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $T::is_finite(self)
            }
            #[inline(always)]
            fn bits(self) -> u64 {
                u64::from(self.to_bits())
            }
            #[inline(always)]
            fn from_bits(bits: u64) -> Self {
                $T::from_bits(bits as _)
            }
        }
    };
}

real!(
    f32,
    TwoStage,
    Single,
    1e12,
    libm::sqrtf,
    libm::expm1f,
    libm::rintf,
    libm::sincosf,
    libm::atan2f
);
real!(f64, f64, Plain<f64>, 1e100, libm::sqrt, libm::expm1, libm::rint, libm::sincos, libm::atan2);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn square_root_is_the_correctly_rounded_one() {
        for bits in (0..0x7f80_0000_u32).step_by(10_007) {
            let x = f32::from_bits(bits);
            assert_eq!(Real::sqrt(x).to_bits(), x.sqrt().to_bits());
        }
    }

    #[test]
    fn rounding_is_to_the_nearest_and_ties_to_even() {
        for bits in (0..0x7f80_0000_u32).step_by(10_007) {
            let x = f32::from_bits(bits);
            assert_eq!(Real::round_ties_even(-x).to_bits(), (-x).round_ties_even().to_bits());
        }
        assert_eq!([0.5, 1.5, 2.5, -0.5].map(Real::round_ties_even), [0.0, 2.0, 2.0, 0.0]);
    }

    #[test]
    fn absolute_value_clears_the_sign_of_everything() {
        assert_eq!(Real::abs(-0.0_f32).to_bits(), 0);
        assert!(Real::abs(f64::NAN).is_nan());
        assert_eq!(Real::abs(f64::NEG_INFINITY), f64::INFINITY);
    }
}
