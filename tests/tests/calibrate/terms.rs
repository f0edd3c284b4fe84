//! Bias instability, quantisation and ramp as `imu calibrate` tells them.

use std::fs;

use imu_tests::recordings::{Folder, SCENE, calibrate, deviations_off, json, number, simulated};

/// [`SCENE`] with a ramp of the gyroscope that goes 30 times as far as its walk, and a flicker of the accelerometer
/// whose flat is 3 times the minimum of its N and K.
const MORE: &str = "\
rate_hz = 50
duration = \"2000s\"
[gyroscope]
noise_density = 0.01
random_walk = 0.001
rate_ramp = 6.7e-4
[accelerometer]
noise_density = 0.02
random_walk = 0.002
[accelerometer.flicker]
bias_instability = 0.031
shortest_tau_s = 0.1
longest_tau_s = 2000
";

#[test]
fn what_a_recording_asks_for_is_told_everywhere() {
    let folder = Folder::new();
    let bag = folder.record("more.bag", &simulated(MORE, 5));
    let out = folder.at("out");
    let found = json(&[&bag, "-o", &out]);
    let (gyroscope, accelerometer) =
        (&found["gyroscope"]["pooled"], &found["accelerometer"]["pooled"]);
    // The walk itself drifts by a thirtieth, over √3 for three axes: five of those.
    let ramp = number(gyroscope, "/rate_ramp/value");
    assert!((ramp / 6.7e-4 - 1.0).abs() < 0.1, "{ramp}");
    assert!(gyroscope["bias_instability"].is_null() && gyroscope["quantisation"].is_null());
    assert!(deviations_off(&gyroscope["random_walk"], 0.001) < 5.0, "{gyroscope}");
    assert_eq!(accelerometer["bias_instability"]["unit"], "m/s²");
    assert!(deviations_off(&accelerometer["bias_instability"], 0.031) < 5.0, "{accelerometer}");
    assert!(accelerometer["rate_ramp"].is_null() && accelerometer["quantisation"].is_null());

    let yaml = fs::read_to_string(folder.at("out/imu.yaml")).expect("written");
    assert!(yaml.contains("# gyroscope rate ramp R: "), "{yaml}");
    assert!(yaml.contains("# accelerometer bias instability B: ") && yaml.contains("µg"), "{yaml}");
    // K'² is at least 3·(2 ln 2/π)·B²/100 s.
    let line = yaml.lines().find(|l| l.starts_with("accelerometer_random_walk: ")).expect("a line");
    let walk: f64 = line.split_whitespace().nth(1).expect("a value").parse().expect("a number");
    let flicker = number(accelerometer, "/bias_instability/value");
    assert!(walk > 0.999 * 0.115_057 * flicker, "{line}");
    assert!(line.contains("covers bias instability"), "{line}");
    let page = fs::read_to_string(folder.at("out/report.html")).expect("written");
    for words in
        ["Bias instability B", "Rate ramp R", "That is K alone, without the flicker B", "0.664 B"]
    {
        assert!(page.contains(words), "{words}");
    }
    let said = calibrate(&[&bag]);
    assert!(
        said.out.contains("bias instability B") && said.out.contains("rate ramp R"),
        "{}",
        said.out
    );
    assert!(said.err.contains("filters know no B"), "{}", said.err);
}

#[test]
fn terms_are_what_is_said() {
    let folder = Folder::new();
    let csv = folder.record("plain.csv", &simulated(SCENE, 5));
    let asked = json(&[&csv]);
    let two = json(&[&csv, "--terms", "nk"]);
    assert_eq!(asked["gyroscope"]["axes"], two["gyroscope"]["axes"]);
    let pooled = |value: &serde_json::Value| value["accelerometer"]["pooled"].clone();
    assert!(pooled(&asked)["bias_instability"].is_null());
    let all = pooled(&json(&[&csv, "--terms", "QNBKR"]));
    for (name, unit) in
        [("bias_instability", "m/s²"), ("quantisation", "m/s"), ("rate_ramp", "m/s³")]
    {
        assert_eq!(all[name]["unit"], unit);
    }
    for wrong in ["n", "nb", "nnk", "nkx", "", "all"] {
        let said = calibrate(&[&csv, "--terms", wrong]);
        assert_eq!((said.code, said.out.as_str()), (2, ""), "{wrong}");
        assert!(said.err.contains("q n b k r"), "{}", said.err);
    }
    let said = calibrate(&[&csv, "--terms", "nbk", "--estimator", "ml"]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("--estimator octaves"), "{}", said.err);
}
