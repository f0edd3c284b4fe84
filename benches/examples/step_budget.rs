//! The price of a step beside its budget: `cargo run --release -p imu-benches --example step_budget`.
//!
//! From the sample to the moved state on a flat world, in `f64`: midpoint, coning and sculling, and three samples beside
//! a straightforward midpoint as VINS-Mono has it; passes over 4096 steps. Exits with 1 if a budget is exceeded.
//!
//! The baseline waits most of its time for one square root and one division, the rules here keep the processor busy:
//! where a neighbour on the same core takes half of that, ratios rise by a fifth. So run it on a machine at rest.

use imu_benches::contest::{Budget, Contender, decide};
use imu_benches::steps::{STEPS, at, run, samples, step, world};
use imu_benches::vins;
use imu_core::integrate::{ConingSculling, Midpoint, ThreeSample};
use std::hint::black_box;
use std::process::ExitCode;

const ROUNDS: usize = 10_000;

fn main() -> ExitCode {
    let arrays: Vec<_> = (0..=STEPS).map(at).collect();
    let samples = samples::<f64>();
    let (first, rest) = (&samples[0], &samples[1..]);
    let (dt, world) = (step(), world());
    let budget = |ratio| Budget { time: None, ratio };
    let contenders = vec![
        Contender::baseline("midpoint as VINS", || {
            let (dt, bias) = (black_box(1e-3), black_box([[0.0; 3]; 2]));
            black_box(vins::run(arrays[0], black_box(&arrays[1..]), dt, bias));
        }),
        Contender::new("midpoint", budget(1.1), || {
            black_box(run(Midpoint::new(first), black_box(rest), &dt, &world));
        }),
        Contender::new("coning and sculling", budget(1.1), || {
            black_box(run(ConingSculling::new(first), black_box(rest), &dt, &world));
        }),
        Contender::new("three samples", budget(1.6), || {
            black_box(run(ThreeSample::new(first), black_box(rest), &dt, &world));
        }),
    ];
    println!("ns a step, of {ROUNDS} interleaved passes over {STEPS} samples");
    decide(contenders, ROUNDS, STEPS)
}
