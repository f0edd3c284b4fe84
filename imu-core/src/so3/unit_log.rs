//! The logarithm of a rotation that is known to be of unit length and small: no trigonometry, root or division.

use super::{imaginary, is_single, log};
use crate::Real;
use nalgebra::{Quaternion, Vector3};

/// cos 0.35: above it the angle is below 0.7 rad.
const SMALL: f64 = 0.939_372_712_847_379;

/// k!/(2k + 1)!!, coefficients of arccos(1 − y)/√(2y − y²).
const SERIES: [f64; 12] = {
    let mut series = [1.0; 12];
    let mut k = 1;
    while k < series.len() {
        series[k] = series[k - 1] * k as f64 / (2 * k + 1) as f64;
        k += 1;
    }
    series
};

/// [`log`] of a unit quaternion. With w = cos h and y = 1 − w, θ/|v| = 2h/sin h = 2 Σ k!/(2k + 1)!! yᵏ, whose nearest
/// singularity is at y = 2: below 0.7 rad y < 0.061, and terms beyond the twelfth (`f32`: sixth) are below rounding.
#[inline(always)]
pub(crate) fn log_of_unit<T: Real>(q: &Quaternion<T>) -> Vector3<T> {
    let sign = if q.coords.w < T::ZERO { -T::ONE } else { T::ONE };
    let w = q.coords.w * sign;
    if w < T::from_f64(SMALL) {
        return far(q);
    }
    let y = T::ONE - w;
    let ratio = if is_single::<T>() {
        SERIES.iter().take(6).rev().fold(T::ZERO, |sum, term| sum * y + T::from_f64(*term))
    } else {
        // Even and odd terms apart: a processor that can works on both at a time.
        let [a, b, c, d, e, f, g, h, i, j, k, l] = SERIES.map(T::from_f64);
        let x = y * y;
        ((((k * x + i) * x + g) * x + e) * x + c) * x
            + a
            + (((((l * x + j) * x + h) * x + f) * x + d) * x + b) * y
    };
    imaginary(q) * ((sign + sign) * ratio)
}

#[cold]
fn far<T: Real>(q: &Quaternion<T>) -> Vector3<T> {
    log(q)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::so3::exp;
    use crate::vector::norm;
    use proptest::prelude::*;

    proptest! {
        /// Five roundings of the series and of the quaternion, each of half a unit of the vector's length.
        #[test]
        fn it_is_the_logarithm(v in [-1.0..1.0, -1.0..1.0, -1.0..1.0], size in 0.0..1.8, flip: bool) {
            let v = Vector3::from(v) * size;
            let sign = if flip { -1.0 } else { 1.0 };
            let q = Quaternion::from(exp(v).coords * sign);
            prop_assert!(norm(&(log_of_unit(&q) - log(&q))) <= 1.2e-15 * norm(&v));
            let q = Quaternion::from(exp(v.map(|x| x as f32)).coords * sign as f32);
            let off = log_of_unit(&q) - log(&q);
            prop_assert!(f64::from(norm(&off)) <= 6e-7 * norm(&v));
        }
    }
}
