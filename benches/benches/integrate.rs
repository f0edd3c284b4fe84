//! A step of every rule, from the sample to the moved state on a flat world, in `f64`, `f32` and `f32` compensated;
//! beside a straightforward midpoint, as VINS-Mono (Qin, Li & Shen, 2018) has it, written here with plain arrays.
//!
//! `cargo bench -p imu-benches --bench integrate`: times are of one step.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use imu_core::integrate::{
    ConingSculling, Euler, Halves, Midpoint, PreviousIncrement, Rule, TextbookEuler,
    TextbookMidpoint, ThreeSample, TwoSample,
};
use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::sample::{Increment, Sample};
use imu_core::time::Step;
use imu_core::world::Flat;
use imu_core::{Compensated, Real, State};
use std::hint::black_box;

const STEPS: usize = 4096;

fn at(k: usize) -> [[f64; 3]; 2] {
    let t = k as f64 / 1000.0;
    let rate = [1.2 * (9.0 * t).cos(), -0.8 * (3.0 * t).sin(), 1.5];
    [rate, [4.0 * (3.0 * t).sin(), 2.0, 9.81 + (9.0 * t).cos()]]
}

fn vector<T: Real>(v: [f64; 3]) -> Vector3<T> {
    Vector3::from(v.map(T::from_f64))
}

fn samples<T: Real>() -> Vec<Sample<T>> {
    let sample = |[rate, force]: [[f64; 3]; 2]| Sample::new(vector(rate), vector(force));
    (0..=STEPS).map(|k| sample(at(k)).expect("finite")).collect()
}

fn increments<T: Real>() -> Vec<Increment<T>> {
    let dt = step();
    let mean = |[rate, force]: [[f64; 3]; 2]| {
        Increment::from_means(vector(rate), vector(force), &dt).expect("finite")
    };
    (0..STEPS).map(|k| mean(at(k))).collect()
}

fn step<T: Real>() -> Step<T> {
    Step::from_nanoseconds(1_000_000).expect("a millisecond")
}

fn begin<T: Real>() -> State<T> {
    let q = [1.0, 0.0, 0.0, 0.0].map(T::from_f64);
    let zero = vector([0.0; 3]);
    State::new(Quaternion::new(q[0], q[1], q[2], q[3]), zero, zero).expect("finite")
}

type V3 = [f64; 3];
type Q = [f64; 4];

fn product(a: Q, b: Q) -> Q {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

fn rotate(q: Q, v: V3) -> V3 {
    let cross = |a: V3, b: V3| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let u = [q[1], q[2], q[3]];
    let t = cross(u, v).map(|x| 2.0 * x);
    let w = cross(u, t);
    [0, 1, 2].map(|k| v[k] + q[0] * t[k] + w[k])
}

/// Attitude, velocity, position; the sample before; biases.
struct Vins {
    q: Q,
    v: V3,
    p: V3,
    before: [V3; 2],
    bias: [V3; 2],
}

impl Vins {
    /// un_acc_0 = R(a₀ − b_a) − g, un_gyr = ½(ω₀ + ω₁) − b_g, q ← q (1, ½ un_gyr dt) normalised, and so on.
    fn step(&mut self, [rate, force]: [V3; 2], dt: f64) {
        const G: V3 = [0.0, 0.0, 9.81];
        let Self { q, v, p, before, bias } = self;
        let less = |a: V3, b: V3| [0, 1, 2].map(|k| a[k] - b[k]);
        let first = less(rotate(*q, less(before[1], bias[1])), G);
        let mean = [0, 1, 2].map(|k| 0.5 * (before[0][k] + rate[k]) - bias[0][k]);
        let turned = product(*q, [1.0, mean[0] * dt / 2.0, mean[1] * dt / 2.0, mean[2] * dt / 2.0]);
        let length = turned.iter().map(|x| x * x).sum::<f64>().sqrt();
        *q = turned.map(|x| x / length);
        let second = less(rotate(*q, less(force, bias[1])), G);
        let felt = [0, 1, 2].map(|k| 0.5 * (first[k] + second[k]));
        *p = [0, 1, 2].map(|k| p[k] + dt * v[k] + 0.5 * dt * dt * felt[k]);
        *v = [0, 1, 2].map(|k| v[k] + dt * felt[k]);
        *before = [rate, force];
    }
}

fn vins(c: &mut Criterion) {
    let inputs: Vec<[V3; 2]> = (0..=STEPS).map(at).collect();
    let mut group = c.benchmark_group("step");
    group.throughput(Throughput::Elements(STEPS as u64));
    group.bench_function("midpoint as VINS, f64", |b| {
        b.iter(|| {
            let mut state = Vins {
                q: [1.0, 0.0, 0.0, 0.0],
                v: [0.0; 3],
                p: [0.0; 3],
                before: inputs[0],
                bias: black_box([[0.0; 3]; 2]),
            };
            let dt = black_box(1e-3);
            for input in black_box(&inputs[1..]) {
                state.step(*input, dt);
            }
            black_box((state.q, state.v, state.p))
        });
    });
    group.finish();
}

fn plain<T: Real, R: Rule<T> + Clone>(
    c: &mut Criterion,
    name: &str,
    rule: &R,
    inputs: &[R::Input],
) {
    let (dt, world) = (step(), Flat::new(vector([0.0, 0.0, -9.81])).expect("finite"));
    let mut group = c.benchmark_group("step");
    group.throughput(Throughput::Elements(inputs.len() as u64));
    group.bench_function(name, |b| {
        b.iter(|| {
            let (mut state, mut rule) = (begin::<T>(), rule.clone());
            for input in black_box(inputs) {
                state.advance(&mut rule, input, &dt, &world);
            }
            state
        });
    });
    group.finish();
}

fn compensated<R: Rule<f32> + Clone>(c: &mut Criterion, name: &str, rule: &R, inputs: &[R::Input]) {
    let (dt, world) = (step(), Flat::new(vector([0.0, 0.0, -9.81])).expect("finite"));
    let mut group = c.benchmark_group("step");
    group.throughput(Throughput::Elements(inputs.len() as u64));
    group.bench_function(name, |b| {
        b.iter(|| {
            let (mut state, mut rule) = (Compensated::from(begin::<f32>()), rule.clone());
            for input in black_box(inputs) {
                state.advance(&mut rule, input, &dt, &world);
            }
            state
        });
    });
    group.finish();
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
    vins(c);
    all::<f64>(c, "f64");
    all::<f32>(c, "f32");
    let samples = samples::<f32>();
    let (first, rest) = (&samples[0], &samples[1..]);
    compensated(c, "midpoint, f32 compensated", &Midpoint::new(first), rest);
    compensated(c, "coning and sculling, f32 compensated", &ConingSculling::new(first), rest);
    compensated(c, "three samples, f32 compensated", &ThreeSample::new(first), rest);
    // Once more, so that a machine that grew slower in between shows.
    vins(c);
}

criterion_group!(benches, steps);
criterion_main!(benches);
