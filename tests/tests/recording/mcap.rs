//! MCAP files: what is written is read back, and what is cut, shuffled or lying is survived.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use imu_tests::mcaps::{
    MAGIC, cdr, channel, chunk, chunk_of, imu, mcap, message, record, schema, text,
};
use imu_tools::error::Error;
use imu_tools::recording::{self, Block, Note, ReadOptions, Sample, Source, Temperature};

const START: i64 = 1_700_000_000_000_000_000;
const IMU: &str = "sensor_msgs/msg/Imu";
const COMPRESSIONS: [&str; 3] = ["", "zstd", "lz4"];

fn block(count: i64) -> Block {
    let mut block = Block::default();
    for i in 0..count {
        let (stamp_ns, v) = (START + i * 4_999_999, i as f64 * 0.1);
        block.gyroscope.push(Sample { stamp_ns, value: [v, -v, 1e-300 * v] });
        block.accelerometer.push(Sample { stamp_ns, value: [f64::MAX, -0.0, 9.81 + v] });
    }
    block
}

fn write(path: &Path, blocks: &[Block]) {
    let mut sink = recording::create(path).unwrap();
    for block in blocks {
        sink.write_block(block).unwrap();
    }
    sink.finish().unwrap();
}

/// All samples and notes.
fn drain(mut source: Box<dyn Source>) -> Result<(Block, Vec<Note>), Error> {
    let (mut all, mut block) = (Block::default(), Block::default());
    while source.next_block(&mut block)? {
        all.gyroscope.append(&mut block.gyroscope);
        all.accelerometer.append(&mut block.accelerometer);
        all.temperature.append(&mut block.temperature);
    }
    assert!(!source.next_block(&mut block)?, "the end is the end");
    Ok((all, source.take_notes()))
}

fn read(path: &Path) -> Result<(Block, Vec<Note>), Error> {
    drain(recording::open(path, &ReadOptions::default())?)
}

/// Reads bytes from a file and through a pipe: both must give the same samples.
fn read_bytes(bytes: &[u8], options: &ReadOptions) -> Result<(Block, Vec<Note>), Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    std::fs::write(&path, bytes).unwrap();
    let file = recording::open(&path, options).and_then(drain);
    let stream = Box::new(Cursor::new(bytes.to_vec()));
    let pipe = recording::read_from(&path, stream, options).and_then(drain);
    match (&file, &pipe) {
        (Ok((file, _)), Ok((pipe, notes))) => {
            assert_eq!(file, pipe, "{notes:?}");
        }
        (file, pipe) => assert_eq!(file.is_err(), pipe.is_err(), "{file:?} {pipe:?}"),
    }
    file
}

fn seconds(block: &Block) -> Vec<i64> {
    block.gyroscope.iter().map(|s| s.stamp_ns / 1_000_000_000).collect()
}

fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    (folder, path)
}

/// Records of a schema, its channel and messages at these seconds.
fn records(seconds: impl Iterator<Item = u32>) -> Vec<Vec<u8>> {
    let mut records = vec![schema(1, IMU), channel(0, 1, "/imu")];
    records.extend(seconds.map(|sec| imu(0, sec)));
    records
}

#[test]
fn samples_are_read_back_to_the_bit() {
    let (_folder, path) = folder();
    // Several chunks, several blocks, sensors of different rates.
    let mut blocks = [block(3000), block(4000), block(1)];
    blocks[1].accelerometer.retain(|s| (s.stamp_ns - START) / 4_999_999 % 4 == 0);
    write(&path, &blocks);
    let (all, notes) = read(&path).unwrap();
    let expected: Vec<_> = blocks.iter().flat_map(|b| &b.gyroscope).copied().collect();
    assert_eq!(all.gyroscope, expected);
    let expected: Vec<_> = blocks.iter().flat_map(|b| &b.accelerometer).copied().collect();
    assert_eq!(all.accelerometer, expected);
    assert_eq!(notes, []);
}

#[test]
fn the_same_samples_give_the_same_bytes() {
    let (_folder, path) = folder();
    write(&path, &[block(5000)]);
    let whole = std::fs::read(&path).unwrap();
    let (mut first, mut second) = (block(5000), block(5000));
    first.gyroscope.truncate(1234);
    first.accelerometer.truncate(1234);
    second.gyroscope.drain(..1234);
    second.accelerometer.drain(..1234);
    write(&path, &[first, second]);
    assert_eq!(std::fs::read(&path).unwrap(), whole);
}

