//! Which terms a record asks for: none beyond N and K unless the likelihood does not let go of it.
//!
//! From N and K on, the term is added whose likelihood-ratio statistic is furthest beyond its critical value, until
//! there is none. A term that a later one has made superfluous goes again.

use super::super::Difference;
use super::descent::{Best, EXACT, ROUGH, descend, floor};
use super::joint::{Joint, Logs};
use super::model::{FLICKER, QUANTISATION, RAMP, TERMS, WALK, WHITE};
use super::short;
use crate::allan::Contradiction;

/// Where a term that is added may start, below the largest that the octaves allow (ln of its square).
const STARTS: [f64; 4] = [0.5, 2.0, 4.0, 7.0];

/// A model and the octaves that it is fitted to.
#[derive(Clone, Copy)]
pub(super) struct Model {
    pub best: Best,
    pub from: usize,
    pub contradiction: Option<Contradiction>,
}

/// A statistic this far below its critical value when [`ROUGH`]ly known does not get there.
const HOPELESS: f64 = 2.0;

/// The best fit with `term` added to the one of `logs`; no step follows one that gains less than `enough`.
pub(super) fn with(joint: &Joint, logs: &Logs, term: usize, enough: f64) -> Best {
    let largest = joint.largest().map(libm::log);
    let mut lifted = *logs;
    // What was not needed may be so beside the new term.
    for (log, most) in lifted.iter_mut().zip(largest) {
        *log = log.map(|log| log.max(most - 7.0));
    }
    let mut start = lifted;
    let mut least = f64::INFINITY;
    for below in STARTS {
        let mut trial = lifted;
        if let (Some(log), Some(most)) = (trial.get_mut(term), largest.get(term)) {
            *log = Some(most - below);
        }
        let minimum = joint.at(&trial, None).minimum;
        if minimum < least {
            (start, least) = (trial, minimum);
        }
    }
    descend(joint, start, None, enough)
}

/// The fit of N and K and of `added`, starting from values of N and K (0: not known).
pub(super) fn fit(
    joint: &Joint,
    noise_density: f64,
    random_walk: f64,
    added: [bool; TERMS],
) -> Best {
    let mut logs: Logs = [None; TERMS];
    for (term, value) in [(WHITE, noise_density), (WALK, random_walk)] {
        let log = if value > 0.0 { 2.0 * libm::log(value) } else { floor(joint, term) + 7.0 };
        if let Some(slot) = logs.get_mut(term) {
            *slot = Some(log);
        }
    }
    let mut best = descend(joint, logs, None, EXACT);
    for (term, _) in added.iter().enumerate().filter(|(_, added)| **added) {
        best = with(joint, &best.logs, term, EXACT);
    }
    best
}

/// What may be added, alone or, where one by itself does not do, together.
const SETS: [&[usize]; 7] = [
    &[FLICKER],
    &[QUANTISATION],
    &[RAMP],
    &[QUANTISATION, FLICKER],
    &[FLICKER, RAMP],
    &[QUANTISATION, RAMP],
    &[QUANTISATION, FLICKER, RAMP],
];

/// How many of [`SETS`] are single terms.
const SINGLE: usize = 3;

/// Adds to a model what its record asks for beyond the `critical` value.
pub(super) fn choose(all: &Joint, base: Model, critical: f64) -> Model {
    let mut model = base;
    for _ in 0..SINGLE {
        let strange = model.from > all.0.from || is_misfit(all, &model);
        let mut found: Option<(f64, Model)> = None;
        for set in SETS.iter().take(if strange { SETS.len() } else { SINGLE }) {
            let known = |term: &usize| model.best.logs.get(*term).copied().flatten().is_some();
            let blind = all.0.sampling.difference == Difference::Hadamard;
            if set.iter().any(|term| known(term) || (blind && *term == RAMP)) {
                continue;
            }
            let Some((statistic, with)) = candidate(all, &model, set, critical) else { continue };
            let ratio = statistic / (critical * set.len() as f64);
            if ratio > found.as_ref().map_or(1.0, |f| f.0) {
                found = Some((ratio, with));
            }
        }
        match found {
            Some((_, with)) => model = with,
            None => break,
        }
    }
    without_superfluous(all, model, critical)
}

/// Whether a model is further from its octaves than their scatter explains.
pub(super) fn is_misfit(all: &Joint, model: &Model) -> bool {
    let mut joint = *all;
    joint.0.from = model.from;
    let n = joint.count() as f64;
    model.best.residual > n + 6.0 * libm::sqrt(2.0 * n)
}

/// The likelihood-ratio statistic of some terms, and the model with them; `None` where the statistic is not beyond
/// `critical` times their number.
fn candidate(all: &Joint, model: &Model, terms: &[usize], critical: f64) -> Option<(f64, Model)> {
    let mut joint = *all;
    let mut contradiction = model.contradiction;
    // A quantised integral shows at the shortest τ, and makes it larger; what is of this slope elsewhere is a
    // vibration, and what makes it smaller a filter.
    if terms.contains(&QUANTISATION) && model.from > all.0.from && !shortest_is_large(all, model) {
        return None;
    }
    joint.0.from = model.from;
    let added = |joint: &Joint, enough| {
        terms.iter().fold(model.best, |best, term| with(joint, &best.logs, *term, enough))
    };
    let (mut without, mut best) = (model.best, added(&joint, ROUGH));
    let hopeless = without.minimum - best.minimum < critical * terms.len() as f64 - HOPELESS;
    if hopeless && model.from <= all.0.from {
        return None;
    }
    best = descend(&joint, best.logs, None, EXACT);
    if model.from > all.0.from {
        // Shorter octaves may contradict what lacks the terms, and not what has them.
        let found = short::contradiction(all, best.logs);
        let from = found.map_or(all.0.from, |c| c.octave + 1);
        joint.0.from = from.min(model.from);
        if from < model.from {
            contradiction = found;
            without = descend(&joint, model.best.logs, None, EXACT);
            best = added(&joint, EXACT);
        }
    }
    if terms.contains(&QUANTISATION) && joint.0.from > 0 {
        return None;
    }
    Some((without.minimum - best.minimum, Model { best, from: joint.0.from, contradiction }))
}

/// Whether the shortest octave is larger than a model of longer ones makes it.
fn shortest_is_large(all: &Joint, model: &Model) -> bool {
    all.0
        .usable()
        .next()
        .is_some_and(|(_, octave)| octave.variance > all.variance(octave, &model.best.logs))
}

/// Takes away, one after the other, what a model does without.
fn without_superfluous(all: &Joint, mut model: Model, critical: f64) -> Model {
    let mut joint = *all;
    joint.0.from = model.from;
    for term in [RAMP, QUANTISATION, FLICKER] {
        if model.best.logs.get(term).copied().flatten().is_none() {
            continue;
        }
        let mut logs = model.best.logs;
        if let Some(log) = logs.get_mut(term) {
            *log = None;
        }
        let without = descend(&joint, logs, None, EXACT);
        if without.minimum - model.best.minimum < critical {
            model.best = without;
        }
    }
    model
}
