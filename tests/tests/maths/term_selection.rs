//! The choice of terms by Monte Carlo, smaller than `examples/term_selection.rs`.
//!
//! Bounds: a count of k expected is exceeded by chance once in a million at k + 5√k + 4 (Poisson, k ≤ 2: 9 and 12); an
//! rms error scatters by 1/√(2n) of itself.

use imu_core::allan::{Parameter, Terms, TermsFit, fit_noise, select_terms};
use imu_tests::term_records::{ACCELEROMETER, GYROSCOPE, Truth, chosen, each, selections};

/// A fifth of the samples of the example: statistics of B and R know K·T/N only.
const fn slower(truth: Truth) -> Truth {
    Truth { rate_hz: 4.0, ..truth }
}

const RECORDS: u64 = 100;

/// Each is added in 0.2 % of records at most: of 100 in 0.2, and in 5 once in 400 000.
#[test]
fn nothing_is_added_to_white_noise_and_walk() {
    for truth in [slower(GYROSCOPE), slower(ACCELEROMETER)] {
        let sampling = truth.sampling();
        let pairs = each(&truth, 1, RECORDS, |octaves| {
            (select_terms(octaves, sampling), fit_noise(octaves, sampling))
        });
        let fits: Vec<TermsFit> = pairs.iter().map(|pair| pair.0).collect();
        assert!(chosen(&fits).into_iter().all(|count| count <= 4), "{:?}", chosen(&fits));
        for (fit, plain) in pairs.iter().filter(|(fit, _)| fit.terms == Terms::default()) {
            assert_eq!(fit.noise_density, plain.noise_density);
            assert_eq!(fit.random_walk, plain.random_walk);
        }
    }
}

/// Behind a low-pass neither.
#[test]
fn nothing_is_added_behind_a_filter() {
    let truth = Truth { lowpass_hz: 0.84, ..slower(ACCELEROMETER) };
    let fits = selections(&truth, 1, RECORDS);
    assert!(chosen(&fits).into_iter().all(|count| count <= 4), "{:?}", chosen(&fits));
    assert!(fits.iter().all(|fit| fit.contradiction.is_some()));
}

/// Found in at least 90 %, less 5 √(0.09/100) for chance; those within 15 % likewise.
fn assert_found(truth: &Truth, of: impl Fn(&TermsFit) -> Option<Parameter>, value: f64) {
    let fits = selections(truth, 1, RECORDS);
    let found: Vec<Parameter> = fits.iter().filter_map(of).collect();
    assert!(found.len() >= 75, "{} of {RECORDS}: {truth:?}", found.len());
    let near = found.iter().filter(
        |p| matches!(p, Parameter::Observable { value: v, .. } if (v / value - 1.0).abs() <= 0.15),
    );
    let near = near.count();
    assert!(near * 100 >= 75 * found.len(), "{near} of {}: {truth:?}", found.len());
}

#[test]
fn flicker_is_found() {
    for truth in [slower(GYROSCOPE).with_flicker(3.0), slower(ACCELEROMETER).with_flicker(3.0)] {
        assert_found(&truth, |fit| fit.bias_instability, truth.bias_instability);
    }
}

#[test]
fn quantisation_is_found() {
    let truth = GYROSCOPE.with_quantisation(0.1);
    assert_found(&truth, |fit| fit.quantisation, truth.quantisation);
}

#[test]
fn a_ramp_is_found() {
    for truth in [slower(GYROSCOPE).with_ramp(30.0), slower(ACCELEROMETER).with_ramp(30.0)] {
        assert_found(&truth, |fit| fit.rate_ramp, truth.rate_ramp);
    }
}

/// All five: none is a misfit (of 100 records in fewer than 4), and B and Q are right.
#[test]
fn all_five_together() {
    let truth = slower(ACCELEROMETER).with_flicker(3.0).with_quantisation(10.0).with_ramp(100.0);
    assert_found(&truth, |fit| fit.bias_instability, truth.bias_instability);
    assert_found(&truth, |fit| fit.quantisation, truth.quantisation);
    let misfits = selections(&truth, 1, RECORDS).iter().filter(|fit| fit.misfit).count();
    assert!(misfits < 4, "{misfits}");
}
