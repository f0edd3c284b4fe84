//! `imu info`: what it finds in recordings with known faults.

use imu_tests::command::{Said, run};
use imu_tests::recordings::{Folder, SCENE, number, simulated};
use imu_tools::recording::{Block, Sample};
use serde_json::Value;

fn info(arguments: &[&str]) -> Said {
    run(&[&["info"], arguments].concat())
}

fn json(path: &str) -> Value {
    let said = info(&[path, "--json"]);
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{path}");
    serde_json::from_str(&said.out).expect("one JSON object")
}

/// A sensor at rest for a minute at 50 Hz, changed by `fault`.
fn record(fault: impl Fn(usize, &mut Sample, &mut Sample)) -> Block {
    let mut block = simulated(&SCENE.replace("2000s", "60s"), 4);
    let pairs = block.gyroscope.iter_mut().zip(&mut block.accelerometer);
    for (k, (gyroscope, accelerometer)) in pairs.enumerate() {
        fault(k, gyroscope, accelerometer);
    }
    block
}

#[test]
fn a_good_recording_is_described() {
    let folder = Folder::new();
    let bag = folder.record("good.bag", &simulated(SCENE, 4));
    let value = json(&bag);
    assert_eq!(value["refusal"], Value::Null);
    assert_eq!(value["streams"][0]["type"], "sensor_msgs/Imu");
    assert_eq!(number(&value, "/streams/0/messages"), 100_000.0);
    assert_eq!(number(&value, "/gyroscope/samples"), 100_000.0);
    assert!((number(&value, "/gyroscope/rate_hz") - 50.0).abs() < 1e-6);
    let said = info(&[&bag]);
    assert_eq!((said.code, said.err.as_str()), (0, ""));
    for words in ["/imu", "sensor_msgs/Imu", "rate            50.000000", "norm of mean    9.8"] {
        assert!(said.out.contains(words), "{words}: {}", said.out);
    }
}

/// What `imu info` says is wrong, for faults that are put in.
#[test]
fn faults_are_named() {
    type Fault = fn(usize, &mut Sample, &mut Sample);
    let faults: [(&str, Fault, &str); 7] = [
        ("stuck", |_, gyro, _| gyro.value[2] = 0.0, "gyroscope: axis z never changes"),
        (
            "saturated",
            |_, _, accel| accel.value[0] = (accel.value[0] * 10.0).clamp(-0.5, 0.5),
            "accelerometer: axis x stays at an end of its range (-0.5000 to 0.5000)",
        ),
        (
            "held",
            |k, gyro, _| {
                if k % 2 == 1 {
                    gyro.value = [k as f64; 3].map(|k| ((k - 1.0) * 0.37).sin() * 0.1);
                } else {
                    gyro.value = [k as f64; 3].map(|k| (k * 0.37).sin() * 0.1);
                }
            },
            "gyroscope: 50 % of the samples repeat the one before, up to 2 in a row",
        ),
        (
            "coarse",
            |_, gyro, _| gyro.value = gyro.value.map(|x| (x / 0.3).round() * 0.3),
            "moves in steps of 3.00e-1, larger than its noise",
        ),
        (
            "handled",
            |k, gyro, _| {
                if k < 500 {
                    gyro.value[0] += (k as f64 * 0.1).sin();
                }
            },
            "gyroscope: moved, touched or shaken for",
        ),
        (
            "in g",
            |_, _, accel| accel.value = accel.value.map(|x| x / 9.80665),
            "its unit is probably g and not m/s²; say --accel-unit g",
        ),
        (
            "clock",
            |k, gyro, accel| {
                if k >= 1500 {
                    gyro.stamp_ns -= 500_000_000;
                    accel.stamp_ns -= 500_000_000;
                }
            },
            "times that the clock was set while samples went on: 1 (first by -0.5",
        ),
    ];
    let folder = Folder::new();
    for (name, fault, words) in faults {
        let csv = folder.record(&format!("{name}.csv"), &record(fault));
        let said = info(&[&csv]);
        assert_eq!((said.code, said.err.as_str()), (0, ""), "{name}");
        assert!(said.out.contains(words), "{name}: {}", said.out);
    }
}

/// Too short to calibrate from is no reason not to describe it.
#[test]
fn three_samples_are_described() {
    let mut block = record(|_, _, _| {});
    block.gyroscope.truncate(3);
    block.accelerometer.truncate(3);
    let folder = Folder::new();
    let said = info(&[&folder.record("three.csv", &block)]);
    assert_eq!((said.code, said.err.as_str()), (0, ""));
    assert!(said.out.contains("has only 3 usable samples"), "{}", said.out);
}

#[test]
fn what_a_recording_does_not_show_is_not_told() {
    let folder = Folder::new();
    let header = "t,gx,gy,gz,ax,ay,az\n";
    let one = info(&[&folder.put("one.csv", format!("{header}\n0,1,2,3,4,5,6\n\n"))]);
    assert_eq!(one.code, 0, "{}", one.err);
    for words in ["unknown: no two stamps differ", "         1  used", "3.00000 to 3.00000"] {
        assert!(one.out.contains(words), "'{words}' is not in {}", one.out);
    }
    assert!(one.out.lines().all(|line| line.len() < 300), "{}", one.out);
    let rows: Vec<String> = (0..9).map(|i| format!("0.{i},nan,nan,nan,0,0,9.8\n")).collect();
    let none = info(&[&folder.put("none.csv", format!("{header}{}", rows.concat()))]);
    assert!(none.out.contains("none is finite"), "{}", none.out);
}

/// What a file calls its columns would reach the terminal, and the terminal would obey.
#[test]
fn control_characters_of_a_file_are_shown_and_not_sent() {
    let folder = Folder::new();
    let path =
        folder.put("esc.csv", "t,gx,gy,gz,ax,ay,az\n0,1,2,3,4,5,6\n1,\x1b[31mred,2,3,4,5,6\n");
    let said = info(&[&path]);
    assert_eq!(said.code, 1);
    assert!(said.err.contains("line 3, column 2: '\\u001b[31mred"), "{}", said.err);
    assert!(!said.err.trim_end().contains(|c: char| c.is_control()), "{:?}", said.err);
}

#[test]
fn what_cannot_be_read_is_one_sentence() {
    let folder = Folder::new();
    let said = info(&[&folder.at("nothing.bag")]);
    assert_eq!((said.code, said.out.as_str()), (1, ""));
    assert!(said.err.starts_with("imu: cannot read"), "{}", said.err);
    assert_eq!(said.err.lines().count(), 1);
}
