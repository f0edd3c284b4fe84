//! The cumulative cubic on SE(3) as the paper prints it, in 4×4 matrices: Lovegrove, Patron-Perez & Sibley (2013), eqs.
//! (4) to (6), with plain arrays in double precision. What splines are measured beside.

use imu_core::se3::{self, Pose};

/// A matrix, row by row.
pub type M4 = [[f64; 4]; 4];

/// Row by row, as vector instructions like it.
fn times(a: &M4, b: &M4) -> M4 {
    a.map(|row| {
        let mut sums = [0.0; 4];
        for (x, other) in row.iter().zip(b) {
            for (sum, y) in sums.iter_mut().zip(other) {
                *sum += x * y;
            }
        }
        sums
    })
}

fn scaled(a: &M4, factor: f64) -> M4 {
    a.map(|row| row.map(|x| x * factor))
}

fn sum(all: &[M4]) -> M4 {
    let mut total = [[0.0; 4]; 4];
    for m in all {
        for (row, more) in total.iter_mut().zip(m) {
            row.iter_mut().zip(more).for_each(|(x, y)| *x += y);
        }
    }
    total
}

/// A rotation vector and what it moves by, as the matrix Ω^.
fn hat([x, y, z]: [f64; 3], [a, b, c]: [f64; 3]) -> M4 {
    [[0.0, -z, y, a], [z, 0.0, -x, b], [-y, x, 0.0, c], [0.0; 4]]
}

/// exp of Ω^ by Rodrigues' formula, (1 − cos)/θ² and (θ − sin)/θ³.
fn exp(omega: &M4) -> M4 {
    let (x, y, z) = (omega[2][1], omega[0][2], omega[1][0]);
    let square = x * x + y * y + z * z;
    let angle = square.sqrt();
    let (a, b, c) = if angle < 1e-6 {
        (1.0, 0.5, 1.0 / 6.0)
    } else {
        let (sin, cos) = angle.sin_cos();
        (sin / angle, (1.0 - cos) / square, (angle - sin) / (square * angle))
    };
    let twice = times(omega, omega);
    let mut result = sum(&[scaled(omega, a), scaled(&twice, b)]);
    let translation = [0, 1, 2].map(|r| {
        omega[r][3] + b * twice[r][3] + c * (0..3).map(|k| twice[r][k] * omega[k][3]).sum::<f64>()
    });
    for r in 0..3 {
        result[r][r] += 1.0;
        result[r][3] = translation[r];
    }
    result[3] = [0.0, 0.0, 0.0, 1.0];
    result
}

/// log of T₀⁻¹T₁ as Ω^, by the trace.
#[must_use]
pub fn log_between(from: &M4, to: &M4) -> M4 {
    let mut inverse = [[0.0; 4]; 4];
    for r in 0..3 {
        for c in 0..3 {
            inverse[r][c] = from[c][r];
        }
        inverse[r][3] = -(0..3).map(|k| from[k][r] * from[k][3]).sum::<f64>();
    }
    inverse[3][3] = 1.0;
    let t = times(&inverse, to);
    let cos = (0.5 * (t[0][0] + t[1][1] + t[2][2] - 1.0)).clamp(-1.0, 1.0);
    let angle = cos.acos();
    let (half, e) = if angle < 1e-6 {
        (0.5, 1.0 / 12.0)
    } else {
        let sin = angle.sin();
        let half = 0.5 * angle / sin;
        (half, (1.0 - half * (1.0 + cos)) / (angle * angle))
    };
    let w = [t[2][1] - t[1][2], t[0][2] - t[2][0], t[1][0] - t[0][1]].map(|x| x * half);
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let p = [t[0][3], t[1][3], t[2][3]];
    let once = cross(w, p);
    let twice = cross(w, once);
    hat(w, [0, 1, 2].map(|k| p[k] - 0.5 * once[k] + e * twice[k]))
}

/// T, Ṫ and T̈ between control points, with `rate` of them a second.
#[inline(always)]
#[must_use]
pub fn evaluated(base: &M4, omegas: [&M4; 3], u: f64, rate: f64) -> [M4; 3] {
    let value = [
        (5.0 + 3.0 * u - 3.0 * u * u + u * u * u) / 6.0,
        (1.0 + 3.0 * u + 3.0 * u * u - 2.0 * u * u * u) / 6.0,
        u * u * u / 6.0,
    ];
    let first = [
        (3.0 - 6.0 * u + 3.0 * u * u) / 6.0 * rate,
        (3.0 + 6.0 * u - 6.0 * u * u) / 6.0 * rate,
        0.5 * u * u * rate,
    ];
    let second = [(u - 1.0) * rate * rate, (1.0 - 2.0 * u) * rate * rate, u * rate * rate];
    let factor = |k: usize| {
        let a = exp(&scaled(omegas[k], value[k]));
        let turned = times(&a, omegas[k]);
        let a1 = scaled(&turned, first[k]);
        let a2 = sum(&[scaled(&times(&a1, omegas[k]), first[k]), scaled(&turned, second[k])]);
        [a, a1, a2]
    };
    let ([a, a1, a2], [b, b1, b2], [c, c1, c2]) = (factor(0), factor(1), factor(2));
    let (ab, a1b, ab1, bc) = (times(&a, &b), times(&a1, &b), times(&a, &b1), times(&b, &c));
    let t = times(&ab, &c);
    let t1 = sum(&[times(&a1, &bc), times(&ab1, &c), times(&ab, &c1)]);
    let mixed = sum(&[times(&times(&a1, &b1), &c), times(&a1b, &c1), times(&ab1, &c1)]);
    let t2 =
        sum(&[times(&a2, &bc), times(&times(&a, &b2), &c), times(&ab, &c2), scaled(&mixed, 2.0)]);
    [times(base, &t), times(base, &t1), times(base, &t2)]
}

/// A pose as a matrix.
#[must_use]
pub fn homogeneous(pose: &Pose<f64>) -> M4 {
    let mut m = [[0.0, 0.0, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0, 0.0, 0.0, 1.0]];
    let rotation = se3::adjoint(pose).diagonal;
    for r in 0..3 {
        for c in 0..3 {
            m[r][c] = rotation[(r, c)];
        }
        m[r][3] = pose.translation()[r];
    }
    m
}