#[test]
fn an_empty_recording_is_a_file_without_messages() {
    let (_folder, path) = folder();
    write(&path, &[]);
    assert_eq!(read(&path).unwrap(), (Block::default(), vec![]));
}

#[test]
fn a_file_of_ours_cut_anywhere_gives_every_whole_message() {
    let (_folder, path) = folder();
    write(&path, &[block(3)]);
    let bytes = std::fs::read(&path).unwrap();
    // Where each message ends: behind its force and 72 bytes of covariance.
    let ends: Vec<usize> = block(3)
        .accelerometer
        .iter()
        .map(|s| {
            let force: Vec<u8> = s.value.iter().flat_map(|v| v.to_le_bytes()).collect();
            bytes.windows(24).position(|w| w == force).unwrap() + 24 + 72
        })
        .collect();
    for cut in 0..bytes.len() {
        let whole = ends.iter().filter(|end| **end <= cut).count();
        match read_bytes(&bytes[..cut], &ReadOptions::default()) {
            Ok((all, notes)) => {
                assert_eq!(all.gyroscope, block(3).gyroscope[..whole], "cut at {cut}");
                assert!(matches!(&notes[..], [Note::Warning(_), ..]), "cut at {cut}: {notes:?}");
            }
            Err(error) => assert_eq!(whole, 0, "cut at {cut}: {error}"),
        }
    }
}

#[test]
fn a_compressed_file_cut_anywhere_keeps_its_whole_chunks() {
    for compression in COMPRESSIONS {
        let chunks = [
            chunk(&records(1..4), compression),
            chunk(&records(4..7), compression),
            chunk(&records(7..10), compression),
        ];
        let bytes = mcap(&chunks);
        assert_eq!(seconds(&read_bytes(&bytes, &ReadOptions::default()).unwrap().0).len(), 9);
        let start = bytes.len() - mcap(&[]).len();
        let first = bytes.windows(9).position(|w| w == &chunks[0][..9]).unwrap();
        assert_eq!(start, chunks.concat().len());
        for cut in 0..bytes.len() {
            let mut end = first;
            let whole = chunks
                .iter()
                .filter(|c| {
                    end += c.len();
                    end <= cut
                })
                .count()
                * 3;
            match read_bytes(&bytes[..cut], &ReadOptions::default()) {
                Ok((all, notes)) => {
                    let found = seconds(&all);
                    assert!(found.len() >= whole, "{compression} cut at {cut}");
                    assert_eq!(found, Vec::from_iter(1..=found.len() as i64));
                    assert!(matches!(&notes[..], [Note::Warning(_), ..]), "{cut}: {notes:?}");
                }
                Err(error) => assert_eq!(whole, 0, "{compression} cut at {cut}: {error}"),
            }
        }
    }
}

#[test]
fn of_a_cut_compressed_chunk_what_can_be_decompressed_is_used() {
    // Several blocks of 64 KB (LZ4) or 128 KB (Zstandard) each.
    for (compression, block) in [("zstd", 128 * 1024), ("lz4", 64 * 1024)] {
        let mut records = records(0..0);
        for sec in 1..3000 {
            // Doubles that do not compress: a multiplicative hash of their number.
            let noise = |i: u32| f64::from((sec * 37 + i).wrapping_mul(2_654_435_761)).sqrt();
            records.push(message(0, sec, &cdr(sec, &Vec::from_iter((0..37).map(noise)))));
        }
        let bytes = mcap(&[chunk(&records, compression)]);
        let cut = &bytes[..bytes.len() * 2 / 3];
        let (all, notes) = read_bytes(cut, &ReadOptions::default()).unwrap();
        let found = seconds(&all);
        // A little more than two thirds of 3000 messages of 351 bytes, less a block.
        assert!(
            found.len() * 351 + block * 2 > 3000 * 351 * 2 / 3,
            "{compression} {}",
            found.len()
        );
        assert_eq!(found, Vec::from_iter(1..=found.len() as i64));
        assert!(matches!(&notes[..], [Note::Warning(w)] if w.contains("middle of a chunk")));
    }
}

