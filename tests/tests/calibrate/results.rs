//! `imu calibrate` as a user calls it: what it prints and writes for recordings that are in order.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write as _;
use std::process::Stdio;

use imu_tests::command::{imu, said};
use imu_tests::recordings::{Folder, SCENE, assert_truth, calibrate, json, number, simulated};
use imu_tools::recording::Block;
use serde_json::Value;

/// A minute at 100 Hz: N shows, K does not.
const MINUTE: &str = "\
rate_hz = 100
duration = \"60s\"
[gyroscope]
noise_density = 0.01
random_walk = 1e-5
[accelerometer]
noise_density = 0.02
random_walk = 1e-4
";

/// The calibration without the words that name its file.
fn numbers(mut calibration: Value) -> Value {
    for (place, word) in [
        ("/recording", "path"),
        ("/recording", "paths"),
        ("/gyroscope", "topic"),
        ("/accelerometer", "topic"),
    ] {
        let object = calibration.pointer_mut(place).and_then(Value::as_object_mut);
        object.expect("an object").remove(word).expect("a word");
    }
    calibration
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().expect("an object").keys().map(String::as_str).collect()
}

#[test]
fn bag_table_and_pipe_of_the_same_samples_give_the_same_numbers() {
    let (folder, block) = (Folder::new(), simulated(SCENE, 11));
    let (bag, csv) = (folder.record("a.bag", &block), folder.record("a.csv", &block));
    let from_bag = json(&[&bag]);
    assert_truth(&from_bag);
    let from_bag = numbers(from_bag);
    assert_eq!(from_bag, numbers(json(&[&csv])));
    for path in [&bag, &csv] {
        let mut call = imu();
        call.args(["calibrate", "-", "--json"]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = call.stderr(Stdio::piped()).spawn().expect("started");
        let bytes = fs::read(path).expect("written");
        child.stdin.take().expect("piped").write_all(&bytes).expect("it reads to the end");
        let said = said(&child.wait_with_output().expect("it ends"));
        assert_eq!(said.code, 0, "{}", said.err);
        let piped: Value = serde_json::from_str(&said.out).expect("JSON");
        assert_eq!(numbers(piped), from_bag);
    }
}

#[test]
fn a_topic_is_found_with_and_without_its_slash() {
    let (folder, block) = (Folder::new(), simulated(MINUTE, 1));
    let bag = folder.record("a.bag", &block);
    let [found, with, without] =
        [&[&*bag][..], &[&bag, "--topic", "/imu"], &[&bag, "--topic", "imu"]].map(json);
    assert_eq!(found["gyroscope"]["topic"], "/imu");
    assert_eq!(found, with);
    assert_eq!(found, without);
    let recorded = json(&[&bag, "--bag-time"]);
    assert_eq!(recorded, found, "the simulator records a message at its stamp");
}

/// The places of all nulls, NaNs cannot be written in JSON and would be among them.
fn nulls(value: &Value, place: String, found: &mut Vec<String>) {
    match value {
        Value::Null => found.push(place),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, v)| nulls(v, format!("{place}/{i}"), found));
        }
        Value::Object(fields) => {
            fields.iter().for_each(|(name, v)| nulls(v, format!("{place}/{name}"), found));
        }
        _ => {}
    }
}

