//! PX4 logs: every source of samples, several instances, what is no log.

use std::io::{Cursor, Read};

use imu_tests::ulog_outcomes::{expected, read, read_plainly, read_stream, refusal, topic};
use imu_tests::ulogs::{
    SENSOR_COMBINED, VEHICLE_IMU, batch, data, definitions, fifo_format, header, increments, line,
    means, plain, plain_definitions, plain_messages, reading, sensor_format, subscription, sync,
    value,
};
use imu_tools::recording::{self, Block, Note, ReadOptions, Sample, Stream};

#[test]
fn readings_of_both_sensors_and_the_temperature_are_read() {
    let outcome = read_plainly(&plain(1, 10_000));
    assert_eq!(outcome.samples, expected(0, 10_000));
    assert_eq!(outcome.topics, ["sensor_gyro:0", "sensor_accel:0"]);
    assert_eq!(outcome.warnings(), Vec::<&str>::new());
    let Note::Info(told) = &outcome.notes[0] else { panic!("{:?}", outcome.notes) };
    assert_eq!(
        told,
        "the gyroscope's readings are those of sensor_gyro:0: as its driver published them, not \
         calibrated by PX4"
    );
    let stream = |name: &str| Stream {
        name: format!("{name}:0"),
        type_name: name.into(),
        messages: 10_000,
        used: true,
    };
    assert_eq!(outcome.streams, [stream("sensor_gyro"), stream("sensor_accel")]);
}

/// A stream that gives one byte a call.
struct Drip(Cursor<Vec<u8>>);

impl Read for Drip {
    fn read(&mut self, to: &mut [u8]) -> std::io::Result<usize> {
        let n = to.len().min(1);
        self.0.read(&mut to[..n])
    }
}

#[test]
fn a_pipe_a_file_and_a_name_without_ending_give_the_same() {
    let bytes = plain(1, 500);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log");
    std::fs::write(&path, &bytes).unwrap();
    let from_pipe =
        read_stream(Box::new(Drip(Cursor::new(bytes))), &ReadOptions::default()).unwrap();
    let mut source = recording::open(&path, &ReadOptions::default()).unwrap();
    let mut block = Block::default();
    assert!(source.next_block(&mut block).unwrap());
    assert_eq!(block, from_pipe.samples);
    assert!(!source.next_block(&mut block).unwrap());
    assert_eq!(Some(source.bytes_read()), source.bytes_total());
}

#[test]
fn of_several_imus_one_is_asked_for() {
    let bytes = plain(3, 50);
    let (code, text) = refusal(&bytes, &ReadOptions::default());
    assert_eq!(code, 2);
    assert_eq!(
        text,
        "a.ulg has several IMUs: sensor_gyro:0, sensor_gyro:1, sensor_gyro:2, sensor_accel:0, \
         sensor_accel:1, sensor_accel:2; choose one by its number, such as --topic 0, or by \
         names, such as --topic sensor_gyro:0,sensor_accel:0"
    );
    for asked in ["1", "sensor_gyro:1", "sensor_accel:1", "sensor_gyro:1,sensor_accel:1", "1,1"] {
        let outcome = read(&bytes, &topic(asked)).unwrap();
        assert_eq!(outcome.samples, expected(1, 50), "{asked}");
        assert_eq!(outcome.streams.len(), 6);
        assert_eq!(outcome.streams.iter().filter(|stream| stream.used).count(), 2);
    }
    let mixed = read(&bytes, &topic("2,0")).unwrap().samples;
    assert_eq!(mixed.gyroscope, expected(2, 50).gyroscope);
    assert_eq!(mixed.accelerometer, expected(0, 50).accelerometer);
    let survey = ReadOptions { survey: true, ..ReadOptions::default() };
    let surveyed = read(&bytes, &survey).unwrap();
    assert_eq!(surveyed.samples, expected(0, 50));
    assert!(surveyed.warnings()[0].starts_with("a.ulg has several IMUs: sensor_gyro:0, "));
    for (asked, wrong) in [
        ("3", "a.ulg has no readings in a topic of an IMU with the number 3; it has sensor_gyro:0"),
        ("gps:0", "a.ulg has no readings in a topic gps:0; it has sensor_gyro:0, sensor_accel:0, "),
        (
            "sensor_gyro:0,sensor_accel:7",
            "a.ulg has no readings in a topic sensor_accel:7; it has ",
        ),
        ("sensor_gyro:a", "sensor_gyro:a is no topic of a ULog: name one like sensor_gyro:0"),
    ] {
        let (code, text) = refusal(&bytes, &topic(asked));
        assert_eq!(code, 2);
        assert!(text.starts_with(wrong), "{text}");
    }
}

