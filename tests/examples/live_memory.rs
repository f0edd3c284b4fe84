//! Memory and time of a live session over 10⁸ samples of both sensors, by what the system says of the process.
//!
//! `cargo run --release -p imu-tests --example live_memory` (Linux; a minute). A checkpoint is made at each line.

use std::time::Instant;

use imu_tools::calibrate::Options;
use imu_tools::live::link::Link;
use imu_tools::live::session::Session;
use imu_tools::recording::{Block, Sample};

/// Samples a block.
const BLOCK: i64 = 4000;

/// 8 kHz.
const PERIOD_NS: i64 = 125_000;

fn main() {
    let mut session = Session::new("it", &Options::default());
    let (mut block, mut state, mut number) = (Block::default(), 1_u64, 0_i64);
    println!("   samples  memory now  at most  checkpoint  view    CPU of one core at 8 kHz");
    let mut spent = 0.0;
    for power in [6, 7, 8] {
        while number < 10_i64.pow(power) {
            block.clear();
            for _ in 0..BLOCK {
                let stamp_ns = number * PERIOD_NS;
                block.gyroscope.push(Sample { stamp_ns, value: noise(&mut state) });
                block.accelerometer.push(Sample { stamp_ns, value: noise(&mut state) });
                number += 1;
            }
            let start = Instant::now();
            session.take(&mut block);
            spent += start.elapsed().as_secs_f64();
        }
        let kept = session.to_bytes(false).map_or(0, |bytes| bytes.len());
        let start = Instant::now();
        let view = session.view(&Link::default());
        let viewed = start.elapsed();
        assert!(view.samples[0] as i64 == number);
        println!(
            "{number:>10}  {:>7.1} MB  {:>4.1} MB  {:>7.1} MB  {:>3.0} ms  {:.2} %",
            status("VmRSS"),
            status("VmHWM"),
            kept as f64 * 1e-6,
            viewed.as_secs_f64() * 1e3,
            100.0 * spent / (number as f64 * PERIOD_NS as f64 * 1e-9)
        );
    }
}

/// About normal noise: the sum of bytes of a random word.
fn noise(state: &mut u64) -> [f64; 3] {
    [0, 1, 2].map(|_| {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        let sum: u32 = state.to_le_bytes().iter().map(|byte| u32::from(*byte)).sum();
        1e-4 * (f64::from(sum) - 1020.0)
    })
}

/// What the system says of this process, MB.
fn status(name: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.unwrap_or(f64::NAN) * 1e-3
}