#[test]
fn json_has_the_documented_shape() {
    let folder = Folder::new();
    let long = json(&[&folder.record("a.bag", &simulated(SCENE, 2))]);
    let short = json(&[&folder.record("b.bag", &simulated(MINUTE, 2))]);
    for calibration in [&long, &short] {
        let mut found = Vec::new();
        nulls(calibration, String::new(), &mut found);
        // What was looked for and is not there.
        const ABSENT: [&str; 5] =
            ["/warm_up_s", "/ramp_per_s", "/bias_instability", "/quantisation", "/rate_ramp"];
        found.retain(|place| {
            !ABSENT.iter().any(|name| place.ends_with(name)) && !place.contains("/checks/step/")
        });
        assert_eq!(found, Vec::<String>::new());
        let has = |value: &Value, names: &[&str]| {
            for name in names {
                assert!(keys(value).contains(name), "{name}: {value}");
            }
        };
        has(calibration, &["recording", "gyroscope", "accelerometer"]);
        has(&calibration["recording"], &["path", "span_s", "warnings"]);
        for name in ["gyroscope", "accelerometer"] {
            let sensor = &calibration[name];
            has(sensor, &["topic", "samples", "rate_hz", "gaps", "duplicates", "backward"]);
            has(
                sensor,
                &["non_finite", "tau_used_s", "axes", "pooled", "for_filters", "deviation"],
            );
            assert_eq!(sensor["tau_used_s"].as_array().map(Vec::len), Some(2));
            let axes = sensor["axes"].as_array().expect("axes");
            assert_eq!(axes.iter().map(|a| &a["axis"]).collect::<Vec<_>>(), ["x", "y", "z"]);
            for axis in axes.iter().chain([&sensor["pooled"]]) {
                for parameter in [&axis["noise_density"], &axis["random_walk"]] {
                    let mut expected = if parameter["observable"] == true {
                        vec!["observable", "value", "sd", "low90", "high90", "unit"]
                    } else {
                        vec!["observable", "upper90", "may_show_from_s", "unit"]
                    };
                    expected.sort_unstable();
                    let mut there = keys(parameter);
                    there.sort_unstable();
                    assert_eq!(there, expected);
                }
            }
            let deviation = sensor["deviation"].as_array().expect("deviations");
            assert!(deviation.len() >= 8, "{deviation:?}");
            for row in deviation {
                let mut there = keys(row);
                there.sort_unstable();
                assert_eq!(there, ["adev", "edf", "tau_s"]);
                for list in ["adev", "edf"] {
                    assert_eq!(row[list].as_array().map(Vec::len), Some(3));
                }
            }
        }
    }
    assert_eq!(long["gyroscope"]["samples"], 100_000);
    // Steps of 20 000 000 ns exactly: a fit over 2000 s cannot be off by more than its rounding.
    assert!((number(&long, "/gyroscope/rate_hz") - 50.0).abs() < 1e-9);
    assert_eq!(long["gyroscope"]["pooled"]["noise_density"]["unit"], "rad/s/√Hz");
    assert_eq!(long["accelerometer"]["pooled"]["random_walk"]["unit"], "m/s³/√Hz");
    assert_eq!(short["gyroscope"]["pooled"]["random_walk"]["observable"], false);
}

/// Keys, values and comments of a YAML file that is one flat map.
fn flat_yaml(text: &str) -> BTreeMap<&str, (&str, &str)> {
    let mut map = BTreeMap::new();
    for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let (key, rest) = line.split_once(": ").unwrap_or_else(|| panic!("no key: {line}"));
        let (value, comment) = rest.split_once("  # ").unwrap_or((rest, ""));
        assert!(map.insert(key, (value, comment)).is_none(), "{key} twice");
    }
    map
}

const KALIBR: [&str; 6] = [
    "accelerometer_noise_density",
    "accelerometer_random_walk",
    "gyroscope_noise_density",
    "gyroscope_random_walk",
    "rostopic",
    "update_rate",
];

