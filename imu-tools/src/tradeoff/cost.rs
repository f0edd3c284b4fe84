//! What an estimator costs: time for each value, time at the end, and memory.
//!
//! All take turns, and the fastest turn of each counts: on a machine with other work a mean measures the
//! others as well. What takes samples as they come is timed on an array that caches hold, beside a plain
//! sum of it; what needs a whole record, on a whole record.

use std::hint::black_box;
use std::mem::size_of;
use std::time::Instant;

use imu_core::allan::AllanLadder;

use super::estimators::{
    ESTIMATORS, Estimator, Gather, LEVELS, Method, Scalar, overlapping, read, sampling,
};
use crate::calibrate::block_means::BlockMeans;
use crate::calibrate::maximum_likelihood;

/// Samples of a pass, 0.4 MB.
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
    let octaves = overlapping(&column);
    let mut all_windows = f64::INFINITY;
    let mut ends = [f64::INFINITY; ESTIMATORS.len()];
    for _ in 0..PASSES_AT_END {
        all_windows = all_windows.min(seconds(|| {
            black_box(overlapping(black_box(&column)));
        }));
        for (end, estimator) in ends.iter_mut().zip(ESTIMATORS) {
            *end = end.min(match estimator.method {
                Method::MaximumLikelihood => {
                    let fit = || {
                        black_box(maximum_likelihood::fit(black_box(&whole), tau0_s, 0.0));
                    };
                    seconds(fit) / 3.0
                }
                method => seconds(|| {
                    black_box(read(
                        black_box(&octaves),
                        method,
                        sampling(estimator.gather, tau0_s),
                    ));
                }),
            });
        }
    }
    let costs = ESTIMATORS.iter().zip(ends).map(|(&Estimator { gather, scalar, .. }, end)| {
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
        Cost { ns_per_value, end_ms: end * 1e3, state_bytes }
    });
    Prices { sum_ns: sum, costs: costs.collect() }
}
