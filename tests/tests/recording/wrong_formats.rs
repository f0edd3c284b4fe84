//! Files of one format under the name of another, files of no format, and wishes that make no sense:
//! each is recognised by what it holds, or refused in one clear sentence.

use std::fs;

use imu_tests::bags::{bag, chunk, connection, message};
use imu_tests::command::{Said, run};
use imu_tests::recordings::{Folder, simulated};
use imu_tests::ulogs;
use imu_tools::recording::Format;

const SHORT: &str = "rate_hz = 100\nduration = \"5s\"\n[gyroscope]\nnoise_density = 0.01\n\
                     [accelerometer]\nnoise_density = 0.02\n";

/// Endings that readers know, one that none does, and none.
const NAMES: [&str; 6] = ["x.bag", "x.mcap", "x.ulg", "x.csv", "x.dat", "x"];

/// Asserts one sentence with these words, this exit code, and no panic.
fn assert_refused(said: &Said, code: i32, words: &[&str], what: &str) {
    assert_eq!(said.code, code, "{what}: {}", said.err);
    assert_eq!(said.err.lines().count(), 1, "{what}: {}", said.err);
    assert!(said.err.starts_with("imu: ") && !said.err.contains("panicked"), "{}", said.err);
    for word in words {
        assert!(said.err.contains(word), "{what}: '{word}' is not in: {}", said.err);
    }
    assert_eq!(said.out, "");
}

#[test]
fn a_recording_is_read_whatever_its_name() {
    let folder = Folder::new();
    let block = simulated(SHORT, 1);
    let out = folder.at("out.csv");
    // EuRoC's are folders.
    for format in Format::ALL.into_iter().filter(|format| *format != Format::Euroc) {
        let bytes = fs::read(folder.record(&format!("source.{}", format.name()), &block));
        let bytes = bytes.expect("written");
        for name in NAMES {
            let path = folder.put(name, &bytes);
            let said = run(&["convert", &path, &out, "--force"]);
            assert_eq!(said.code, 0, "{name}: {}", said.err);
            assert!(said.out.starts_with("wrote 500 samples of both"), "{}", said.out);
            // Text has no first bytes to know it by.
            let is_told = said.err.contains("is text, and no ");
            let misnamed = ["x.bag", "x.mcap", "x.ulg"].contains(&name);
            assert_eq!(is_told, format == Format::Csv && misnamed, "{name}: {}", said.err);
        }
    }
    for name in NAMES {
        let path = folder.put(name, ulogs::plain(1, 100));
        let said = run(&["convert", &path, &out, "--force"]);
        assert_eq!(said.code, 0, "{name}: {}", said.err);
    }
}

#[test]
fn what_is_no_recording_is_refused_under_any_name() {
    let folder = Folder::new();
    let zeros = vec![0; 100_000];
    let noise: Vec<u8> =
        (0..100_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let with = |magic: &[u8]| [magic, &noise].concat();
    let contents: [(&str, Vec<u8>); 14] = [
        ("nothing", Vec::new()),
        ("one byte", vec![7]),
        ("a line end", b"\n".to_vec()),
        ("zeros", zeros),
        ("noise", noise.clone()),
        ("a zip file", with(b"PK\x03\x04\x14\0\0\0")),
        ("a picture", with(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR")),
        ("a database", with(b"SQLite format 3\0\x10\0")),
        ("a program", with(b"\x7fELF\x02\x01\x01\0")),
        ("words", b"Dear diary,\ntoday there was no recording.\n".to_vec()),
        ("a bag's first line", b"#ROSBAG V2.0\n".to_vec()),
        ("the first bytes of MCAP", b"\x89MCAP0\r\n".to_vec()),
        ("the first bytes of ULog", ulogs::header()),
        ("only a header", b"t,gx,gy,gz,ax,ay,az\n".to_vec()),
    ];
    for (what, bytes) in &contents {
        for name in NAMES {
            let path = folder.put(name, bytes);
            for arguments in
                [vec!["calibrate", &path], vec!["convert", &path, &folder.at("out.csv")]]
            {
                let said = run(&arguments);
                assert_refused(&said, 1, &[name], &format!("{what} as {name}"));
            }
        }
    }
    assert!(!folder.names().contains(&"out.csv".to_owned()));
    // The name of a damaged beginning says what it should have been.
    let mut bytes = fs::read(folder.record("whole.bag", &simulated(SHORT, 1))).expect("written");
    bytes[..9].fill(0xff);
    let said = run(&["calibrate", &folder.put("x.bag", bytes)]);
    assert_refused(&said, 1, &["x.bag is no ROS 1 bag"], "a damaged beginning");
}

#[test]
fn wishes_that_make_no_sense() {
    let folder = Folder::new();
    let block = simulated(SHORT, 1);
    let (bag_path, csv) = (folder.record("a.bag", &block), folder.record("a.csv", &block));
    let two = [
        connection(0, "/left", "sensor_msgs/Imu"),
        connection(1, "/right", "sensor_msgs/Imu"),
        message(0, 5, 0),
        message(1, 5, 0),
    ];
    let two = folder.put("two.bag", bag(&[chunk(&two)]));
    let empty_folder = folder.path().join("folder");
    fs::create_dir(&empty_folder).expect("made");
    let empty_folder = empty_folder.to_str().expect("UTF-8").to_owned();
    let out = folder.at("out.csv");
    for (flags, code, words) in [
        (vec![two.as_str()], 2, &["two.bag", "/left", "/right", "--topic"][..]),
        (vec![&two, "--topic", "/middle"], 2, &["/middle", "/left"]),
        (vec![&bag_path, "--columns", "t,gx,gy,gz"], 2, &["a.bag", "--columns"]),
        (vec![&bag_path, "--map", "t=t"], 2, &["a.bag", "--map"]),
        (vec![&bag_path, "--topic", ","], 2, &["--topic ',' lacks a name"]),
        (vec![&bag_path, "--time-unit", "ms"], 2, &["a.bag", "--time-unit"]),
        (vec![&csv, "--topic", "/imu"], 2, &["a.csv", "--topic"]),
        (vec![&csv, "--bag-time"], 2, &["a.csv", "--bag-time"]),
        (vec![&csv, "--columns", "t,t,gx"], 2, &["--columns"]),
        (vec![&csv, "--gyro-unit", "m/s"], 2, &["'m/s' is no unit of angular rate"]),
        (vec![&csv, "--accel-unit", "rad/s"], 2, &["'rad/s' is no unit of"]),
        (vec![&csv, "--time-unit", "years"], 2, &["'years' is no unit of time"]),
        (vec![&empty_folder], 1, &["folder"]),
    ] {
        for command in ["calibrate", "convert"] {
            let mut arguments = vec![command];
            arguments.extend(&flags);
            if command == "convert" {
                arguments.push(&out);
            }
            assert_refused(&run(&arguments), code, words, &format!("{arguments:?}"));
        }
    }
    assert!(!folder.names().contains(&"out.csv".to_owned()));
}
