//! What distance remains after the best rotation and translation of a trajectory onto the truth: the absolute
//! trajectory error, without a list of points.
//!
//! The rotation is that of Horn (1987), "Closed-form solution of absolute orientation using unit quaternions": the
//! eigenvector of the largest eigenvalue of a symmetric 4×4 matrix, here by Jacobi's method. It is that of Umeyama
//! (1991) without scale, which TUM's and evo's `ate` compute.
//!
//! Sums are kept of positions x and of errors d = x − y, not of the truth y, and what remains is summed as (R − I)x + d:
//! so an error of nanometres on a path of kilometres keeps its digits.

use imu_core::nalgebra::{Matrix3, Quaternion, Vector3};
use imu_core::so3;

/// Sums over pairs of positions.
#[derive(Clone, Debug)]
pub(super) struct Alignment {
    n: f64,
    /// The first position and error, from which all are counted.
    origin: Option<(Vector3<f64>, Vector3<f64>)>,
    x: Vector3<f64>,
    d: Vector3<f64>,
    xx: Matrix3<f64>,
    /// Σ x dᵀ
    xd: Matrix3<f64>,
    dd: f64,
}

impl Default for Alignment {
    fn default() -> Self {
        let (vector, matrix) = (Vector3::zeros(), Matrix3::zeros());
        Self { n: 0.0, origin: None, x: vector, d: vector, xx: matrix, xd: matrix, dd: 0.0 }
    }
}

impl Alignment {
    /// Takes a position and by how much it is off.
    pub(super) fn push(&mut self, position: &Vector3<f64>, off: &Vector3<f64>) {
        let (first, first_off) = self.origin.get_or_insert((*position, *off));
        let (x, d) = (position - *first, off - *first_off);
        self.n += 1.0;
        self.x += x;
        self.d += d;
        self.xx += x * x.transpose();
        self.xd += x * d.transpose();
        self.dd += d.dot(&d);
    }

    /// Root mean square of what remains, m.
    pub(super) fn rmse(&self) -> f64 {
        let about_mean = |sum: &Matrix3<f64>, a: &Vector3<f64>, b: &Vector3<f64>| {
            sum - a * b.transpose() / self.n
        };
        let xx = about_mean(&self.xx, &self.x, &self.x);
        let xd = about_mean(&self.xd, &self.x, &self.d);
        let dd = self.dd - self.d.dot(&self.d) / self.n;
        // R − I, column by column, without cancellation.
        let rotation = best(&xx, &xd);
        let axes = Matrix3::identity();
        let columns = [0, 1, 2].map(|k| so3::displacement(&rotation, &axes.column(k).into_owned()));
        let moved = Matrix3::from_columns(&columns);
        let turned = (moved * xx * moved.transpose()).trace();
        let rest = turned + 2.0 * (moved * xd).trace() + dd;
        (rest.max(0.0) / self.n).sqrt()
    }
}

/// The rotation of x that comes nearest to y = x − d, from the sums about their means.
fn best(xx: &Matrix3<f64>, xd: &Matrix3<f64>) -> Quaternion<f64> {
    // S = Σ x yᵀ; what is antisymmetric in it comes from d alone.
    let s = xx - xd;
    let odd = |i: usize, j: usize| xd[(j, i)] - xd[(i, j)];
    let even = |i: usize, j: usize| s[(i, j)] + s[(j, i)];
    let (x, y, z) = (s[(0, 0)], s[(1, 1)], s[(2, 2)]);
    let horn = [
        [x + y + z, odd(1, 2), odd(2, 0), odd(0, 1)],
        [odd(1, 2), x - y - z, even(0, 1), even(2, 0)],
        [odd(2, 0), even(0, 1), y - x - z, even(1, 2)],
        [odd(0, 1), even(2, 0), even(1, 2), z - x - y],
    ];
    let [w, i, j, k] = largest(horn);
    Quaternion::new(w, i, j, k)
}

/// The unit eigenvector of the largest eigenvalue of a symmetric matrix, by Jacobi's rotations (Golub & Van Loan (2013),
/// Matrix Computations, section 8.5); of equal eigenvalues the first.
fn largest(mut a: [[f64; 4]; 4]) -> [f64; 4] {
    /// A 4×4 matrix needs six.
    const SWEEPS: usize = 30;
    let mut vectors =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        let mut quiet = true;
        for p in 0..3 {
            for q in p + 1..4 {
                let off = a[p][q];
                if off.abs() <= f64::MIN_POSITIVE
                    || off.abs() <= 1e-2 * f64::EPSILON * a[p][p].abs().min(a[q][q].abs())
                {
                    continue;
                }
                quiet = false;
                let slope = (a[q][q] - a[p][p]) / (2.0 * off);
                let tan = slope.signum() / (slope.abs() + slope.hypot(1.0));
                let cos = 1.0 / tan.hypot(1.0);
                let sin = tan * cos;
                for row in &mut a {
                    (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
                }
                let (upper, lower) = (a[p], a[q]);
                a[p] = [0, 1, 2, 3].map(|k| cos * upper[k] - sin * lower[k]);
                a[q] = [0, 1, 2, 3].map(|k| sin * upper[k] + cos * lower[k]);
                for row in &mut vectors {
                    (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
                }
            }
        }
        if quiet {
            break;
        }
    }
    let mut first = 0;
    for k in 1..4 {
        if a[k][k] > a[first][first] {
            first = k;
        }
    }
    vectors.map(|row| row[first])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(i: u32) -> Vector3<f64> {
        let t = f64::from(i) * 0.1;
        Vector3::new(20.0 * t.cos() + 4e5, 15.0 * t.sin(), (3.0 * t).sin())
    }

    fn rmse(found: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> f64 {
        let mut alignment = Alignment::default();
        for y in (0..200).map(path) {
            let x = found(&y);
            alignment.push(&x, &(x - y));
        }
        alignment.rmse()
    }

    #[test]
    fn a_rigid_motion_leaves_nothing() {
        let turn = so3::exp(Vector3::new(0.5, -1.0, 2.0));
        // Squares of 40 m at most round to 2e-13 m² each; the root of some of these is what is left.
        assert!(rmse(|y| so3::rotate(&turn, y) + Vector3::new(1.0, 2.0, 3.0)) < 1e-5);
        assert!(rmse(|y| *y) == 0.0);
    }

    #[test]
    fn a_small_error_keeps_its_digits() {
        // Alternating by ± 1 µm up and down: no rigid motion takes it away, but for the one half in n of a shift.
        let mut alignment = Alignment::default();
        for i in 0..200 {
            let off = Vector3::new(0.0, 0.0, if i % 2 == 0 { 1e-6 } else { -1e-6 });
            let x = path(i);
            alignment.push(&x, &off);
        }
        assert!((alignment.rmse() / 1e-6 - 1.0).abs() < 1e-3, "{}", alignment.rmse());
    }

    #[test]
    fn where_nothing_moves_the_mean_is_taken_away() {
        let mut alignment = Alignment::default();
        for off in [1.0, 2.0, 3.0] {
            let off = Vector3::new(off, 0.0, 0.0);
            alignment.push(&off, &off);
        }
        assert!((alignment.rmse() - (2.0_f64 / 3.0).sqrt()).abs() < 1e-15);
    }
}
