//! Which short averaging times lie, whatever the terms: [`super::super::scan`], for a model of more than N and K.

use super::super::scan::{CONTRADICTS, Contradiction, MARGIN, SCAN_FROM, short_are_white};
use super::descent::{Best, EXACT, descend};
use super::joint::{Joint, Logs};

/// Looks for short octaves that contradict the longer ones under a model, whose values are sought from `start` on.
pub(super) fn contradiction(all: &Joint, start: Logs) -> Option<Contradiction> {
    let span = all.0.span();
    let first = all.0.octaves.iter().position(|o| all.0.tau(o) * SCAN_FROM * 2.0 > span)?;
    let mut joint = *all;
    joint.0.from = first;
    if joint.count() == 0 {
        return None;
    }
    let mut longer = descend(&joint, start, None, EXACT);
    for octave in (all.0.from..first).rev() {
        joint.0.from = octave;
        let with = descend(&joint, longer.logs, None, EXACT);
        if contradicts(&with, &longer) {
            if short_are_white(&all.0) {
                return None;
            }
            // An outlier, or the first of many? The next shorter octave says.
            let sigmas = libm::sqrt(with.residual - longer.residual);
            let mut shorter = joint;
            shorter.0.from = octave.saturating_sub(1);
            shorter.0.without = Some(octave);
            if octave == 0 || contradicts(&descend(&shorter, longer.logs, None, EXACT), &longer) {
                let octave = (octave + MARGIN).min(first.saturating_sub(1));
                return Some(Contradiction { octave, sigmas });
            }
            joint.0.without = Some(octave);
        } else {
            longer = with;
        }
    }
    None
}

/// Whether one more octave is further than 4 standard deviations from the fit without it.
fn contradicts(with: &Best, without: &Best) -> bool {
    with.residual - without.residual > CONTRADICTS
}
