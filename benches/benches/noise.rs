//! Normal numbers, noise stages and the simulator. Baselines: the generator alone, and rand_distr's
//! normal on the same generator. `simulator/4h_200hz_6_axes` is one whole calibration record,
//! 2 880 000 samples of both sensors with white noise and random walk, in memory.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use imu_core::noise::{
    Axis, Channel, Normal, RandomWalk, Sensor, Stage, Term, ThreeAxis, White, Xoshiro128PlusPlus,
    Xoshiro256PlusPlus,
};
use imu_tools::recording::Block;
use imu_tools::scene::{Path, Preset, Simulator};
use rand_core::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};

const N: usize = 4096;

fn normals(c: &mut Criterion) {
    let mut group = c.benchmark_group("normal");
    group.throughput(Throughput::Elements(N as u64));
    let mut narrow = Xoshiro128PlusPlus::seed_from_u64(7);
    let mut wide = Xoshiro256PlusPlus::seed_from_u64(7);
    group.bench_function("baseline_words_u32", |b| {
        b.iter(|| (0..N).fold(0, |sum: u32, _| sum.wrapping_add(narrow.next_u32())));
    });
    group.bench_function("baseline_words_u64", |b| {
        b.iter(|| (0..N).fold(0, |sum: u64, _| sum.wrapping_add(wide.next_u64())));
    });
    group.bench_function("f32", |b| {
        b.iter(|| (0..N).map(|_| f32::standard_normal(&mut narrow)).sum::<f32>());
    });
    group.bench_function("f64", |b| {
        b.iter(|| (0..N).map(|_| f64::standard_normal(&mut wide)).sum::<f64>());
    });
    group.bench_function("rand_distr_f32", |b| {
        b.iter(|| (0..N).map(|_| -> f32 { StandardNormal.sample(&mut narrow) }).sum::<f32>());
    });
    group.bench_function("rand_distr_f64", |b| {
        b.iter(|| (0..N).map(|_| -> f64 { StandardNormal.sample(&mut wide) }).sum::<f64>());
    });
    group.finish();
}

fn stages<T: Normal>(c: &mut Criterion, scalar: &str) {
    let [n, k, dt] = [0.015, 5e-5, 0.005].map(T::from_f64);
    let (white, walk) = (White { noise_density: n }, RandomWalk { random_walk: k });
    let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
    let mut group = c.benchmark_group("stage");
    group.throughput(Throughput::Elements(N as u64));
    let mut values = vec![T::ZERO; N];

    let mut stage = white.prepare(dt, x).expect("valid");
    group.bench_function(BenchmarkId::new("white_apply", scalar), |b| {
        b.iter(|| stage.apply(black_box(&mut values)));
    });
    let mut stage = walk.prepare(dt, x).expect("valid");
    group.bench_function(BenchmarkId::new("random_walk_apply", scalar), |b| {
        b.iter(|| stage.apply(black_box(&mut values)));
    });
    let mut stage = (white, walk).prepare(dt, x).expect("valid");
    group.bench_function(BenchmarkId::new("both_apply", scalar), |b| {
        b.iter(|| stage.apply(black_box(&mut values)));
    });
    group.bench_function(BenchmarkId::new("both_step", scalar), |b| {
        b.iter(|| black_box(&mut values).iter_mut().for_each(|value| *value = stage.step(*value)));
    });
    let mut sensor =
        ThreeAxis::prepare([(white, walk); 3], dt, 7, Sensor::GYROSCOPE).expect("valid");
    let mut values = vec![[T::ZERO; 3]; N];
    group.throughput(Throughput::Elements(3 * N as u64));
    group.bench_function(BenchmarkId::new("three_axes_both_step", scalar), |b| {
        b.iter(|| sensor.apply(black_box(&mut values)));
    });
    group.finish();
}

fn simulator(c: &mut Criterion) {
    let mut group = c.benchmark_group("simulator");
    let samples = 2_880_000;
    group.sample_size(10).throughput(Throughput::Elements(6 * samples));
    for (name, motion) in [("4h_200hz_6_axes", Path::Rest), ("4h_moving", Path::Ellipse)] {
        let scene = imu_tools::scene::Scene { motion, ..Preset::Mid.scene() };
        group.bench_function(name, |b| {
            b.iter(|| {
                let mut simulator = Simulator::new(&scene).expect("valid");
                let mut block = Block::default();
                let mut count = 0;
                while simulator.advance(&mut block) {
                    count += black_box(&block).gyroscope.len() as u64;
                }
                assert_eq!(count, samples);
            });
        });
    }
    group.finish();
}

fn f32_and_f64(c: &mut Criterion) {
    stages::<f32>(c, "f32");
    stages::<f64>(c, "f64");
}

criterion_group!(benches, normals, f32_and_f64, simulator);
criterion_main!(benches);
