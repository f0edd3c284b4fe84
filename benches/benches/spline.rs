//! Evaluations of splines, cached and not, in `f64` and `f32`; beside the 4×4 matrices of the paper, Lovegrove,
//! Patron-Perez & Sibley (2013), in double precision.
//!
//! `cargo bench -p imu-benches --bench spline`: times are of one evaluation. The matrix form comes first and last, so
//! that a machine that grew slower in between shows.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use imu_benches::matrices::{M4, evaluated, homogeneous, log_between};
use imu_core::Real;
use imu_core::nalgebra::Vector3;
use imu_core::se3::Pose;
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

fn matrices(c: &mut Criterion) {
    let poses: Vec<_> = poses().iter().map(homogeneous).collect();
    let logs: Vec<_> = poses.windows(2).map(|w| log_between(&w[0], &w[1])).collect();
    let (step, rate) = (i64::from(STEP_NS), 1e9 / f64::from(STEP_NS));
    let place = |t: i64| ((t / step) as usize, (t % step) as f64 / step as f64);
    check(&poses, &logs);
    ask(c, "full, 4×4 matrices, cached, f64", |t| {
        let (i, u) = place(t);
        evaluated(&poses[i - 1], [&logs[i - 1], &logs[i], &logs[i + 1]], u, rate)
    });
    ask(c, "full, 4×4 matrices, uncached, f64", |t| {
        let (i, u) = place(t);
        let log = |k: usize| log_between(&poses[k], &poses[k + 1]);
        evaluated(&poses[i - 1], [&log(i - 1), &log(i), &log(i + 1)], u, rate)
    });
}

/// The peer computes the same curve.
fn check(matrices: &[M4], logs: &[M4]) {
    let poses = poses();
    let curve = Se3Spline::from_control_points(0, STEP_NS, &poses).expect("a curve");
    let full = curve.full(i64::from(STEP_NS) * 5 + 2_500_000).expect("inside");
    let [t, t1, t2] = evaluated(&matrices[4], [&logs[4], &logs[5], &logs[6]], 0.25, 100.0);
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
    every!("split, cached", SplitSpline::from_control_points(0, STEP_NS, &knots));
    every!("split, uncached", SplitSpline::from_control_points(0, STEP_NS, &poses));
    every!("symmetric, cached", SymmetricSplitSpline::from_control_points(0, STEP_NS, &knots));
    every!("symmetric, uncached", SymmetricSplitSpline::from_control_points(0, STEP_NS, &poses));
    every!("SE(3), cached", Se3Spline::from_control_points(0, STEP_NS, &screws));
    every!("SE(3), uncached", Se3Spline::from_control_points(0, STEP_NS, &poses));
}

fn evaluations(c: &mut Criterion) {
    matrices(c);
    all::<f64>(c, "f64");
    all::<f32>(c, "f32");
    matrices(c);
}

criterion_group!(benches, evaluations);
criterion_main!(benches);
