use super::super::Difference;
use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const ALLAN: Sampling =
    Sampling { tau0_s: 0.01, difference: Difference::Allan, windows: 4, records: 1 };
const LEVELS: usize = 24;

/// Q, N, B, K, R.
type Values = [f64; TERMS];

/// The expected octaves of these terms, for a record of n samples.
fn expected(values: Values, samples: u64, sampling: Sampling) -> [Octave; LEVELS] {
    let mut level = 0_u32;
    [(); LEVELS].map(|()| {
        let m = 1_u64 << level;
        level += 1;
        let spans = sampling.difference.blocks();
        let stride = (m / u64::from(sampling.windows)).max(1);
        let differences = samples.checked_sub(spans * m).map_or(0, |rest| rest / stride + 1);
        let mut octave = Octave { samples: m, differences, variance: 0.0, white_gain: 1.0 };
        if differences > 0 {
            let ones = of_ones(&octave, &sampling);
            octave.variance = ones.iter().zip(values).map(|(one, v)| one * v * v).sum();
        }
        octave
    })
}

fn value(parameter: Option<Parameter>) -> f64 {
    match parameter {
        Some(Parameter::Observable { value, low90, high90, sd }) => {
            assert!(low90 < value && value < high90 && sd > 0.0);
            value
        }
        other => panic!("{other:?}"),
    }
}

/// Every term well above its limit at some τ: R·T is 100 times the walk's way, B three times the minimum of the rest.
const EVERY: Values = [3e-4, 0.01, 4e-3, 2e-4, 2e-4];

/// Variances at their expectations are fitted by the terms that they came from, to the pull of the longest octaves.
#[test]
fn expectations_are_fitted() {
    for windows in [1, 4] {
        let sampling = Sampling { windows, ..ALLAN };
        let octaves = expected(EVERY, 1_440_000, sampling);
        let fit = fit_terms(&octaves, sampling, Terms::ALL);
        let found =
            [fit.quantisation, Some(fit.noise_density), fit.bias_instability, None, fit.rate_ramp];
        for ((found, truth), within) in
            found.into_iter().zip(EVERY).zip([0.01, 0.01, 0.05, 0.0, 0.05])
        {
            if found.is_some() {
                assert!((value(found) / truth - 1.0).abs() < within, "{truth} {fit:?}");
            }
        }
        assert!(!fit.misfit && fit.contradiction.is_none());
        let chosen = select_terms(&octaves, sampling);
        assert_eq!(chosen.terms, Terms::ALL);
        // The search ends where a step gains less than 1e-7 of a deviance.
        let values = [fit, chosen].map(|fit| value(fit.bias_instability));
        assert!((values[0] / values[1] - 1.0).abs() < 1e-4, "{values:?}");
        // The Hadamard variance has no ramp in it.
        let sampling = Sampling { difference: Difference::Hadamard, ..sampling };
        let fit = fit_terms(&expected(EVERY, 1_440_000, sampling), sampling, Terms::ALL);
        assert_eq!(fit.rate_ramp, None);
        assert!(!fit.terms.rate_ramp);
        assert!((value(fit.bias_instability) / EVERY[FLICKER] - 1.0).abs() < 0.05, "{fit:?}");
        assert!((value(fit.quantisation) / EVERY[QUANTISATION] - 1.0).abs() < 0.01, "{fit:?}");
    }
}

/// Where N and K are all, the selection is the fit of N and K, to the bit; forced terms are not observable.
#[test]
fn white_noise_and_walk_ask_for_nothing() {
    let octaves = expected([0.0, 0.015, 0.0, 5e-5, 0.0], 2_880_000, ALLAN);
    let plain = fit_noise(&octaves, ALLAN);
    for fit in [select_terms(&octaves, ALLAN), fit_terms(&octaves, ALLAN, Terms::default())] {
        assert_eq!(fit, TermsFit::of(plain));
    }
    let fit = fit_terms(&octaves, ALLAN, Terms::ALL);
    for (parameter, small) in [
        // Half of the count at which quantisation equals white noise at one sample; the curve's minimum.
        (fit.quantisation, 0.5 * 0.015 * (0.01_f64 / 3.0).sqrt()),
        (fit.bias_instability, 2.0 * 9.3e-4),
        // Ten times what the walk goes by.
        (fit.rate_ramp, 10.0 * 5e-5 / 28_800_f64.sqrt()),
    ] {
        let Some(Parameter::NotObservable { upper90, record_at_least_s }) = parameter else {
            panic!("{fit:?}");
        };
        assert!(upper90 > 0.0 && upper90 < small, "{upper90} {small}");
        assert!(record_at_least_s >= 2.0 * 28_800.0 * 0.999);
    }
    assert!((value(Some(fit.random_walk)) / 5e-5 - 1.0).abs() < 0.1, "{fit:?}");
}

