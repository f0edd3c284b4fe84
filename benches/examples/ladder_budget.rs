//! The ladder's speed beside its budget: `cargo run --release -p imu-benches --example ladder_budget`.
//!
//! The whole contract (finite check, bound, reference, accurate squares) on 6 × 22 octaves of
//! `f64`, and a 24-lane sum of the same array as the baseline. On a shared machine a mean measures
//! the neighbours as well, so the passes are interleaved, each over 2¹⁶ samples, and the fastest
//! pass of each counts, with the median beside it. Exits with 1 if a budget is exceeded.

use imu_core::allan::Ladder;
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

const SAMPLES: usize = 1 << 16;
const ROUNDS: usize = 3000;

/// What is measured, with its passes in ns a value.
struct Contender<'a> {
    name: &'static str,
    /// At most so many ns a value, and so many times the baseline.
    budget: Option<(f64, f64)>,
    pass: Box<dyn FnMut() + 'a>,
    times: Vec<f64>,
}

impl<'a> Contender<'a> {
    fn new(name: &'static str, budget: Option<(f64, f64)>, pass: impl FnMut() + 'a) -> Self {
        Self { name, budget, pass: Box::new(pass), times: Vec::with_capacity(ROUNDS) }
    }
}

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
    let mut contenders = [
        Contender::new("24-lane sum", None, || {
            let mut lanes = [0.0; 24];
            for row in black_box(rows.as_flattened()).chunks_exact(24) {
                for (lane, x) in lanes.iter_mut().zip(row) {
                    *lane += x;
                }
            }
            black_box(lanes);
        }),
        Contender::new("extend, disjoint", Some((1.25, 4.5)), || disjoint.extend(black_box(rows))),
        Contender::new("extend, 4 windows", Some((2.2, 8.0)), || windows.extend(black_box(rows))),
        Contender::new("push, disjoint", Some((2.0, 7.0)), || {
            for row in black_box(rows) {
                pushed.push(row);
            }
        }),
    ];
    for _ in 0..ROUNDS {
        for contender in &mut contenders {
            let start = Instant::now();
            (contender.pass)();
            let nanoseconds = start.elapsed().as_secs_f64() * 1e9;
            contender.times.push(nanoseconds / (SAMPLES * 6) as f64);
        }
    }

    println!("ns a value, of {ROUNDS} interleaved passes over {SAMPLES} samples of 6 axes");
    println!("{:18} {:>8} {:>6} {:>7} {:>6}  median", "", "fastest", "at most", "ratio", "at most");
    let mut met = true;
    let mut baseline = f64::NAN;
    for contender in &mut contenders {
        contender.times.sort_by(f64::total_cmp);
        let (fastest, median) = (contender.times[0], contender.times[ROUNDS / 2]);
        match contender.budget {
            None => {
                baseline = fastest;
                println!("{:18} {fastest:8.2} {:32.2}", contender.name, median);
            }
            Some((time, ratio)) => {
                println!(
                    "{:18} {fastest:8.2} {time:7.2} {:7.1} {ratio:7.1} {median:7.2}",
                    contender.name,
                    fastest / baseline,
                );
                met &= fastest <= time && fastest / baseline <= ratio;
            }
        }
    }
    if met { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
