//! More than N and K: bias instability B (flicker), quantisation Q and rate ramp R, where a record asks for them.
//!
//! The Allan variance of all five is 3Q²/τ² + N²/τ + (2 ln 2/π)B² + K²τ/3 + R²τ²/2 (IEEE Std 952-1997, annex C).
//! [`select_terms`] starts from what [`fit_noise`] says of N and K, and adds a term only where
//! the likelihood ratio is beyond a critical value that a record of white noise and random walk alone passes in
//! fewer than one case of 200; [`fit_terms`] fits the terms that it is told to.
//!
//! **K beside B.** Flicker and random walk differ by half a power of τ in the deviation, so who asks for both knows
//! each less well: K's error grows by some 35 % where there is no B. Where B is there and is left out, K stands for
//! both and is too large. That is why B is not in every fit.
//!
//! **Short τ.** A low-pass makes them smaller than white noise, quantisation larger. Both contradict N and K of the
//! longer τ; Q is asked for only where with it the octaves down to the shortest agree.
//!
//! ```
//! use imu_core::allan::{AllanLadder, Difference, Parameter, Sampling, Terms, fit_terms, select_terms};
//!
//! // White noise of sd 1 at 100 Hz, and an angle that is counted in steps of 0.01.
//! let mut ladder: AllanLadder<f64, 1, 24, 4> = AllanLadder::new();
//! let mut state = 1_u32;
//! let (mut angle, mut counted) = (0.0_f64, 0.0);
//! for _ in 0..100_000 {
//!     state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
//!     angle += 0.01 * 12_f64.sqrt() * (f64::from(state) / 4_294_967_296.0 - 0.5);
//!     let last = counted;
//!     counted = (angle / 0.01).round() * 0.01;
//!     ladder.push(&[(counted - last) / 0.01]);
//! }
//! let sampling = Sampling { tau0_s: 0.01, difference: Difference::Allan, windows: 4, records: 1 };
//! let fit = select_terms(&ladder.octaves(0), sampling);
//! assert_eq!(fit.terms, Terms { quantisation: true, ..Terms::default() });
//! let Some(Parameter::Observable { value, .. }) = fit.quantisation else { panic!() };
//! assert!((value / (0.01 / 12_f64.sqrt()) - 1.0).abs() < 0.1, "{value}");
//! ```

mod bounds;
mod choose;
mod descent;
mod joint;
mod model;
mod short;
mod spread;

use super::likelihood::Likelihood;
use super::{Contradiction, NoiseFit, Octave, Parameter, Sampling, fit_noise, fit_noise_from};
use choose::Model;
use descent::{Best, EXACT};
use joint::{Joint, Logs};
use model::{FLICKER, PerTerm, QUANTISATION, RAMP, TERMS, WALK, WHITE, of_ones};

/// Terms of a model beside N and K, which are always in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Terms {
    /// Q, quantisation of the integral.
    pub quantisation: bool,
    /// B, flicker.
    pub bias_instability: bool,
    /// R, a ramp; a Hadamard variance does not see it, and never has this term.
    pub rate_ramp: bool,
}

impl Terms {
    /// All of them.
    pub const ALL: Self = Self { quantisation: true, bias_instability: true, rate_ramp: true };

    /// Nothing but N and K.
    #[must_use]
    pub fn is_none(self) -> bool {
        self == Self::default()
    }

    fn added(self) -> [bool; TERMS] {
        [self.quantisation, false, self.bias_instability, false, self.rate_ramp]
    }
}

/// The noise of one signal by as many terms as were asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TermsFit {
    /// What was fitted beside N and K.
    pub terms: Terms,
    /// Q, in the signal's unit times s: the standard deviation of the error of the integral.
    pub quantisation: Option<Parameter>,
    /// N, in the signal's unit /√Hz.
    pub noise_density: Parameter,
    /// B, in the signal's unit; the flat of the Allan deviation is 0.664 B.
    pub bias_instability: Option<Parameter>,
    /// K, in the signal's unit /s/√Hz.
    pub random_walk: Parameter,
    /// |R|, in the signal's unit /s.
    pub rate_ramp: Option<Parameter>,
    /// Indices of the shortest and longest octave that were used; `None`: there was nothing to use.
    pub used: Option<(usize, usize)>,
    /// Why shorter ones were not.
    pub contradiction: Option<Contradiction>,
    /// The octaves used are further from the curve than their scatter explains: there is something else.
    pub misfit: bool,
}