#[test]
fn yaml_has_the_keys_of_kalibr_and_the_pooled_values() {
    let folder = Folder::new();
    let bag = folder.record("a.bag", &simulated(SCENE, 3));
    let out = folder.at("deep/out");
    let calibration = json(&[&bag, "-o", &out]);
    let text = fs::read_to_string(folder.at("deep/out/imu.yaml")).expect("written");
    let yaml = flat_yaml(&text);
    assert_eq!(yaml.keys().copied().collect::<Vec<_>>(), KALIBR);
    for (key, (value, comment)) in &yaml {
        let Some((sensor, name)) = key.split_once('_').filter(|(s, _)| *s != "update") else {
            continue;
        };
        let parameter = &calibration[sensor]["pooled"][name];
        let value: f64 = value.parse().expect("a number");
        // Six digits after the first are printed.
        assert!((value / number(parameter, "/value") - 1.0).abs() < 1e-6, "{key}");
        let unit = parameter["unit"].as_str().expect("a unit");
        assert!(comment.starts_with(unit) && comment.contains(" to "), "{comment}");
    }
    assert_eq!(yaml["rostopic"].0, "\"/imu\"");
    let rate: f64 = yaml["update_rate"].0.parse().expect("a number");
    assert!((rate - 50.0).abs() < 1e-6);

    let table = fs::read_to_string(folder.at("deep/out/allan.csv")).expect("written");
    let mut rows = table.lines();
    let columns = rows.next().expect("a header").split(',').count();
    let rows: Vec<&str> = rows.collect();
    assert!(rows.iter().all(|row| row.split(',').count() == columns));
    let deviations = |sensor: &str| calibration[sensor]["deviation"].as_array().map_or(0, Vec::len);
    assert_eq!(rows.len(), deviations("gyroscope") + deviations("accelerometer"));
    let first: Vec<&str> = rows[0].split(',').collect();
    let adev = number(&calibration, "/gyroscope/deviation/0/adev/0");
    assert!((first[2].parse::<f64>().expect("a number") / adev - 1.0).abs() < 1e-12);
}

#[test]
fn a_random_walk_that_does_not_show_is_a_bound_and_a_warning() {
    let folder = Folder::new();
    let bag = folder.record("a.bag", &simulated(MINUTE, 4));
    let calibration = json(&[&bag, "-o", &folder.at("out")]);
    let said = calibrate(&[&bag]);
    assert_eq!(said.code, 0);
    assert!(said.out.contains("not observable"), "{}", said.out);
    let text = fs::read_to_string(folder.at("out/imu.yaml")).expect("written");
    let yaml = flat_yaml(&text);
    for sensor in ["gyroscope", "accelerometer"] {
        let key = format!("{sensor}_random_walk");
        let (value, comment) = yaml[&*key];
        assert_eq!(calibration[sensor]["pooled"]["random_walk"]["observable"], false);
        // It covers what each axis shows by itself, too.
        let axes = (0..3).map(|axis| format!("/{sensor}/axes/{axis}/random_walk"));
        let ends = axes.chain([format!("/{sensor}/pooled/random_walk")]).map(|path| {
            let end = if calibration.pointer(&path).is_some_and(|k| k["observable"] == true) {
                "high90"
            } else {
                "upper90"
            };
            number(&calibration, &format!("{path}/{end}"))
        });
        let bound = ends.fold(0.0, f64::max);
        let value: f64 = value.parse().expect("a number");
        assert!(value > 0.0 && (value / bound - 1.0).abs() < 1e-6);
        assert!(comment.contains("NOT KNOWN WELL") && comment.contains("the largest upper end"));
        let warned = |text: &str| text.contains(sensor) && text.contains("too short");
        assert!(said.err.lines().any(|line| line.starts_with("imu: warning: ") && warned(line)));
        let warnings = calibration["recording"]["warnings"].as_array().expect("warnings");
        assert!(warnings.iter().any(|w| w.as_str().is_some_and(warned)));
        assert!(text.lines().any(|line| line.starts_with("# Warning: ") && warned(line)));
    }
}

