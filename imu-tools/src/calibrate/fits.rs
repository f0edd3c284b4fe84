//! What the ladder of a sensor says of its noise, with all that is known of drift and filters.

use imu_core::allan::{
    Contradiction, Difference, NoiseFit, Octave, Parameter, Sampling, average_octaves, fit_noise,
    fit_noise_from, fitted_edf,
};

use super::block_means::BlockMeans;
use super::checks::Checks;
use super::slope::{self, SlopeReading};
use super::{AxisNoise, Deviation, LEVELS, SensorKind, SensorLadder, SensorNoise, WINDOWS};
use super::{drift, maximum_likelihood};
use crate::recording::Summary;

/// N and K of each axis.
struct Fits {
    axes: [NoiseFit; 3],
    /// Why short τ decided nothing.
    contradiction: Option<Contradiction>,
}

impl Fits {
    /// The first octave that decided.
    fn from(&self) -> usize {
        self.contradiction.map_or(0, |c| c.octave + 1)
    }
}

/// Fits all axes to the same octaves: one axis that shows a low-pass filter speaks for all, which
/// share it.
fn fit_axes(octaves: &[[Octave; LEVELS]; 3], sampling: Sampling) -> Fits {
    let alone = octaves.map(|axis| fit_noise(&axis, sampling));
    let found = alone.iter().filter_map(|fit| fit.contradiction);
    let contradiction = found.max_by_key(|c| c.octave);
    let mut fits = Fits { axes: alone, contradiction };
    let from = fits.from();
    for (fit, axis) in fits.axes.iter_mut().zip(octaves) {
        if fit.contradiction.map(|c| c.octave) != contradiction.map(|c| c.octave) {
            *fit = fit_noise_from(axis, sampling, from);
        }
    }
    fits
}

/// Reads the ladder and fits it.
pub(super) fn noise(
    kind: SensorKind,
    stamps: Summary,
    ladder: &SensorLadder,
    means: &BlockMeans,
    mean: [f64; 3],
    keep_all: bool,
) -> SensorNoise {
    let tau0_s = if stamps.rate_hz > 0.0 { 1.0 / stamps.rate_hz } else { 0.0 };
    let sampling =
        Sampling { tau0_s, difference: Difference::Allan, windows: WINDOWS as u8, records: 1 };
    let whole = [0, 1, 2].map(|axis| ladder.octaves(axis));
    let of_whole = fit_axes(&whole, sampling);
    let drift = drift::examine(means, whole, tau0_s, of_whole.from());
    let (octaves, of_octaves) = if keep_all || drift.warm_up == 0 {
        (whole, of_whole)
    } else {
        (drift.octaves, fit_axes(&drift.octaves, sampling))
    };
    let from = of_octaves.from();
    let Fits { axes: fits, contradiction } = of_octaves;
    // An axis that never changes is no record of noise.
    let live: Vec<_> = octaves.into_iter().filter(|axis| axis[0].variance > 0.0).collect();
    let together = Sampling { records: live.len() as u32, ..sampling };
    let pooled = fit_noise_from(&average_octaves(&live), together, from);
    let mut axes =
        fits.map(|f| AxisNoise { noise_density: f.noise_density, random_walk: f.random_walk });
    let mut pooled_noise =
        AxisNoise { noise_density: pooled.noise_density, random_walk: pooled.random_walk };
    let mut misfit = fits.map(|f| f.misfit);
    if let Some(ramp) = drift.ramp.filter(|_| !keep_all) {
        for ((axis, misfit), fit) in axes.iter_mut().zip(&mut misfit).zip(&ramp.axes) {
            axis.random_walk = fit.random_walk;
            *misfit = fit.misfit;
        }
        pooled_noise.random_walk = ramp.pooled.random_walk;
    }

    let tau = |octave: &Octave| octave.samples as f64 * tau0_s;
    let deviation = (0..LEVELS)
        .map(|level| octaves.map(|axis| axis[level]))
        .take_while(|octaves| octaves.iter().any(|o| o.differences > 0))
        .map(|octaves| {
            let mut edf = [0.0; 3];
            for ((edf, octave), fit) in edf.iter_mut().zip(&octaves).zip(&fits) {
                *edf = fitted_edf(octave, sampling, fit);
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
        ramp: drift.ramp.map(|ramp| ramp.slope),
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
            AxisNoise { noise_density: reading(noise_density), random_walk: reading(random_walk) }
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
