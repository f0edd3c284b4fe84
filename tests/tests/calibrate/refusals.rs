//! What `imu calibrate` refuses: each with one clear sentence, the right exit code, and nothing
//! half-written.

use std::fs;

use imu_tests::bags::{bag, chunk, connection, message};
use imu_tests::command::Said;
use imu_tests::recordings::{Folder, calibrate, simulated};
use imu_tools::recording::Block;

const IMU: &str = "sensor_msgs/Imu";

/// Six seconds at 100 Hz.
fn short() -> Block {
    simulated(
        "rate_hz = 100\nduration = \"6s\"\n[gyroscope]\nnoise_density = 0.01\n\
         [accelerometer]\nnoise_density = 0.02\n",
        1,
    )
}

/// Asserts a refusal of one sentence that holds all these words.
fn assert_refused(said: &Said, code: i32, words: &[&str]) {
    assert_eq!(said.code, code, "{}", said.err);
    assert_eq!(said.err.lines().count(), 1, "{}", said.err);
    assert!(said.err.starts_with("imu: "), "{}", said.err);
    for word in words {
        assert!(said.err.contains(word), "'{word}' is not in: {}", said.err);
    }
    assert_eq!(said.out, "");
}

#[test]
fn files_that_are_no_recordings() {
    let folder = Folder::new();
    let no_imu = bag(&[chunk(&[connection(0, "/odom", "nav_msgs/Odometry")])]);
    let two = [connection(0, "/left/imu", IMU), connection(1, "right", IMU), message(0, 5, 0)];
    let zip = [b"PK\x03\x04\x14\0\0\0".to_vec(), vec![7; 1000]].concat();
    for (path, words) in [
        (folder.at("absent.bag"), &["absent.bag", "there is no such file"][..]),
        (folder.put("empty.bag", ""), &["empty.bag is empty"]),
        (folder.put("empty.csv", ""), &["empty.csv is empty"]),
        (
            folder.put("text.bag", "Dear diary,\nno bag.\n"),
            &["text.bag holds no row of numbers", "no ROS 1 bag"],
        ),
        (folder.put("old.bag", "#ROSBAG V1.2\n"), &["old.bag is no ROS 1 bag of version 2.0"]),
        (folder.put("a.zip", zip), &["a.zip is no whole .npz"]),
        (folder.put("text.csv", "Dear diary,\nno table.\n"), &["text.csv holds no row of numbers"]),
        (
            folder.put("no_imu.bag", no_imu),
            &[
                "no_imu.bag has no topic of an IMU (type sensor_msgs/Imu)",
                "/odom (nav_msgs/Odometry)",
            ],
        ),
    ] {
        assert_refused(&calibrate(&[&path]), 1, words);
    }
    let path = folder.put("two.bag", bag(&[chunk(&two)]));
    let words = ["several Imu topics: /left/imu (sensor_msgs/Imu), right (sensor_msgs/Imu)"];
    assert_refused(&calibrate(&[&path]), 2, &[words[0], "--topic"]);
    assert_refused(
        &calibrate(&[&path, "--topic", "/imu"]),
        2,
        &["two.bag has no topic /imu", "/left/imu", "right"],
    );
    let one = folder.record("one.bag", &short());
    let words = ["one.bag has no topic gyro", "/imu (sensor_msgs/Imu)"];
    assert_refused(&calibrate(&[&one, "--topic", "gyro"]), 2, &words);
    let here = folder.path().to_str().expect("UTF-8");
    assert_refused(&calibrate(&[here]), 1, &["is a folder without a recording"]);
    assert_refused(&calibrate(&["-"]), 1, &["standard input is empty"]);
}

#[test]
fn tables_with_faults() {
    let folder = Folder::new();
    let path = folder.record("a.csv", &short());
    let text = fs::read_to_string(path).expect("written");
    let lines: Vec<&str> = text.lines().collect();
    let with = |line: usize, text: &str| {
        let mut lines = lines.clone();
        lines[line - 1] = text;
        lines.join("\n") + "\n"
    };
    let narrow: String = (0..100).map(|i| format!("0.{i:02},1,2,3,4\n")).collect();
    let no_time: String = (0..100).map(|i| format!("{i},1,2,3,4,5\n")).collect();
    let fourth: Vec<&str> = lines[3].split(',').collect();
    let cut = with(4, &fourth[..4].join(","));
    let word = with(4, &lines[3].replacen(fourth[2], "fast", 1));
    for (name, text, words) in [
        ("narrow.csv", narrow, &["line 1", "5 columns where 7 are needed", "--columns"][..]),
        (
            "no_time.csv",
            format!("gx,gy,gz,ax,ay,az\n{no_time}"),
            &["in the header", "time", "--columns"],
        ),
        ("cut.csv", cut, &["line 4", "column"]),
        ("word.csv", word, &["line 4, column 3: 'fast' is no number"]),
    ] {
        let path = folder.put(name, text);
        assert_refused(&calibrate(&[&path]), 1, &[&[name], words].concat());
    }
}

