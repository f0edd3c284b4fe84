//! Cumulative weights of the uniform cubic: how far along each of three neighbouring intervals the curve is.
//!
//! B₁ = 1 − (1 − u)³/6, B₂ = (1 + 3u + 3u² − 2u³)/6, B₃ = u³/6, and their derivatives by time, u from 0 to 1 along the
//! interval. Source: Sommer, Usenko, Schubert, Demmel & Cremers (2020), "Efficient derivative computation for
//! cumulative B-splines on Lie groups", eq. (19) to (24).
//!
//! `K` is the number of intervals that act, one less than the order. The recurrences of `so3` and these weights take any
//! `K`; what is fixed to the cubic are [`Knots`](super::Knots)' span, the window of four control points, and the
//! time-symmetric form.

use crate::Real;

/// B, Ḃ and B̈ of `K` intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weights<T: Real, const K: usize> {
    /// B, no unit.
    pub(crate) value: [T; K],
    /// Ḃ, 1/s.
    pub(crate) rate: [T; K],
    /// B̈, 1/s².
    pub(crate) acceleration: [T; K],
}

impl<T: Real> Weights<T, 3> {
    /// At u, with `rate` knots a second.
    #[inline(always)]
    pub(crate) fn cubic(u: T, rate: T) -> Self {
        let [half, sixth] = [1.0 / 2.0, 1.0 / 6.0].map(T::from_f64);
        let rest = T::ONE - u;
        let (square, rest_square) = (u * u, rest * rest);
        let (first, last) = (rest_square * rest * sixth, square * u * sixth);
        let (half_rate, half_square) = (rate * half, rate * rate);
        Self {
            // N₁ = B₁ − B₂ and N₂ = B₂ − B₃ mirror one another.
            value: [T::ONE - first, sixth + (u + square) * half - (last + last), last],
            rate: [rest_square * half_rate, rate * (half + u * rest), square * half_rate],
            acceleration: [-rest * half_square, (rest - u) * half_square, u * half_square],
        }
    }

    /// B − 1: the weights from the other end.
    #[inline(always)]
    pub(crate) fn from_the_end(u: T) -> [T; 3] {
        let [a, b, c] = Self::cubic(T::ONE - u, T::ZERO).value;
        [-c, -b, -a]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The matrix form of Sommer et al. (2020), eq. (19): C(1, u, u², u³)ᵀ, and what follows from it. A few
        /// roundings of numbers up to 1.
        #[test]
        fn they_are_the_published_ones(u in 0.0..=1.0_f64) {
            const C: [[f64; 4]; 3] = [[5.0, 3.0, -3.0, 1.0], [1.0, 3.0, 3.0, -2.0], [0.0, 0.0, 0.0, 1.0]];
            let sum = |row: &[f64; 4], u: [f64; 4]| -> f64 { row.iter().zip(u).map(|(c, u)| c * u / 6.0).sum() };
            let weights = Weights::cubic(u, 4.0);
            let back = Weights::from_the_end(u);
            for (k, row) in C.iter().enumerate() {
                prop_assert!((weights.value[k] - sum(row, [1.0, u, u * u, u * u * u])).abs() < 4e-16);
                prop_assert!((back[k] - (weights.value[k] - 1.0)).abs() < 4e-16);
                prop_assert!((weights.rate[k] / 4.0 - sum(row, [0.0, 1.0, 2.0 * u, 3.0 * u * u])).abs() < 1e-15);
                prop_assert!((weights.acceleration[k] / 16.0 - sum(row, [0.0, 0.0, 2.0, 6.0 * u])).abs() < 1e-15);
            }
        }

        /// Plain weights 1 − B₁, B₁ − B₂, B₂ − B₃, B₃ are never negative, and the same from the other end.
        #[test]
        fn they_part_one(u in 0.0..=1.0_f64) {
            let plain = |u| {
                let [a, b, c] = Weights::cubic(u, 1.0).value;
                [1.0 - a, a - b, b - c, c]
            };
            let (here, mut there) = (plain(u), plain(1.0 - u));
            there.reverse();
            for (a, b) in here.into_iter().zip(there) {
                prop_assert!(a >= -1e-16 && (a - b).abs() < 4e-16);
            }
        }
    }
}
