//! The Jacobians of the exponential, J_l and J_r, and their inverses: how a rotation changes with its vector.
//!
//! exp(θ + δ) = exp(J_l(θ) δ) exp(θ) = exp(θ) exp(J_r(θ) δ), to first order in δ. With z = |θ|²:
//!
//! J_l = 1 + b[θ]× + c[θ]×², J_l⁻¹ = 1 − ½[θ]× + e[θ]×², J_r(θ) = J_l(−θ) = J_lᵀ,
//!
//! b = (1 − cos|θ|)/z = ½ sinc²(|θ|/2), c = (|θ| − sin|θ|)/|θ|³, e = (1 − (|θ|/2) cot(|θ|/2))/z.
//!
//! Below 1 rad all three are series; above, half angles. Nothing happens at π: the inverses exist up to 2π. Source:
//! Chirikjian (2011), "Stochastic Models, Information Theory, and Lie Groups", vol. 2, eqs. (10.86) and following.
//!
//! ```
//! use imu_core::nalgebra::{Matrix3, Vector3};
//! use imu_core::so3;
//! let turn = Vector3::new(0.3, -2.0, 1.0);
//! let off: Matrix3<f64> = so3::left_jacobian(&turn) * so3::inverse_left_jacobian(&turn) - Matrix3::identity();
//! assert!(off.abs().max() < 1e-14);
//! ```

use super::is_single;
use crate::Real;
use crate::matrix::{self, Rows, add_scaled, skew, transposed, two_skews};
use crate::vector::dot;
use nalgebra::{Matrix3, Vector3};

/// J_l of a rotation vector in rad. Its product with its inverse is off from 1 by at most 1e-14 (`f64`) and 5e-7
/// (`f32`) in an element, from 0 to π.
#[must_use]
pub fn left_jacobian<T: Real>(rotation: &Vector3<T>) -> Matrix3<T> {
    matrix::matrix(&left_rows(rotation))
}

/// J_r of a rotation vector in rad: J_l's transpose.
#[must_use]
pub fn right_jacobian<T: Real>(rotation: &Vector3<T>) -> Matrix3<T> {
    matrix::matrix(&transposed(&left_rows(rotation)))
}

/// J_l⁻¹ of a rotation vector in rad, of a length below 2π: at 2π there is none, and beyond it means nothing.
#[must_use]
pub fn inverse_left_jacobian<T: Real>(rotation: &Vector3<T>) -> Matrix3<T> {
    matrix::matrix(&inverse_left_rows(rotation))
}

/// J_r⁻¹ of a rotation vector in rad, of a length below 2π: J_l⁻¹'s transpose.
#[must_use]
pub fn inverse_right_jacobian<T: Real>(rotation: &Vector3<T>) -> Matrix3<T> {
    matrix::matrix(&transposed(&inverse_left_rows(rotation)))
}

pub(crate) fn left_rows<T: Real>(rotation: &Vector3<T>) -> Rows<T> {
    let (b, c) = coefficients(dot(rotation, rotation));
    quadratic(rotation, b, c)
}

pub(crate) fn inverse_left_rows<T: Real>(rotation: &Vector3<T>) -> Rows<T> {
    quadratic(rotation, T::from_f64(-0.5), inverse_coefficient(dot(rotation, rotation)))
}

/// 1 + b[θ]× + c[θ]×²
fn quadratic<T: Real>(rotation: &Vector3<T>, b: T, c: T) -> Rows<T> {
    let once = add_scaled(&matrix::identity(), b, &skew(rotation));
    add_scaled(&once, c, &two_skews(rotation, rotation))
}

/// 1/(2k + 2)!
const B: [f64; 8] = inverse_factorials(2);
/// 1/(2k + 3)!
const C: [f64; 8] = inverse_factorials(3);
/// Coefficients of (1 − ½√z cot ½√z)/z: |B₂ₖ|/(2k)! of Bernoulli's numbers, k from 1.
const E: [f64; 10] = [
    1.0 / 12.0,
    1.0 / 720.0,
    1.0 / 30_240.0,
    1.0 / 1_209_600.0,
    1.0 / 47_900_160.0,
    691.0 / 1_307_674_368_000.0,
    1.0 / 74_724_249_600.0,
    3617.0 / 10_670_622_842_880_000.0,
    43_867.0 / 5_109_094_217_170_944_000.0,
    174_611.0 / 802_857_662_698_291_200_000.0,
];