/// Ten batches of eight counts, 8 kHz, one a millisecond.
fn fifo_log() -> Vec<u8> {
    let formats = [fifo_format("sensor_gyro_fifo"), fifo_format("sensor_accel_fifo")];
    let readings = [sensor_format("sensor_gyro"), sensor_format("sensor_accel")];
    let all: Vec<&str> = formats.iter().chain(&readings).map(String::as_str).collect();
    let mut log = definitions(&all);
    log.extend(subscription(0, 0, "sensor_gyro_fifo"));
    log.extend(subscription(0, 1, "sensor_accel_fifo"));
    log.extend(subscription(2, 2, "sensor_gyro"));
    log.extend(subscription(2, 3, "sensor_accel"));
    for i in 0..10_i16 {
        let at = 20_000_000 + 1000 * u64::from(i.unsigned_abs());
        let counts: Vec<[i16; 3]> = (0..8).map(|k| [8 * i + k, -k, 100]).collect();
        log.extend(data(0, &batch(at, 10, 125.0, 0.001, &counts)));
        log.extend(data(1, &batch(at + 3, 11, 125.0, 0.5, &counts)));
    }
    log.extend(data(2, &reading(20_000_000, 10, [0.0; 3], 36.5, 0)));
    log.extend(data(3, &reading(20_000_000, 11, [0.0; 3], 37.5, 0)));
    log
}

#[test]
fn every_sample_of_a_fifo_has_its_own_stamp() {
    let outcome = read_plainly(&fifo_log());
    assert_eq!(outcome.topics, ["sensor_gyro_fifo:0", "sensor_accel_fifo:0"]);
    assert_eq!(outcome.warnings(), Vec::<&str>::new());
    let (rates, forces) = (outcome.samples.gyroscope, outcome.samples.accelerometer);
    assert_eq!((rates.len(), forces.len()), (80, 80));
    for (i, (rate, force)) in rates.iter().zip(&forces).enumerate() {
        // The last of eight has the stamp of its batch.
        let stamp_ns = 20_000_000_000 + 125_000 * (i as i64 - 7);
        let (count, scale) = (i as f64, f64::from(0.001_f32));
        assert_eq!((rate.stamp_ns, force.stamp_ns), (stamp_ns, stamp_ns + 3000));
        assert_eq!(rate.value, [count * scale, -((i % 8) as f64) * scale, 100.0 * scale]);
        assert_eq!(force.value, [count * 0.5, -((i % 8) as f64) * 0.5, 50.0]);
    }
    // Of the topic of the same chip, whatever its instance.
    let celsius: Vec<f64> = outcome.samples.temperature.iter().map(|t| t.celsius).collect();
    assert_eq!(celsius, [36.5]);
    let others = "; --topic has others: sensor_gyro:2";
    assert!(matches!(&outcome.notes[0], Note::Info(text) if text.ends_with(others)));
}

#[test]
fn increments_become_means_and_thinned_out_topics_do_not_win() {
    let gyroscope = sensor_format("sensor_gyro");
    let mut log = definitions(&[VEHICLE_IMU, &gyroscope]);
    log.extend(subscription(1, 4, "vehicle_imu"));
    log.extend(subscription(0, 5, "sensor_gyro"));
    for i in 0..100_u64 {
        let fields = increments(20_000_000 + 4000 * i, [0.5, 0.0, -1.0], [0.25, 0.0, 2.0], 4000);
        log.extend(data(4, &fields));
        if i % 25 == 0 {
            log.extend(data(5, &reading(20_000_000 + 4000 * i, 10, [9.0; 3], 30.0, 0)));
        }
    }
    let outcome = read_plainly(&log);
    assert_eq!(outcome.topics, ["vehicle_imu:1", "vehicle_imu:1"]);
    assert_eq!(outcome.samples.gyroscope.len(), 100);
    assert_eq!(outcome.samples.temperature.len(), 4);
    let sample = outcome.samples.gyroscope[1];
    assert_eq!(sample.stamp_ns, 20_004_000_000);
    for (got, want) in sample.value.iter().zip([125.0, 0.0, -250.0_f64]) {
        // Two roundings: of the time in seconds and of the quotient.
        assert!((got - want).abs() <= 4e-16 * want.abs(), "{got} {want}");
    }
    let force = outcome.samples.accelerometer[1].value;
    assert!((force[2] - 500.0).abs() <= 4e-16 * 500.0, "{force:?}");
    assert!(outcome.notes.iter().any(|note| matches!(note, Note::Info(text)
        if text.contains("each reading is the mean over the interval that ends at its stamp"))));
}

