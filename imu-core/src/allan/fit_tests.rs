use super::super::Difference;
use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const ALLAN: Sampling =
    Sampling { tau0_s: 0.01, difference: Difference::Allan, windows: 4, records: 1 };

/// The expected octaves of white noise and random walk, for a record of n samples.
fn expected(n: f64, k: f64, samples: u64, sampling: Sampling) -> [Octave; 24] {
    let mut level = 0_u32;
    [(); 24].map(|()| {
        let m = 1_u64 << level;
        level += 1;
        let (tau, m2) = (m as f64 * sampling.tau0_s, (m as f64) * (m as f64));
        let (spans, walk) = match sampling.difference {
            Difference::Allan => (2, (1.0 + 0.5 / m2) / 3.0),
            Difference::Hadamard => (3, (1.0 + 1.0 / m2) / 6.0),
        };
        let stride = (m / u64::from(sampling.windows)).max(1);
        let differences = samples.checked_sub(spans * m).map_or(0, |rest| rest / stride + 1);
        Octave {
            samples: m,
            differences,
            variance: if differences > 0 { n * n / tau + k * k * tau * walk } else { 0.0 },
            white_gain: 1.0,
        }
    })
}

fn value(parameter: Parameter) -> f64 {
    match parameter {
        Parameter::Observable { value, low90, high90, sd } => {
            assert!(low90 < value && value < high90 && sd > 0.0);
            value
        }
        Parameter::NotObservable { .. } => panic!("not observable"),
    }
}

/// Variances at their expectations are fitted by the parameters that they came from. The cube
/// root's mean is below 1 by 2/9ν, so the longest octaves pull by a fraction of their own scatter.
#[test]
fn expectations_are_fitted() {
    for difference in [Difference::Allan, Difference::Hadamard] {
        for windows in [1, 4] {
            for (n, k) in [(0.015, 5e-5), (0.019, 5e-4), (2e-5, 3e-8), (1.0, 1.0)] {
                let sampling = Sampling { difference, windows, ..ALLAN };
                let fit = fit_noise(&expected(n, k, 1_440_000, sampling), sampling);
                assert!((value(fit.noise_density) / n - 1.0).abs() < 2e-4, "{fit:?}");
                // 2(N/K)/T ≤ 4 %: a fifth of it.
                assert!((value(fit.random_walk) / k - 1.0).abs() < 0.05, "{fit:?}");
                assert_eq!(fit.contradiction, None);
                assert_eq!(fit.used.map(|used| used.0), Some(0));
            }
        }
    }
}

/// Scaling signal and time scales the parameters, to rounding and the step of the search.
#[test]
fn the_fit_knows_no_units() {
    let base = expected(0.015, 5e-5, 1_000_000, ALLAN);
    let fit = fit_noise(&base, ALLAN);
    let scaled = base.map(|o| Octave { variance: o.variance * 1e12, ..o });
    let slow = Sampling { tau0_s: ALLAN.tau0_s * 64.0, ..ALLAN };
    let other = fit_noise(&scaled, slow);
    // N² = variance·τ; K² = variance/τ.
    assert!((value(other.noise_density) / value(fit.noise_density) / 8e6 - 1.0).abs() < 1e-3);
    assert!((value(other.random_walk) / value(fit.random_walk) * 8.0 / 1e6 - 1.0).abs() < 1e-3);
}

#[test]
fn no_walk_is_not_observable_and_bounded() {
    let octaves = expected(0.01, 0.0, 1_000_000, ALLAN);
    let fit = fit_noise(&octaves, ALLAN);
    let Parameter::NotObservable { upper90, record_at_least_s } = fit.random_walk else {
        panic!("{fit:?}");
    };
    // The walk would show at √(2N/(K T)) ≈ 1: K ≈ 2N/T = 2e-6; the bound is of that order.
    assert!(upper90 > 2e-7 && upper90 < 2e-5, "{upper90}");
    assert!(record_at_least_s >= 20_000.0);
    assert!((value(fit.noise_density) / 0.01 - 1.0).abs() < 1e-3);
}

#[test]
fn no_white_noise_is_not_observable_and_bounded() {
    let octaves = expected(1e-9, 1.0, 100_000, ALLAN);
    let fit = fit_noise(&octaves, ALLAN);
    assert!((value(fit.random_walk) - 1.0).abs() < 0.02);
    let Parameter::NotObservable { upper90, .. } = fit.noise_density else { panic!("{fit:?}") };
    // White noise as large as the walk's share at τ0 (0.005) would show easily.
    assert!(upper90 < 0.005, "{upper90}");
}

