//! What an estimator costs: time for each value, time at the end, and memory.
//!
//! The passes of all are interleaved with those of a plain sum of the same array, and the fastest of each
//! counts: on a machine with other work a mean measures the others as well.

use std::hint::black_box;
use std::mem::size_of;
use std::time::Instant;

use imu_core::allan::AllanLadder;

use super::estimators::{
    ESTIMATORS, Estimator, Gather, LEVELS, Method, Scalar, overlapping, read, sampling,
};
use crate::calibrate::block_means::BlockMeans;
use crate::calibrate::maximum_likelihood;

/// Samples of a pass: they fit a second-level cache.
const SAMPLES: usize = 1 << 14;
/// Passes of those that take samples as they come, and of what is done once.
const PASSES: usize = 200;
const PASSES_AT_END: usize = 5;

/// The price of an estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Nanoseconds for each value of an axis, as they come.
    pub ns_per_value: f64,
    /// Milliseconds for each axis when a record ends.
    pub end_ms: f64,
    /// Memory for three axes, bytes.
    pub state_bytes: usize,
}

/// The prices of all.
pub(super) struct Prices {
    /// A plain sum, ns a value.
    pub(super) sum_ns: f64,
    pub(super) costs: Vec<Cost>,
}

/// Seconds that something takes.
fn seconds(run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64()
}

/// Times the estimators on a record, sampled every `tau0_s` seconds.
pub(super) fn measure(tau0_s: f64, record: &[[f64; 3]]) -> Prices {
    let pass = record.get(..SAMPLES).unwrap_or(record);
    let single: Vec<[f32; 3]> = pass.iter().map(|row| row.map(|x| x as f32)).collect();
    let column: Vec<f64> = record.iter().map(|row| row[0]).collect();
    let mut ladders = (
        AllanLadder::<f32, 3, LEVELS, 1>::new(),
        AllanLadder::<f64, 3, LEVELS, 1>::new(),
        AllanLadder::<f32, 3, LEVELS, 4>::new(),
        AllanLadder::<f64, 3, LEVELS, 4>::new(),
    );
    let mut means = BlockMeans::new();
    // Blocks are as long as they will be, most of the time.
    means.extend(record);
    let mut fastest = [f64::INFINITY; 6];
    for _ in 0..PASSES {
        let sum = || {
            let mut lanes = [0.0; 24];
            for values in black_box(pass).as_flattened().chunks_exact(24) {
                lanes.iter_mut().zip(values).for_each(|(lane, x)| *lane += x);
            }
            black_box(lanes);
        };
        let times = [
            seconds(sum),
            seconds(|| ladders.0.extend(black_box(&single))),
            seconds(|| ladders.1.extend(black_box(pass))),
            seconds(|| ladders.2.extend(black_box(&single))),
            seconds(|| ladders.3.extend(black_box(pass))),
            seconds(|| means.extend(black_box(pass))),
        ];
        fastest.iter_mut().zip(times).for_each(|(fastest, time)| *fastest = fastest.min(time));
    }
    let [sum, disjoint32, disjoint64, windows32, windows64, blocks] =
        fastest.map(|time| time * 1e9 / (3 * pass.len()) as f64);
    let mut whole = BlockMeans::new();
    whole.extend(record);
    let best_of =
        |run: &dyn Fn()| (0..PASSES_AT_END).map(|_| seconds(run)).fold(f64::INFINITY, f64::min);
    let octaves = overlapping(&column);
    let all_windows = best_of(&|| {
        black_box(overlapping(black_box(&column)));
    });
    let costs = ESTIMATORS.iter().map(|&Estimator { gather, scalar, method }| {
        let (ns_per_value, state_bytes) = match (gather, scalar) {
            (Gather::Disjoint, Scalar::F32) => (disjoint32, size_of_val(&ladders.0)),
            (Gather::Disjoint, Scalar::F64) => (disjoint64, size_of_val(&ladders.1)),
            (Gather::FourWindows, Scalar::F32) => (windows32, size_of_val(&ladders.2)),
            (Gather::FourWindows, Scalar::F64) => (windows64, size_of_val(&ladders.3)),
            // Two sums for every value.
            (Gather::Overlapping, _) => (
                all_windows * 1e9 / column.len() as f64,
                3 * 2 * size_of::<f64>() * (column.len() + 1),
            ),
            (Gather::BlockMeans, _) => (blocks, BlockMeans::LARGEST_BYTES),
        };
        let end = match method {
            Method::MaximumLikelihood => {
                best_of(&|| {
                    black_box(maximum_likelihood::fit(black_box(&whole), tau0_s, 0.0));
                }) / 3.0
            }
            Method::Fit | Method::Slope => best_of(&|| {
                black_box(read(black_box(&octaves), method, sampling(gather, tau0_s)));
            }),
        };
        Cost { ns_per_value, end_ms: end * 1e3, state_bytes }
    });
    Prices { sum_ns: sum, costs: costs.collect() }
}