#[test]
fn either_sensor_alone_is_calibrated_as_if_both_were_there() {
    let (folder, block) = (Folder::new(), simulated(SCENE, 5));
    let both = json(&[&folder.record("both.bag", &block)]);
    for (there, absent) in [("gyroscope", "accelerometer"), ("accelerometer", "gyroscope")] {
        let mut alone = block.clone();
        match absent {
            "gyroscope" => alone.gyroscope.clear(),
            _ => alone.accelerometer.clear(),
        }
        for name in ["one.bag", "one.csv"] {
            let one = json(&[&folder.record(name, &alone), "-o", &folder.at(there)]);
            assert_eq!(one[absent], Value::Null);
            assert_eq!(one[there]["pooled"], both[there]["pooled"]);
            assert_eq!(one[there]["deviation"], both[there]["deviation"]);
            let text =
                fs::read_to_string(folder.at(&format!("{there}/imu.yaml"))).expect("written");
            let yaml = flat_yaml(&text);
            assert!(yaml.contains_key(&*format!("{there}_random_walk")));
            assert!(!yaml.contains_key(&*format!("{absent}_random_walk")));
        }
    }
}

#[test]
fn sensors_of_different_rates_have_no_gaps() {
    let (folder, mut block) = (Folder::new(), simulated(SCENE, 6));
    let mut index = 0;
    block.accelerometer.retain(|_| {
        index += 1;
        index % 5 == 1
    });
    // Every fifth sample, taken alone: N²/τ₀ is the variance of a sample, so N is √5 times larger.
    let truth = 0.02 * 5_f64.sqrt();
    let mut pooled = Vec::new();
    for name in ["a.bag", "a.csv"] {
        let calibration = json(&[&folder.record(name, &block)]);
        for (sensor, rate, samples) in
            [("gyroscope", 50.0, 100_000), ("accelerometer", 10.0, 20_000)]
        {
            assert!((number(&calibration[sensor], "/rate_hz") - rate).abs() < 1e-9);
            assert_eq!(calibration[sensor]["samples"], samples);
            assert_eq!(calibration[sensor]["gaps"], Value::Array(Vec::new()));
        }
        let n = &calibration["accelerometer"]["pooled"]["noise_density"];
        // 60 000 samples: at least √(1/(2·60 000)) = 0.3 %; N/K = 22 s makes it little more.
        let off = (number(n, "/value") / truth - 1.0).abs();
        assert!(off < 0.02, "{off}");
        pooled.push(calibration["accelerometer"]["pooled"].clone());
    }
    assert_eq!(pooled[0], pooled[1]);
}

#[test]
fn the_time_between_from_and_to_is_what_counts() {
    let (folder, block) = (Folder::new(), simulated(SCENE, 7));
    let whole = folder.record("whole.bag", &block);
    let start = block.gyroscope[0].stamp_ns;
    let within = |stamp_ns: i64| (100_000_000_000..=400_000_000_000).contains(&(stamp_ns - start));
    let mut part = Block::default();
    part.gyroscope.extend(block.gyroscope.iter().filter(|s| within(s.stamp_ns)));
    part.accelerometer.extend(block.accelerometer.iter().filter(|s| within(s.stamp_ns)));
    let part = json(&[&folder.record("part.bag", &part)]);
    let cut = json(&[&whole, "--from", "100", "--to", "400"]);
    assert_eq!(cut["gyroscope"]["samples"], 15_001);
    for sensor in ["gyroscope", "accelerometer"] {
        for name in ["noise_density", "random_walk"] {
            // The cut may leave another first block, and so another reference: roundings.
            let [a, b] = [&cut, &part].map(|c| &c[sensor]["pooled"][name]);
            assert_eq!(a["observable"], b["observable"]);
            let place = if a["observable"] == true { "/value" } else { "/upper90" };
            assert!((number(a, place) / number(b, place) - 1.0).abs() < 1e-6, "{a} {b}");
        }
    }
}