/// A low-pass makes short τ too small: they are left out, and the rest is fitted.
#[test]
fn short_octaves_that_contradict_are_left_out() {
    let mut octaves = expected(0.015, 5e-5, 2_880_000, ALLAN);
    for (octave, factor) in octaves.iter_mut().zip([0.1, 0.3, 0.6, 0.85, 0.95]) {
        octave.variance *= factor;
    }
    let fit = fit_noise(&octaves, ALLAN);
    let contradiction = fit.contradiction.unwrap();
    assert!(contradiction.octave >= 5 && contradiction.octave <= 7, "{contradiction:?}");
    assert!(contradiction.sigmas > 4.0);
    assert_eq!(fit.used.unwrap().0, contradiction.octave + 1);
    assert!((value(fit.noise_density) / 0.015 - 1.0).abs() < 0.005);
    assert!((value(fit.random_walk) / 5e-5 - 1.0).abs() < 0.1);
    // All octaves together would be far off.
    let all = fit_noise_from(&octaves, ALLAN, 0);
    assert!(match all.noise_density {
        Parameter::Observable { value, .. } => (value / 0.015 - 1.0).abs() > 0.3,
        Parameter::NotObservable { .. } => true,
    });
}

/// Flicker in the middle: the short octaves are white, so N is theirs, and the fit says that white
/// noise and random walk are not all.
#[test]
fn flicker_is_no_filter() {
    let mut octaves = expected(0.001, 1e-6, 2_880_000, ALLAN);
    for octave in &mut octaves {
        if octave.differences > 0 {
            octave.variance += 2e-4 * 2e-4;
        }
    }
    let fit = fit_noise(&octaves, ALLAN);
    assert_eq!(fit.contradiction, None);
    assert!(fit.misfit);
    assert!((value(fit.noise_density) / 0.001 - 1.0).abs() < 0.05, "{fit:?}");
    assert!(!fit_noise(&expected(0.001, 1e-6, 2_880_000, ALLAN), ALLAN).misfit);
}

/// One octave that is off among good ones is no reason to throw away the shorter ones.
#[test]
fn a_single_outlier_is_no_contradiction() {
    let mut octaves = expected(0.015, 5e-5, 2_880_000, ALLAN);
    octaves[6].variance *= 1.03; // 5.5 standard deviations
    let fit = fit_noise(&octaves, ALLAN);
    assert_eq!(fit.contradiction, None);
    assert!((value(fit.noise_density) / 0.015 - 1.0).abs() < 0.005);
}

/// Axes averaged have the interval of one, over √3.
#[test]
fn pooling_narrows_the_interval() {
    let axis = expected(0.019, 5e-4, 2_880_000, ALLAN);
    let one = fit_noise(&axis, ALLAN);
    let three = fit_noise(&average_octaves(&[axis; 3]), Sampling { records: 3, ..ALLAN });
    let (Parameter::Observable { sd: wide, .. }, Parameter::Observable { sd: narrow, .. }) =
        (one.random_walk, three.random_walk)
    else {
        panic!()
    };
    assert!((wide / narrow / 3_f64.sqrt() - 1.0).abs() < 0.1, "{}", wide / narrow);
    assert_eq!(average_octaves::<4>(&[]).map(|o| o.differences), [0; 4]);
}

fn octave() -> impl Strategy<Value = Octave> {
    let number = prop_oneof![
        4 => 1e-12..1e12_f64,
        1 => prop::sample::select(std::vec![0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320, 1e308]),
    ];
    let count = prop_oneof![0_u64..5, 0_u64..1_000_000, Just(u64::MAX)];
    (0_u32..40, count, number, 1.0..2.0_f64).prop_map(
        |(level, differences, variance, white_gain)| Octave {
            samples: 1 << level,
            differences,
            variance,
            white_gain,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 300,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Whatever comes in: no NaN, nothing negative, an answer.
    #[test]
    fn anything_gets_an_answer(
        octaves in prop::collection::vec(octave(), 0..32),
        tau0_s in prop_oneof![1e-5..10_f64, Just(0.0), Just(f64::NAN), Just(f64::INFINITY)],
        windows in prop::sample::select(std::vec![0_u8, 1, 4, 255]),
        records in prop::sample::select(std::vec![0_u32, 1, 3, u32::MAX]),
        hadamard: bool,
    ) {
        let difference = if hadamard { Difference::Hadamard } else { Difference::Allan };
        let sampling = Sampling { tau0_s, difference, windows, records };
        let fit = fit_noise(&octaves, sampling);
        for parameter in [fit.noise_density, fit.random_walk] {
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
}
