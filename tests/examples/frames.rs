//! Frames of every protocol over a bad line, in full: `cargo run --release -p imu-tests --example frames
//! [FRAMES]`, a million of each where nothing is said.

use imu_tests::frames::{Outcome, bad_line};
use imu_tools::live::protocol::Protocol;

/// Frames that are held in memory.
const BATCH: u32 = 50_000;

fn main() {
    let frames = std::env::args().nth(1).map_or(1_000_000_u32, |n| n.parse().expect("a number"));
    println!("protocol,whole,lost,lost with a whole one before,invented");
    for protocol in Protocol::ALL {
        let mut outcome = Outcome::default();
        (0..frames.div_ceil(BATCH)).for_each(|seed| {
            outcome += bad_line(protocol, BATCH.min(frames), u64::from(seed) + 1);
        });
        println!(
            "{protocol},{},{},{},{}",
            outcome.whole, outcome.lost, outcome.second_lost, outcome.invented
        );
    }
}
