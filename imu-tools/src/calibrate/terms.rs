//! Which terms explain the octaves of a sensor: N and K, and of bias instability B, quantisation Q and ramp R what its
//! record asks for or the user names.
//!
//! Each axis is asked by itself, and so are all together. Where there is a ramp, K and B are read from the Hadamard
//! variance, which is blind to it: beside a ramp the long octaves of the Allan variance say little of a walk.

use imu_core::allan::{
    Contradiction, Octave, Sampling, Terms, TermsFit, average_octaves, fit_noise, fit_terms,
    fit_terms_from, select_terms, select_terms_from,
};

use super::drift::Hadamard;
use super::{AxisNoise, FittedTerms, LEVELS};

/// The fits of a sensor.
pub(super) struct Fits {
    pub(super) axes: [TermsFit; 3],
    pub(super) pooled: TermsFit,
    /// Why short τ decided nothing.
    pub(super) contradiction: Option<Contradiction>,
}

/// The first octave that decides where N and K are all: one axis that shows a low-pass filter speaks for all, which
/// share it.
pub(super) fn first_to_trust(octaves: &[[Octave; LEVELS]; 3], sampling: Sampling) -> usize {
    let found = octaves.iter().filter_map(|axis| fit_noise(axis, sampling).contradiction);
    found.map(|c| c.octave + 1).max().unwrap_or(0)
}

impl Fits {
    /// Fits all axes, and all together, from the same octave on.
    pub(super) fn new(
        octaves: &[[Octave; LEVELS]; 3],
        sampling: Sampling,
        terms: FittedTerms,
    ) -> Self {
        let alone = octaves.map(|axis| match terms {
            FittedTerms::Asked => select_terms(&axis, sampling),
            FittedTerms::Given(terms) => fit_terms(&axis, sampling, terms),
        });
        let found = alone.iter().filter_map(|fit| fit.contradiction);
        let contradiction = found.max_by_key(|c| c.octave);
        let from = contradiction.map_or(0, |c| c.octave + 1);
        let again = |axis: &[Octave; LEVELS], sampling: Sampling| match terms {
            FittedTerms::Asked => select_terms_from(axis, sampling, from),
            FittedTerms::Given(terms) => fit_terms_from(axis, sampling, terms, from),
        };
        let mut axes = alone;
        for (fit, axis) in axes.iter_mut().zip(octaves) {
            if fit.contradiction.map(|c| c.octave) != contradiction.map(|c| c.octave) {
                *fit = again(axis, sampling);
            }
        }
        // An axis that never changes is no record of noise.
        let live: Vec<_> = octaves.iter().filter(|axis| axis[0].variance > 0.0).copied().collect();
        let together = Sampling { records: live.len() as u32, ..sampling };
        Self { axes, pooled: again(&average_octaves(&live), together), contradiction }
    }

    /// Whether any of them has a ramp in it.
    pub(super) fn has_ramp(&self) -> bool {
        self.axes.iter().chain([&self.pooled]).any(|fit| fit.terms.rate_ramp)
    }

    /// Puts a ramp into all of them, if what is fitted is what the record asks for.
    pub(super) fn with_ramp(
        &mut self,
        octaves: &[[Octave; LEVELS]; 3],
        sampling: Sampling,
        terms: FittedTerms,
    ) {
        let FittedTerms::Asked = terms else { return };
        let from = self.contradiction.map_or(0, |c| c.octave + 1);
        let live: Vec<_> = octaves.iter().filter(|axis| axis[0].variance > 0.0).copied().collect();
        let pooled = (average_octaves(&live), Sampling { records: live.len() as u32, ..sampling });
        let [x, y, z] = octaves.map(|axis| (axis, sampling));
        let fits = self.axes.iter_mut().chain([&mut self.pooled]);
        for (fit, (octaves, sampling)) in fits.zip([x, y, z, pooled]) {
            if !fit.terms.rate_ramp {
                let terms = Terms { rate_ramp: true, ..fit.terms };
                let contradiction = fit.contradiction;
                *fit = fit_terms_from(&octaves, sampling, terms, from);
                fit.contradiction = contradiction;
            }
        }
    }

    /// What they say of each axis and of all together.
    pub(super) fn noise(&self) -> ([AxisNoise; 3], AxisNoise) {
        (self.axes.map(|fit| noise(&fit)), noise(&self.pooled))
    }
}

/// K and B past a ramp: the Hadamard variance fitted with a flicker where `fits` have one.
pub(super) fn past_a_ramp(hadamard: &Hadamard, fits: &Fits) -> ([TermsFit; 3], TermsFit) {
    let Hadamard { octaves, sampling, from } = hadamard;
    let of = |octaves: &[Octave], sampling: Sampling, like: &TermsFit| {
        let terms = Terms { bias_instability: like.terms.bias_instability, ..Terms::default() };
        fit_terms_from(octaves, sampling, terms, *from)
    };
    let (together, of_all) = hadamard.pooled();
    let mut axes = fits.axes;
    for (axis, octaves) in axes.iter_mut().zip(octaves) {
        *axis = of(octaves, *sampling, axis);
    }
    (axes, of(&together, of_all, &fits.pooled))
}

fn noise(fit: &TermsFit) -> AxisNoise {
    AxisNoise {
        noise_density: fit.noise_density,
        random_walk: fit.random_walk,
        bias_instability: fit.bias_instability,
        quantisation: fit.quantisation,
        rate_ramp: fit.rate_ramp,
    }
}
