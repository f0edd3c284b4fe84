//! What the Allan variance of a record of a noise term may be: its exact expectation from the term's
//! autocovariance, and how far a finite record scatters about it.
//!
//! A record is read in disjoint *pairs* of blocks of m samples: d_j is the difference of the means of
//! the two blocks of pair j. With R(k) the autocovariance of the samples,
//!
//! cov(d_0, d_l) = Σ_k w(k) R(2ml + k)/m²,  w(k) = 2m − 3|k| to m, |k| − 2m from m to 2m,
//!
//! w being the autocorrelation of m times −1 and m times +1; the Allan variance is ½ cov(d_0, d_0).
//! Nothing but the covariance of the term's discrete process enters, so this holds at every m, and
//! is what closed forms in τ are compared with.

use imu_core::noise::{
    Axis, BandVibration, Channel, Flicker, GaussMarkov, IncrementQuantisation, IntervalMean,
    Normal, Quantisation, Sensor, Stage, Start, Term, White,
};
use std::f64::consts::{PI, TAU};

/// Samples of a record.
pub const SAMPLES: usize = 1 << 16;
/// Octaves looked at: blocks of 1 to 2¹³ samples, 4 pairs and more.
pub const OCTAVES: usize = 14;
/// Sampling interval, s.
pub const DT: f64 = 0.01;
/// Records of each term.
pub const SEEDS: u64 = 20;

/// Gauss-Markov: σ, T.
pub const GAUSS_MARKOV: (f64, f64) = (0.02, 3.0);
/// Flicker: B, τ₁, τ₂ of five processes.
pub const FLICKER: (f64, f64, f64) = (0.03, 0.05, 50.0);
/// Band vibration: σ, f₀, bandwidth.
pub const BAND: (f64, f64, f64) = (0.5, 7.0, 2.0);
/// Quantisation of increments: Q.
pub const INCREMENT: f64 = 1e-3;
/// Quantisation of readings: the step, and the standard deviation of the white noise that moves them.
pub const READING: (f64, f64) = (0.01, 0.015);

/// A term, its autocovariance, and its records.
pub struct Case {
    /// Its name.
    pub name: &'static str,
    /// R(k), k = 0 … `SAMPLES` − 1.
    pub autocovariance: Vec<f64>,
    /// The record of a seed, at a truth of zero.
    pub record: Box<dyn Fn(u64) -> Vec<f64>>,
}

/// Every stationary term, in the scalar `T`.
#[must_use]
pub fn cases<T: Normal>() -> Vec<Case> {
    let t = T::from_f64;
    let correlated = |law: &dyn Fn(f64) -> f64| (0..SAMPLES).map(|k| law(k as f64)).collect();
    let white = |first: &[f64]| {
        let mut all = vec![0.0; SAMPLES];
        all[..first.len()].copy_from_slice(first);
        all
    };
    let (sigma, time) = GAUSS_MARKOV;
    let gauss_markov = GaussMarkov {
        standard_deviation: t(sigma),
        correlation_time: t(time),
        start: Start::Stationary,
    };
    let (b, shortest, longest) = FLICKER;
    let flicker = Flicker::<T, 5> {
        bias_instability: t(b),
        shortest_tau: t(shortest),
        longest_tau: t(longest),
    };
    let (rms, frequency, bandwidth) = BAND;
    let band = BandVibration {
        standard_deviation: t(rms),
        frequency: t(frequency),
        bandwidth: t(bandwidth),
    };
    let (step, moved) = READING;
    let noise = White { noise_density: t(moved * DT.sqrt()) };
    let q = INCREMENT / DT;
    let members = flicker_members();
    vec![
        Case {
            name: "white",
            autocovariance: white(&[0.015 * 0.015 / DT]),
            record: record(White { noise_density: t(0.015) }),
        },
        Case {
            name: "Gauss-Markov",
            autocovariance: correlated(&|k| sigma * sigma * (-k * DT / time).exp()),
            record: record(gauss_markov),
        },
        Case {
            name: "flicker",
            autocovariance: correlated(&|k| {
                members.iter().map(|(variance, time)| variance * (-k * DT / time).exp()).sum()
            }),
            record: record(flicker),
        },
        Case {
            name: "quantisation of readings",
            // The fundamental of the error's law is exp(−2π²σ²/q²) = 5e-20: q²/12, uncorrelated.
            autocovariance: white(&[moved * moved + step * step / 12.0]),
            record: record((noise, Quantisation { step: t(step) })),
        },
        Case {
            name: "quantisation of increments",
            autocovariance: white(&[2.0 * q * q, -q * q]),
            record: record(IncrementQuantisation { quantisation_noise: t(INCREMENT) }),
        },
        Case {
            name: "band vibration",
            autocovariance: correlated(&|k| {
                let decay = PI * bandwidth * k * DT;
                let damping = 0.5 * bandwidth / frequency;
                let root = (1.0 - damping * damping).sqrt();
                let angle = root * TAU * frequency * k * DT;
                rms * rms * (-decay).exp() * (angle.cos() - damping / root * angle.sin())
            }),
            record: record(band),
        },
        Case {
            name: "Gauss-Markov, interval means",
            // The double integral of σ²e^(−|t|/T) over two intervals.
            autocovariance: correlated(&|k| {
                let x = DT / time;
                let same = 2.0 * (x + (-x).exp_m1());
                let other = -(-x).exp_m1() * x.exp_m1() * (-k * x).exp();
                sigma * sigma / (x * x) * if k == 0.0 { same } else { other }
            }),
            record: record(IntervalMean(gauss_markov)),
        },
        Case {
            name: "band vibration, interval means",
            // Differences of x, whose autocovariance is that of the resonator's displacement.
            autocovariance: correlated(&|k| {
                let displacement = |k: f64| {
                    let decay = PI * bandwidth * k.abs() * DT;
                    let damping = 0.5 * bandwidth / frequency;
                    let root = (1.0 - damping * damping).sqrt();
                    let angle = root * TAU * frequency * k.abs() * DT;
                    (-decay).exp() * (angle.cos() + damping / root * angle.sin())
                };
                let moved = 2.0 * displacement(k) - displacement(k - 1.0) - displacement(k + 1.0);
                rms * rms * moved / (TAU * frequency * DT).powi(2)
            }),
            record: record(IntervalMean(band)),
        },
    ]
}

