//! Evaluations of splines, cached and not, in `f64` and `f32`; beside the 4×4 matrices of the paper, Lovegrove,
//! Patron-Perez & Sibley (2013), eqs. (4) to (6), written here in double precision with plain arrays.
//!
//! `cargo bench -p imu-benches --bench spline`: times are of one evaluation. The matrix form comes first and last, so
//! that a machine that grew slower in between shows.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use imu_core::Real;
use imu_core::nalgebra::Vector3;
use imu_core::se3::{self, Pose};
use imu_core::spline::{
    Knot, ScrewKnot, Se3Spline, SplitSpline, SymmetricSplitSpline, cache, cache_screws,
};
use imu_core::trajectory::{Ellipse, Motion, Trajectory};
use std::hint::black_box;

/// 100 control poses a second, for 20 s.
const STEP_NS: u32 = 10_000_000;
const COUNT: i64 = 2000;
/// Evaluations of one pass.
const QUESTIONS: i64 = 4096;

fn poses() -> Vec<Pose<f64>> {
    let at = |k: i64| -> Motion<f64> { Ellipse::default().at(k * i64::from(STEP_NS)) };
    let pose = |m: Motion<f64>| Pose::new(m.attitude_wb, m.position_w).expect("a pose");
    (0..COUNT).map(|k| pose(at(k))).collect()
}

/// Instants all over the curve, in order, as a simulator asks.
fn instants() -> Vec<i64> {
    let length = (COUNT - 3) * i64::from(STEP_NS);
    (0..QUESTIONS).map(|k| i64::from(STEP_NS) + k * (length / QUESTIONS)).collect()
}

type M4 = [[f64; 4]; 4];

fn times(a: &M4, b: &M4) -> M4 {
    a.map(|row| [0, 1, 2, 3].map(|c| (0..4).map(|k| row[k] * b[k][c]).sum()))
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
fn log_between(from: &M4, to: &M4) -> M4 {
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

/// T, Ṫ and T̈.
#[inline(always)]
fn paper(base: &M4, omegas: [&M4; 3], u: f64, rate: f64) -> [M4; 3] {
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

fn homogeneous(pose: &Pose<f64>) -> M4 {
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

fn matrices(c: &mut Criterion) {
    let poses: Vec<M4> = poses().iter().map(homogeneous).collect();
    let logs: Vec<M4> = poses.windows(2).map(|w| log_between(&w[0], &w[1])).collect();
    let (step, rate) = (i64::from(STEP_NS), 1e9 / f64::from(STEP_NS));
    let place = |t: i64| ((t / step) as usize, (t % step) as f64 / step as f64);
    check(&poses, &logs);
    ask(c, "full, 4×4 matrices, cached, f64", |t| {
        let (i, u) = place(t);
        paper(&poses[i - 1], [&logs[i - 1], &logs[i], &logs[i + 1]], u, rate)
    });
    ask(c, "full, 4×4 matrices, uncached, f64", |t| {
        let (i, u) = place(t);
        let log = |k: usize| log_between(&poses[k], &poses[k + 1]);
        paper(&poses[i - 1], [&log(i - 1), &log(i), &log(i + 1)], u, rate)
    });
}

/// The peer computes the same curve.
fn check(matrices: &[M4], logs: &[M4]) {
    let poses = poses();
    let curve = Se3Spline::new(0, STEP_NS, &poses).expect("a curve");
    let full = curve.full(i64::from(STEP_NS) * 5 + 2_500_000).expect("inside");
    let [t, t1, t2] = paper(&matrices[4], [&logs[4], &logs[5], &logs[6]], 0.25, 100.0);
    for k in 0..3 {
        assert!((t[k][3] - full.pose.translation()[k]).abs() < 1e-12);
        assert!((t1[k][3] - full.velocity_w[k]).abs() < 1e-9);
        assert!((t2[k][3] - full.acceleration_w[k]).abs() < 1e-6);
    }
}

fn ask<R>(c: &mut Criterion, name: &str, question: impl Fn(i64) -> R) {
    let instants = instants();
    let mut group = c.benchmark_group("spline");
    group.throughput(Throughput::Elements(instants.len() as u64));
    group.bench_function(name, |b| {
        b.iter(|| {
            for t in black_box(&instants) {
                black_box(question(*t));
            }
        });
    });
    group.finish();
}

fn all<T: Real>(c: &mut Criterion, scalar: &str) {
    let double = poses();
    let poses: Vec<Pose<T>> = double.iter().map(Pose::cast).collect();
    let mut knots = vec![Knot::<T>::default(); double.len()];
    let mut screws = vec![ScrewKnot::<T>::default(); double.len()];
    cache(&double, &mut knots).expect("neighbours");
    cache_screws(&double, &mut screws).expect("neighbours");
    let gravity = Vector3::from([0.0, 0.0, -9.81].map(T::from_f64));
    macro_rules! every {
        ($what:literal, $curve:expr) => {
            let curve = $curve.expect("a curve");
            let name = |question: &str| format!("{question}, {}, {scalar}", $what);
            ask(c, &name("pose"), |t| curve.pose(t));
            ask(c, &name("pose and velocity"), |t| curve.pose_and_velocity(t));
            ask(c, &name("full"), |t| curve.full(t));
            ask(c, &name("IMU"), |t| curve.imu(t, &gravity));
        };
    }
    every!("split, cached", SplitSpline::new(0, STEP_NS, &knots));
    every!("split, uncached", SplitSpline::new(0, STEP_NS, &poses));
    every!("symmetric, cached", SymmetricSplitSpline::new(0, STEP_NS, &knots));
    every!("symmetric, uncached", SymmetricSplitSpline::new(0, STEP_NS, &poses));
    every!("SE(3), cached", Se3Spline::new(0, STEP_NS, &screws));
    every!("SE(3), uncached", Se3Spline::new(0, STEP_NS, &poses));
}

fn evaluations(c: &mut Criterion) {
    matrices(c);
    all::<f64>(c, "f64");
    all::<f32>(c, "f32");
    matrices(c);
}

criterion_group!(benches, evaluations);
criterion_main!(benches);