impl TermsFit {
    fn of(fit: NoiseFit) -> Self {
        Self {
            terms: Terms::default(),
            quantisation: None,
            noise_density: fit.noise_density,
            bias_instability: None,
            random_walk: fit.random_walk,
            rate_ramp: None,
            used: fit.used,
            contradiction: fit.contradiction,
            misfit: fit.misfit,
        }
    }

    /// Q², N², B², K², R²; 0 for what is not known.
    fn squares(&self) -> PerTerm {
        let Self { quantisation, noise_density, bias_instability, random_walk, rate_ramp, .. } =
            *self;
        [quantisation, Some(noise_density), bias_instability, Some(random_walk), rate_ramp].map(
            |p| match p {
                Some(Parameter::Observable { value, .. }) => value * value,
                _ => 0.0,
            },
        )
    }

    /// The variance that the fitted terms give an octave, in the signal's unit squared.
    #[must_use]
    pub fn variance(&self, octave: &Octave, sampling: Sampling) -> f64 {
        of_ones(octave, &sampling)
            .iter()
            .zip(self.squares())
            .map(|(one, square)| one * square)
            .sum()
    }

    /// Equivalent degrees of freedom of an octave under the terms that were fitted (white noise where nothing was).
    #[must_use]
    pub fn degrees(&self, octave: &Octave, sampling: Sampling) -> f64 {
        if octave.differences == 0 {
            return 0.0;
        }
        let mut variances = of_ones(octave, &sampling);
        for (variance, square) in variances.iter_mut().zip(self.squares()) {
            *variance *= square;
        }
        let total: f64 = variances.iter().sum();
        if !(total > 0.0 && total < f64::MAX) {
            variances = [0.0, 1.0, 0.0, 0.0, 0.0];
        }
        f64::from(sampling.records.max(1)) * joint(&[], sampling, 0).degrees(octave, &variances)
    }
}

/// What the likelihood-ratio statistic of a term must exceed.
const CRITICAL: f64 = 12.0;

fn joint(octaves: &[Octave], sampling: Sampling, from: usize) -> Joint<'_> {
    Joint(Likelihood { octaves, sampling, from, without: None })
}

/// Fits N and K, and of Q, B and R what the record asks for, to all octaves that do not contradict longer ones.
///
/// Where it asks for none, the result is that of [`fit_noise`], to the bit. Never a NaN, whatever `octaves` are.
#[must_use]
pub fn select_terms(octaves: &[Octave], sampling: Sampling) -> TermsFit {
    chosen(fit_noise(octaves, sampling), octaves, sampling, 0)
}

/// The same for the octaves from index `from` on, whatever they say of one another. Where `from` is not 0 nothing
/// is known of quantisation, which shows at the shortest τ.
///
/// Where the record asks for no more than N and K, the result is that of [`fit_noise_from`], to the bit.
#[must_use]
pub fn select_terms_from(octaves: &[Octave], sampling: Sampling, from: usize) -> TermsFit {
    chosen(fit_noise_from(octaves, sampling, from), octaves, sampling, from)
}

/// Adds to a fit of N and K what the octaves from index `least` on ask for.
fn chosen(base: NoiseFit, octaves: &[Octave], sampling: Sampling, least: usize) -> TermsFit {
    let from = base.contradiction.map_or(least, |c| c.octave + 1);
    let trusted = joint(octaves, sampling, from);
    if !is_sound(&trusted, &base) {
        return TermsFit::of(base);
    }
    let best = start(&trusted, &base, Terms::default());
    let model = Model { best, from, contradiction: base.contradiction };
    let model = choose::choose(&joint(octaves, sampling, least), model, CRITICAL);
    if terms_of(&model.best.logs).is_none() {
        return TermsFit::of(base);
    }
    told(&joint(octaves, sampling, model.from), &model.best, model.contradiction)
}

