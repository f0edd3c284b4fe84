//! Any bytes behind the first line of a bag, through the bag reader and the timelines.
#![no_main]

use std::io::Cursor;

use imu_tools::recording::{Block, ReadOptions, Timeline, read_from};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut file = b"#ROSBAG V2.0\n".to_vec();
    file.extend_from_slice(bytes.strip_prefix(b"#ROSBAG V2.0\n").unwrap_or(bytes));
    let length = file.len();
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
    // A message is 312 bytes long at least, before it is compressed.
    let compressed = |at: &[u8]| at == b"compression=bz2" || at == b"compression=lz4";
    assert!(samples * 312 <= length || bytes.windows(15).any(compressed));
    assert!(timeline.finish(|_| {}).samples as usize <= samples);
});
