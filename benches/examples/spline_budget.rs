//! The price of a full evaluation of a spline beside its budgets:
//! `cargo run --release -p imu-benches --example spline_budget`.
//!
//! Pose, velocities and accelerations at 1024 instants of the classic ellipse, 100 control points a second: beside the
//! 4×4 matrices of the paper, with the logarithms worked out before in both, and in neither; single beside double
//! precision; the time-symmetric form beside the plain one. Each row without a budget is the baseline of those below.
//!
//! Exits with 1 if a budget is exceeded.

use imu_benches::contest::{Budget, Contender, decide};
use imu_benches::matrices::{evaluated, homogeneous, log_between};
use imu_core::Real;
use imu_core::se3::Pose;
use imu_core::spline::{
    Attitudes, Form, Knot, Positions, SplitCurve, SplitSpline, SymmetricSplitSpline, cache,
};
use imu_core::trajectory::{Ellipse, Motion, Trajectory};
use std::hint::black_box;
use std::process::ExitCode;

const STEP_NS: u32 = 10_000_000;
const COUNT: i64 = 2000;
const INSTANTS: i64 = 1024;
const ROUNDS: usize = 3000;

fn ask<T: Real, C: Attitudes<T> + Positions<T>, F: Form<T>>(
    curve: &SplitCurve<T, C, F>,
    instants: &[i64],
) {
    for &t in black_box(instants) {
        let _ = black_box(curve.full(t));
    }
}

fn main() -> ExitCode {
    let poses: Vec<Pose<f64>> = (0..COUNT)
        .map(|k| {
            let motion: Motion<f64> = Ellipse::default().at(k * i64::from(STEP_NS));
            Pose::new(motion.attitude_wb, motion.position_w).expect("a pose")
        })
        .collect();
    let mut double = vec![Knot::<f64>::default(); poses.len()];
    let mut single = vec![Knot::<f32>::default(); poses.len()];
    cache(&poses, &mut double).expect("neighbours");
    cache(&poses, &mut single).expect("neighbours");
    let cached = SplitSpline::from_control_points(0, STEP_NS, &double).expect("a curve");
    let cached_single = SplitSpline::from_control_points(0, STEP_NS, &single).expect("a curve");
    let uncached = SplitSpline::from_control_points(0, STEP_NS, &poses).expect("a curve");
    let symmetric =
        SymmetricSplitSpline::from_control_points(0, STEP_NS, &double).expect("a curve");
    let uncached_symmetric =
        SymmetricSplitSpline::from_control_points(0, STEP_NS, &poses).expect("a curve");

    let matrices: Vec<_> = poses.iter().map(homogeneous).collect();
    let logs: Vec<_> = matrices.windows(2).map(|two| log_between(&two[0], &two[1])).collect();
    let (step, rate) = (i64::from(STEP_NS), 1e9 / f64::from(STEP_NS));
    let place = |t: i64| ((t / step) as usize, (t % step) as f64 / step as f64);
    let length = (COUNT - 3) * step;
    let instants: Vec<_> = (0..INSTANTS).map(|k| step + k * (length / INSTANTS)).collect();

    let budget = |ratio| Budget { time: None, ratio };
    let contenders = vec![
        Contender::baseline("4×4 matrices, uncached", || {
            for &t in black_box(&instants) {
                let (i, u) = place(t);
                let log = |k: usize| log_between(&matrices[k], &matrices[k + 1]);
                let logs = [&log(i - 1), &log(i), &log(i + 1)];
                black_box(evaluated(&matrices[i - 1], logs, u, rate));
            }
        }),
        Contender::new("uncached", budget(1.0 / 2.2), || ask(&uncached, &instants)),
        Contender::baseline("uncached", || ask(&uncached, &instants)),
        Contender::new("symmetric, uncached", budget(2.6), || ask(&uncached_symmetric, &instants)),
        Contender::baseline("4×4 matrices, cached", || {
            for &t in black_box(&instants) {
                let (i, u) = place(t);
                let logs = [&logs[i - 1], &logs[i], &logs[i + 1]];
                black_box(evaluated(&matrices[i - 1], logs, u, rate));
            }
        }),
        Contender::new("cached", budget(1.0 / 3.0), || ask(&cached, &instants)),
        Contender::baseline("cached", || ask(&cached, &instants)),
        Contender::new("symmetric, cached", budget(2.6), || ask(&symmetric, &instants)),
        Contender::new("cached, f32", budget(0.75), || ask(&cached_single, &instants)),
    ];
    println!("ns an evaluation, of {ROUNDS} interleaved passes over {INSTANTS} instants");
    decide(contenders, ROUNDS, INSTANTS as usize)
}
