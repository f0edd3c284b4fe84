//! Any bytes behind the magic of an SQLite file, through the reader of rosbag2's databases.
#![no_main]

use std::io::Cursor;

use imu_tools::recording::{Block, ReadOptions, read_from};
use libfuzzer_sys::fuzz_target;

const MAGIC: &[u8] = b"SQLite format 3\0";

fuzz_target!(|bytes: &[u8]| {
    let mut file = MAGIC.to_vec();
    file.extend_from_slice(bytes.strip_prefix(MAGIC).unwrap_or(bytes));
    let options = ReadOptions::default();
    let Ok(mut source) = read_from("-".as_ref(), Box::new(Cursor::new(file)), &options) else {
        return;
    };
    let mut block = Block::default();
    while let Ok(true) = source.next_block(&mut block) {
        assert!(block.gyroscope.len() <= imu_tools::recording::BLOCK_SAMPLES);
    }
});
