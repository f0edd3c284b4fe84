//! Bags: what is written is read back, and what is cut, shuffled or lying is survived.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use imu_tests::bags::{bag, chunk, connection, message, record};
use imu_tools::error::Error;
use imu_tools::recording::{self, Block, ForceUnit, Note, RateUnit, ReadOptions, Sample};

const START: i64 = 1_700_000_000_000_000_000;

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

/// All samples and notes of a file.
fn read(path: &Path, options: &ReadOptions) -> Result<(Block, Vec<Note>), Error> {
    let mut source = recording::open(path, options)?;
    let (mut all, mut block) = (Block::default(), Block::default());
    while source.next_block(&mut block)? {
        all.gyroscope.append(&mut block.gyroscope);
        all.accelerometer.append(&mut block.accelerometer);
    }
    assert!(!source.next_block(&mut block)?, "the end is the end");
    Ok((all, source.take_notes()))
}

fn read_bytes(bytes: &[u8], options: &ReadOptions) -> Result<(Block, Vec<Note>), Error> {
    let mut file = tempfile::NamedTempFile::with_suffix(".bag").unwrap();
    file.write_all(bytes).unwrap();
    read(file.path(), options)
}

fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.bag");
    (folder, path)
}

#[test]
fn samples_are_read_back_to_the_bit() {
    let (_folder, path) = folder();
    // Several chunks, several blocks.
    let blocks = [block(3000), block(4000), block(1)];
    write(&path, &blocks);
    let (all, notes) = read(&path, &ReadOptions::default()).unwrap();
    let expected: Vec<_> = blocks.iter().flat_map(|b| &b.gyroscope).copied().collect();
    assert_eq!(all.gyroscope, expected);
    let expected: Vec<_> = blocks.iter().flat_map(|b| &b.accelerometer).copied().collect();
    assert_eq!(all.accelerometer, expected);
    assert_eq!(notes, []);
}

#[test]
fn sensors_of_different_rates_share_a_bag() {
    let (_folder, path) = folder();
    let mut block = block(1000);
    block.accelerometer.retain(|s| (s.stamp_ns - START) / 4_999_999 % 4 == 0);
    write(&path, std::slice::from_ref(&block));
    assert_eq!(read(&path, &ReadOptions::default()).unwrap().0, block);
}

#[test]
fn units_that_the_user_gives_are_brought_to_si() {
    let (_folder, path) = folder();
    let mut block = Block::default();
    block.gyroscope.push(Sample { stamp_ns: START, value: [180.0, 0.0, -90.0] });
    block.accelerometer.push(Sample { stamp_ns: START, value: [0.0, 0.5, -1.0] });
    write(&path, &[block]);
    let options = ReadOptions {
        gyro_unit: Some(RateUnit::DegPerS),
        accel_unit: Some(ForceUnit::G),
        ..ReadOptions::default()
    };
    let (read, _) = read(&path, &options).unwrap();
    let pi = std::f64::consts::PI;
    // One rounding of the factor and one of the product.
    for (got, want) in [
        (read.gyroscope[0].value, [pi, 0.0, -pi / 2.0]),
        (read.accelerometer[0].value, [0.0, 0.5 * 9.80665, -9.80665]),
    ] {
        for (got, want) in got.iter().zip(want) {
            assert!((got - want).abs() <= 4e-16 * want.abs(), "{got} {want}");
        }
    }
}

#[test]
fn the_same_samples_give_the_same_bytes() {
    let (_folder, path) = folder();
    write(&path, &[block(5000)]);
    let whole = std::fs::read(&path).unwrap();
    let pieces: Vec<Block> = (0..5000)
        .map(|i| {
            let all = block(5000);
            Block {
                gyroscope: vec![all.gyroscope[i]],
                accelerometer: vec![all.accelerometer[i]],
                ..Block::default()
            }
        })
        .take(50)
        .collect();
    write(&path, &pieces);
    let short = std::fs::read(&path).unwrap();
    write(&path, &[block(50)]);
    assert_eq!(std::fs::read(&path).unwrap(), short);
    write(&path, &[block(5000)]);
    assert_eq!(std::fs::read(&path).unwrap(), whole);
}

#[test]
fn an_empty_recording_is_a_bag_without_messages() {
    let (_folder, path) = folder();
    write(&path, &[]);
    assert_eq!(read(&path, &ReadOptions::default()).unwrap(), (Block::default(), vec![]));
}

#[test]
fn a_bag_cut_anywhere_gives_every_whole_message() {
    let (_folder, path) = folder();
    write(&path, &[block(3)]);
    let bytes = std::fs::read(&path).unwrap();
    // Where each message ends: behind its force, that is, 72 bytes of covariance behind it.
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
                let told = notes.iter().any(|n| matches!(n, Note::Warning(w) if w.contains("cut")));
                assert!(told || whole == 3, "cut at {cut}: {notes:?}");
            }
            Err(error) => assert_eq!(whole, 0, "cut at {cut}: {error}"),
        }
    }
}

