//! Any bytes behind the magic of an MCAP file, through its reader and the timelines.
#![no_main]

use std::io::Cursor;

use imu_tools::recording::{Block, ReadOptions, Timeline, read_from};
use libfuzzer_sys::fuzz_target;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

fuzz_target!(|bytes: &[u8]| {
    let mut file = MAGIC.to_vec();
    file.extend_from_slice(bytes.strip_prefix(MAGIC).unwrap_or(bytes));
    let options = ReadOptions::default();
    let Ok(mut source) = read_from("-".as_ref(), Box::new(Cursor::new(file)), &options) else {
        return;
    };
    let mut block = Block::default();
    let (mut timeline, mut samples) = (Timeline::new(), 0);
    while let Ok(true) = source.next_block(&mut block) {
        samples += block.gyroscope.len();
        timeline.push(&block.gyroscope, |_| {});
    }
    assert!(timeline.finish(|_| {}).samples as usize <= samples);
});