const fn inverse_factorials(first: u32) -> [f64; 8] {
    let mut series = [0.0; 8];
    let (mut factorial, mut n, mut k) = (1.0, 1, 0);
    while k < series.len() {
        while n < first + 2 * k as u32 {
            n += 1;
            factorial *= n as f64;
        }
        series[k] = 1.0 / factorial;
        k += 1;
    }
    series
}

/// Σ s(k) xᵏ, of five terms in `f32`.
#[inline(always)]
pub(crate) fn series<T: Real>(terms: &[f64], x: T) -> T {
    let count = if is_single::<T>() { 5 } else { terms.len() };
    terms.iter().take(count).rev().fold(T::ZERO, |sum, term| sum * x + T::from_f64(*term))
}

/// b and c of z = |θ|².
#[inline(always)]
pub(crate) fn coefficients<T: Real>(z: T) -> (T, T) {
    if z < T::ONE { (series(&B, -z), series(&C, -z)) } else { large_coefficients(z) }
}

#[cold]
fn large_coefficients<T: Real>(z: T) -> (T, T) {
    let angle = z.sqrt();
    let half = angle * T::from_f64(0.5);
    let (sin, cos) = half.sin_cos();
    let sinc = sin / half;
    (T::from_f64(0.5) * sinc * sinc, (T::ONE - sinc * cos) / z)
}

/// e of z = |θ|².
fn inverse_coefficient<T: Real>(z: T) -> T {
    if z < T::ONE {
        return series(&E, z);
    }
    let half = z.sqrt() * T::from_f64(0.5);
    let (sin, cos) = half.sin_cos();
    (T::ONE - half * cos / sin) / z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::so3::{exp, inverse, log, product};
    use crate::vector::norm;
    use core::f64::consts::PI;
    use proptest::prelude::*;

    fn along(direction: [f64; 3], angle: f64) -> Option<Vector3<f64>> {
        let axis = Vector3::from(direction);
        (norm(&axis) > 1e-3).then(|| axis * (angle / norm(&axis)))
    }

    proptest! {
        #[test]
        fn inverses_invert(direction in [-1.0..1.0, -1.0..1.0, -1.0..1.0], angle in 0.0..=PI) {
            let Some(turn) = along(direction, angle) else { return Ok(()) };
            let off = |a: Matrix3<f64>, b: Matrix3<f64>| (a * b - Matrix3::identity()).abs().max();
            prop_assert!(off(left_jacobian(&turn), inverse_left_jacobian(&turn)) <= 1e-14);
            prop_assert!(off(right_jacobian(&turn), inverse_right_jacobian(&turn)) <= 1e-14);
            let single = turn.map(|x| x as f32);
            let double = |m: Matrix3<f32>| m.map(f64::from);
            let (j, i) = (left_jacobian(&single), inverse_left_jacobian(&single));
            prop_assert!(off(double(j), double(i)) <= 5e-7);
        }

        /// Central differences of h = 1e-5: h²/6 times third derivatives below 1, and rounding of 2e-16/h.
        #[test]
        fn they_are_derivatives(
            direction in [-1.0..1.0, -1.0..1.0, -1.0..1.0], angle in 0.0..3.0, d in [-1.0..1.0, -1.0..1.0, -1.0..1.0]
        ) {
            const H: f64 = 1e-5;
            let Some(turn) = along(direction, angle) else { return Ok(()) };
            let d = Vector3::from(d);
            let back = inverse(&exp(turn));
            let (after, before) = (exp(turn + d * H), exp(turn - d * H));
            let left = (log(&product(&after, &back)) - log(&product(&before, &back))) / (2.0 * H);
            prop_assert!((left - left_jacobian(&turn) * d).abs().max() < 2e-10);
            let right = (log(&product(&back, &after)) - log(&product(&back, &before))) / (2.0 * H);
            prop_assert!((right - right_jacobian(&turn) * d).abs().max() < 2e-10);
        }
    }

    /// Nothing jumps where the series end, and there is no branch at π.
    #[test]
    fn nothing_breaks_anywhere() {
        for angle in [1.0, PI, 1e-4, 1e-160] {
            let [below, above] =
                [1.0 - 1e-12, 1.0 + 1e-12].map(|k| Vector3::new(0.6, 0.0, -0.8) * (angle * k));
            assert!((left_jacobian(&below) - left_jacobian(&above)).abs().max() < 1e-11);
            let jump = inverse_left_jacobian(&below) - inverse_left_jacobian(&above);
            assert!(jump.abs().max() < 1e-11);
        }
    }
}
