//! Any bytes in any pieces at any times, through decoder and clock to samples: stamps go on, and no sample is lost.
#![no_main]

use imu_tools::live::intake::Intake;
use imu_tools::live::link::Link;
use imu_tools::live::protocol::Protocol;
use imu_tools::live::run::{Decode as _, Step};
use imu_tools::recording::{Block, ReadOptions, Sample};
use libfuzzer_sys::fuzz_target;

/// Waits between pieces, ns: none, some, a pause, a clock that is set back.
const WAITS: [i64; 8] = [
    0,
    50_000,
    1_000_000,
    16_000_000,
    700_000_000,
    11_000_000_000,
    4_000_000_000_000,
    -3_000_000_000,
];

fn later(samples: &[Sample], last: &mut Option<i64>) {
    for sample in samples {
        assert!(last.is_none_or(|last| last < sample.stamp_ns || last == i64::MAX));
        *last = Some(sample.stamp_ns);
    }
}

fuzz_target!(|bytes: &[u8]| {
    let [kind, length, bytes @ ..] = bytes else { return };
    let protocol = Protocol::ALL.get(usize::from(kind % 8)).copied();
    let mut intake = Intake::new("it", protocol, &ReadOptions::default()).unwrap();
    let (mut steps, mut now_ns) = (Vec::new(), 0_i64);
    for piece in bytes.chunks(usize::from(*length).max(1)) {
        let first = usize::from(piece.first().copied().unwrap_or_default());
        now_ns += WAITS[(first + usize::from(kind / 8)) % WAITS.len()];
        if intake.feed(now_ns, piece, &mut steps).is_err() {
            return;
        }
        if first % 64 == 63 {
            intake.reopened(&mut steps);
        }
    }
    if intake.finish(&mut steps).is_err() {
        return;
    }
    let (mut last, mut samples) = ([None; 2], 0);
    let blocks = steps.iter().filter_map(|step| match step {
        Step::Samples(block, _) => Some(block),
        Step::Restart => None,
    });
    for Block { gyroscope, accelerometer, .. } in blocks {
        later(gyroscope, &mut last[0]);
        later(accelerometer, &mut last[1]);
        samples += gyroscope.len().max(accelerometer.len()) as u64;
    }
    let mut link = Link::default();
    intake.tell(&mut link);
    assert!(samples <= link.messages);
});
