//! Records that were handled, bumped, cut and warming up: N and K as if they had not been.
//!
//! How often intervals hold the truth over many seeds: `cargo run --release -p imu-tests --example
//! disturbed`.

use imu_core::allan::Parameter;
use imu_tests::disturbed::{Disturbances, Disturbed};
use imu_tools::calibrate::{Calibration, Options, SensorNoise, calibrate};
use imu_tools::scene::{Preset, Scene, Simulator};

const LENGTH_S: f64 = 7200.0;

fn calibrated(what: Disturbances, seed: u64, keep_all: bool) -> Calibration {
    let scene = Scene { duration_ns: (LENGTH_S * 1e9) as u64, seed, ..Preset::Mid.scene() };
    let simulator = Simulator::new(&scene).unwrap();
    let source = Disturbed::new(simulator, what, LENGTH_S, seed + 1);
    let options = Options { keep_all, ..Options::default() };
    calibrate(Box::new(source), "disturbed", &options, |_| {}).unwrap()
}

/// N of every axis within 3 % (its scatter is 0.06 %), pooled K within six times the spread that
/// its interval states (1.645 σ on either side, in logarithms).
fn assert_noise(sensor: &SensorNoise, n: f64, k: f64) {
    for axis in &sensor.axes {
        let Parameter::Observable { value, .. } = axis.noise_density else { panic!("no N") };
        assert!((value / n - 1.0).abs() < 0.03, "N {value} instead of {n}");
    }
    match sensor.pooled.random_walk {
        Parameter::Observable { value, low90, high90, .. } => {
            let spread = (high90 / low90).ln() / (2.0 * 1.645);
            assert!(
                (value / k).ln().abs() < 6.0 * spread,
                "K {value} ({low90} to {high90}), not {k}"
            );
        }
        Parameter::NotObservable { upper90, .. } => assert!(upper90 > 0.5 * k, "{upper90} {k}"),
    }
}

#[test]
fn everything_at_once() {
    let calibration = calibrated(Disturbances::all(LENGTH_S), 11, false);
    let (Some(gyroscope), Some(accelerometer)) =
        (&calibration.gyroscope, &calibration.accelerometer)
    else {
        panic!("both sensors are there")
    };
    assert_noise(gyroscope, 0.015, 5e-5);
    assert_noise(accelerometer, 0.019, 5e-4);
    for sensor in [gyroscope, accelerometer] {
        let (first, last) = (&sensor.disturbed[0], sensor.disturbed.last().unwrap());
        assert!(first.from_s == 0.0 && (24.0..32.0).contains(&first.to_s), "{first:?}");
        assert!((7165.0..7178.0).contains(&last.from_s), "{last:?}");
        assert!((600.0..=3600.0).contains(&sensor.warm_up_s.unwrap()), "{:?}", sensor.warm_up_s);
        assert_eq!(sensor.ramp, None);
    }
    let bump = &accelerometer.disturbed[1];
    assert!(bump.from_s > 3940.0 && bump.to_s < 3980.0, "{bump:?}");
    let told = |words: &str| calibration.warnings.iter().any(|w| w.contains(words));
    assert!(told("gyroscope: moved, touched or shaken for"), "{:?}", calibration.warnings);
    assert!(told("left out (--keep-all would keep it)"));
    assert!(told("as a sensor does that warms up"));
}

/// With --keep-all the result is wrong, and the report says why.
#[test]
fn everything_kept() {
    let calibration = calibrated(Disturbances::all(LENGTH_S), 11, true);
    let Some(gyroscope) = &calibration.gyroscope else { panic!("there is a gyroscope") };
    let Parameter::Observable { low90, .. } = gyroscope.pooled.random_walk else { panic!("K") };
    assert!(low90 > 1e-4, "twice the true K at least: {low90}");
    let told = |words: &str| calibration.warnings.iter().any(|w| w.contains(words));
    assert!(told("N and K are those of the motion"), "{:?}", calibration.warnings);
    assert!(told("read as random walk: K is too large"));
}

#[test]
fn a_ramp_all_along_is_read_past() {
    let what = Disturbances { ramp_per_hour: 0.1, ..Disturbances::default() };
    let calibration = calibrated(what, 3, false);
    let Some(gyroscope) = &calibration.gyroscope else { panic!("there is a gyroscope") };
    assert_noise(gyroscope, 0.015, 5e-5);
    for slope in gyroscope.ramp.expect("a ramp") {
        // The walk goes 5e-5·√4800 = 0.0035 between the quarters, 0.0023 an hour; six of those.
        assert!((slope * 3600.0 - 0.1).abs() < 6.0 * 0.0023, "{slope}");
    }
    assert!(calibration.warnings.iter().any(|w| w.contains("Hadamard variance")));
}

/// Nothing is found where nothing is.
#[test]
fn rest_is_rest() {
    let calibration = calibrated(Disturbances::default(), 5, false);
    for sensor in [&calibration.gyroscope, &calibration.accelerometer].into_iter().flatten() {
        assert!(sensor.disturbed.is_empty() && sensor.ramp.is_none(), "{:?}", sensor.disturbed);
        assert_eq!(sensor.warm_up_s, None);
    }
}