#[test]
fn units_by_flag_mend_a_recording_in_g_and_degrees() {
    let (folder, mut block) = (Folder::new(), simulated(SCENE, 8));
    let si = json(&[&folder.record("si.bag", &block)]);
    for sample in &mut block.accelerometer {
        sample.value = sample.value.map(|x| x / 9.806_65);
    }
    for sample in &mut block.gyroscope {
        sample.value = sample.value.map(f64::to_degrees);
    }
    for name in ["g.bag", "g.csv"] {
        let path = folder.record(name, &block);
        let scaled = json(&[&path, "--accel-unit", "g", "--gyro-unit", "deg/s"]);
        for sensor in ["gyroscope", "accelerometer"] {
            for name in ["noise_density", "random_walk"] {
                let place = format!("/{sensor}/pooled/{name}/value");
                // Roundings of values of 10 m/s² and less beside noise of 0.1: 1e-14.
                assert!((number(&scaled, &place) / number(&si, &place) - 1.0).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn units_that_cannot_be_told_are_stated() {
    let folder = Folder::new();
    let path = folder.record("a.csv", &simulated(MINUTE, 9));
    let text = fs::read_to_string(&path).expect("written");
    let (_, rows) = text.split_once('\n').expect("a header");
    let path = folder.put("bare.csv", format!("t,gx,gy,gz,ax,ay,az\n{rows}"));
    let said = calibrate(&[&path]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.err.contains("angular rate as rad/s (--gyro-unit)"), "{}", said.err);
    assert!(said.err.contains("time as ns"), "{}", said.err);
    let given =
        calibrate(&[&path, "--gyro-unit", "rad/s", "--accel-unit", "m/s^2", "--time-unit", "ns"]);
    assert!(!given.err.contains("is read with"), "{}", given.err);
    assert_eq!(given.out, said.out);
}

#[test]
fn the_table_names_units_and_their_twins() {
    let folder = Folder::new();
    let said = calibrate(&[&folder.record("a.bag", &simulated(SCENE, 10))]);
    assert_eq!(said.code, 0);
    for words in ["rad/s/√Hz", "m/s³/√Hz", "°/√h", "µg/√Hz", "all axes", "100000 samples"]
    {
        assert!(said.out.contains(words), "{words} is not in {}", said.out);
    }
    assert_eq!(said.err, "", "nothing to warn of");
}

#[test]
fn results_go_into_a_folder_and_not_over_a_recording() {
    let folder = Folder::new();
    let recording = folder.record("allan.csv", &simulated(SCENE, 1));
    for (output, words) in [("-", "go into a folder"), (&folder.at(""), "is the recording itself")]
    {
        let said = calibrate(&[&recording, "-o", output]);
        assert_eq!(said.code, 2, "{output}: {}", said.err);
        assert!(said.err.contains(words), "{}", said.err);
    }
    assert_eq!(folder.names(), ["allan.csv"]);
}

/// Where a sensor never changes nothing is known of its noise: no form has a number for it.
#[test]
fn a_constant_sensor_has_no_number_in_any_form() {
    let (folder, mut block) = (Folder::new(), simulated(MINUTE, 1));
    for sample in &mut block.accelerometer {
        sample.value = [0.0, 0.0, 9.81];
    }
    let path = folder.record("a.csv", &block);
    for (form, keys) in [
        ("kalibr", &["accelerometer_noise_density", "accelerometer_random_walk"][..]),
        ("imu_utils", &["acc_n", "acc_w"]),
        ("vins", &["acc_n", "acc_w"]),
        ("openvins", &["accelerometer_noise_density", "accelerometer_random_walk"]),
        ("orbslam3", &["IMU.NoiseAcc", "IMU.AccWalk"]),
        ("ros-covariance", &["linear_acceleration_covariance"]),
    ] {
        let said = calibrate(&[&path, "--format", form]);
        assert_eq!(said.code, 0, "{}", said.err);
        for key in keys {
            let lines: Vec<_> = said.out.lines().filter(|line| line.contains(key)).collect();
            let told = |line: &&str| {
                line.trim_start().starts_with('#') && line.contains("nothing is known")
            };
            assert!(!lines.is_empty() && lines.iter().all(told), "{form}: {}", said.out);
        }
        let number = |line: &str| !line.trim_start().starts_with('#') && line.contains("e-");
        assert!(said.out.lines().any(number), "the gyroscope's: {form}: {}", said.out);
    }
}
