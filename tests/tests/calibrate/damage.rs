//! Recordings with faults: what is lost or absurd is counted and reported, and costs the result
//! nothing but its share.

use imu_tests::recordings::{
    Folder, SCENE, assert_truth, calibrate, deviations_off, json, number, simulated,
};
use imu_tools::recording::{Block, Sample};
use serde_json::Value;

/// Does this to both sensors.
fn change(block: &mut Block, mut change: impl FnMut(&mut Vec<Sample>)) {
    change(&mut block.gyroscope);
    change(&mut block.accelerometer);
}

/// The shortest and longest τ that decided, and the longest that was read.
fn taus(calibration: &Value, sensor: &str) -> [f64; 3] {
    let deviation = calibration[sensor]["deviation"].as_array().expect("deviations");
    [
        number(&calibration[sensor], "/tau_used_s/0"),
        number(&calibration[sensor], "/tau_used_s/1"),
        number(deviation.last().expect("a deviation"), "/tau_s"),
    ]
}

/// Whether some warning about this sensor holds these words.
fn warns(calibration: &Value, sensor: &str, words: &str) -> bool {
    let warnings = calibration["recording"]["warnings"].as_array().expect("warnings");
    warnings
        .iter()
        .filter_map(Value::as_str)
        .any(|warning| warning.starts_with(sensor) && warning.contains(words))
}

#[test]
fn numbers_that_are_none_are_missing() {
    let (folder, whole) = (Folder::new(), simulated(SCENE, 21));
    let untouched = json(&[&folder.record("whole.bag", &whole)]);
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e30, -1e30, 1e300];
    let mut block = whole;
    change(&mut block, |samples| {
        for (k, bad) in bad.into_iter().enumerate() {
            samples[20_000 + 7919 * k].value[k % 3] = bad;
        }
    });
    for name in ["a.bag", "a.csv"] {
        let calibration = json(&[&folder.record(name, &block)]);
        assert_truth(&calibration);
        for sensor in ["gyroscope", "accelerometer"] {
            assert_eq!(calibration[sensor]["non_finite"], bad.len());
            assert!(warns(&calibration, sensor, "6 samples are not finite or absurdly large"));
            assert_eq!(calibration[sensor]["gaps"], Value::Array(Vec::new()), "rows are there");
            assert_eq!(taus(&calibration, sensor), taus(&untouched, sensor));
        }
    }
}

#[test]
fn a_glitch_at_the_start_is_not_the_measure_of_the_rest() {
    let (folder, mut block) = (Folder::new(), simulated(SCENE, 22));
    change(&mut block, |samples| samples[0].value = [1e4; 3]);
    for name in ["a.bag", "a.csv"] {
        let calibration = json(&[&folder.record(name, &block)]);
        assert_truth(&calibration);
        for sensor in ["gyroscope", "accelerometer"] {
            assert_eq!(calibration[sensor]["non_finite"], 1);
        }
    }
}

/// Drops about one sample in a hundred, by the bits of a xorshift generator.
fn drop_one_percent(samples: &mut Vec<Sample>, mut state: u64) {
    samples.retain(|_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 >= 0.01 * (1_u64 << 53) as f64
    });
}

/// Drops a minute from second 800.
fn drop_a_minute(samples: &mut Vec<Sample>) {
    let start = samples[0].stamp_ns + 800_000_000_000;
    samples.retain(|s| !(start..start + 60_000_000_000).contains(&s.stamp_ns));
}

#[test]
fn losses_are_counted_and_cost_their_share() {
    let folder = Folder::new();
    for (seed, percent, minute) in [(23, true, false), (24, false, true), (25, true, true)] {
        let mut block = simulated(SCENE, seed);
        let untouched = json(&[&folder.record("whole.bag", &block)]);
        let ends = [0, block.gyroscope.len() - 1].map(|i| block.gyroscope[i]);
        if percent {
            change(&mut block, |samples| drop_one_percent(samples, 88_172_645_463_325_252));
        }
        if minute {
            change(&mut block, drop_a_minute);
        }
        // Nobody can count what is missing before the first or after the last stamp.
        assert_eq!([block.gyroscope[0], block.gyroscope[block.gyroscope.len() - 1]], ends);
        let missing = 100_000 - block.gyroscope.len();
        for name in ["a.bag", "a.csv"] {
            let calibration = json(&[&folder.record(name, &block)]);
            assert_truth(&calibration);
            for sensor in ["gyroscope", "accelerometer"] {
                let words = format!("samples missing: {missing},");
                assert!(warns(&calibration, sensor, &words), "{}", calibration["recording"]);
                assert_eq!(calibration[sensor]["samples"], block.gyroscope.len());
                // As long a τ as without losses.
                assert_eq!(taus(&calibration, sensor), taus(&untouched, sensor));
                let gaps = calibration[sensor]["gaps"].as_array().expect("gaps");
                if minute {
                    let found = gaps.iter().any(|gap| {
                        number(gap, "/missing") >= 3000.0
                            && (number(gap, "/at_s") - 800.0).abs() < 1.0
                    });
                    // Of many gaps only the first are listed, all are counted.
                    assert!(found || percent, "{gaps:?}");
                }
                assert!(!gaps.is_empty());
            }
        }
    }
}

