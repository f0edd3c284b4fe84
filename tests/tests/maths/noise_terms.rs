//! Every stationary noise term has the Allan variance of its discrete process at every octave, in
//! both scalars; and that is the closed form which its documentation states.
//!
//! Twenty records of each are averaged. The estimate is a quadratic form of a normal vector with
//! 20·edf degrees of freedom, so by Laurent & Massart (2000), lemma 1, it is off by more than
//! −2√(x/20 edf) or +2√(x/20 edf) + 2x·spread/(20 M), relative, with a chance below e^(−x) each.
//! x = ln(2 · 2 · 8 · 14 / 10⁻⁶) = 19.9 makes it one in a million over all checks here. Uniform
//! numbers (quantisation of increments) scatter less than normal ones: theirs is the same bound.
//! How many single records lie in the 99.9 % band: `cargo run --release -p imu-tests --example terms`.

use imu_core::noise::{
    Axis, Channel, GaussMarkov, IntervalMean, Normal, RandomWalk, RateRamp, Sensor, Sinusoid,
    Stage, Start, Term, WarmUp,
};
use imu_tests::allan_bands::{
    BAND, Band, DT, FLICKER, GAUSS_MARKOV, INCREMENT, OCTAVES, READING, SAMPLES, SEEDS, allan,
    bands, cases, record,
};
use std::f64::consts::{LN_2, PI};

fn every_term<T: Normal>(first_seed: u64) {
    let cases = cases::<T>();
    let chance = 1e-6 / (2 * 2 * cases.len() * OCTAVES) as f64;
    let x = -chance.ln();
    for case in cases {
        let mut mean = vec![0.0; OCTAVES];
        for seed in first_seed..first_seed + SEEDS {
            let variances = allan(&(case.record)(seed));
            mean.iter_mut().zip(variances).for_each(|(mean, v)| *mean += v / SEEDS as f64);
        }
        for (band, found) in bands(&case.autocovariance).into_iter().zip(mean) {
            let Band { block, pairs, variance, edf, spread } = band;
            let below = 2.0 * (x / (SEEDS as f64 * edf)).sqrt();
            let above = below + 2.0 * x * spread / (SEEDS as f64 * pairs);
            let off = found / variance - 1.0;
            assert!(-below < off && off < above, "{}, m = {block}: {off}", case.name);
        }
    }
}

#[test]
fn every_term_in_double_precision() {
    every_term::<f64>(100);
}

#[test]
fn every_term_in_single_precision() {
    every_term::<f32>(200);
}

/// Interval means of a random walk have K²τ/3 at every octave, from one sample on, where instants have
/// half as much again. Differences over disjoint pairs of blocks are independent: M degrees of freedom
/// each, twenty records, bound by the same lemma at 10⁻⁶ over both scalars.
fn a_walk_of_means<T: Normal>(first_seed: u64) {
    let walk = record(IntervalMean(RandomWalk { random_walk: T::from_f64(0.25) }));
    let x = (2.0 * 2.0 * OCTAVES as f64 / 1e-6).ln();
    let mut mean = vec![0.0; OCTAVES];
    for seed in first_seed..first_seed + SEEDS {
        let variances = allan(&walk(seed));
        mean.iter_mut().zip(variances).for_each(|(mean, v)| *mean += v / SEEDS as f64);
    }
    for (octave, found) in mean.into_iter().enumerate() {
        let pairs = SEEDS as f64 * (SAMPLES >> (octave + 1)) as f64;
        let expected = 0.25_f64.powi(2) * f64::from(1 << octave) * DT / 3.0;
        let (below, off) = (2.0 * (x / pairs).sqrt(), found / expected - 1.0);
        assert!(-below < off && off < below + 2.0 * x / pairs, "octave {octave}: {off}");
    }
}

#[test]
fn interval_means_of_a_random_walk() {
    a_walk_of_means::<f64>(300);
    a_walk_of_means::<f32>(400);
}

