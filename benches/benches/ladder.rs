//! The Allan ladder, beside the plainest thing that reads the same array: 24 running sums.
//!
//! `cargo bench -p imu-benches --bench ladder`: the whole contract (finite check, bound, reference,
//! accurate squares) on 6 × 22 octaves; times are per value (a sample of 6 axes is 6 values).

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use imu_core::Real;
use imu_core::allan::Ladder;
use std::hint::black_box;

const SAMPLES: usize = 1 << 16;

fn record<T: Real, const AXES: usize>() -> Vec<[T; AXES]> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    (0..SAMPLES)
        .map(|_| {
            [(); AXES].map(|()| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                T::from_f64((state >> 11) as f64 / (1_u64 << 53) as f64)
            })
        })
        .collect()
}

fn ladder<T: Real, const AXES: usize, const WINDOWS: usize, const ORDER: usize>(
    c: &mut Criterion,
    name: &str,
) {
    let rows = record::<T, AXES>();
    let mut group = c.benchmark_group("ladder");
    group.throughput(Throughput::Elements((SAMPLES * AXES) as u64));
    group.bench_function(format!("push/{name}"), |b| {
        let mut ladder = Ladder::<T, AXES, 22, WINDOWS, ORDER>::new();
        b.iter(|| {
            for row in black_box(&rows) {
                ladder.push(row);
            }
        });
        black_box(&ladder);
    });
    group.bench_function(format!("extend/{name}"), |b| {
        let mut ladder = Ladder::<T, AXES, 22, WINDOWS, ORDER>::new();
        b.iter(|| ladder.extend(black_box(&rows)));
        black_box(&ladder);
    });
}

fn baseline(c: &mut Criterion) {
    let rows = record::<f64, 6>();
    let flat = rows.as_flattened();
    let mut group = c.benchmark_group("ladder");
    group.throughput(Throughput::Elements(flat.len() as u64));
    group.bench_function("baseline: 24-lane sum", |b| {
        b.iter(|| {
            let mut lanes = [0.0; 24];
            for row in black_box(flat).chunks_exact(24) {
                for (lane, x) in lanes.iter_mut().zip(row) {
                    *lane += x;
                }
            }
            lanes
        });
    });
}

fn ladders(c: &mut Criterion) {
    ladder::<f64, 6, 1, 1>(c, "f64, 6 axes, disjoint");
    ladder::<f64, 6, 4, 1>(c, "f64, 6 axes, 4 windows");
    ladder::<f64, 6, 1, 2>(c, "f64, 6 axes, disjoint, Hadamard");
    ladder::<f64, 6, 4, 2>(c, "f64, 6 axes, 4 windows, Hadamard");
    ladder::<f32, 6, 1, 1>(c, "f32, 6 axes, disjoint");
    ladder::<f32, 6, 4, 1>(c, "f32, 6 axes, 4 windows");
    ladder::<f64, 3, 1, 1>(c, "f64, 3 axes, disjoint");
    ladder::<f64, 3, 4, 1>(c, "f64, 3 axes, 4 windows");
    ladder::<f64, 1, 1, 1>(c, "f64, 1 axis, disjoint");
    ladder::<f64, 1, 4, 1>(c, "f64, 1 axis, 4 windows");
}

criterion_group!(benches, baseline, ladders);
criterion_main!(benches);