#[test]
fn jitter_is_no_gap_and_changes_nothing() {
    let (folder, mut block) = (Folder::new(), simulated(SCENE, 26));
    let even = json(&[&folder.record("even.bag", &block)]);
    // ± 6 ms about a step of 20 ms, from a sequence that is spread evenly (Weyl).
    change(&mut block, |samples| {
        for (k, sample) in samples.iter_mut().enumerate() {
            sample.stamp_ns += (k as i64 * 7_639_320_225) % 12_000_001 - 6_000_000;
        }
    });
    for name in ["a.bag", "a.csv"] {
        let jittered = json(&[&folder.record(name, &block)]);
        for sensor in ["gyroscope", "accelerometer"] {
            assert_eq!(jittered[sensor]["samples"], 100_000);
            assert_eq!(jittered[sensor]["gaps"], Value::Array(Vec::new()));
            assert_eq!(jittered[sensor]["backward"], 0);
            // Rates, fitted over 2000 s, differ by less than 12 ms in all.
            let rate = number(&jittered[sensor], "/rate_hz");
            assert!((rate / 50.0 - 1.0).abs() < 6e-6, "{rate}");
            for name in ["noise_density", "random_walk"] {
                let place = format!("/{sensor}/pooled/{name}/value");
                let ratio = number(&jittered, &place) / number(&even, &place);
                // N goes with √τ₀, K with 1/√τ₀, and its interval's prior with neither.
                assert!((ratio - 1.0).abs() < 6e-6, "{place}: {ratio}");
            }
        }
    }
}

#[test]
fn stamps_twice_or_backward_are_counted() {
    let (folder, mut block) = (Folder::new(), simulated(SCENE, 27));
    change(&mut block, |samples| {
        let again = samples[500];
        samples.insert(501, again);
        samples[70_000].stamp_ns -= 45_000_000;
    });
    let calibration = json(&[&folder.record("a.bag", &block)]);
    assert_truth(&calibration);
    for sensor in ["gyroscope", "accelerometer"] {
        assert_eq!(calibration[sensor]["duplicates"], 1);
        assert_eq!(calibration[sensor]["backward"], 1);
        assert!(warns(&calibration, sensor, "the same as the one before"));
        assert!(warns(&calibration, sensor, "earlier than the one before"));
    }
}

#[test]
fn a_sensor_behind_a_low_pass_says_what_decided() {
    let folder = Folder::new();
    let mut text = SCENE.replace("[gyroscope]", "[gyroscope]\nlowpass_hz = 5");
    text = text.replace("[accelerometer]", "[accelerometer]\nlowpass_hz = 10");
    let calibration = json(&[&folder.record("a.bag", &simulated(&text, 28))]);
    for (sensor, noise_density, random_walk) in imu_tests::recordings::TRUTH {
        let [shortest, ..] = taus(&calibration, sensor);
        assert!(shortest > 0.02, "{shortest}");
        assert!(warns(&calibration, sensor, "contradict the longer ones"));
        let pooled = &calibration[sensor]["pooled"];
        let off = deviations_off(&pooled["random_walk"], random_walk);
        assert!(off < 5.0, "{off}: {pooled}");
        // A pole at 5 Hz still takes a per cent or two at the τ that are left.
        let ratio = number(pooled, "/noise_density/value") / noise_density;
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    }
    let said = calibrate(&[&folder.at("a.bag")]);
    assert!(said.out.contains("averaging times used: "), "{}", said.out);
}