/// (σ_i², T_i) of the processes of [`FLICKER`], by the formulas of its documentation.
#[must_use]
pub fn flicker_members() -> [(f64, f64); 5] {
    let (b, shortest, longest) = FLICKER;
    let ratio = (16.0 * longest / shortest).powf(0.25);
    [0, 1, 2, 3, 4].map(|i| {
        let time = shortest / 4.0 * ratio.powi(i);
        let end = if i == 0 || i == 4 { ratio / (ratio - 1.0) } else { 1.0 };
        let sampled = 2.0 * time / DT * (DT / (2.0 * time)).tanh();
        (b * b * ratio.ln() / PI * end * sampled, time)
    })
}

/// The records of a term, by their seeds.
pub fn record<T: Normal, P: Term<T> + Copy + 'static>(term: P) -> Box<dyn Fn(u64) -> Vec<f64>> {
    Box::new(move |seed| {
        let channel = Channel::new(seed, Sensor::GYROSCOPE, Axis::X);
        let mut stage = term.prepare(T::from_f64(DT), channel).expect("valid parameters");
        let mut block = vec![T::ZERO; SAMPLES];
        stage.apply(&mut block);
        block.into_iter().map(T::to_f64).collect()
    })
}

/// What an octave of one record is expected to show.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    /// Samples of a block.
    pub block: usize,
    /// Pairs of blocks.
    pub pairs: f64,
    /// The Allan variance.
    pub variance: f64,
    /// 2/(relative variance of the estimate), for a normal process: M/(1 + 2Σ(1 − l/M)ρ_l²).
    pub edf: f64,
    /// At least the largest eigenvalue of the d_j's correlations: 1 + 2Σ|ρ_l|.
    pub spread: f64,
}

/// The bands of all octaves, from the autocovariance.
#[must_use]
pub fn bands(autocovariance: &[f64]) -> Vec<Band> {
    (0..OCTAVES)
        .map(|octave| {
            let m = 1_usize << octave;
            let pairs = SAMPLES / (2 * m);
            let at = |k: usize| autocovariance.get(k).copied().unwrap_or(0.0);
            let covariance = |l: usize| {
                let sum: f64 = (0..2 * m)
                    .map(|k| {
                        let w = if k < m {
                            2.0 * m as f64 - 3.0 * k as f64
                        } else {
                            k as f64 - 2.0 * m as f64
                        };
                        let lag = 2 * m * l;
                        w * if k == 0 { at(lag) } else { at(lag + k) + at(lag.abs_diff(k)) }
                    })
                    .sum();
                sum / (m * m) as f64
            };
            let zero = covariance(0);
            let (mut squares, mut spread) = (1.0, 1.0);
            for l in 1..pairs {
                let correlation = covariance(l) / zero;
                squares += 2.0 * (1.0 - l as f64 / pairs as f64) * correlation * correlation;
                spread += 2.0 * correlation.abs();
            }
            let count = pairs as f64;
            Band { block: m, pairs: count, variance: 0.5 * zero, edf: count / squares, spread }
        })
        .collect()
}

/// The Allan variance of a record over pairs of blocks, octave by octave.
#[must_use]
pub fn allan(record: &[f64]) -> Vec<f64> {
    let mut sums = record.to_vec();
    (0..OCTAVES)
        .map(|octave| {
            let m = f64::from(1 << octave);
            let pairs = sums.as_chunks().0;
            let square: f64 = pairs.iter().map(|[a, b]| ((b - a) / m).powi(2)).sum();
            let variance = square / (2 * pairs.len()) as f64;
            sums = pairs.iter().map(|[a, b]| a + b).collect();
            variance
        })
        .collect()
}
