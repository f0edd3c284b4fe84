//! A term as far as a record shows it: its value and interval, or the bound below which it is.
//!
//! The ends of an interval are where −2 ln likelihood, at the values of the other terms that suit each value of this
//! one best, has risen by 1.645²; so it is asymmetric where the likelihood is.

use super::super::Parameter;
use super::super::fit::{INTERVAL, UPPER};
use super::descent::{Best, EXACT, FLOOR, descend, floor};
use super::joint::{Joint, Logs};
use super::model::{TERMS, WALK, WHITE};

/// A bound is looked for up to this many times the largest square that the octaves allow, as a logarithm: 1e4.
const BEYOND: f64 = 9.21;
/// Steps outward at most, each a fifth longer at least: from 0.02 to 30.
const OUTWARD: u32 = 40;

/// What the best fit says of `term`.
pub(super) fn parameter(joint: &Joint, best: &Best, term: usize) -> Parameter {
    let nothing = Parameter::NotObservable { upper90: f64::INFINITY, record_at_least_s: 0.0 };
    let Some(log) = best.logs.get(term).copied().flatten() else { return nothing };
    let lowest = floor(joint, term);
    let highest = (lowest - FLOOR).max(log) + BEYOND;
    let square = |log: f64| libm::exp(0.5 * log);
    let profile = Profile { joint, best, term, log };
    if profile.deviance(best.logs, lowest).0 > UPPER {
        let value = square(log);
        let low90 = profile.bound(lowest, INTERVAL).map_or(0.0, square).min(value);
        let high90 = profile.bound(highest, INTERVAL).map_or(f64::INFINITY, square).max(value);
        let sd = (high90 - low90) / (2.0 * libm::sqrt(INTERVAL));
        return Parameter::Observable { value, sd, low90, high90 };
    }
    let twice = 2.0 * joint.0.span();
    match profile.bound(highest, UPPER) {
        Some(bound) => {
            // As for N and K alone: sd(ln K) = √(2N/(K T)) must fall to a third.
            let white = best.logs[WHITE].map_or(0.0, square);
            let walk = if term == WALK { 18.0 * white / square(bound) } else { 0.0 };
            Parameter::NotObservable { upper90: square(bound), record_at_least_s: walk.max(twice) }
        }
        None => Parameter::NotObservable { upper90: f64::INFINITY, record_at_least_s: twice },
    }
}

/// The likelihood along one term.
struct Profile<'a> {
    joint: &'a Joint<'a>,
    best: &'a Best,
    term: usize,
    /// ln of the square of the term at its best.
    log: f64,
}

impl Profile<'_> {
    /// By how much −2 ln likelihood rises where ln of the term's square is `to`, and the other terms there; the
    /// search for them begins at `from`.
    fn deviance(&self, from: Logs, to: f64) -> (f64, Logs) {
        let mut start: [Option<f64>; TERMS] = from;
        if let Some(Some(log)) = start.get_mut(self.term) {
            *log = to;
        }
        let found = descend(self.joint, start, Some(self.term), EXACT);
        ((found.minimum - self.best.minimum).max(0.0), found.logs)
    }

    /// Where, on the way to `end`, the deviance reaches `level`; `None` if nowhere. Its root is nearly a straight
    /// line: outward by extrapolation, back by interpolation.
    fn bound(&self, end: f64, level: f64) -> Option<f64> {
        let target = libm::sqrt(level);
        let direction = if end > self.log { 1.0 } else { -1.0 };
        let most = (end - self.log) * direction;
        let (mut inside, mut at_inside) = (0.0, 0.0);
        let mut logs = self.best.logs;
        let mut way: f64 = 0.02;
        let mut beyond = None;
        for _ in 0..OUTWARD {
            way = way.min(most);
            let (deviance, found) = self.deviance(logs, self.log + direction * way);
            let root = libm::sqrt(deviance);
            if root >= target {
                beyond = Some((way, root));
                break;
            }
            if way >= most {
                break;
            }
            (inside, at_inside, logs) = (way, root, found);
            way *= (1.05 * target / root.max(1e-3)).clamp(1.2, 10.0);
        }
        let (mut outside, mut at_outside) = beyond?;
        for _ in 0..12 {
            let share = (target - at_inside) / (at_outside - at_inside).max(1e-12);
            let middle = inside + (outside - inside) * share.clamp(0.05, 0.95);
            let (deviance, found) = self.deviance(logs, self.log + direction * middle);
            let root = libm::sqrt(deviance);
            if (root - target).abs() < 5e-3 * target {
                return Some(self.log + direction * middle);
            }
            if root > target {
                (outside, at_outside) = (middle, root);
            } else {
                (inside, at_inside, logs) = (middle, root, found);
            }
        }
        Some(self.log + direction * 0.5 * (inside + outside))
    }
}