/// Fits N, K and these `terms`, to all octaves that do not contradict longer ones under them.
///
/// With no more terms than N and K the result is that of [`fit_noise`], to the bit.
#[must_use]
pub fn fit_terms(octaves: &[Octave], sampling: Sampling, terms: Terms) -> TermsFit {
    let base = fit_noise(octaves, sampling);
    let terms = possible(terms, sampling);
    let all = joint(octaves, sampling, 0);
    if terms.is_none() || !is_sound(&all, &base) {
        return TermsFit { terms, ..TermsFit::of(base) };
    }
    let found = short::contradiction(&all, start(&all, &base, terms).logs);
    let from = found.map_or(0, |c| c.octave + 1);
    TermsFit { contradiction: found, ..fit_terms_from(octaves, sampling, terms, from) }
}

/// Fits N, K and these `terms` to the octaves from index `from` on, whatever they say of one another.
#[must_use]
pub fn fit_terms_from(
    octaves: &[Octave],
    sampling: Sampling,
    terms: Terms,
    from: usize,
) -> TermsFit {
    let base = fit_noise_from(octaves, sampling, from);
    let terms = possible(terms, sampling);
    let all = joint(octaves, sampling, from);
    if terms.is_none() || !is_sound(&all, &base) {
        return TermsFit { terms, ..TermsFit::of(base) };
    }
    told(&all, &start(&all, &base, terms), None)
}

/// The likelihood-ratio statistic of a larger model: by how much −2 ln likelihood falls when `more` is fitted instead
/// of `terms`, to the octaves from index `from` on. 0 where there is nothing to fit.
///
/// Octaves are correlated and few, and a term that is not there is at the edge of what is possible, so its law is
/// not χ²: `tests/examples/term_selection.rs` shows it.
#[must_use]
pub fn likelihood_ratio(
    octaves: &[Octave],
    sampling: Sampling,
    from: usize,
    terms: Terms,
    more: Terms,
) -> f64 {
    let base = fit_noise_from(octaves, sampling, from);
    let all = joint(octaves, sampling, from);
    if !is_sound(&all, &base) {
        return 0.0;
    }
    let fewer = start(&all, &base, possible(terms, sampling));
    let mut more_best = fewer;
    for (term, added) in possible(more, sampling).added().into_iter().enumerate() {
        if added && more_best.logs.get(term).copied().flatten().is_none() {
            more_best = choose::with(&all, &more_best.logs, term, EXACT);
        }
    }
    (fewer.minimum - more_best.minimum).max(0.0)
}

/// What a difference can see of these terms.
fn possible(terms: Terms, sampling: Sampling) -> Terms {
    let sees_ramps = sampling.difference == super::Difference::Allan;
    Terms { rate_ramp: terms.rate_ramp && sees_ramps, ..terms }
}

/// Whether there are octaves to fit something to.
fn is_sound(all: &Joint, base: &NoiseFit) -> bool {
    base.used.is_some() && all.count() > 0
}

fn start(all: &Joint, base: &NoiseFit, terms: Terms) -> Best {
    let value = |p: Parameter| match p {
        Parameter::Observable { value, .. } => value,
        Parameter::NotObservable { .. } => 0.0,
    };
    choose::fit(all, value(base.noise_density), value(base.random_walk), terms.added())
}

fn terms_of(logs: &Logs) -> Terms {
    Terms {
        quantisation: logs[QUANTISATION].is_some(),
        bias_instability: logs[FLICKER].is_some(),
        rate_ramp: logs[RAMP].is_some(),
    }
}

/// A fit in words.
fn told(joint: &Joint, best: &Best, contradiction: Option<Contradiction>) -> TermsFit {
    let terms = terms_of(&best.logs);
    let told = |term: usize| bounds::parameter(joint, best, term);
    let misfit =
        choose::is_misfit(joint, &Model { best: *best, from: joint.0.from, contradiction });
    let first = joint.0.usable().next();
    let last = joint.0.usable().next_back();
    TermsFit {
        terms,
        quantisation: terms.quantisation.then(|| told(QUANTISATION)),
        noise_density: told(WHITE),
        bias_instability: terms.bias_instability.then(|| told(FLICKER)),
        random_walk: told(WALK),
        rate_ramp: terms.rate_ramp.then(|| told(RAMP)),
        used: first.zip(last).map(|((first, _), (last, _))| (first, last)),
        contradiction,
        misfit,
    }
}

#[cfg(test)]
mod tests;
