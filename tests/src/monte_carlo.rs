//! Many simulated records, calibrated: how far the estimates scatter, and how often the intervals
//! hold the truth.

use imu_core::allan::{
    AllanLadder, Difference, NoiseFit, Parameter, Sampling, average_octaves, fit_noise,
    fit_noise_from,
};
use imu_core::noise::{RandomWalk, Sensor, Stage, ThreeAxis, White};

/// A sensor at rest, and how it is recorded.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// N, unit/√Hz.
    pub noise_density: f64,
    /// K, unit/s/√Hz.
    pub random_walk: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// Length of a record.
    pub duration_s: f64,
    /// Corner of a one-pole low-pass before sampling.
    pub lowpass_hz: Option<f64>,
    /// A loss of single samples at random, and one hole, in the middle, of this many seconds.
    pub loss: Loss,
}

/// What is missing from a record.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loss {
    /// Probability that a sample is lost.
    pub probability: f64,
    /// Length of one hole.
    pub hole_s: f64,
}

impl Case {
    /// sd of ln K that no estimator can beat: √(2N/(K T)).
    pub fn limit(&self) -> f64 {
        (2.0 * self.noise_density / (self.random_walk * self.duration_s)).sqrt()
    }
}

/// The fits of one sensor of one record.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Each axis on its own: the default path, f64, 4 windows a τ.
    pub axes: [NoiseFit; 3],
    /// Each axis on its own, disjoint ladder in f32, 22 octaves.
    pub small: [NoiseFit; 3],
    /// All axes together, f64, 4 windows.
    pub pooled: NoiseFit,
}

/// Simulates and fits one record.
///
/// # Panics
/// When the case is not valid.
pub fn record(case: &Case, seed: u64) -> Outcome {
    let dt = 1.0 / case.rate_hz;
    let terms =
        (White { noise_density: case.noise_density }, RandomWalk { random_walk: case.random_walk });
    let mut sensor =
        ThreeAxis::prepare([terms; 3], dt, seed, Sensor::GYROSCOPE).expect("a valid case");
    let n = (case.duration_s * case.rate_hz).round() as usize;
    let pole = case.lowpass_hz.map_or(1.0, |f| 1.0 - (-std::f64::consts::TAU * f * dt).exp());
    let mut filtered = [0.0; 3];
    let hole = {
        let length = (case.loss.hole_s * case.rate_hz) as usize;
        n / 2..n / 2 + length
    };
    let mut coin = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;

    let mut ladder = AllanLadder::<f64, 3, 32, 4>::new();
    let mut small = AllanLadder::<f32, 3, 22, 1>::new();
    let mut block = Vec::with_capacity(4096);
    for k in 0..n {
        let value = sensor.step([0.0; 3]);
        for (filtered, value) in filtered.iter_mut().zip(value) {
            *filtered += pole * (value - *filtered);
        }
        coin ^= coin << 13;
        coin ^= coin >> 7;
        coin ^= coin << 17;
        let lost = hole.contains(&k)
            || ((coin >> 11) as f64) < case.loss.probability * (1_u64 << 53) as f64;
        if lost {
            drain(&mut ladder, &mut small, &mut block);
            ladder.missing(1);
            small.missing(1);
        } else {
            block.push(filtered);
            if block.len() == 4096 {
                drain(&mut ladder, &mut small, &mut block);
            }
        }
    }
    drain(&mut ladder, &mut small, &mut block);

    let octaves = [0, 1, 2].map(|axis| ladder.octaves(axis));
    let sampling =
        |windows, records| Sampling { tau0_s: dt, difference: Difference::Allan, windows, records };
    let axes = octaves.map(|axis| fit_noise(&axis, sampling(4, 1)));
    let from = axes.iter().filter_map(|f| f.contradiction).map(|c| c.octave + 1).max();
    Outcome {
        axes,
        small: [0, 1, 2].map(|axis| fit_noise(&small.octaves(axis), sampling(1, 1))),
        pooled: fit_noise_from(&average_octaves(&octaves), sampling(4, 3), from.unwrap_or(0)),
    }
}

/// Hands what has gathered to both ladders.
fn drain(
    ladder: &mut AllanLadder<f64, 3, 32, 4>,
    small: &mut AllanLadder<f32, 3, 22, 1>,
    block: &mut Vec<[f64; 3]>,
) {
    ladder.extend(block);
    let single: Vec<[f32; 3]> = block.iter().map(|row| row.map(|x| x as f32)).collect();
    small.extend(&single);
    block.clear();
}

/// Records with seeds `first`…`first + count`, on all cores.
pub fn records(case: &Case, first: u64, count: u64) -> Vec<Outcome> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|worker| {
                scope.spawn(move || {
                    (first..first + count)
                        .filter(|seed| seed % threads == worker)
                        .map(|seed| record(case, seed))
                        .collect::<Vec<_>>()
                })
            })
            .collect();
        workers.into_iter().flat_map(|w| w.join().expect("a worker does not panic")).collect()
    })
}

/// How estimates of one parameter scatter about the truth.
#[derive(Clone, Copy, Debug)]
pub struct Scatter {
    /// How many estimates.
    pub count: usize,
    /// How many said *not observable* (they count as an estimate of 0).
    pub not_observable: usize,
    /// Root mean square of estimate/truth − 1.
    pub rms: f64,
    /// Median of estimate/truth − 1.
    pub median: f64,
    /// Share of 90 % intervals that hold the truth.
    pub coverage: f64,
    /// Share of intervals that lie above the truth.
    pub above: f64,
}

/// Scatter of the estimates of a parameter whose true value is `truth`.
pub fn scatter(estimates: impl IntoIterator<Item = Parameter>, truth: f64) -> Scatter {
    let mut errors = Vec::new();
    let (mut not_observable, mut held, mut above) = (0, 0, 0);
    for estimate in estimates {
        match estimate {
            Parameter::Observable { value, low90, high90, .. } => {
                errors.push(value / truth - 1.0);
                held += usize::from(low90 <= truth && truth <= high90);
                above += usize::from(low90 > truth);
            }
            Parameter::NotObservable { upper90, .. } => {
                errors.push(-1.0);
                not_observable += 1;
                held += usize::from(truth <= upper90);
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    let count = errors.len();
    let n = count.max(1) as f64;
    Scatter {
        count,
        not_observable,
        rms: (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt(),
        median: errors.get(count / 2).copied().unwrap_or(f64::NAN),
        coverage: held as f64 / n,
        above: above as f64 / n,
    }
}
