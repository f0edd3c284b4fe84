//! Reading and writing a bag in memory, beside a plain copy of as many bytes.
//!
//! 72 000 messages (six minutes at 200 Hz), 27 MB: more than most caches hold.

use std::hint::black_box;
use std::io::{Cursor, Read as _};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use imu_tools::recording::{self, Block, ReadOptions, Sample};

fn blocks() -> Vec<Block> {
    let sample = |i: i64| Sample {
        stamp_ns: 1_700_000_000_000_000_000 + i * 5_000_000,
        value: [i as f64, 0.1, 9.81],
    };
    let samples: Vec<Sample> = (0..72_000).map(sample).collect();
    let block = |s: &[Sample]| Block {
        gyroscope: s.to_vec(),
        accelerometer: s.to_vec(),
        ..Block::default()
    };
    samples.chunks(4096).map(block).collect()
}

fn bag(c: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.bag");
    let blocks = blocks();
    let write = || {
        let mut sink = recording::create(&path).expect("a new file");
        for block in &blocks {
            sink.write_block(block).expect("room for a bag");
        }
        sink.finish().expect("room for a bag");
    };
    write();
    let bytes: &'static [u8] = std::fs::read(&path).expect("the bag").leak();

    let mut group = c.benchmark_group("bag");
    group.throughput(Throughput::Bytes(bytes.len() as u64)).sample_size(20);
    // Through a buffer of the size that the reader uses, as a pipe or file would come.
    group.bench_function("copy", |b| {
        let mut buffer = vec![0; 256 * 1024];
        b.iter(|| {
            let mut from = Cursor::new(bytes);
            while from.read(&mut buffer).is_ok_and(|n| n > 0) {
                black_box(&buffer);
            }
        });
    });
    group.bench_function("read", |b| {
        let mut block = Block::default();
        b.iter(|| {
            let stream = Box::new(Cursor::new(bytes));
            let options = ReadOptions::default();
            let mut source =
                recording::read_from("-".as_ref(), stream, &options).expect("our own bag");
            while source.next_block(&mut block).expect("our own bag") {
                black_box(&block);
            }
        });
    });
    let plain = folder.path().join("b");
    group.bench_function("write bytes to a file", |b| {
        b.iter(|| std::fs::write(&plain, bytes).expect("room for a bag"));
    });
    group.bench_function("write a bag to a file", |b| b.iter(write));
    group.finish();
}

criterion_group!(benches, bag);
criterion_main!(benches);
