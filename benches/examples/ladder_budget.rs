//! The ladder's speed beside its budget: `cargo run --release -p imu-benches --example ladder_budget`.
//!
//! The whole contract (finite check, bound, reference, accurate squares) on 6 × 22 octaves of
//! `f64`, and a 24-lane sum of the same array as the baseline; passes over 2¹⁶ samples. Exits with 1
//! if a budget is exceeded.

use imu_benches::contest::{Budget, Contender, decide};
use imu_core::allan::Ladder;
use std::hint::black_box;
use std::process::ExitCode;

const SAMPLES: usize = 1 << 16;
const ROUNDS: usize = 3000;

fn record() -> Vec<[f64; 6]> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    (0..SAMPLES)
        .map(|_| {
            [(); 6].map(|()| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 11) as f64 / (1_u64 << 53) as f64
            })
        })
        .collect()
}

fn main() -> ExitCode {
    let rows = record();
    let rows = rows.as_slice();
    let mut disjoint = Ladder::<f64, 6, 22, 1, 1>::new();
    let mut windows = Ladder::<f64, 6, 22, 4, 1>::new();
    let mut pushed = Ladder::<f64, 6, 22, 1, 1>::new();
    let budget = |time, ratio| Budget { time: Some(time), ratio };
    let contenders = vec![
        Contender::baseline("24-lane sum", || {
            let mut lanes = [0.0; 24];
            for row in black_box(rows.as_flattened()).chunks_exact(24) {
                for (lane, x) in lanes.iter_mut().zip(row) {
                    *lane += x;
                }
            }
            black_box(lanes);
        }),
        Contender::new("extend, disjoint", budget(1.25, 4.5), || disjoint.extend(black_box(rows))),
        Contender::new("extend, 4 windows", budget(2.2, 8.0), || windows.extend(black_box(rows))),
        Contender::new("push, disjoint", budget(2.0, 7.0), || {
            for row in black_box(rows) {
                pushed.push(row);
            }
        }),
    ];
    println!("ns a value, of {ROUNDS} interleaved passes over {SAMPLES} samples of 6 axes");
    decide(contenders, ROUNDS, SAMPLES * 6)
}
