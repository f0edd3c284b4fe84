//! Standard normal numbers by the ziggurat method, in `f32` and `f64`.
//!
//! Source: Marsaglia & Tsang (2000), "The Ziggurat Method for Generating Random Variables",
//! Journal of Statistical Software 5(8), with the layer and the position taken from disjoint bits
//! of the word, as Doornik (2005), "An Improved Ziggurat Method to Generate Normal Random Samples",
//! asks for. 128 layers for `f32` (1.5 KB of table), 256 for `f64` (6 KB).
//!
//! One word, one table look-up, one comparison of integers and one multiplication give 97.2 %
//! (`f32`) or 98.5 % (`f64`) of the numbers; the rest need an exponential, and the tail beyond
//! 3.44 (3.65) two logarithms, all from the `libm` crate: so the same bits on every target. The
//! positions are odd multiples of 2⁻²⁴ (2⁻⁵³) of a layer's width: the law is exactly symmetric and
//! no number is zero. Its tails end at 8.3 (`f32`) and 12.2 (`f64`).
//!
//! ```
//! use imu_core::noise::{Normal, Xoshiro128PlusPlus};
//! use rand_core::SeedableRng;
//! let mut rng = Xoshiro128PlusPlus::seed_from_u64(7);
//! let mean = (0..10_000).map(|_| f32::standard_normal(&mut rng)).sum::<f32>() / 10_000.0;
//! assert!(mean.abs() < 5.0 / 100.0); // five standard deviations of the mean
//! ```

use super::xoshiro::{Xoshiro128PlusPlus, Xoshiro256PlusPlus};
use super::ziggurat_tables::{HEIGHTS_F32, HEIGHTS_F64, LAYERS_F32, LAYERS_F64, R_F32, R_F64};
use crate::Real;
use rand_core::{Rng, SeedableRng};

/// A scalar that normal numbers can be drawn of: `f32` or `f64`.
///
/// The numbers that a generator's words turn into are part of the format: a change of them is a
/// breaking change, guarded by tests.
pub trait Normal: Real {
    /// The generator that the noise stages of this scalar carry.
    type Generator: Rng + SeedableRng + Copy + PartialEq + core::fmt::Debug + Send + Sync + 'static;

    /// The next standard normal number (mean 0, variance 1) from the words of `rng`.
    ///
    /// Draws a word for a number as a rule, more where the first is refused. A generator that is
    /// stuck at one word may never satisfy it.
    fn standard_normal<R: Rng + ?Sized>(rng: &mut R) -> Self;
}

/// Tells the optimiser that the branch it stands in is seldom taken.
#[cold]
#[inline]
const fn seldom() {}

macro_rules! ziggurat {
    ($T:ident, $generator:ident, $word:ident, $signed:ident, $next:ident, $unused:literal,
     $mask:literal, $mantissa:literal, $layers:ident, $heights:ident, $r:ident,
     $exp:path, $log:path) => {
        impl Normal for $T {
            type Generator = $generator;

            #[inline(always)]
            fn standard_normal<R: Rng + ?Sized>(rng: &mut R) -> Self {
                loop {
                    let word = rng.$next();
                    // The low bits choose the layer; the high ones, signed and made odd, the place.
                    let index = (word & $mask) as usize;
                    let place = (word as $signed >> $unused) | 1;
                    let (inner, width) = $layers[index];
                    let x = place as $T * width;
                    if place.unsigned_abs() < inner {
                        return x;
                    }
                    seldom();
                    if index == 0 {
                        let beyond = loop {
                            let e = -$log(positive(rng.$next())) / $r;
                            if -2.0 * $log(positive(rng.$next())) > e * e {
                                break $r + e;
                            }
                        };
                        return if place < 0 { -beyond } else { beyond };
                    }
                    let (low, high) = ($heights[index], $heights[index + 1]);
                    if low + (high - low) * positive(rng.$next()) < $exp(-0.5 * x * x) {
                        return x;
                    }
                }

                /// Uniform on (0, 1], by the word's high bits.
                #[inline(always)]
                fn positive(word: $word) -> $T {
                    ((word >> ($word::BITS - $mantissa)) + 1) as $T
                        * (1.0 / ((1 as $word) << $mantissa) as $T)
                }
            }
        }
    };
}

