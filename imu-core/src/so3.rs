//! Rotations: the exponential and the logarithm between rotation vectors and unit quaternions, and what is needed
//! around them.
//!
//! Quaternions are Hamilton's, w first in words and [`nalgebra`]'s in memory; `q_ab` takes vectors from frame b to
//! frame a, and `q_ac = q_ab q_bc`. A rotation vector is the axis times the angle in radians.
//!
//! An IMU turns little between two samples. So [`exp`] takes polynomials below 0.7 rad: no trigonometry, no square
//! root, no division, and right to rounding; above, it takes the general form, which is right at any angle.
//! Products drift from unit length by rounding; [`renormalised`] takes them back, without a square root.
//!
//! Same bits on every target: arithmetic, the square root, and the pure-Rust `libm` are all that is in here.
//!
//! ```
//! use imu_core::nalgebra::Vector3;
//! use imu_core::so3;
//! // A quarter turn to the left, seen from above: what was ahead is now to the left.
//! let q_wb = so3::exp(Vector3::new(0.0, 0.0, core::f64::consts::FRAC_PI_2));
//! let ahead_w = so3::rotate(&q_wb, &Vector3::new(1.0, 0.0, 0.0));
//! assert!(ahead_w.x.abs() < 1e-15 && (ahead_w.y - 1.0).abs() < 1e-15);
//! assert!((so3::log(&q_wb).z - core::f64::consts::FRAC_PI_2).abs() < 1e-15);
//! ```

mod jacobians;
mod unit_log;

pub(crate) use jacobians::{coefficients, inverse_left_rows, left_rows, series};
pub use jacobians::{inverse_left_jacobian, inverse_right_jacobian, left_jacobian, right_jacobian};
pub(crate) use unit_log::log_of_unit;

use crate::Real;
use crate::lanes::Four;
use crate::vector::{cross, dot};
use core::ops::{Add, Mul};
use nalgebra::{Quaternion, Vector3};

/// Square of the half angle, in rad², up to which polynomials are right to rounding: an angle of 0.7 rad.
const SMALL: f64 = 0.35 * 0.35;

/// The rotation by a vector: e^θ, of unit length up to rounding. θ in rad.
///
/// q = (cos |θ|/2, sin(|θ|/2) θ/|θ|). Largest error of a component, measured: below 0.7 rad 4.3e-8 in `f32` and
/// 2.3e-16 in `f64`; above it the rounding of the angle, 3e-7 and 6e-16 at a full turn. A rotation of more than 1e18 rad
/// (`f32`; 1e150 in `f64`), or one that is not finite, gives NaN.
#[must_use]
#[inline]
pub fn exp<T: Real>(rotation: Vector3<T>) -> Quaternion<T> {
    exp_of_half(rotation * T::from_f64(0.5))
}

/// The rotation by twice a vector: who multiplies by a time anyway saves three multiplications.
#[inline(always)]
pub(crate) fn exp_of_half<T: Real>(half: Vector3<T>) -> Quaternion<T> {
    exp_of_squared_half(half, dot(&half, &half))
}

/// The same of a half vector whose square is known.
#[inline(always)]
pub(crate) fn exp_of_squared_half<T: Real>(half: Vector3<T>, square: T) -> Quaternion<T> {
    let (cos, sinc) = cos_and_sinc(square);
    Quaternion::new(cos, half.x * sinc, half.y * sinc, half.z * sinc)
}

/// cos √x and sin √x/√x.
#[inline(always)]
fn cos_and_sinc<T: Real>(x: T) -> (T, T) {
    if x < T::from_f64(SMALL) { small::<T, T>(x, T::from_f64) } else { large(x) }
}

/// The same of four.
#[inline(always)]
pub(crate) fn four_cos_and_sinc<T: Real>(x: T::Four) -> (T::Four, T::Four) {
    if x.all_below(T::from_f64(SMALL)) {
        small::<T, T::Four>(x, |term| T::Four::all(T::from_f64(term)))
    } else {
        one_by_one::<T>(x)
    }
}

#[cold]
fn one_by_one<T: Real>(x: T::Four) -> (T::Four, T::Four) {
    let pairs = x.lanes().map(cos_and_sinc);
    (T::Four::new(pairs.map(|(cos, _)| cos)), T::Four::new(pairs.map(|(_, sinc)| sinc)))
}

/// cos √x and sin √x/√x near 0 by their series; more terms would change nothing. Of a `T`, or of several.
#[inline(always)]
fn small<T: Real, X>(x: X, constant: impl Fn(f64) -> X + Copy) -> (X, X)
where
    X: Copy + Add<Output = X> + Mul<Output = X>,
{
    // (−1)ⁿ/(2n)! and (−1)ⁿ/(2n + 1)!
    const COS: [f64; 7] = [
        1.0,
        -1.0 / 2.0,
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40_320.0,
        -1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
    ];
    const SINC: [f64; 7] = [
        1.0,
        -1.0 / 6.0,
        1.0 / 120.0,
        -1.0 / 5040.0,
        1.0 / 362_880.0,
        -1.0 / 39_916_800.0,
        1.0 / 6_227_020_800.0,
    ];
    if is_single::<T>() {
        let horner = |series: [f64; 7]| {
            let [a, b, c, d, ..] = series.map(constant);
            ((d * x + c) * x + b) * x + a
        };
        return (horner(COS), horner(SINC));
    }
    // Even and odd terms apart: a processor that can works on both at a time.
    let square = x * x;
    let halves = |series: [f64; 7]| {
        let [a, b, c, d, e, f, g] = series.map(constant);
        (((g * square + e) * square + c) * square + a) + ((f * square + d) * square + b) * x
    };
    (halves(COS), halves(SINC))
}

