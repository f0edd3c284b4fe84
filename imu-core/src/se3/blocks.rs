//! Matrices on twists, \[D C; 0 D\]: adjoints, Jacobians of the exponential, and their inverses.

use super::{Pose, Twist};
use crate::matrix::{self, Rows, add_scaled, product, skew, two_skews};
use crate::vector::dot;
use crate::{Real, so3};
use nalgebra::{Matrix3, Matrix6};

/// A 6×6 matrix \[D C; 0 D\] that acts on twists (ρ, φ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocks<T: Real> {
    /// D, twice on the diagonal.
    pub diagonal: Matrix3<T>,
    /// C, what the angular part adds to the linear one.
    pub corner: Matrix3<T>,
}

impl<T: Real> Blocks<T> {
    fn of(diagonal: &Rows<T>, corner: &Rows<T>) -> Self {
        Self { diagonal: matrix::matrix(diagonal), corner: matrix::matrix(corner) }
    }

    /// (Dρ + Cφ, Dφ)
    #[must_use]
    pub fn times(&self, twist: &Twist<T>) -> Twist<T> {
        let Twist { linear, angular } = twist;
        Twist {
            linear: matrix::times(&self.diagonal, linear) + matrix::times(&self.corner, angular),
            angular: matrix::times(&self.diagonal, angular),
        }
    }

    /// The whole matrix.
    #[must_use]
    pub fn matrix(&self) -> Matrix6<T> {
        let element = |row: usize, column: usize| match (row < 3, column < 3) {
            (true, true) => self.diagonal.get((row, column)),
            (true, false) => self.corner.get((row, column.wrapping_sub(3))),
            (false, true) => None,
            (false, false) => self.diagonal.get((row.wrapping_sub(3), column.wrapping_sub(3))),
        };
        Matrix6::from_fn(|row, column| element(row, column).copied().unwrap_or(T::ZERO))
    }
}

/// Ad(T) = \[R \[p\]×R; 0 R\]: exp(Ad(T)ξ) = T exp(ξ) T⁻¹.
#[must_use]
pub fn adjoint<T: Real>(pose: &Pose<T>) -> Blocks<T> {
    let rotation = matrix::rotation(&pose.rotation());
    Blocks::of(&rotation, &matrix::crossed(&pose.translation(), &rotation))
}

/// ad(ξ) = \[\[φ\]× \[ρ\]×; 0 \[φ\]×\]: ad(ξ)η is [`Twist::bracket`].
#[must_use]
pub fn small_adjoint<T: Real>(twist: &Twist<T>) -> Blocks<T> {
    Blocks::of(&skew(&twist.angular), &skew(&twist.linear))
}

/// J_l = \[J Q; 0 J\]: exp(ξ + δ) = exp(J_l δ) exp(ξ) to first order; J is SO(3)'s.
#[must_use]
pub fn left_jacobian<T: Real>(twist: &Twist<T>) -> Blocks<T> {
    Blocks::of(&so3::left_rows(&twist.angular), &coupling(twist))
}

/// J_r(ξ) = J_l(−ξ): exp(ξ + δ) = exp(ξ) exp(J_r δ) to first order.
#[must_use]
pub fn right_jacobian<T: Real>(twist: &Twist<T>) -> Blocks<T> {
    left_jacobian(&-*twist)
}

/// J_l⁻¹ = \[J⁻¹ −J⁻¹QJ⁻¹; 0 J⁻¹\], of an angle below 2π.
#[must_use]
pub fn inverse_left_jacobian<T: Real>(twist: &Twist<T>) -> Blocks<T> {
    let inverse = so3::inverse_left_rows(&twist.angular);
    let corner = product(&product(&inverse, &coupling(twist)), &inverse);
    Blocks::of(&inverse, &corner.map(|row| -row))
}

/// J_r⁻¹(ξ) = J_l⁻¹(−ξ), of an angle below 2π.
#[must_use]
pub fn inverse_right_jacobian<T: Real>(twist: &Twist<T>) -> Blocks<T> {
    inverse_left_jacobian(&-*twist)
}

/// Q = ½r + c(pr + rp + prp) + d(ppr + rpp − 3prp) + e(prpp + pprp), r = \[ρ\]×, p = \[φ\]×. Source: Barfoot (2017), eq.
/// (7.86).
fn coupling<T: Real>(twist: &Twist<T>) -> Rows<T> {
    let (r, p) = (skew(&twist.linear), skew(&twist.angular));
    let (pr, rp) = (product(&p, &r), product(&r, &p));
    let pp = two_skews(&twist.angular, &twist.angular);
    let prp = product(&pr, &p);
    let (c, d, e) = coefficients(dot(&twist.angular, &twist.angular));
    let sum = |a: &Rows<T>, b: &Rows<T>| add_scaled(a, T::ONE, b);
    let second = sum(&sum(&pr, &rp), &prp);
    let third = add_scaled(&sum(&product(&p, &pr), &product(&rp, &p)), -T::from_u32(3), &prp);
    let fourth = sum(&product(&prp, &p), &product(&pp, &rp));
    let half = r.map(|row| row * T::from_f64(0.5));
    add_scaled(&add_scaled(&add_scaled(&half, c, &second), d, &third), e, &fourth)
}

/// 1/(2k + 4)!
const D: [f64; 8] = {
    let mut series = [1.0 / 24.0; 8];
    let mut k = 1;
    while k < series.len() {
        series[k] = series[k - 1] / ((2 * k + 3) * (2 * k + 4)) as f64;
        k += 1;
    }
    series
};

/// (k + 1)/(2k + 5)!
const E: [f64; 8] = {
    let mut series = [1.0 / 120.0; 8];
    let mut k = 1;
    while k < series.len() {
        series[k] = series[k - 1] * (k + 1) as f64 / (k * (2 * k + 4) * (2 * k + 5)) as f64;
        k += 1;
    }
    series
};

/// (θ − sin θ)/θ³, (θ² + 2cos θ − 2)/(2θ⁴) and (2θ − 3sin θ + θcos θ)/(2θ⁵) of z = θ²: series below 1 rad, and above
/// by the first two coefficients b and c of J_l: sin θ = θ(1 − cz), cos θ = 1 − bz.
fn coefficients<T: Real>(z: T) -> (T, T, T) {
    let (b, c) = so3::coefficients(z);
    if z < T::ONE {
        return (c, so3::series(&D, -z), so3::series(&E, -z));
    }
    let two = T::from_u32(2);
    (c, (T::ONE - two * b) / (two * z), (T::from_u32(3) * c - b) / (two * z))
}