/// A term alone beside N and K is the one that is chosen, and the likelihood ratio says by how much.
#[test]
fn each_is_chosen_by_itself() {
    let only = |term: usize, value: f64| {
        let mut values = [0.0, 0.015, 0.0, 5e-5, 0.0];
        values[term] = value;
        let octaves = expected(values, 2_880_000, ALLAN);
        let fit = select_terms(&octaves, ALLAN);
        let ratio = likelihood_ratio(&octaves, ALLAN, 0, Terms::default(), fit.terms);
        assert!(ratio > CRITICAL, "{ratio} {fit:?}");
        assert_eq!(likelihood_ratio(&octaves, ALLAN, 0, fit.terms, fit.terms), 0.0);
        fit.terms
    };
    assert_eq!(only(QUANTISATION, 3e-4), Terms { quantisation: true, ..Terms::default() });
    assert_eq!(only(FLICKER, 4e-3), Terms { bias_instability: true, ..Terms::default() });
    assert_eq!(only(RAMP, 1e-5), Terms { rate_ramp: true, ..Terms::default() });
}

/// A low-pass is no quantisation and no flicker: short τ are left out as they are without more terms.
#[test]
fn a_filter_asks_for_nothing() {
    let mut octaves = expected([0.0, 0.015, 0.0, 5e-5, 0.0], 2_880_000, ALLAN);
    for (octave, factor) in octaves.iter_mut().zip([0.1, 0.3, 0.6, 0.85, 0.95]) {
        octave.variance *= factor;
    }
    let fit = select_terms(&octaves, ALLAN);
    assert_eq!(fit, TermsFit::of(fit_noise(&octaves, ALLAN)));
    assert!(fit.contradiction.is_some());
    // Behind a filter flicker is still seen, and N is that of the octaves behind it.
    let mut octaves = expected([0.0, 0.015, 4e-3, 5e-5, 0.0], 2_880_000, ALLAN);
    for (octave, factor) in octaves.iter_mut().zip([0.1, 0.3, 0.6, 0.85, 0.95]) {
        octave.variance *= factor;
    }
    let fit = select_terms(&octaves, ALLAN);
    assert_eq!(fit.terms, Terms { bias_instability: true, ..Terms::default() });
    assert!((value(fit.bias_instability) / 4e-3 - 1.0).abs() < 0.05, "{fit:?}");
    assert!((value(Some(fit.noise_density)) / 0.015 - 1.0).abs() < 0.05, "{fit:?}");
}

/// The curve and its degrees of freedom are those of the terms.
#[test]
fn curve_and_degrees() {
    let octaves = expected(EVERY, 1_440_000, ALLAN);
    let fit = fit_terms(&octaves, ALLAN, Terms::ALL);
    for octave in octaves.iter().filter(|o| o.differences >= 6) {
        assert!((fit.variance(octave, ALLAN) / octave.variance - 1.0).abs() < 0.2, "{octave:?}");
        let degrees = fit.degrees(octave, ALLAN);
        assert!(degrees >= 1.0, "{degrees}");
    }
    let nothing = TermsFit::of(fit_noise(&[], ALLAN));
    let octave = Octave { samples: 4, differences: 100, variance: 1.0, white_gain: 1.0 };
    assert!(nothing.degrees(&octave, ALLAN) > 1.0);
    assert_eq!(nothing.degrees(&Octave { differences: 0, ..octave }, ALLAN), 0.0);
}

fn octave() -> impl Strategy<Value = Octave> {
    let number = prop_oneof![
        4 => 1e-12..1e12_f64,
        1 => prop::sample::select(std::vec![0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320, 1e308]),
    ];
    let gain = prop_oneof![8 => 1.0..2.0_f64, 1 => prop::sample::select(std::vec![0.0, f64::NAN, 1e300, -1.0])];
    let count = prop_oneof![0_u64..5, 0_u64..1_000_000, Just(u64::MAX)];
    (0_u32..40, count, number, gain).prop_map(|(level, differences, variance, white_gain)| Octave {
        samples: 1 << level,
        differences,
        variance,
        white_gain,
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 150,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Whatever comes in: no NaN, nothing negative, an answer.
    #[test]
    fn anything_gets_an_answer(
        octaves in prop::collection::vec(octave(), 0..24),
        tau0_s in prop_oneof![1e-5..10_f64, Just(0.0), Just(f64::NAN), Just(f64::INFINITY)],
        windows in prop::sample::select(std::vec![0_u8, 1, 4, 255]),
        records in prop::sample::select(std::vec![0_u32, 1, 3, u32::MAX]),
        hadamard: bool,
        [quantisation, bias_instability, rate_ramp]: [bool; 3],
    ) {
        let difference = if hadamard { Difference::Hadamard } else { Difference::Allan };
        let sampling = Sampling { tau0_s, difference, windows, records };
        let terms = Terms { quantisation, bias_instability, rate_ramp };
        for fit in [select_terms(&octaves, sampling), fit_terms(&octaves, sampling, terms)] {
            let all = [
                fit.quantisation,
                Some(fit.noise_density),
                fit.bias_instability,
                Some(fit.random_walk),
                fit.rate_ramp,
            ];
            for parameter in all.into_iter().flatten() {
                match parameter {
                    Parameter::Observable { value, sd, low90, high90 } => {
                        prop_assert!(value >= 0.0 && sd >= 0.0, "{:?}", fit);
                        prop_assert!(low90 <= value && value <= high90, "{:?}", fit);
                    }
                    Parameter::NotObservable { upper90, record_at_least_s } => {
                        prop_assert!(upper90 >= 0.0 && record_at_least_s >= 0.0, "{:?}", fit);
                    }
                }
            }
        }
        prop_assert!(likelihood_ratio(&octaves, sampling, 0, Terms::default(), terms) >= 0.0);
    }
}
