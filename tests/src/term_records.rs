//! Simulated records of up to five terms (Q, N, B, K, R), and what the fit says of many of them.

use imu_core::allan::{
    AllanLadder, Difference, Octave, Parameter, Sampling, Terms, TermsFit, select_terms,
};
use imu_core::noise::{
    Axis, Channel, Flicker, IncrementQuantisation, RandomWalk, RateRamp, Sensor, Stage, Term, White,
};

/// Octaves of a record's ladder.
pub const LEVELS: usize = 28;

/// The noise of one axis at rest, and how long it is recorded. What is 0 is left out.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// Q, unit·s.
    pub quantisation: f64,
    /// N, unit/√Hz.
    pub noise_density: f64,
    /// B, unit; flat from 4 samples to the length of the record.
    pub bias_instability: f64,
    /// K, unit/s/√Hz.
    pub random_walk: f64,
    /// R, unit/s.
    pub rate_ramp: f64,
    /// Corner of a one-pole low-pass before sampling; 0: none.
    pub lowpass_hz: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// Length of a record, s.
    pub duration_s: f64,
}

/// Four hours at 20 Hz, K·T/N = 48 as a gyroscope of N/K = 300 s has it.
pub const GYROSCOPE: Truth = Truth {
    quantisation: 0.0,
    noise_density: 0.015,
    bias_instability: 0.0,
    random_walk: 5e-5,
    rate_ramp: 0.0,
    lowpass_hz: 0.0,
    rate_hz: 20.0,
    duration_s: 4.0 * 3600.0,
};

/// The same for an accelerometer of N/K = 38 s.
pub const ACCELEROMETER: Truth = Truth { noise_density: 0.019, random_walk: 5e-4, ..GYROSCOPE };

impl Truth {
    /// How the octaves of a record come about.
    #[must_use]
    pub fn sampling(&self) -> Sampling {
        let tau0_s = 1.0 / self.rate_hz;
        Sampling { tau0_s, difference: Difference::Allan, windows: 4, records: 1 }
    }

    /// B of which the flat stands `times` above the minimum of the curve of N and K, √(2NK/√3).
    #[must_use]
    pub fn with_flicker(self, times: f64) -> Self {
        let least = (2.0 * self.noise_density * self.random_walk / 3_f64.sqrt()).sqrt();
        Self {
            bias_instability: times * least / (2.0 * 2_f64.ln() / std::f64::consts::PI).sqrt(),
            ..self
        }
    }

    /// Q that makes `share` of the variance that white noise makes at one sample: 3Q²/dt² = share·N²/dt.
    #[must_use]
    pub fn with_quantisation(self, share: f64) -> Self {
        Self { quantisation: self.noise_density * (share / (3.0 * self.rate_hz)).sqrt(), ..self }
    }

    /// R that goes `times` as far in the record as the walk's standard deviation: R·T = times·K√T.
    #[must_use]
    pub fn with_ramp(self, times: f64) -> Self {
        Self { rate_ramp: times * self.random_walk / self.duration_s.sqrt(), ..self }
    }

    /// The octaves of the record of a seed.
    ///
    /// # Panics
    /// When the truth is no noise.
    #[must_use]
    pub fn octaves(&self, seed: u64) -> [Octave; LEVELS] {
        let dt = 1.0 / self.rate_hz;
        let rest = (
            White { noise_density: self.noise_density },
            RandomWalk { random_walk: self.random_walk },
            RateRamp { rate_ramp: self.rate_ramp },
        );
        let flicker = Flicker::<f64, 8> {
            bias_instability: self.bias_instability,
            shortest_tau: 4.0 * dt,
            longest_tau: self.duration_s,
        };
        let counts = IncrementQuantisation { quantisation_noise: self.quantisation };
        match (self.bias_instability > 0.0, self.quantisation > 0.0) {
            (false, false) => self.record(rest, seed),
            (true, false) => self.record((flicker, rest), seed),
            (false, true) => self.record((rest, counts), seed),
            (true, true) => self.record((flicker, rest, counts), seed),
        }
    }

    fn record<P: Term<f64>>(&self, terms: P, seed: u64) -> [Octave; LEVELS] {
        let dt = 1.0 / self.rate_hz;
        let channel = Channel::new(seed, Sensor::GYROSCOPE, Axis::X);
        let mut stage = terms.prepare(dt, channel).expect("valid noise");
        let pole = if self.lowpass_hz > 0.0 {
            1.0 - (-std::f64::consts::TAU * self.lowpass_hz * dt).exp()
        } else {
            1.0
        };
        let mut filtered = 0.0;
        let mut ladder = AllanLadder::<f64, 1, LEVELS, 4>::new();
        let mut left = (self.duration_s * self.rate_hz).round() as usize;
        let mut block = Vec::with_capacity(4096);
        while left > 0 {
            block.clear();
            block.resize(left.min(4096), [0.0]);
            for value in &mut block {
                filtered += pole * (stage.step(0.0) - filtered);
                *value = [filtered];
            }
            left -= block.len();
            ladder.extend(&block);
        }
        ladder.octaves(0)
    }
}

/// Something of the octaves of the records with seeds `first`…`first + count`, on all cores.
///
/// # Panics
/// When `of` does.
pub fn each<T: Send>(
    truth: &Truth,
    first: u64,
    count: u64,
    of: impl Fn(&[Octave; LEVELS]) -> T + Sync,
) -> Vec<T> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let of = &of;
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|worker| {
                scope.spawn(move || {
                    (first..first + count)
                        .filter(|seed| seed % threads == worker)
                        .map(|seed| of(&truth.octaves(seed)))
                        .collect::<Vec<_>>()
                })
            })
            .collect();
        workers.into_iter().flat_map(|w| w.join().expect("a worker does not panic")).collect()
    })
}

/// What is chosen for many records.
#[must_use]
pub fn selections(truth: &Truth, first: u64, count: u64) -> Vec<TermsFit> {
    each(truth, first, count, |octaves| select_terms(octaves, truth.sampling()))
}

/// How many of them have Q, B and R.
#[must_use]
pub fn chosen(fits: &[TermsFit]) -> [usize; 3] {
    let count = |of: fn(&Terms) -> bool| fits.iter().filter(|fit| of(&fit.terms)).count();
    [count(|t| t.quantisation), count(|t| t.bias_instability), count(|t| t.rate_ramp)]
}

/// The estimates of a term where it was chosen.
pub fn estimates(fits: &[TermsFit], of: impl Fn(&TermsFit) -> Option<Parameter>) -> Vec<Parameter> {
    fits.iter().filter_map(of).collect()
}