/// Means of a continuous process have its closed form exactly, at one sample too.
#[test]
fn interval_means_of_gauss_markov_have_the_continuous_form() {
    let (sigma, time) = GAUSS_MARKOV;
    for Band { block, variance, .. } in expected("Gauss-Markov, interval means") {
        let x = block as f64 * DT / time;
        // From the exponential series where the bracket would cancel.
        let bracket = if x < 0.02 {
            x * x * (1.0 / 3.0 - x / 4.0 + 7.0 / 60.0 * x * x)
        } else {
            1.0 - (3.0 - 4.0 * (-x).exp() + (-2.0 * x).exp()) / (2.0 * x)
        };
        let continuous = 2.0 * sigma * sigma / x * bracket;
        assert!((variance / continuous - 1.0).abs() < 1e-5, "{block}");
    }
}

fn expected(name: &str) -> Vec<Band> {
    let cases = cases::<f64>();
    let case = cases.iter().find(|case| case.name == name).expect("a case");
    bands(&case.autocovariance)
}

/// The sampled form; and for τ of many samples the continuous one.
#[test]
fn gauss_markov_has_its_closed_form() {
    let (sigma, time) = GAUSS_MARKOV;
    for Band { block, variance, .. } in expected("Gauss-Markov") {
        let (m, phi) = (block as f64, (-DT / time).exp());
        let p = phi.powf(m);
        let white = m * (1.0 + phi) / (1.0 - phi);
        let ends = phi * (3.0 - 4.0 * p + p * p) / (1.0 - phi).powi(2);
        let sampled = sigma * sigma / (m * m) * (white - ends);
        assert!((variance / sampled - 1.0).abs() < 1e-9, "{m}");
        let x = m * DT / time;
        let bracket = 1.0 - (3.0 - 4.0 * (-x).exp() + (-2.0 * x).exp()) / (2.0 * x);
        let continuous = 2.0 * sigma * sigma / x * bracket;
        assert!((variance / continuous - 1.0).abs() < 1.0 / (m * m).min(1e3), "{m}");
    }
}

/// Flat over the range asked for: 5 % in deviation are allowed, and five processes keep 3 %.
#[test]
fn flicker_is_flat_where_it_should_be() {
    let (b, shortest, longest) = FLICKER;
    let flat = b * (2.0 * LN_2 / PI).sqrt();
    let mut octaves = 0;
    for Band { block, variance, .. } in expected("flicker") {
        let tau = block as f64 * DT;
        if (shortest..=longest).contains(&tau) {
            octaves += 1;
            assert!((variance.sqrt() / flat - 1.0).abs() < 0.03, "{tau} s: {}", variance.sqrt());
        }
    }
    assert_eq!(octaves, 10);
}

#[test]
fn quantisations_have_their_closed_forms() {
    for Band { block, variance, .. } in expected("quantisation of increments") {
        let tau = block as f64 * DT;
        assert!((variance / (3.0 * INCREMENT.powi(2) / (tau * tau)) - 1.0).abs() < 1e-9);
    }
    let (step, moved) = READING;
    for Band { block, variance, .. } in expected("quantisation of readings") {
        let density_squared = (moved * moved + step * step / 12.0) * DT;
        assert!((variance / (density_squared / (block as f64 * DT)) - 1.0).abs() < 1e-9);
    }
}

/// Peaks where one frequency would, and falls as its documentation says: 3σ²/(2πf₀τ)², and the
/// white floor that sampling folds down.
#[test]
fn band_vibration_has_its_closed_form() {
    let (sigma, frequency, bandwidth) = BAND;
    let all = expected("band vibration");
    let peak = all.iter().max_by(|a, b| a.variance.total_cmp(&b.variance)).expect("octaves");
    let tau = peak.block as f64 * DT * frequency;
    assert!((0.371 / 1.42..0.371 * 1.42).contains(&tau), "{tau}");
    let folded = PI / 3.0 * sigma * sigma * bandwidth * DT * DT;
    for Band { block, variance, .. } in all {
        let tau = block as f64 * DT;
        if tau * frequency > 4.0 {
            let expected = 3.0 * (sigma / (2.0 * PI * frequency * tau)).powi(2) + folded / tau;
            assert!((variance / expected - 1.0).abs() < 0.05, "{tau} s");
        }
    }
}

