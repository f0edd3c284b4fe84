//! Several files on one command line: pieces of one recording, several days, several sensors.

use imu_tests::command::run;
use imu_tests::recordings::{
    Folder, SCENE, TRUTH, assert_truth, calibrate, deviations_off, json, number, simulated,
};
use imu_tools::recording::{Block, Sample};

const DAY_NS: i64 = 86_400_000_000_000;

/// The samples from one to another, of both sensors.
fn piece(block: &Block, range: std::ops::Range<usize>) -> Block {
    Block {
        gyroscope: block.gyroscope[range.clone()].to_vec(),
        accelerometer: block.accelerometer[range].to_vec(),
        ..Block::default()
    }
}

/// The same samples at another time, changed.
fn moved(mut block: Block, by_ns: i64, change: impl Fn(&mut Sample)) -> Block {
    for sample in block.gyroscope.iter_mut().chain(&mut block.accelerometer) {
        sample.stamp_ns += by_ns;
        change(sample);
    }
    block
}

#[test]
fn pieces_in_any_order_are_one_recording_and_what_lies_between_is_missing() {
    let folder = Folder::new();
    let block = simulated(SCENE, 1);
    // Twenty seconds are lost between the second piece and the third.
    let pieces = [0..30_000, 30_000..60_000, 61_000..100_000].map(|range| piece(&block, range));
    let mut all = Block::default();
    for piece in &pieces {
        all.gyroscope.extend_from_slice(&piece.gyroscope);
        all.accelerometer.extend_from_slice(&piece.accelerometer);
    }
    let whole = json(&[&folder.record("whole.bag", &all)]);
    assert_eq!(number(&whole, "/gyroscope/missing"), 1000.0);
    let names: Vec<String> = ["0.bag", "1.bag", "2.bag"]
        .iter()
        .zip(&pieces)
        .map(|(name, piece)| folder.record(name, piece))
        .collect();
    let joined = json(&[&names[2], &names[0], &names[1]]);
    assert_eq!(joined["gyroscope"], whole["gyroscope"]);
    assert_eq!(joined["accelerometer"], whole["accelerometer"]);
    assert_eq!(joined["recording"]["path"], names.join(", "));
    assert_eq!(joined["recording"]["paths"], serde_json::json!(names));
    assert_eq!(whole["recording"]["paths"].as_array().map(Vec::len), Some(1));

    // `convert` makes the whole of them again.
    let again = folder.at("again.bag");
    let said = run(&["convert", &names[1], &names[2], &names[0], &again]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(
        std::fs::read(again).expect("written")
            == std::fs::read(folder.at("whole.bag")).expect("written")
    );
}

#[test]
fn two_days_are_pooled_and_the_step_of_the_bias_is_no_random_walk() {
    let folder = Folder::new();
    let first = folder.record("monday.bag", &simulated(SCENE, 1));
    // Tuesday's bias is another one by 50 times what the walk does in a record (K √T = 0.045 rad/s),
    // and the sensor lies on another side.
    let second = moved(simulated(SCENE, 2), DAY_NS, |sample| {
        let [x, y, z] = sample.value;
        sample.value = if z.abs() > 5.0 { [z, x, y] } else { [x + 2.0, y - 2.0, z] };
    });
    let second = folder.record("tuesday.bag", &second);
    for estimator in ["octaves", "ml"] {
        let one = json(&[&first, "--estimator", estimator]);
        let both = json(&[&second, &first, "--estimator", estimator]);
        if estimator == "octaves" {
            assert_truth(&both);
        }
        for (sensor, noise_density, random_walk) in TRUTH {
            let pooled = &both[sensor]["pooled"];
            // 5 sd: 6e-7 of a normal's deviates lie outside.
            assert!(deviations_off(&pooled["noise_density"], noise_density) < 5.0, "{pooled}");
            assert!(deviations_off(&pooled["random_walk"], random_walk) < 5.0, "{pooled}");
        }
        assert_eq!(number(&both, "/gyroscope/samples"), 200_000.0);
        assert_eq!(number(&both, "/gyroscope/missing"), 0.0);
        assert_eq!(number(&both, "/accelerometer/non_finite"), 0.0);
        assert_eq!(number(&both, "/gyroscope/restarts"), 0.0);
        assert_eq!(both["recording"]["warnings"], serde_json::json!([]));
        // Twice the data: √2 less uncertain, and not less than that.
        let sd = |json| {
            let k = "/gyroscope/pooled/random_walk";
            number(json, &format!("{k}/sd")) / number(json, &format!("{k}/value"))
        };
        let gain = sd(&one) / sd(&both);
        assert!((1.2..1.7).contains(&gain), "{estimator}: {gain}");
    }
}

#[test]
fn two_sensors_at_one_time_are_pooled_for_calibration_and_not_mixed_by_convert() {
    let folder = Folder::new();
    let left = folder.record("left.csv", &simulated(SCENE, 1));
    let right = moved(simulated(SCENE, 2), 3_000_000, |sample| sample.value[0] += 0.5);
    let right = folder.record("right.csv", &right);
    let both = json(&[&left, &right]);
    assert_truth(&both);
    let remarks = both["recording"]["remarks"].to_string();
    assert!(remarks.contains("right.csv begins before"), "{remarks}");

    let said = run(&["convert", &left, &right, &folder.at("both.csv")]);
    assert_eq!(said.code, 1);
    assert!(said.err.contains("overlap in time"), "{}", said.err);
    assert!(!folder.names().contains(&"both.csv".to_owned()));
}

/// A table for each sensor: they are not two IMUs.
#[test]
fn two_halves_of_one_recording_are_told_to_be_merged() {
    let folder = Folder::new();
    let block = piece(&simulated(SCENE, 1), 0..10_000);
    let table = |name: &str, header: &str, list: &[Sample], late_ns: i64| {
        let row = |Sample { stamp_ns, value: [x, y, z] }: &Sample| {
            format!("{},{x},{y},{z}\n", stamp_ns + late_ns)
        };
        let rows: String = list.iter().map(row).collect();
        folder.put(name, format!("t [ns],{header}\n{rows}"))
    };
    let gyroscope = table("g.csv", "gx,gy,gz", &block.gyroscope, 0);
    let accelerometer = table("a.csv", "ax,ay,az", &block.accelerometer, 1_000_000);
    for (one, other) in [(&gyroscope, &accelerometer), (&accelerometer, &gyroscope)] {
        let said = calibrate(&[one, other]);
        assert_eq!(said.code, 1, "{}", said.err);
        assert_eq!(said.err.lines().count(), 1, "{}", said.err);
        for words in ["g.csv and ", "a.csv are of one time", "one recording of both"] {
            assert!(said.err.contains(words), "'{words}' is not in {}", said.err);
        }
    }
}

#[test]
fn warnings_name_the_file() {
    let folder = Folder::new();
    let block = simulated(SCENE, 1);
    let first = folder.record("first.bag", &piece(&block, 0..50_000));
    let second = folder.record("second.bag", &piece(&block, 50_000..100_000));
    let bytes = std::fs::read(&second).expect("read");
    let second = folder.put("second.bag", &bytes[..bytes.len() / 2]);
    let said = calibrate(&[&first, &second]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(
        said.err
            .lines()
            .any(|line| line.starts_with("imu: warning: ") && line.contains("second.bag")),
        "{}",
        said.err
    );
}

#[test]
fn files_that_do_not_belong_together_are_refused_in_one_sentence() {
    let folder = Folder::new();
    let block = simulated(SCENE, 1);
    let first = folder.record("first.bag", &piece(&block, 0..10_000));
    let copy = folder.record("copy.csv", &piece(&block, 0..9_000));
    let faster = {
        let mut faster = moved(piece(&block, 0..10_000), DAY_NS, |_| {});
        for list in [&mut faster.gyroscope, &mut faster.accelerometer] {
            let start = list[0].stamp_ns;
            for (i, sample) in list.iter_mut().enumerate() {
                sample.stamp_ns = start + i as i64 * 10_000_000;
            }
        }
        folder.record("faster.bag", &faster)
    };
    let in_g = moved(piece(&block, 20_000..30_000), 0, |sample| {
        if sample.value[2].abs() > 5.0 {
            sample.value = sample.value.map(|x| x / 9.80665);
        }
    });
    let in_g = folder.record("in_g.csv", &in_g);
    let text = folder.put("diary.txt", "Dear diary,\nno table.\n");
    for (other, code, words) in [
        (&first, 2, &["first.bag is named twice"][..]),
        (&copy, 1, &["copy.csv", "first.bag", "begin with the same samples"]),
        (&faster, 1, &["50.0 samples a second in", "first.bag and 100.0 in", "faster.bag"]),
        (&in_g, 1, &["in_g.csv", "first.bag", "another unit"]),
        (&text, 1, &["diary.txt holds no row of numbers"]),
        (&folder.at("absent.bag"), 1, &["absent.bag", "there is no such file"]),
        (&"-".to_owned(), 1, &["standard input is empty"]),
    ] {
        for command in ["calibrate", "convert"] {
            let out = folder.at("out.csv");
            let mut arguments = vec![command, &first, other];
            if command == "convert" {
                arguments.push(&out);
            }
            let said = run(&arguments);
            assert_eq!(said.code, code, "{arguments:?}: {}", said.err);
            assert_eq!(said.err.lines().count(), 1, "{}", said.err);
            for word in words {
                assert!(said.err.contains(word), "'{word}' is not in: {}", said.err);
            }
        }
    }
}
