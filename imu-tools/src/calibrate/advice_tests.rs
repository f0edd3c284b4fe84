//! Records of white noise at 200 Hz in which something is wrong, and the sentences that they get.

use super::*;
use crate::calibrate::sensor::Pipeline;
use crate::calibrate::{Options, SensorKind, refusal};
use crate::recording::Sample;

const RATE: usize = 200;

/// A minute and more of white noise of standard deviation 1, as `change` makes it.
fn record(seconds: usize, change: impl Fn(usize, &mut [f64; 3])) -> SensorNoise {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut uniform = move || {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut pipeline = Pipeline::new(SensorKind::Gyroscope, &Options::default());
    let samples: Vec<Sample> = (0..seconds * RATE)
        .map(|k| {
            let mut value = [(); 3].map(|()| (0..12).map(|_| uniform()).sum::<f64>() - 6.0);
            change(k, &mut value);
            Sample { stamp_ns: k as i64 * 5_000_000, value }
        })
        .collect();
    samples.chunks(1000).for_each(|part| pipeline.push(part));
    pipeline.finish().unwrap()
}

#[track_caller]
fn assert_told(sensor: &SensorNoise, words: &str) {
    let told = warnings(sensor, false);
    assert!(told.iter().any(|sentence| sentence.contains(words)), "{words}: {told:?}");
}

#[track_caller]
fn assert_not_told(sensor: &SensorNoise, words: &str) {
    let told = warnings(sensor, false);
    assert!(!told.iter().any(|sentence| sentence.contains(words)), "{words}: {told:?}");
}

#[test]
fn a_frozen_axis_is_named_with_its_time() {
    let sensor = record(600, |k, value| {
        if k >= 300 * RATE {
            value[1] = 0.25;
        }
    });
    assert_told(&sensor, "axis y stood still (300");
    assert_told(&sensor, " to 600 s), as a sensor or a driver does that hangs: left out");
    assert_not_told(&sensor, "moved, touched or shaken");
}

#[test]
fn a_frozen_sensor_is_no_fast_driver() {
    let sensor = record(600, |k, value| {
        if k >= 300 * RATE {
            *value = [0.25, 0.5, -0.5];
        }
    });
    assert_told(&sensor, "all axes stood still (");
    assert_not_told(&sensor, "publishes faster");
}

/// Walking: 2 Hz, a hundred times the noise at that τ.
#[test]
fn motion_all_the_time_is_named() {
    let sensor = record(300, |k, value| {
        let phase = k as f64 / RATE as f64 * 2.0 * std::f64::consts::TAU;
        *value = [0, 1, 2].map(|axis| value[axis] + 30.0 * (phase + axis as f64).sin());
    });
    assert_told(&sensor, "moved or shaken all the time: at τ = 0.");
    assert_not_told(&sensor, "warms up");
    assert_not_told(&sensor, "low-pass filter");
}

#[test]
fn a_low_pass_is_no_motion() {
    let state = std::cell::Cell::new([0.0; 3]);
    let sensor = record(600, |_, value| {
        let before = state.get();
        *value = [0, 1, 2].map(|axis| before[axis] + 0.3 * (value[axis] - before[axis]));
        state.set(*value);
    });
    assert_told(&sensor, "as a low-pass filter or a vibration makes them do");
    assert_not_told(&sensor, "all the time");
}

/// What settles in seconds does not warm up, and its time has a digit.
#[test]
fn seconds_are_no_warm_up() {
    let mut sensor = record(60, |_, _| {});
    sensor.warm_up_s = Some(0.32);
    assert_told(&sensor, "the first 0.3 s go further than the noise of the rest does");
    assert_not_told(&sensor, "warms up");
    sensor.warm_up_s = Some(320.0);
    assert_told(&sensor, "the first 5 min 20 s drift as a sensor does that warms up");
}

#[test]
fn what_is_rejected_is_named_for_what_it_is() {
    let refused = |sensor: SensorNoise| {
        let error = refusal::of_samples("file", &Some(sensor), &None, &Options::default());
        error.expect("a refusal").to_string()
    };
    let sentence = refused(record(60, |k, value| {
        if k % 7 == 0 {
            value[1] = f64::NAN;
        }
    }));
    assert!(sentence.contains("are not finite (empty fields"), "{sentence}");
    assert!(!sentence.contains("--from"), "{sentence}");
    let sentence = refused(record(60, |k, value| {
        *value = if k % 8 == 1 { [0.0; 3] } else { value.map(|x| 1e5 + x) };
    }));
    assert!(sentence.contains("12 % of the first ones being 0 on all axes"), "{sentence}");
}