fn play<T: Normal>(term: impl Term<T>, dt: f64, count: usize) -> Vec<f64> {
    let channel = Channel::new(1, Sensor::GYROSCOPE, Axis::X);
    let mut stage = term.prepare(T::from_f64(dt), channel).expect("valid parameters");
    let mut block = vec![T::ZERO; count];
    stage.apply(&mut block);
    block.into_iter().map(T::to_f64).collect()
}

/// Terms that draw nothing have their closed form but for rounding: 2 units in the last place of the
/// largest value for a ramp, 3e-7 A a sample for the sinusoid in `f32`.
fn deterministic<T: Normal>() {
    let ramp = play::<T>(RateRamp { rate_ramp: T::from_f64(0.25) }, 0.0078125, SAMPLES);
    for (octave, variance) in allan(&ramp).into_iter().enumerate() {
        let tau = f64::from(1 << octave) * 0.0078125;
        assert!((variance / (0.25 * 0.25 * tau * tau / 2.0) - 1.0).abs() < 1e-2, "{tau}");
    }
    // 0.37 cycles and a little in a sample: phases all round.
    let f = 0.371_234_5;
    let rotor = Sinusoid { amplitude: T::ONE, frequency: T::from_f64(f), phase: T::ZERO };
    let record = play::<T>(rotor, 1.0, SAMPLES);
    for (octave, variance) in allan(&record).into_iter().enumerate().take(6) {
        let m = f64::from(1 << octave);
        let expected = (PI * f * m).sin().powi(4) / (m * (PI * f).sin()).powi(2);
        let pairs = SAMPLES as f64 / (2.0 * m);
        // The mean of cos over the phases of the pairs, which are a geometric series.
        let leak = 1.0 / (pairs * (2.0 * PI * f * 2.0 * m).sin().abs());
        assert!((variance / expected - 1.0).abs() < leak + 1e-4, "{m}: {variance} {expected}");
    }
}

#[test]
fn deterministic_terms() {
    deterministic::<f32>();
    deterministic::<f64>();
}

/// Ten hours of warm-up at 1 kHz in `f32`, a decay of 2.8e-8 a sample: half a unit in the last place.
#[test]
fn a_slow_warm_up_arrives_in_single_precision() {
    let warm_up =
        WarmUp { coefficient: 1e-3_f32, start: -5.0, rise: 25.0, time_constant: 36_000.0 };
    let count = 36_000_000;
    let bias = play::<f32>(warm_up, 1e-3, count + 1)[count];
    let exact = -5e-3 + 25e-3 * (1.0 - (-1.0_f64).exp());
    assert!((bias / exact - 1.0).abs() < 1e-6, "{bias} {exact}");
}

/// In `f32` a correlation time of 10⁸ intervals keeps its stationary variance: 400 processes, each
/// a second after its start.
#[test]
fn a_long_correlation_time_in_single_precision() {
    let slow = GaussMarkov {
        standard_deviation: 1.0_f32,
        correlation_time: 1e5,
        start: Start::Stationary,
    };
    let n = 400;
    let mut square = 0.0;
    for seed in 0..n {
        let channel = Channel::new(seed, Sensor::GYROSCOPE, Axis::X);
        let mut stage = slow.prepare(1e-3, channel).expect("valid");
        let first = f64::from(stage.bias());
        stage.apply(&mut [0.0; 1000]);
        // It moved as a random walk of √(2dt/T) a step: 4.5e-3 in all.
        assert!((f64::from(stage.bias()) - first).abs() < 6.0 * 4.5e-3);
        square += f64::from(stage.bias()).powi(2);
    }
    // sd of the mean square: √(2/400) = 0.07.
    assert!((square / n as f64 - 1.0).abs() < 5.5 * 0.071);
}
