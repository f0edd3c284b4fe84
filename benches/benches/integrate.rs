//! A step of every rule, from the sample to the moved state on a flat world, in `f64`, `f32` and `f32` compensated;
//! beside a straightforward midpoint, as VINS-Mono (Qin, Li & Shen, 2018) has it.
//!
//! `cargo bench -p imu-benches --bench integrate`: times are of 4096 steps. On a machine that others use as well, take
//! the ratios of `--example step_budget`: those here are of means.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use imu_benches::steps::{STEPS, at, begin, run, samples, step, vector, world};
use imu_benches::vins::{self, V3};
use imu_core::integrate::{
    ConingSculling, Euler, Halves, Midpoint, PreviousIncrement, Rule, TextbookEuler,
    TextbookMidpoint, ThreeSample, TwoSample,
};
use imu_core::sample::Increment;
use imu_core::time::Step;
use imu_core::world::Flat;
use imu_core::{Compensated, Real, State};
use std::hint::black_box;

fn increments<T: Real>() -> Vec<Increment<T>> {
    let dt = step();
    let mean = |[rate, force]: [[f64; 3]; 2]| {
        Increment::from_means(vector(rate), vector(force), &dt).expect("finite")
    };
    (0..STEPS).map(|k| mean(at(k))).collect()
}

fn as_vins(c: &mut Criterion) {
    let inputs: Vec<[V3; 2]> = (0..=STEPS).map(at).collect();
    let mut group = c.benchmark_group("step");
    group.throughput(Throughput::Elements(STEPS as u64));
    group.bench_function("midpoint as VINS, f64", |b| {
        let (first, rest) = (inputs[0], &inputs[1..]);
        b.iter(|| vins::run(first, black_box(rest), black_box(1e-3), black_box([[0.0; 3]; 2])));
    });
    group.finish();
}

fn plain<T: Real, R: Rule<T> + Clone>(
    c: &mut Criterion,
    name: &str,
    rule: &R,
    inputs: &[R::Input],
) {
    let (dt, world) = (step(), world());
    let mut group = c.benchmark_group("step");
    group.throughput(Throughput::Elements(inputs.len() as u64));
    group.bench_function(name, |b| {
        b.iter(|| run(rule.clone(), black_box(inputs), &dt, &world));
    });
    group.finish();
}

fn compensated<R: Rule<f32> + Clone>(c: &mut Criterion, name: &str, rule: &R, inputs: &[R::Input]) {
    let (dt, world) = (step(), world());
    let mut group = c.benchmark_group("step");
    group.throughput(Throughput::Elements(inputs.len() as u64));
    group.bench_function(name, |b| {
        b.iter(|| compensated_run(rule.clone(), black_box(inputs), &dt, &world));
    });
    group.finish();
}

#[inline(never)]
fn compensated_run<R: Rule<f32>>(
    mut rule: R,
    inputs: &[R::Input],
    dt: &Step<f32>,
    world: &Flat<f32>,
) -> State<f32> {
    let mut state = Compensated::from(begin());
    for input in inputs {
        state.advance(&mut rule, input, dt, world);
    }
    state.state()
}

fn all<T: Real>(c: &mut Criterion, scalar: &str) {
    let (samples, increments) = (samples::<T>(), increments::<T>());
    let (first, rest) = (&samples[0], &samples[1..]);
    let (pairs, _) = increments.as_chunks();
    let pairs: Vec<_> = pairs.iter().map(|&[first, second]| Halves { first, second }).collect();
    let name = |rule: &str| format!("{rule}, {scalar}");
    plain::<T, _>(c, &name("Euler"), &Euler, rest);
    plain::<T, _>(c, &name("midpoint"), &Midpoint::new(first), rest);
    plain::<T, _>(c, &name("coning and sculling"), &ConingSculling::new(first), rest);
    plain::<T, _>(c, &name("three samples"), &ThreeSample::new(first), rest);
    plain::<T, _>(c, &name("previous increment"), &PreviousIncrement::new(), &increments);
    plain::<T, _>(c, &name("two increments"), &TwoSample, &pairs);
    plain::<T, _>(c, &name("textbook Euler"), &TextbookEuler, rest);
    plain::<T, _>(c, &name("textbook midpoint"), &TextbookMidpoint::new(first), rest);
}

fn steps(c: &mut Criterion) {
    as_vins(c);
    all::<f64>(c, "f64");
    all::<f32>(c, "f32");
    let samples = samples::<f32>();
    let (first, rest) = (&samples[0], &samples[1..]);
    compensated(c, "midpoint, f32 compensated", &Midpoint::new(first), rest);
    compensated(c, "coning and sculling, f32 compensated", &ConingSculling::new(first), rest);
    compensated(c, "three samples, f32 compensated", &ThreeSample::new(first), rest);
    // Once more, so that a machine that grew slower in between shows.
    as_vins(c);
}

criterion_group!(benches, steps);
criterion_main!(benches);
