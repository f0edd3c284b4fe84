//! Any bytes behind the first ones of gzip, Zstandard and UTF-16.
#![no_main]

use std::io::Cursor;

use imu_tools::recording::{Block, ReadOptions, read_from};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let options = ReadOptions::default();
    for magic in [&b"\x1f\x8b\x08\x00"[..], b"\x28\xb5\x2f\xfd", b"\xff\xfe", b"\xfe\xff"] {
        let stream = Box::new(Cursor::new([magic, bytes].concat()));
        let Ok(mut source) = read_from("-".as_ref(), stream, &options) else { continue };
        let mut block = Block::default();
        while let Ok(true) = source.next_block(&mut block) {}
        source.take_notes();
    }
});