/// cos √x and sin √x/√x where x is not near 0.
#[cold]
fn large<T: Real>(x: T) -> (T, T) {
    let angle = x.sqrt();
    let (sin, cos) = angle.sin_cos();
    (cos, sin / angle)
}

/// The vector of a rotation: the inverse of [`exp`], of length 0 to π rad.
///
/// θ = 2 atan2(|v|, |w|)/|v| · v, with the sign of w; a series where |v| is small. The quaternion need not be of
/// exactly unit length: a factor that both parts have in common falls out. Of the zero quaternion the result is zero,
/// of one that is not finite NaN.
#[must_use]
pub fn log<T: Real>(q: &Quaternion<T>) -> Vector3<T> {
    // A turn of more than π is one of less the other way.
    let sign = if q.coords.w < T::ZERO { -T::ONE } else { T::ONE };
    let (w, v) = (q.coords.w * sign, imaginary(q) * sign);
    let square = dot(&v, &v);
    // atan x = x(1 − x²/3 + x⁴/5 …): the last term is beyond the digits where x² is below this.
    let series = T::from_f64(if is_single::<T>() { 1e-4 } else { 1e-8 });
    if square > series * (w * w) {
        let sin = square.sqrt();
        return v * (T::from_u32(2) * sin.atan2(w) / sin);
    }
    if w == T::ZERO {
        return v; // zero, too
    }
    v * (T::from_u32(2) / w * (T::ONE - square / (T::from_u32(3) * (w * w))))
}

/// One rotation after another: `q_ac = q_ab q_bc`.
#[must_use]
#[inline]
pub fn product<T: Real>(ab: &Quaternion<T>, bc: &Quaternion<T>) -> Quaternion<T> {
    let (a, b) = (&ab.coords, &bc.coords);
    Quaternion::new(
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
    )
}

/// The rotation back: the conjugate of a unit quaternion.
#[must_use]
#[inline]
pub fn inverse<T: Real>(q: &Quaternion<T>) -> Quaternion<T> {
    Quaternion::new(q.coords.w, -q.coords.x, -q.coords.y, -q.coords.z)
}

/// The same vector in the other frame: `v_a = q_ab v_b q_ab*`, by two cross products.
#[must_use]
#[inline]
pub fn rotate<T: Real>(ab: &Quaternion<T>, b: &Vector3<T>) -> Vector3<T> {
    let (w, v) = (ab.coords.w, imaginary(ab));
    let once = cross(&v, b);
    let t = once + once;
    // In the order that multiply-and-add instructions like.
    Vector3::new(
        b.x + w * t.x + v.y * t.z - v.z * t.y,
        b.y + w * t.y + v.z * t.x - v.x * t.z,
        b.z + w * t.z + v.x * t.y - v.y * t.x,
    )
}

/// How far a rotation carries a point: `q_ab b q_ab* − b`, right to rounding of its own size however small the angle.
#[must_use]
#[inline]
pub fn displacement<T: Real>(ab: &Quaternion<T>, b: &Vector3<T>) -> Vector3<T> {
    let v = imaginary(ab);
    let once = cross(&v, b);
    let twice = once + once;
    twice * ab.coords.w + cross(&v, &twice)
}

/// A unit quaternion less 1, right to rounding of its own size however small the angle.
///
/// Its real part is √(1 − |v|²) − 1, below 0.7 rad by the binomial series of |v|²; above, −|v|²/(1 + w), or the plain
/// difference where w is below ½. It takes |v| at its word: the real part need not agree with it to the last digit.
#[must_use]
#[inline]
pub fn less_one<T: Real>(q: &Quaternion<T>) -> Quaternion<T> {
    let v = imaginary(q);
    let x = dot(&v, &v);
    let w = q.coords.w;
    let real = if x < T::from_f64(SMALL) && w > T::ZERO {
        let terms = if is_single::<T>() { 7 } else { BINOMIAL.len() };
        -x * BINOMIAL
            .iter()
            .take(terms)
            .rev()
            .fold(T::ZERO, |sum, term| sum * x + T::from_f64(*term))
    } else if w > T::from_f64(0.5) {
        -x / (T::ONE + w)
    } else {
        w - T::ONE
    };
    Quaternion::new(real, v.x, v.y, v.z)
}

/// Coefficients of (1 − √(1 − x))/x.
const BINOMIAL: [f64; 16] = {
    let mut series = [0.5; 16];
    let mut n = 1;
    while n < series.len() {
        // c(n+1) = c(n) (2n − 1)/(2n + 2)
        series[n] = series[n - 1] * (2 * n - 1) as f64 / (2 * n + 2) as f64;
        n += 1;
    }
    series
};

/// |q|.
#[must_use]
pub fn length<T: Real>(q: &Quaternion<T>) -> T {
    let c = &q.coords;
    (c.w * c.w + c.x * c.x + c.y * c.y + c.z * c.z).sqrt()
}

/// A quaternion near unit length taken nearer: q(1.5 − 0.5|q|²), one step of Newton's for 1/|q|.
///
/// A length that is off by ε is off by 1.5ε² afterwards.
#[must_use]
#[inline]
pub fn renormalised<T: Real>(q: &Quaternion<T>) -> Quaternion<T> {
    let c = &q.coords;
    let square = c.w * c.w + c.x * c.x + c.y * c.y + c.z * c.z;
    Quaternion::from(c * (T::from_f64(1.5) - T::from_f64(0.5) * square))
}

fn is_single<T: Real>() -> bool {
    T::EPSILON.to_f64() > 1e-10
}

#[inline]
fn imaginary<T: Real>(q: &Quaternion<T>) -> Vector3<T> {
    Vector3::new(q.coords.x, q.coords.y, q.coords.z)
}

#[cfg(test)]
#[path = "so3_tests.rs"]
mod tests;