#[test]
fn fields_in_any_order_and_messages_outside_of_chunks() {
    for order in 0..3 {
        let records = [
            chunk(&[connection(0, "/imu", "sensor_msgs/Imu"), message(0, 5, order)]),
            chunk(&[message(0, 6, order), message(0, 7, order + 1)]),
            // What a recorder was writing when it died: a chunk whose size is still 0.
            record(&[("compression", b"none"), ("op", &[5]), ("size", &[0; 4])], &[]),
            message(0, 8, order),
        ];
        for (bag_time, first) in [(false, 5), (true, 6)] {
            let options = ReadOptions { bag_time, ..ReadOptions::default() };
            let (all, notes) = read_bytes(&bag(&records), &options).unwrap();
            let seconds: Vec<i64> =
                all.gyroscope.iter().map(|s| s.stamp_ns / 1_000_000_000).collect();
            assert_eq!(seconds, [first, first + 1, first + 2, first + 3]);
            assert_eq!(all.gyroscope[0].value, [13.0, 14.0, 15.0]);
            assert_eq!(all.accelerometer[0].value, [25.0, 26.0, 27.0]);
            assert!(matches!(&notes[..], [Note::Warning(w)] if w.contains("not closed")));
        }
    }
}

#[test]
fn topics_are_found_listed_and_asked_for() {
    let imu = "sensor_msgs/Imu";
    let two = bag(&[chunk(&[
        connection(0, "/camera", "sensor_msgs/Image"),
        connection(1, "/left", imu),
        message(1, 5, 0),
        connection(2, "/right", imu),
        message(2, 6, 0),
        message(1, 7, 0),
    ])]);
    let topic = |topic: &str| ReadOptions { topic: Some(topic.into()), ..ReadOptions::default() };
    let error = read_bytes(&two, &ReadOptions::default()).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    for part in ["/left", "/right", "--topic"] {
        assert!(error.to_string().contains(part), "{error}");
    }
    assert_eq!(read_bytes(&two, &topic("left")).unwrap().0.gyroscope.len(), 2);
    let (both, _) = read_bytes(&two, &topic("/left,/right")).unwrap();
    assert_eq!((both.gyroscope.len(), both.accelerometer.len()), (2, 1));
    assert_eq!(both.accelerometer[0].stamp_ns, 6_000_000_000);

    let error = read_bytes(&two, &topic("/imu")).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    for part in ["no topic /imu", "/camera (sensor_msgs/Image)", "/left (sensor_msgs/Imu)"] {
        assert!(error.to_string().contains(part), "{error}");
    }
    let error = read_bytes(&two, &topic("/camera")).unwrap_err();
    assert!(error.to_string().contains("holds sensor_msgs/Image"), "{error}");

    let none = bag(&[chunk(&[connection(0, "/camera", "sensor_msgs/Image")])]);
    let error = read_bytes(&none, &ReadOptions::default()).unwrap_err();
    assert_eq!(error.exit_code(), 1);
    assert!(error.to_string().contains("/camera (sensor_msgs/Image)"), "{error}");
}

#[test]
fn claims_of_gigabytes_are_survived() {
    let connection = connection(0, "/imu", "sensor_msgs/Imu");
    let good = chunk(&[connection, message(0, 5, 0)]);
    let claim = u32::MAX.to_le_bytes();
    let mut lies: Vec<Vec<u8>> = vec![claim.to_vec()];
    for fields in [&message(0, 6, 0)[..], &chunk(&[])[..]] {
        let header = 4 + u32::from_le_bytes(fields[..4].try_into().unwrap()) as usize;
        lies.push([&fields[..header], &claim, &[0; 100]].concat());
    }
    let mut frame = message(0, 6, 0);
    let at = frame.len() - 37 * 8 - 3 - 4;
    frame[at..at + 4].copy_from_slice(&claim);
    lies.push(frame);
    for lie in lies {
        let (all, notes) = read_bytes(&bag(&[good.clone(), lie]), &ReadOptions::default()).unwrap();
        assert_eq!(all.gyroscope.len(), 1);
        assert!(!notes.is_empty());
    }
}

#[test]
fn damage_in_a_chunk_costs_only_what_it_hits() {
    let first = chunk(&[
        connection(0, "/imu", "sensor_msgs/Imu"),
        message(0, 5, 0),
        vec![0xff; 100],
        message(0, 6, 0),
    ]);
    let bytes = bag(&[first, chunk(&[message(0, 7, 0)])]);
    let (all, notes) = read_bytes(&bytes, &ReadOptions::default()).unwrap();
    assert_eq!(all.gyroscope.len(), 3);
    assert!(matches!(&notes[0], Note::Warning(w) if w.contains("100 bytes are lost")), "{notes:?}");
}

#[test]
fn stamps_that_a_bag_cannot_hold_are_refused_and_leave_nothing() {
    for stamp_ns in [-1, i64::MAX] {
        let (folder, path) = folder();
        let mut sink = recording::create(&path).unwrap();
        let gyroscope = vec![Sample { stamp_ns, value: [0.0; 3] }];
        let error = sink.write_block(&Block { gyroscope, ..Block::default() }).unwrap_err();
        assert!(error.to_string().contains("1970 to 2106"), "{error}");
        drop(sink);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

#[test]
fn what_is_no_recording_says_so() {
    let options = ReadOptions::default();
    let error = read_bytes(b"", &options).unwrap_err();
    assert!(error.to_string().ends_with("is empty"), "{error}");
    let error = read_bytes(b"#RXSBAG V2.0\n\x45\0\0\0", &options).unwrap_err();
    assert!(error.to_string().contains("no ROS 1 bag"), "{error}");
    let error = recording::open(Path::new("/no/such.bag"), &options).err().unwrap();
    assert!(error.to_string().contains("no such file"), "{error}");
    let error = recording::create(Path::new("a.xyz")).err().unwrap();
    assert_eq!(error.exit_code(), 2);
}
