//! A symmetric positive definite matrix of seven diagonals, factored once and solved for many right-hand sides: what
//! fitting a cubic spline comes to.

use imu_core::nalgebra::Vector3;

/// Diagonals beside the main one: each control point shares intervals with the three before it.
const BAND: usize = 3;

/// The lower half: entry `[row][k]` is in column `row − k`. After [`factor`](Banded::factor) Cholesky's L.
pub(super) struct Banded {
    rows: Vec<[f64; BAND + 1]>,
}

impl Banded {
    pub(super) fn zero(size: usize) -> Self {
        Self { rows: vec![[0.0; BAND + 1]; size] }
    }

    /// Adds weight·vᵀv, where `v` begins in column `first`.
    pub(super) fn add(&mut self, first: usize, v: &[f64; BAND + 1], weight: f64) {
        let rows = self.rows.get_mut(first..).unwrap_or_default();
        for (i, (row, a)) in rows.iter_mut().zip(v).enumerate() {
            for (entry, b) in row.iter_mut().zip(v[..=i].iter().rev()) {
                *entry += weight * a * b;
            }
        }
    }

    /// Cholesky's factor in place; `None` where the matrix is not positive definite.
    pub(super) fn factor(mut self) -> Option<Factor> {
        for row in 0..self.rows.len() {
            let (done, rest) = self.rows.split_at_mut(row);
            let current = &mut rest[0];
            for k in (1..=BAND.min(row)).rev() {
                let other = &done[row - k];
                let sum: f64 = (1..=BAND - k).map(|j| current[k + j] * other[j]).sum();
                current[k] = (current[k] - sum) / other[0];
            }
            let square: f64 = current[1..].iter().map(|x| x * x).sum();
            let pivot = current[0] - square;
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            current[0] = pivot.sqrt();
        }
        Some(Factor { rows: self.rows })
    }
}

/// Cholesky's L, of which the matrix is LLᵀ.
pub(super) struct Factor {
    rows: Vec<[f64; BAND + 1]>,
}

impl Factor {
    /// Solves for one vector a row, in place.
    pub(super) fn solve(&self, values: &mut [Vector3<f64>]) {
        for row in 0..self.rows.len().min(values.len()) {
            let sum = (1..=BAND.min(row))
                .fold(Vector3::zeros(), |sum, k| sum + values[row - k] * self.rows[row][k]);
            values[row] = (values[row] - sum) / self.rows[row][0];
        }
        for row in (0..self.rows.len().min(values.len())).rev() {
            let below = (self.rows.len() - 1 - row).min(BAND);
            let sum = (1..=below)
                .fold(Vector3::zeros(), |sum, k| sum + values[row + k] * self.rows[row + k][k]);
            values[row] = (values[row] - sum) / self.rows[row][0];
        }
    }
}
