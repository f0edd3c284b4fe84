//! The noise fit by Monte Carlo, smaller than `examples/statistics.rs` and with wider bounds.
//!
//! An rms error of n independent estimates scatters by 1/√(2n) of itself, a little more because
//! estimates of K have longer tails than a normal; a share p by √(p(1 − p)/n). Bounds stand 5 to 6
//! of these beyond what the estimator does: 1e-6 of all seeds would break them.

use imu_core::allan::{Difference, Ladder, NoiseFit, Parameter, Sampling, fit_noise};
use imu_tests::monte_carlo::{Case, Loss, Outcome, Scatter, records, scatter};

const RECORDS: u64 = 200;

/// Four hours of the presets' middle level, 32 times slower: statistics know K·T/N, not the rate.
const GYROSCOPE: Case = Case {
    noise_density: 0.015,
    random_walk: 5e-5,
    rate_hz: 6.25,
    duration_s: 4.0 * 3600.0,
    lowpass_hz: None,
    loss: Loss { probability: 0.0, hole_s: 0.0 },
};

const ACCELEROMETER: Case = Case { noise_density: 0.019, random_walk: 5e-4, ..GYROSCOPE };

/// An rms error within `times` the limit, beyond which only chance would take it.
fn assert_rms(name: &str, s: &Scatter, times: f64, limit: f64) {
    let allowed = times * limit * (1.0 + 6.0 / (2.0 * s.count as f64).sqrt());
    assert!(s.rms <= allowed, "{name}: rms {} beyond {allowed}, limit {limit}", s.rms);
    // No estimator is better than the limit: one that seems to be is not measured rightly.
    let least = limit * (1.0 - 6.0 / (2.0 * s.count as f64).sqrt());
    assert!(s.rms >= least, "{name}: rms {} below {least}", s.rms);
    // A median scatters by 1.25 rms/√n; estimates of K lie up to 2 % low or high.
    let median = 0.02 + 6.0 * 1.25 * s.rms / (s.count as f64).sqrt();
    assert!(s.median.abs() <= median, "{name}: median {}", s.median);
}

/// A coverage of 90 ± 3 %, and what chance adds.
fn assert_coverage(name: &str, s: &Scatter) {
    let chance = 5.0 * (0.9 * 0.1 / s.count as f64).sqrt();
    assert!((s.coverage - 0.9).abs() <= 0.03 + chance, "{name}: coverage {}", s.coverage);
}

fn axes(outcomes: &[Outcome], of: impl Fn(&NoiseFit) -> Parameter) -> Vec<Parameter> {
    outcomes.iter().flat_map(|o| &o.axes).map(of).collect()
}

fn small(outcomes: &[Outcome], of: impl Fn(&NoiseFit) -> Parameter) -> Vec<Parameter> {
    outcomes.iter().flat_map(|o| &o.small).map(of).collect()
}

#[test]
fn estimates_scatter_little_more_than_they_must() {
    for (name, case, first) in [("gyroscope", GYROSCOPE, 1), ("accelerometer", ACCELEROMETER, 1001)]
    {
        let outcomes = records(&case, first, RECORDS);
        let k = |parameters| scatter(parameters, case.random_walk);
        let default = k(axes(&outcomes, |f| f.random_walk));
        assert_rms(name, &default, 1.15, case.limit());
        assert_coverage(name, &default);
        let disjoint = k(small(&outcomes, |f| f.random_walk));
        assert_rms(name, &disjoint, 1.25, case.limit());
        assert_coverage(name, &disjoint);
        let pooled = k(outcomes.iter().map(|o| o.pooled.random_walk).collect());
        assert_rms(name, &pooled, 1.15, case.limit() / 3_f64.sqrt());
        assert_coverage(name, &pooled);
        // K·T/N is 48 and more: K = 0 is 2.5 sd and more away in ln K's terms; 1 % may miss it.
        for s in [default, disjoint] {
            let chance = 0.01 + 5.0 * (0.01 / s.count as f64).sqrt();
            assert!(s.not_observable as f64 <= chance * s.count as f64, "{name}: {s:?}");
        }
        assert_eq!(pooled.not_observable, 0, "{name}");

        // N of n samples by their first differences: sd √(1.5/2n) = 1.22 of the limit; the fit takes
        // longer τ as well, and disjoint blocks give it 1.41 at most.
        let limit = 1.0 / (2.0 * case.duration_s * case.rate_hz).sqrt();
        let n = scatter(axes(&outcomes, |f| f.noise_density), case.noise_density);
        assert_rms(name, &n, 1.3, limit);
        assert_coverage(name, &n);
        let n = scatter(small(&outcomes, |f| f.noise_density), case.noise_density);
        assert_rms(name, &n, 1.5, limit);
        assert_coverage(name, &n);
    }
}