#[test]
fn no_index_no_summary_no_chunks() {
    let (all, notes) = read_bytes(&mcap(&records(5..8)), &ReadOptions::default()).unwrap();
    assert_eq!((seconds(&all), notes), (vec![5, 6, 7], vec![]));
    assert_eq!(all.gyroscope[0].value, [13.0, 14.0, 15.0]);
    assert_eq!(all.accelerometer[0].value, [25.0, 26.0, 27.0]);
    let options = ReadOptions { bag_time: true, ..ReadOptions::default() };
    let (all, _) = read_bytes(&mcap(&records(5..8)), &options).unwrap();
    assert_eq!(seconds(&all), [6, 7, 8]);
}

#[test]
fn unknown_records_and_other_topics_are_passed_over() {
    for compression in COMPRESSIONS {
        let image = vec![7; 3_000_000];
        let mut all = records(1..3);
        all.extend([schema(2, "sensor_msgs/msg/Image"), channel(9, 2, "/camera")]);
        all.extend([message(9, 3, &image), imu(0, 4), record(0x80, &[&[1; 100]]), imu(0, 5)]);
        let bytes = mcap(&[chunk(&all, compression), record(9, &[&image]), imu(0, 6)]);
        let (all, notes) = read_bytes(&bytes, &ReadOptions::default()).unwrap();
        assert_eq!((seconds(&all), notes), (vec![1, 2, 4, 5, 6], vec![]), "{compression}");
    }
}

#[test]
fn temperatures_come_along() {
    let mut all = records(1..3);
    all.extend([schema(2, "sensor_msgs/msg/Temperature"), channel(1, 2, "/imu/temperature")]);
    all.push(message(1, 2, &cdr(2, &[36.5, 0.0])));
    let (all, notes) = read_bytes(&mcap(&all), &ReadOptions::default()).unwrap();
    assert_eq!(all.temperature, [Temperature { stamp_ns: 2_000_000_000, celsius: 36.5 }]);
    assert_eq!(notes, []);
}

#[test]
fn topics_are_found_listed_and_asked_for() {
    let both = [
        schema(1, IMU),
        channel(1, 1, "/front"),
        channel(2, 1, "/rear"),
        imu(1, 5),
        imu(2, 6),
        imu(1, 7),
    ];
    let error = read_bytes(&mcap(&both), &ReadOptions::default()).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    for part in ["/front", "/rear", "--topic"] {
        assert!(error.to_string().contains(part), "{error}");
    }
    let topic = |topic: &str| ReadOptions { topic: Some(topic.into()), ..ReadOptions::default() };
    assert_eq!(seconds(&read_bytes(&mcap(&both), &topic("front")).unwrap().0), [5, 7]);
    let (all, _) = read_bytes(&mcap(&both), &topic("/front,/rear")).unwrap();
    assert_eq!((all.gyroscope.len(), all.accelerometer.len()), (2, 1));
    let error = read_bytes(&mcap(&both), &topic("/imu")).unwrap_err();
    assert!(error.to_string().contains("/rear (sensor_msgs/msg/Imu)"), "{error}");
}

#[test]
fn another_encoding_is_refused_in_a_sentence() {
    let ros1 = record(4, &[&[0, 0, 1, 0], &text("/imu"), &text("ros1"), &[0; 4]]);
    let bytes = mcap(&[schema(1, "sensor_msgs/Imu"), ros1]);
    let error = read_bytes(&bytes, &ReadOptions::default()).unwrap_err();
    assert!(error.to_string().contains("ros1"), "{error}");

    let mut odd = records(1..3);
    odd.push(message(0, 3, &[0, 3, 0, 0]));
    odd.push(message(0, 4, &[0, 1, 0, 0]));
    let (all, notes) = read_bytes(&mcap(&odd), &ReadOptions::default()).unwrap();
    assert_eq!(seconds(&all), [1, 2]);
    let told = format!("{notes:?}");
    assert!(told.contains("representation 00 03"), "{told}");
    assert!(told.contains("1 messages that are no"), "{told}");
}

#[test]
fn a_wrong_checksum_is_told_and_its_samples_used() {
    for compression in COMPRESSIONS {
        let good = chunk(&records(1..4), compression);
        let mut bad = good.clone();
        bad[9 + 24] ^= 1;
        let later = chunk(&records(4..6), compression);
        let (all, notes) = read_bytes(&mcap(&[bad, later]), &ReadOptions::default()).unwrap();
        assert_eq!(seconds(&all), [1, 2, 3, 4, 5]);
        assert!(matches!(&notes[..], [Note::Warning(w)] if w.contains("checksum")), "{notes:?}");
    }
}