#[test]
fn old_logs_give_the_means_of_the_selected_imu() {
    let mut log = definitions(&[SENSOR_COMBINED]);
    log.extend(subscription(0, 0, "sensor_combined"));
    for i in 0..10 {
        let relative = if i == 5 { i32::MAX } else { -250 };
        let fields = means(20_000_000 + 5000 * i, [0.25, 0.5, 1.0], [1.0, 2.0, 9.5], relative);
        log.extend(data(0, &fields));
    }
    let outcome = read_plainly(&log);
    assert_eq!(outcome.topics, ["sensor_combined:0", "sensor_combined:0"]);
    let Block { gyroscope, accelerometer, .. } = outcome.samples;
    // One force is marked as invalid.
    assert_eq!((gyroscope.len(), accelerometer.len()), (10, 9));
    assert_eq!(gyroscope[0], Sample { stamp_ns: 20_000_000_000, value: [0.25, 0.5, 1.0] });
    assert_eq!(accelerometer[0], Sample { stamp_ns: 19_999_750_000, value: [1.0, 2.0, 9.5] });
}

#[test]
fn nested_formats_and_padding_that_was_left_out_do_not_move_fields() {
    let mut log = definitions(&[
        "sensor_gyro:pose[2] before;uint64_t timestamp;float x;float y;float z;tail after;",
        "pose:uint64_t t;float[3] p;uint8_t[4] _padding0;",
        "tail:uint16_t a;uint8_t[6] _padding0;",
        &sensor_format("sensor_accel"),
    ]);
    log.extend(subscription(0, 9, "sensor_gyro"));
    for padding in [0, 6] {
        let mut fields = vec![0xee; 48];
        fields.extend(1000_u64.to_le_bytes());
        fields.extend([1.0_f32, 2.0, 3.0].into_iter().flat_map(f32::to_le_bytes));
        fields.extend(vec![0; 2 + padding]);
        log.extend(data(9, &fields));
    }
    let outcome = read_plainly(&log);
    let sample = Sample { stamp_ns: 1_000_000, value: [1.0, 2.0, 3.0] };
    assert_eq!(outcome.samples.gyroscope, [sample, sample]);
    assert_eq!(
        outcome.warnings(),
        ["a.ulg has no readings of the accelerometer: there is no topic with any"]
    );
}

#[test]
fn what_is_no_log_or_has_no_imu_is_told_in_a_sentence() {
    let options = ReadOptions::default();
    assert_eq!(refusal(b"ULoh\x01\x12\x35\x01", &options).1, "a.ulg is no ULog");
    let cut = "a.ulg is cut off in its first 16 bytes: nothing of the log is left";
    assert_eq!(refusal(&header()[..12], &options).1, cut);
    assert_eq!(refusal(&header(), &options).1, "a.ulg holds no messages");
    let mut log = definitions(&["battery:uint64_t timestamp;float v;", "b:uint64_t timestamp;"]);
    log.extend(subscription(0, 0, "battery"));
    log.extend(subscription(1, 1, "b"));
    assert_eq!(
        refusal(&log, &options).1,
        "a.ulg has no topic of an IMU (sensor_gyro, sensor_accel, their _fifo, vehicle_imu or \
         sensor_combined); it has battery:0, b:1"
    );
    // Those of an IMU come first, of whatever number.
    let formats = ["battery:uint64_t timestamp;float v;".to_owned(), sensor_format("sensor_gyro")];
    let mut log = definitions(&[&formats[0], &formats[1]]);
    log.extend(subscription(0, 0, "battery"));
    log.extend(subscription(1, 1, "sensor_gyro"));
    let (code, text) = refusal(&log, &topic("7"));
    assert_eq!(code, 2);
    assert!(text.ends_with("it has sensor_gyro:1, battery:0"), "{text}");
    let mut log = definitions(&["sensor_gyro:uint64_t timestamp;float x;"]);
    log.extend(subscription(0, 0, "sensor_gyro"));
    let unreadable = "topic sensor_gyro:0 of a.ulg cannot be read: it has no field y";
    assert_eq!(refusal(&log, &options).1, unreadable);
    let bag_time = ReadOptions { bag_time: true, ..ReadOptions::default() };
    assert_eq!(refusal(&plain(1, 1), &bag_time).0, 2);
}

#[test]
fn topics_that_come_late_are_found() {
    // More than is looked at before the choice, twice over.
    let noise: Vec<u8> =
        (0..50_000).flat_map(|_| line("forty bytes of text, to fill it up")).collect();
    let messages = plain_messages(1, 20).concat();
    let log = [plain_definitions(), noise.clone(), messages].concat();
    assert_eq!(read_plainly(&log).samples, expected(0, 20));
    let only_rates = [
        plain_definitions(),
        subscription(0, 0, "sensor_gyro"),
        data(0, &reading(20_000_000, 10, [0.0; 3], 40.0, 0)),
        noise,
        subscription(0, 1, "sensor_accel"),
        data(1, &reading(20_000_000, 11, [0.0; 3], 40.0, 0)),
        sync(),
        value(b'I', "char[3] sys_name", b"PX4"),
    ];
    let outcome = read_plainly(&only_rates.concat());
    let samples = outcome.samples;
    assert_eq!((samples.gyroscope.len(), samples.accelerometer.len()), (1, 1));
    assert_eq!(outcome.topics, ["sensor_gyro:0", "sensor_accel:0"]);
}