#[test]
fn losses_cost_their_share_only() {
    for (name, loss, first) in [
        ("1 %", Loss { probability: 0.01, hole_s: 0.0 }, 2001),
        ("hole", Loss { probability: 0.0, hole_s: 60.0 }, 3001),
        ("both", Loss { probability: 0.01, hole_s: 60.0 }, 4001),
    ] {
        let case = Case { loss, ..ACCELEROMETER };
        let outcomes = records(&case, first, RECORDS / 2);
        let whole = records(&ACCELEROMETER, first, 1)[0].pooled.used;
        assert!(outcomes.iter().all(|o| o.pooled.used == whole), "{name}: τ as long as without");
        let s = scatter(axes(&outcomes, |f| f.random_walk), case.random_walk);
        assert_rms(name, &s, 1.15, case.limit());
        assert_coverage(name, &s);
    }
}

#[test]
fn low_passes_are_seen_and_left_out() {
    for (hz, first) in [(92.0, 5001), (42.0, 6001), (20.0, 7001)] {
        // N/K = 12.5 s in 600 s: K·T/N = 48, as the gyroscope above.
        let case = Case {
            noise_density: 0.01,
            random_walk: 8e-4,
            rate_hz: 200.0,
            duration_s: 600.0,
            lowpass_hz: Some(hz),
            loss: Loss::default(),
        };
        let outcomes = records(&case, first, RECORDS / 2);
        let n = scatter(axes(&outcomes, |f| f.noise_density), case.noise_density);
        assert!(n.rms < 0.03, "{hz} Hz: {n:?}");
        let k = scatter(axes(&outcomes, |f| f.random_walk), case.random_walk);
        assert_coverage("low-passed", &k);
    }
}

/// A parameter without a number that is none.
fn assert_sound(what: &str, parameter: Parameter) {
    match parameter {
        Parameter::Observable { value, sd, low90, high90 } => {
            assert!(value > 0.0 && value.is_finite(), "{what}: {parameter:?}");
            assert!(sd > 0.0 && sd.is_finite(), "{what}: {parameter:?}");
            assert!(0.0 <= low90 && low90 <= value && value <= high90, "{what}: {parameter:?}");
            assert!(high90.is_finite(), "{what}: {parameter:?}");
        }
        Parameter::NotObservable { upper90, record_at_least_s } => {
            assert!(upper90 > 0.0, "{what}: {parameter:?}");
            assert!(record_at_least_s >= 0.0, "{what}: {parameter:?}");
        }
    }
}

/// Fits, at each of these lengths, a record of uniform noise, its running sum, and a constant.
fn fit_every_length<const WINDOWS: usize, const ORDER: usize>(difference: Difference) {
    let lengths = (0..=200).chain([255, 256, 257, 1000, 4095, 65_536]);
    for length in lengths {
        let mut ladder = Ladder::<f64, 3, 22, WINDOWS, ORDER>::new();
        let (mut state, mut sum) = (88_172_645_463_325_252_u64, 0.0);
        for _ in 0..length {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            let noise = (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
            sum += noise;
            ladder.push(&[noise, sum, 0.25]);
        }
        let sampling = Sampling { tau0_s: 0.005, difference, windows: WINDOWS as u8, records: 1 };
        for axis in 0..3 {
            let fit = fit_noise(&ladder.octaves(axis), sampling);
            let what =
                format!("axis {axis} of {length} samples, {WINDOWS} windows, {difference:?}");
            assert_sound(&what, fit.noise_density);
            assert_sound(&what, fit.random_walk);
        }
    }
}

#[test]
fn no_length_gives_a_number_that_is_none() {
    fit_every_length::<1, 1>(Difference::Allan);
    fit_every_length::<4, 1>(Difference::Allan);
    fit_every_length::<1, 2>(Difference::Hadamard);
    fit_every_length::<4, 2>(Difference::Hadamard);
}
