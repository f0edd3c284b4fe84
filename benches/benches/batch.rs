//! The exact batch estimator: preparing an hour of one axis at 200 Hz, and reading all its octaves,
//! with every overlapping window or disjoint blocks. Baseline: adding up the same values.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use imu_core::allan::Difference::{Allan, Hadamard};
use imu_tools::calibrate::batch::Batch;

fn record() -> Vec<f64> {
    let mut n = 1_234_567_890_u64;
    (0..3600 * 200)
        .map(|_| {
            n = 16_807 * n % 2_147_483_647;
            9.81 + 1e-2 * (n as f64 / 2_147_483_647.0 - 0.5)
        })
        .collect()
}

fn batch(c: &mut Criterion) {
    let values = record();
    let prepared = Batch::new(&values).expect("values are finite");
    let mut group = c.benchmark_group("batch");
    group.sample_size(20).throughput(Throughput::Elements(values.len() as u64));
    group.bench_function("baseline_sum", |b| b.iter(|| black_box(&values).iter().sum::<f64>()));
    group.bench_function("new", |b| b.iter(|| Batch::new(black_box(&values))));
    for (name, difference) in [("allan", Allan), ("hadamard", Hadamard)] {
        for overlapped in [false, true] {
            let windows = if overlapped { "overlapped" } else { "disjoint" };
            group.bench_function(BenchmarkId::new(format!("{name}_octaves"), windows), |b| {
                b.iter(|| {
                    prepared
                        .octaves(difference)
                        .filter_map(|m| {
                            let stride = if overlapped { 1 } else { m };
                            prepared.reading(difference, m, stride)
                        })
                        .map(|reading| reading.variance)
                        .sum::<f64>()
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, batch);
criterion_main!(benches);