#[test]
fn gravity_in_another_unit() {
    let (folder, block) = (Folder::new(), short());
    for (per_m_s2, unit) in [(1.0 / 9.806_65, "g"), (1e3 / 9.806_65, "mg")] {
        let mut other = block.clone();
        for sample in &mut other.accelerometer {
            sample.value = sample.value.map(|x| x * per_m_s2);
        }
        for name in ["a.bag", "a.csv"] {
            let path = folder.record(name, &other);
            let out = folder.at("out");
            let said = calibrate(&[&path, "-o", &out, "--accel-unit", unit]);
            assert_eq!(said.code, 0, "{}", said.err);
            assert!(!said.err.contains("gravity"), "{}", said.err);
            fs::remove_dir_all(&out).expect("written");
            let said = calibrate(&[&path, "-o", &out]);
            let likely = format!("its unit is probably {unit} and not m/s²;");
            let words = [name, "the accelerometer reads", &likely, "--accel-unit"];
            assert_refused(&said, 1, &words);
            assert!(!folder.names().contains(&"out".to_owned()));
            // A user who insists is told only.
            let said = calibrate(&[&path, "--accel-unit", "m/s^2"]);
            assert_eq!(said.code, 0, "{}", said.err);
            assert!(said.err.contains("warning: the accelerometer reads"), "{}", said.err);
        }
    }
}

#[test]
fn records_that_are_too_short() {
    let (folder, mut block) = (Folder::new(), short());
    let whole = folder.record("whole.bag", &block);
    let said = calibrate(&[&whole, "--from", "7"]);
    assert_refused(&said, 1, &["only 0 usable samples between --from and --to"]);
    block.gyroscope.truncate(3);
    block.accelerometer.truncate(3);
    for name in ["a.bag", "a.csv"] {
        let path = folder.record(name, &block);
        let said = calibrate(&[&path, "-o", &folder.at("out")]);
        assert_refused(&said, 1, &[name, "has only 3 usable samples", "record"]);
    }
    let none = folder.record("none.bag", &Block::default());
    let said = calibrate(&[&none]);
    assert_refused(&said, 1, &["none.bag has only 0 usable samples"]);
    assert_eq!(folder.names(), ["a.bag", "a.csv", "none.bag", "whole.bag"]);
}

#[test]
fn mistakes_on_the_command_line() {
    let (folder, block) = (Folder::new(), short());
    let (bag, csv) = (folder.record("a.bag", &block), folder.record("a.csv", &block));
    for (arguments, words) in [
        (&[][..], "<FILE>"),
        (&[&*bag, "--from", "5", "--to", "2"], "--from 5 is not before --to 2"),
        (&[&bag, "--from", "5", "--to", "5"], "--from 5 is not before --to 5"),
        (&[&bag, "--from", "-1"], "--from wants seconds"),
        (&[&bag, "--to", "NaN"], "--to wants seconds"),
        (&[&bag, "--from", "noon"], "'noon'"),
        (&[&bag, "--frobnicate"], "'--frobnicate'"),
        (&[&bag, "--accel-unit", "stone"], "'stone' is no unit of specific force"),
        (&[&bag, "--gyro-unit", "rpm"], "'rpm' is no unit of angular rate"),
        (&[&csv, "--time-unit", "h"], "'h' is no unit of time"),
        (&[&csv, "--topic", "imu"], "is no bag"),
        (&[&csv, "--columns", "t,gx,gy"], "--columns"),
        (&[&csv, "--columns", "a,b,c"], "--columns"),
        (&[&bag, "--columns", "t,gx,gy,gz"], "is a bag"),
        (&[&bag, "--time-unit", "s"], "is a bag"),
    ] {
        assert_refused(&calibrate(arguments), 2, &[words]);
    }
    assert_refused(&calibrate(&[&bag, &csv]), 1, &["would count twice"]);
}

#[test]
fn results_that_cannot_be_written_leave_nothing() {
    let (folder, block) = (Folder::new(), short());
    let bag = folder.record("a.bag", &block);
    let file = folder.put("file", "mine");
    let said = calibrate(&[&bag, "-o", &file]);
    assert_refused(&said, 1, &["cannot make the folder", &file]);
    let said = calibrate(&[&bag, "-o", &folder.at("file/out")]);
    assert_refused(&said, 1, &["cannot make the folder", "not a folder"]);
    assert_eq!(fs::read(&file).expect("it is still there"), b"mine");

    // A folder where the second file should go: the first is not written either.
    fs::create_dir_all(folder.at("out/allan.csv")).expect("made");
    let said = calibrate(&[&bag, "-o", &folder.at("out")]);
    assert_refused(&said, 1, &["allan.csv", "it is a folder"]);
    let left = fs::read_dir(folder.at("out")).expect("the folder").count();
    assert_eq!(left, 1, "the folder in the way");
}

/// `/dev/full` is a disk without space.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_and_leaves_nothing() {
    use imu_tests::command::{imu, said};
    let (folder, block) = (Folder::new(), short());
    let bag = folder.record("a.bag", &block);
    let full = fs::File::options().write(true).open("/dev/full").expect("Linux has it");
    let call = imu().args(["calibrate", "--json", &bag]).stdout(full).output();
    assert_refused(&said(&call.expect("started")), 1, &["the disk is full"]);

    fs::create_dir(folder.at("out")).expect("made");
    std::os::unix::fs::symlink("/dev/full", folder.at("out/imu.yaml")).expect("made");
    let said = calibrate(&[&bag, "-o", &folder.at("out")]);
    assert_refused(&said, 1, &["the disk is full"]);
    let left = fs::read_dir(folder.at("out")).expect("the folder").count();
    assert_eq!(left, 1, "the link");
}
