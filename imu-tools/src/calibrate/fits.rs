//! What the ladder of a sensor says of its noise, with all that is known of drift and filters.

use imu_core::allan::{Difference, Octave, Parameter, Sampling};

use super::block_means::BlockMeans;
use super::checks::Checks;
use super::slope::{self, SlopeReading};
use super::terms::{Fits, first_to_trust, past_a_ramp};
use super::{AxisNoise, Deviation, LEVELS, SensorKind, SensorLadder, SensorNoise, WINDOWS};
use super::{Options, drift, maximum_likelihood};
use crate::recording::Summary;

/// Reads the ladder and fits it.
pub(super) fn noise(
    kind: SensorKind,
    stamps: Summary,
    ladder: &SensorLadder,
    means: &BlockMeans,
    mean: [f64; 3],
    options: &Options,
) -> SensorNoise {
    let Options { keep_all, terms, .. } = *options;
    let tau0_s = if stamps.rate_hz > 0.0 { 1.0 / stamps.rate_hz } else { 0.0 };
    let sampling =
        Sampling { tau0_s, difference: Difference::Allan, windows: WINDOWS as u8, records: 1 };
    let whole = [0, 1, 2].map(|axis| ladder.octaves(axis));
    let drift = drift::examine(means, whole, tau0_s, first_to_trust(&whole, sampling));
    let octaves = if keep_all { whole } else { drift.octaves };
    let mut fits = Fits::new(&octaves, sampling, terms);
    if drift.slope.is_some() && !keep_all {
        fits.with_ramp(&octaves, sampling, terms);
    }
    let (mut axes, mut pooled_noise) = fits.noise();
    let mut misfit = fits.axes.map(|f| f.misfit);
    if !keep_all && (drift.slope.is_some() || fits.has_ramp()) {
        let (past, pooled) = past_a_ramp(&drift.hadamard, &fits);
        for ((axis, misfit), fit) in axes.iter_mut().zip(&mut misfit).zip(&past) {
            (axis.random_walk, axis.bias_instability) = (fit.random_walk, fit.bias_instability);
            *misfit = fit.misfit;
        }
        pooled_noise.random_walk = pooled.random_walk;
        pooled_noise.bias_instability = pooled.bias_instability;
    }
    let Fits { axes: fits, pooled, contradiction } = fits;

    let tau = |octave: &Octave| octave.samples as f64 * tau0_s;
    let deviation = (0..LEVELS)
        .map(|level| octaves.map(|axis| axis[level]))
        .take_while(|octaves| octaves.iter().any(|o| o.differences > 0))
        .map(|octaves| {
            let mut edf = [0.0; 3];
            for ((edf, octave), fit) in edf.iter_mut().zip(&octaves).zip(&fits) {
                *edf = fit.degrees(octave, sampling);
            }
            Deviation { tau_s: tau(&octaves[0]), octaves, edf }
        })
        .collect::<Vec<_>>();
    let at = |level: usize| octaves[0].get(level).map_or(0.0, tau);
    SensorNoise {
        kind,
        topic: String::new(),
        stamps,
        rejected: ladder.rejected_samples(),
        mean,
        record_means: Vec::new(),
        axes,
        pooled: pooled_noise,
        tau_used_s: pooled.used.map(|(first, last)| (at(first), at(last))),
        contradiction,
        misfit,
        disturbed: Vec::new(),
        warm_up_s: (drift.warm_up > 0).then_some(drift.warm_up as f64 * tau0_s),
        ramp: drift.slope,
        checks: Checks::default(),
        signal: Vec::new(),
        deviation,
    }
}

impl SensorNoise {
    /// Puts the exact maximum likelihood in the place of the fit to octaves.
    pub(super) fn by_maximum_likelihood(&mut self, means: &BlockMeans) {
        let tau0_s = self.tau0_s();
        let shortest_s = self.tau_used_s.map_or(0.0, |(first, _)| first);
        let found = maximum_likelihood::fit(means, tau0_s, shortest_s);
        self.axes = found.axes;
        self.pooled = found.pooled;
        self.tau_used_s = Some((found.block_s, self.stamps.span_s));
    }

    /// Puts the classic slope readings in the place of the fit; they have no interval, so theirs is
    /// all there is.
    pub(super) fn by_slope(&mut self) {
        let axes = [0, 1, 2].map(|axis| self.curve(axis));
        let read = |axes: &[&[Octave]]| {
            let SlopeReading { noise_density, random_walk } =
                slope::kalibr_allan(axes, self.tau0_s());
            AxisNoise::of_two(reading(noise_density), reading(random_walk))
        };
        let [x, y, z] = &axes;
        let found = axes.each_ref().map(|axis| read(&[axis]));
        self.pooled = read(&[x, y, z]);
        self.axes = found;
    }

    /// Time between samples, s; 0 where it is not known.
    #[must_use]
    pub fn tau0_s(&self) -> f64 {
        if self.stamps.rate_hz > 0.0 { 1.0 / self.stamps.rate_hz } else { 0.0 }
    }

    /// The octaves of one axis, shortest first.
    #[must_use]
    pub fn curve(&self, axis: usize) -> Vec<Octave> {
        self.deviation.iter().filter_map(|d| d.octaves.get(axis).copied()).collect()
    }
}

/// A number without an interval.
fn reading(value: Option<f64>) -> Parameter {
    match value {
        Some(value) => {
            Parameter::Observable { value, sd: f64::INFINITY, low90: 0.0, high90: f64::INFINITY }
        }
        None => Parameter::NotObservable { upper90: f64::INFINITY, record_at_least_s: 0.0 },
    }
}
