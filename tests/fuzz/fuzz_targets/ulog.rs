//! Any bytes behind the header of a PX4 log, through the ULog reader and the timelines.
#![no_main]

use std::io::Cursor;

use imu_tools::recording::{Block, ReadOptions, Timeline, read_from};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let header = b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0";
    let mut file = header.to_vec();
    let rest = if bytes.starts_with(&header[..7]) { bytes.get(16..) } else { Some(bytes) };
    file.extend_from_slice(rest.unwrap_or_default());
    let length = file.len();
    let options = ReadOptions { survey: true, ..ReadOptions::default() };
    let Ok(mut source) = read_from("-".as_ref(), Box::new(Cursor::new(file)), &options) else {
        return;
    };
    let mut block = Block::default();
    let (mut timeline, mut samples) = (Timeline::new(), 0);
    while let Ok(true) = source.next_block(&mut block) {
        samples += block.gyroscope.len();
        timeline.push(&block.gyroscope, |_| {});
    }
    // Three axes of a byte at least, each in its own place.
    assert!(samples * 3 <= length);
    assert!(timeline.finish(|_| {}).samples as usize <= samples);
    let told = source.take_notes().len();
    assert!(told < 40, "{told}");
});
