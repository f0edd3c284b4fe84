//! Any bytes behind the first ones of an array, from a pipe, and as a file of arrays.
#![no_main]

use std::io::Cursor;

use imu_tools::recording::{self, Block, ReadOptions, Source, read_from};
use libfuzzer_sys::fuzz_target;

fn samples(mut source: Box<dyn Source>) -> usize {
    let (mut block, mut samples) = (Block::default(), 0);
    while let Ok(true) = source.next_block(&mut block) {
        samples += block.accelerometer.len();
        // A small file can be deflated from a large one, but not from an endless one.
        assert!(samples < 1 << 24);
    }
    samples
}

fuzz_target!(|bytes: &[u8]| {
    let options = ReadOptions::default();
    let array = [b"\x93NUMPY\x01\x00", bytes].concat();
    if let Ok(source) = read_from("-".as_ref(), Box::new(Cursor::new(array)), &options) {
        // Three numbers of a byte at least, and a time.
        assert!(samples(source) * 4 <= bytes.len());
    }
    // An archive is read at its end first, so it must be a file.
    let path = std::env::temp_dir().join(format!("imu-fuzz-{}.npz", std::process::id()));
    if std::fs::write(&path, [b"PK\x03\x04", bytes].concat()).is_ok()
        && let Ok(source) = recording::open(&path, &options)
    {
        samples(source);
    }
});
