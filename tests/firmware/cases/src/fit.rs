//! `imu_core::allan::fit_noise`: what it makes of octaves that show N and K, one of them, nothing, or
//! a filter at short τ; what it costs.

use crate::Report;
use crate::inputs::Integers;
use core::hint::black_box;
use imu_core::Real;
use imu_core::allan::{
    AllanLadder, Difference, NoiseFit, Octave, Parameter, Sampling, average_octaves, fit_noise,
    fit_noise_from, fitted_edf,
};

/// τ from 5 ms to 2.9 h.
const LEVELS: usize = 22;
const TAU0: f64 = 0.005;

/// Samples of the records whose bits are compared: 41 s, for the emulated M0's sake.
const SHORT: u64 = 1 << 13;
/// Samples of the record whose cost is counted: 5.8 h, something at every τ.
const LONG: u64 = 1 << 22;

/// What the octaves of a case are made of.
#[derive(Clone, Copy)]
struct Shape {
    noise_density: f64,
    random_walk: f64,
    /// How much of the variance a filter leaves at one sample; half of the rest comes back with
    /// every octave.
    left: f64,
}

const BOTH: Shape = Shape { noise_density: 0.02, random_walk: 0.02, left: 1.0 };

fn sampling(difference: Difference, windows: u8) -> Sampling {
    black_box(Sampling { tau0_s: TAU0, difference, windows, records: 1 })
}

/// Octaves of so many samples with the scatter of their degrees of freedom, more or less.
fn octaves(record: u64, shape: Shape, sampling: Sampling) -> [Octave; LEVELS] {
    let mut integers = Integers::new(23);
    let per_block = u64::from(sampling.windows);
    let walk_share = match sampling.difference {
        Difference::Allan => 1.0 / 3.0,
        Difference::Hadamard => 1.0 / 6.0,
    };
    let mut samples = 1_u64;
    let mut missing = 1.0 - shape.left;
    [(); LEVELS].map(|()| {
        let tau = samples as f64 * TAU0;
        let blocks = record.checked_div(samples).unwrap_or_default();
        let differences = (blocks * per_block).saturating_sub(2 * per_block - 1);
        let (n2, k2) =
            (shape.noise_density * shape.noise_density, shape.random_walk * shape.random_walk);
        let scatter = integers.unit::<f64>() / Real::sqrt(differences.max(2) as f64);
        let variance = (n2 / tau + k2 * tau * walk_share) * (1.0 + scatter) * (1.0 - missing);
        missing *= 0.5;
        samples *= 2;
        Octave { samples: samples / 2, differences, variance, white_gain: 1.0 }
    })
}

/// Every kind of answer.
pub fn bits(report: &mut dyn Report) {
    for difference in [Difference::Allan, Difference::Hadamard] {
        for windows in [1, 4] {
            let sampling = sampling(difference, windows);
            let both = octaves(SHORT, BOTH, sampling);
            answer(report, &fit_noise(&both, sampling), &both, sampling);
            let bare = octaves(SHORT, Shape { random_walk: 0.0, ..BOTH }, sampling);
            answer(report, &fit_noise_from(&bare, sampling, 2), &bare, sampling);
            let walk = octaves(SHORT, Shape { noise_density: 0.0, ..BOTH }, sampling);
            answer(report, &fit_noise_from(&walk, sampling, 3), &walk, sampling);
        }
        let sampling = sampling(difference, 4);
        let filtered = octaves(SHORT, Shape { left: 0.3, ..BOTH }, sampling);
        let fit = fit_noise(&filtered, sampling);
        report.flag(fit.contradiction.is_some());
        answer(report, &fit, &filtered, sampling);
    }
    nothing(report);
    ladder(report);
}

/// No octaves, octaves of nothing, octaves of nonsense.
fn nothing(report: &mut dyn Report) {
    let sound = sampling(Difference::Allan, 1);
    answer(report, &fit_noise(black_box(&[]), sound), &[], sound);
    let octaves = octaves(SHORT, BOTH, sound);
    for (differences, variance) in [
        (0, 1.0),
        (100, 0.0),
        (100, f64::NAN),
        (100, f64::INFINITY),
        (100, -1.0),
        (u64::MAX, 1e-300),
    ] {
        let bad = octaves.map(|octave| Octave { differences, variance, ..octave });
        answer(report, &fit_noise(black_box(&bad), sound), &bad, sound);
    }
    for tau0_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let sampling = Sampling { tau0_s, windows: 0, records: 0, ..sound };
        let fit = fit_noise(&octaves, black_box(sampling));
        report.flag(matches!(fit.noise_density, Parameter::NotObservable { .. }));
        report.flag(fit.used.is_none());
    }
    answer(report, &fit_noise_from(&octaves, sound, usize::MAX), &octaves, sound);
}

/// From samples of three axes to their joint fit.
fn ladder(report: &mut dyn Report) {
    let mut integers = Integers::new(31);
    let mut ladder = AllanLadder::<f32, 3, 10, 4>::new();
    let mut bias = 0.0_f32;
    for _ in 0..1000 {
        bias += 0.05 * integers.unit::<f32>();
        ladder.push(&[(); 3].map(|()| bias + integers.unit::<f32>()));
    }
    let axes = [0, 1, 2].map(|axis| ladder.octaves(axis));
    let joint = average_octaves(black_box(&axes));
    let sampling = Sampling { records: 3, ..sampling(Difference::Allan, 4) };
    answer(report, &fit_noise(&joint, sampling), &joint, sampling);
    for octave in average_octaves::<10>(black_box(&[])) {
        report.word(octave.differences);
        report.real(octave.variance);
    }
}

fn answer(report: &mut dyn Report, fit: &NoiseFit, octaves: &[Octave], sampling: Sampling) {
    for parameter in [fit.noise_density, fit.random_walk] {
        match parameter {
            Parameter::Observable { value, sd, low90, high90 } => {
                report.flag(true);
                [value, sd, low90, high90].into_iter().for_each(|x| report.real(x));
            }
            Parameter::NotObservable { upper90, record_at_least_s } => {
                report.flag(false);
                report.real(upper90);
                report.real(record_at_least_s);
            }
        }
    }
    report.flag(fit.misfit);
    let (first, last) = fit.used.unwrap_or((99, 99));
    report.word(first as u64);
    report.word(last as u64);
    let contradiction = fit.contradiction;
    report.word(contradiction.map_or(99, |c| c.octave as u64));
    report.real(contradiction.map_or(0.0, |c| c.sigmas));
    for octave in octaves.iter().step_by(7) {
        report.real(fitted_edf(octave, sampling, fit));
    }
}

/// Instructions and stack of a fit with its scan for contradictions.
pub fn cost(report: &mut dyn Report) {
    // Half a billion instructions take the M0's emulator too long, and it has no limit to keep.
    if cfg!(target_abi = "eabihf") {
        let sampling = sampling(Difference::Allan, 4);
        let octaves = octaves(LONG, Shape { random_walk: 0.002, ..BOTH }, sampling);
        let mut fit = || {
            black_box(fit_noise(black_box(&octaves), sampling));
        };
        report.instructions("fit", 1, &mut fit);
        report.stack("fit", &mut fit);
    }
}
