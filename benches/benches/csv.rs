//! Reading a CSV in memory, beside the plain way: split at line ends and commas, parse each field.
//!
//! 72 000 rows (six minutes at 200 Hz) with all digits of their doubles, 10 MB.

use std::hint::black_box;
use std::io::Cursor;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use imu_tools::recording::{self, Block, ReadOptions, Sample};

/// Values whose shortest text has as many digits as a sensor's have after a change of units.
fn blocks() -> Vec<Block> {
    let sample = |i: i64| {
        let v = (i as f64 * 0.7).sin();
        Sample {
            stamp_ns: 1_700_000_000_000_000_000 + i * 5_000_000,
            value: [v, v / 3.0, v + 9.81],
        }
    };
    let samples: Vec<Sample> = (0..72_000).map(sample).collect();
    let block = |s: &[Sample]| Block {
        gyroscope: s.to_vec(),
        accelerometer: s.to_vec(),
        ..Block::default()
    };
    samples.chunks(4096).map(block).collect()
}

fn csv(c: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.csv");
    let mut sink = recording::create(&path).expect("a new file");
    for block in &blocks() {
        sink.write_block(block).expect("room for a table");
    }
    sink.finish().expect("room for a table");
    let bytes: &'static [u8] = std::fs::read(&path).expect("the table").leak();
    let with_blanks = String::from_utf8_lossy(bytes).replace(',', " , ").into_bytes();
    let with_blanks: &'static [u8] = with_blanks.leak();

    let mut group = c.benchmark_group("csv");
    group.throughput(Throughput::Bytes(bytes.len() as u64)).sample_size(20);
    group.bench_function("split and parse", |b| {
        let text = std::str::from_utf8(bytes).expect("our own table");
        b.iter(|| {
            for line in text.lines().skip(1) {
                let mut fields = line.split(',');
                black_box(fields.next().and_then(|t| t.parse::<i64>().ok()));
                for field in fields {
                    black_box(field.parse::<f64>().ok());
                }
            }
        });
    });
    for (name, bytes) in [("read", bytes), ("read, blanks around commas", with_blanks)] {
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function(name, |b| {
            let mut block = Block::default();
            b.iter(|| {
                let stream = Box::new(Cursor::new(bytes));
                let options = ReadOptions::default();
                let mut source =
                    recording::read_from("-".as_ref(), stream, &options).expect("our own table");
                while source.next_block(&mut block).expect("our own table") {
                    black_box(&block);
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, csv);
criterion_main!(benches);
