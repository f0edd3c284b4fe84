//! Which short averaging times lie: those that contradict the fit of the longer ones.
//!
//! [`super::fit`] has the rules in words.

use super::likelihood::Likelihood;
use super::search::{Point, best, misfits, nearby};

/// Short τ that contradict the longer ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contradiction {
    /// Index of the longest octave that was left out; all shorter ones were, too.
    pub octave: usize,
    /// By how many standard deviations the longest one that contradicts does so.
    pub sigmas: f64,
}

/// Contradiction of an octave, squared standard deviations.
pub(super) const CONTRADICTS: f64 = 16.0;
/// So many octaves more are left out, where the cause of a contradiction fades.
pub(super) const MARGIN: usize = 2;
/// So many of the shortest octaves tell a filter from noise that is not of this model.
const WHITE_OCTAVES: usize = 5;
/// The scan for contradictions starts where a record is this many averaging times long.
pub(super) const SCAN_FROM: f64 = 64.0;

/// Looks for short octaves that contradict the longer ones. Its memory is free again when the fit
/// begins.
#[inline(never)]
pub(super) fn contradiction(all: &Likelihood) -> Option<Contradiction> {
    let span = all.span();
    let start = all.octaves.iter().position(|o| all.tau(o) * SCAN_FROM * 2.0 > span)?;
    let mut likelihood = Likelihood { from: start, ..*all };
    let mut longer = best(&likelihood, likelihood.range()?);
    for octave in (0..start).rev() {
        likelihood.from = octave;
        let with = nearby(&likelihood, &longer)?;
        if contradicts(&with, &longer) {
            if short_are_white(all) {
                return None;
            }
            // An outlier, or the first of many? The next shorter octave says.
            let sigmas = libm::sqrt(with.at.residual - longer.at.residual);
            let shorter =
                Likelihood { from: octave.saturating_sub(1), without: Some(octave), ..likelihood };
            if octave == 0 || contradicts(&nearby(&shorter, &longer)?, &longer) {
                let octave = (octave + MARGIN).min(start.saturating_sub(1));
                return Some(Contradiction { octave, sigmas });
            }
            likelihood.without = Some(octave);
        } else {
            longer = with;
        }
    }
    None
}

/// Whether the shortest octaves are white noise among themselves. No filter leaves them so: then it
/// is the longer ones that are something else, and N is to be had from the short ones.
pub(super) fn short_are_white(all: &Likelihood) -> bool {
    let shortest = all.octaves.get(..WHITE_OCTAVES).unwrap_or_default();
    let short = Likelihood { octaves: shortest, from: 0, ..*all };
    short.usable().count() == WHITE_OCTAVES
        && short.range().is_some_and(|(low, _)| {
            let white = Point { x: low, at: short.at(low) };
            !misfits(&short, &white)
        })
}

/// Whether one more octave is further than 4 standard deviations from the fit without it: what a
/// Gaussian datum adds to the sum of squares is its standardised residual, squared.
fn contradicts(with: &Point, without: &Point) -> bool {
    with.at.residual - without.at.residual > CONTRADICTS
}