#[test]
fn claims_of_gigabytes_are_survived() {
    let good = records(1..3);
    let claim = (4_u64 << 30).to_le_bytes();
    for compression in COMPRESSIONS {
        // The decompressed length, that of the stored records, that of the record.
        let whole = chunk(&good, compression);
        let stored = 9 + 28 + 4 + compression.len();
        for at in [9 + 16, stored, 1] {
            let mut lie = whole.clone();
            lie[at..at + 8].copy_from_slice(&claim);
            let bytes = mcap(&[chunk(&good, ""), lie, chunk(&records(7..8), "")]);
            let file = read_one(&bytes);
            assert!(file.0.gyroscope.len() >= 3, "{compression} {at}");
            assert!(compression.is_empty() || !file.1.is_empty(), "{compression} {at}");
        }
    }
    let mut lie = imu(0, 3);
    lie[1..9].copy_from_slice(&u64::MAX.to_le_bytes());
    let (all, notes) = read_one(&mcap(&[good.concat(), lie, imu(0, 4)]));
    assert_eq!(seconds(&all), [1, 2, 4]);
    assert!(!notes.is_empty());
}

/// Reads bytes from a file only: behind a wrong length a pipe cannot know where it ends.
fn read_one(bytes: &[u8]) -> (Block, Vec<Note>) {
    let (_folder, path) = folder();
    std::fs::write(&path, bytes).unwrap();
    read(&path).unwrap()
}

#[test]
fn damage_costs_no_more_than_what_it_hit() {
    let rubbish = vec![0; 100];
    // In a chunk, between its messages; and between chunks.
    let mut inside = records(1..3);
    inside.push(rubbish.clone());
    inside.extend([imu(0, 3), imu(0, 4)]);
    for compression in COMPRESSIONS {
        let chunks =
            [chunk(&inside, compression), rubbish.clone(), chunk(&records(5..7), compression)];
        let (all, notes) = read_bytes(&mcap(&chunks), &ReadOptions::default()).unwrap();
        assert_eq!(seconds(&all), [1, 2, 3, 4, 5, 6], "{compression}");
        let told =
            notes.iter().filter(|n| matches!(n, Note::Warning(w) if w.contains("100 bytes")));
        assert_eq!(told.count(), 2, "{notes:?}");
    }
    // Damage in compressed bytes costs the rest of their chunk.
    for compression in ["zstd", "lz4"] {
        let mut bad = chunk(&records(1..1000), compression);
        let middle = bad.len() / 2;
        bad[middle..middle + 20].fill(0xff);
        let bytes =
            mcap(&[chunk(&records(1..3), ""), bad, chunk(&records(2000..2002), compression)]);
        let (all, notes) = read_bytes(&bytes, &ReadOptions::default()).unwrap();
        assert_eq!(seconds(&all)[seconds(&all).len() - 2..], [2000, 2001]);
        assert!(!notes.is_empty(), "{notes:?}");
    }
}

#[test]
fn unknown_compression_says_what_to_do() {
    let bytes = mcap(&[chunk_of(5, 0, "brotli", b"abcde")]);
    let error = read_bytes(&bytes, &ReadOptions::default()).unwrap_err();
    assert!(error.to_string().contains("brotli"), "{error}");
}

#[test]
fn stamps_that_ros_2_cannot_hold_are_refused_and_leave_nothing() {
    for stamp_ns in [-1, (1 << 31) * 1_000_000_000] {
        let (folder, path) = folder();
        let mut sink = recording::create(&path).unwrap();
        let gyroscope = vec![Sample { stamp_ns, value: [0.0; 3] }];
        let error = sink.write_block(&Block { gyroscope, ..Block::default() }).unwrap_err();
        assert!(error.to_string().contains("1970 to 2038"), "{error}");
        drop(sink);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

#[test]
fn what_is_no_mcap_says_so() {
    let options = ReadOptions::default();
    let error = read_bytes(b"t,gx,gy,gz\n", &options).unwrap_err();
    assert!(error.to_string().contains("no MCAP file"), "{error}");
    let error = read_bytes(MAGIC, &options).unwrap_err();
    assert!(error.to_string().contains("no messages"), "{error}");
    let columns = ReadOptions { columns: Some("t".into()), ..options };
    assert_eq!(read_bytes(&mcap(&records(1..2)), &columns).unwrap_err().exit_code(), 2);
}