ziggurat!(
    f32,
    Xoshiro128PlusPlus,
    u32,
    i32,
    next_u32,
    7,
    0x7f,
    24,
    LAYERS_F32,
    HEIGHTS_F32,
    R_F32,
    libm::expf,
    libm::logf
);
ziggurat!(
    f64,
    Xoshiro256PlusPlus,
    u64,
    i64,
    next_u64,
    10,
    0xff,
    53,
    LAYERS_F64,
    HEIGHTS_F64,
    R_F64,
    libm::exp,
    libm::log
);

#[cfg(test)]
mod tests {
    use super::*;

    /// FNV-1a over the bits of the first million numbers.
    fn hash<T: Normal>(bits: impl Fn(T) -> u64) -> u64 {
        let mut rng = T::Generator::seed_from_u64(7);
        (0..1_000_000).fold(0xcbf2_9ce4_8422_2325, |hash: u64, _| {
            (hash ^ bits(T::standard_normal(&mut rng))).wrapping_mul(0x0000_0100_0000_01b3)
        })
    }

    #[test]
    fn the_numbers_never_change() {
        assert_eq!(hash::<f32>(|x| x.to_bits().into()), 0xcccc_f5d1_8d01_c640);
        assert_eq!(hash::<f64>(f64::to_bits), 0xb5d0_d1e0_e888_8e80);
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
        let first = [(); 3].map(|()| f64::standard_normal(&mut rng));
        assert_eq!(first, [0.2274326233395725, 0.8987581895545641, -0.9216075305818846]);
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(7);
        let first = [(); 3].map(|()| f32::standard_normal(&mut rng));
        assert_eq!(first, [0.5504091, 0.22397797, 1.8402485]);
    }

    /// The layers cover equal areas and fit together. `edges` of a layer in double precision;
    /// `eps`: half a unit in the last place of the table's scalar, relative.
    fn layers_fit(layers: &[(f64, f64)], heights: &[f64], r: f64, full: f64, eps: f64) {
        let f = |x: f64| libm::exp(-0.5 * x * x);
        let edge = |i: usize| layers.get(i).map_or(0.0, |&(_, width)| width * full);
        assert!((edge(1) / r - 1.0).abs() <= 2.0 * eps);
        let area = edge(0) * f(r);
        for (i, &(inner, _)) in layers.iter().enumerate() {
            // Both edges are rounded, and `inner` is a whole number.
            let exact = full * edge(i + 1) / edge(i);
            assert!((inner - exact).abs() <= 1.0 + 2.0 * eps * full, "layer {i}: {inner}");
            if i > 0 {
                // Two heights rounded, one edge, and the area itself (r twice, as f' = -x f).
                let (low, high) = (heights[i], heights[i + 1]);
                let slack = 2.0 * eps * edge(i) + (2.0 + r * r) * eps * area;
                assert!((edge(i) * (high - low) - area).abs() <= slack, "layer {i}");
                let slack = (1.0 + edge(i) * edge(i)) * 2.0 * eps * f(edge(i));
                assert!((low - f(edge(i))).abs() <= slack, "height {i}");
            }
        }
        assert_eq!(heights.last(), Some(&1.0));
    }

    #[test]
    fn the_layers_of_the_tables_have_equal_areas() {
        let layers = LAYERS_F32.map(|(inner, width)| (f64::from(inner), f64::from(width)));
        let full = f64::from(1 << 24);
        layers_fit(&layers, &HEIGHTS_F32.map(f64::from), R_F32.into(), full, 1.0 / full);
        let layers = LAYERS_F64.map(|(inner, width)| (inner as f64, width));
        let full = (1_u64 << 53) as f64;
        layers_fit(&layers, &HEIGHTS_F64, R_F64, full, 1.0 / full);
    }
}
