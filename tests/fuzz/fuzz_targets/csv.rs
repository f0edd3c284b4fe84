//! Any text, through the CSV reader and the timelines.
#![no_main]

use std::io::Cursor;

use imu_tools::recording::{Block, ReadOptions, Timeline, read_from};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let options = ReadOptions::default();
    let stream = Box::new(Cursor::new(bytes.to_vec()));
    let Ok(mut source) = read_from("-".as_ref(), stream, &options) else { return };
    let mut block = Block::default();
    let (mut timeline, mut samples) = (Timeline::new(), 0);
    while let Ok(true) = source.next_block(&mut block) {
        samples += block.accelerometer.len();
        timeline.push(&block.accelerometer, |_| {});
    }
    // A row has a time and three numbers, and a separator or line end behind each. What is packed
    // may hold more than its bytes, and is another target's.
    let packed = [&b"\x1f\x8b"[..], b"\x28\xb5\x2f\xfd", b"\x93NUMPY"];
    let packed = packed.iter().any(|magic| bytes.starts_with(magic));
    // A frame of Zstandard that is skipped may stand before one that is not.
    let skipped = bytes.get(1..4) == Some(b"\x2a\x4d\x18");
    assert!(packed || skipped || samples * 8 <= bytes.len() + 1);
    assert!(timeline.finish(|_| {}).samples as usize <= samples);
});
