//! `imu_core::allan::select_terms` and what belongs to it: every term by itself and all together, one that is not
//! there, a filter, nothing; what a fit costs.

use crate::Report;
use crate::inputs::Integers;
use core::hint::black_box;
use imu_core::Real;
use imu_core::allan::{
    Difference, Octave, Parameter, Sampling, Terms, TermsFit, fit_terms, fit_terms_from,
    likelihood_ratio, select_terms,
};

/// τ from 10 ms to 5 s, for the emulated M0's sake.
const LEVELS: usize = 10;
const TAU0: f64 = 0.01;

/// Q, N, B, K, R.
type Values = [f64; 5];

const PLAIN: Values = [0.0, 0.02, 0.0, 0.02, 0.0];

fn sampling(difference: Difference, windows: u8) -> Sampling {
    black_box(Sampling { tau0_s: TAU0, difference, windows, records: 1 })
}

/// Octaves with the scatter of their numbers of differences, more or less; a filter leaves the part `left` of the
/// shortest.
fn octaves<const N: usize>(values: Values, left: f64) -> [Octave; N] {
    let mut integers = Integers::new(29);
    let mut samples = 1_u64;
    let mut missing = 1.0 - left;
    let [q, n, b, k, r] = black_box(values);
    [(); N].map(|()| {
        let tau = samples as f64 * TAU0;
        let blocks = (1_u64 << (N - 1)).checked_div(samples).unwrap_or_default();
        let differences = (4 * blocks).saturating_sub(7);
        let variance = 3.0 * q * q / (tau * tau)
            + n * n / tau
            + 0.44 * b * b
            + k * k * tau / 3.0
            + 0.5 * r * r * tau * tau;
        let scatter = integers.unit::<f64>() / Real::sqrt(differences.max(2) as f64);
        let variance = variance * (1.0 + scatter) * (1.0 - missing);
        missing *= 0.5;
        samples *= 2;
        Octave { samples: samples / 2, differences, variance, white_gain: 1.0 }
    })
}

/// Every kind of answer.
pub fn bits(report: &mut dyn Report) {
    let allan = sampling(Difference::Allan, 4);
    for values in [[0.004, 0.02, 0.0, 0.002, 0.0], [0.0, 0.02, 0.05, 0.0, 0.0]] {
        let octaves = octaves::<LEVELS>(values, 1.0);
        answer(report, &select_terms(&octaves, allan), &octaves, allan);
    }
    let filtered = octaves::<LEVELS>(PLAIN, 0.3);
    answer(report, &select_terms(&filtered, allan), &filtered, allan);
    let every = octaves::<LEVELS>([0.004, 0.02, 0.05, 0.01, 0.01], 1.0);
    let hadamard = sampling(Difference::Hadamard, 1);
    answer(report, &fit_terms_from(&every, allan, Terms::ALL, 0), &every, allan);
    answer(report, &fit_terms_from(&every, hadamard, Terms::ALL, 1), &every, hadamard);
    let flicker = Terms { bias_instability: true, ..Terms::default() };
    let plain = octaves::<LEVELS>(PLAIN, 1.0);
    answer(report, &fit_terms(&plain, allan, flicker), &plain, allan);
    report.real(likelihood_ratio(&plain, allan, 0, Terms::default(), flicker));
    answer(report, &select_terms(black_box(&[]), allan), &[], allan);
}

fn answer(report: &mut dyn Report, fit: &TermsFit, octaves: &[Octave], sampling: Sampling) {
    let TermsFit { quantisation, noise_density, bias_instability, random_walk, rate_ramp, .. } =
        *fit;
    for parameter in
        [quantisation, Some(noise_density), bias_instability, Some(random_walk), rate_ramp]
    {
        report.flag(parameter.is_some());
        match parameter {
            Some(Parameter::Observable { value, sd, low90, high90 }) => {
                [value, sd, low90, high90].into_iter().for_each(|x| report.real(x));
            }
            Some(Parameter::NotObservable { upper90, record_at_least_s }) => {
                report.real(upper90);
                report.real(record_at_least_s);
            }
            None => {}
        }
    }
    report.flag(fit.misfit);
    let (first, last) = fit.used.unwrap_or((99, 99));
    report.word(first as u64);
    report.word(last as u64);
    report.word(fit.contradiction.map_or(99, |c| c.octave as u64));
    for octave in octaves.iter().step_by(5) {
        report.real(fit.variance(octave, sampling));
        report.real(fit.degrees(octave, sampling));
    }
}

/// Instructions and stack of the choice among all terms where flicker is one.
pub fn cost(report: &mut dyn Report) {
    // As for the fit of N and K: too long for the M0's emulator.
    if cfg!(target_abi = "eabihf") {
        let sampling = sampling(Difference::Allan, 4);
        // More octaves are more instructions than the timer counts.
        let octaves = octaves::<10>([0.0, 0.02, 0.02, 0.002, 0.0], 1.0);
        let mut choice = || {
            black_box(select_terms(black_box(&octaves), sampling));
        };
        report.instructions("choice from 10 octaves", 1, &mut choice);
        report.stack("choice from 10 octaves", &mut choice);
    }
}
