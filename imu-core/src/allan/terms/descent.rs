//! The most likely values of the terms of a model: damped scoring over the logarithms of their squares.
//!
//! Steps are Fisher's (the expected second derivatives) with Levenberg's and Marquardt's damping, and the slope is
//! that of the likelihood itself, by central differences: degrees of freedom and correlations change with the terms,
//! too. A step that makes matters worse is not taken, so the search cannot diverge. In logarithms a term that is not
//! there goes to its floor, a ten-millionth of what could be seen, and stays a number.

use super::joint::{Joint, Logs, Matrix};
use super::model::{PerTerm, TERMS};

/// Half-distance of numerical derivatives.
const DELTA: f64 = 3e-3;
/// The floor of a term's square over the largest that the octaves allow, as a logarithm: 1e-7.
pub(super) const FLOOR: f64 = -16.118_095_650_958_32;
/// No step changes the square of a term by more than this factor, as a logarithm.
const LONGEST: f64 = 2.5;
/// Steps at most.
const STEPS: u32 = 60;
/// A step that gains less of −2 ln likelihood is the last: by then a value is within a few thousandths of its
/// standard deviation of the best.
pub(super) const EXACT: f64 = 1e-5;
/// The same where the question is whether anything is to be gained at all.
pub(super) const ROUGH: f64 = 0.2;

/// The best values found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Best {
    pub logs: Logs,
    pub minimum: f64,
    /// The sum of squared standardised residuals.
    pub residual: f64,
}

/// The logarithm of the least square that a term can have.
pub(super) fn floor(joint: &Joint, term: usize) -> f64 {
    joint.largest().get(term).map_or(0.0, |most| libm::log(*most) + FLOOR)
}

/// The best values near `start`, of the terms that are in it but for `fixed`; no step follows one that gains less than
/// `enough`.
pub(super) fn descend(joint: &Joint, start: Logs, fixed: Option<usize>, enough: f64) -> Best {
    let floors = joint.largest().map(|most| libm::log(most) + FLOOR);
    let mut logs = start;
    for (index, (log, floor)) in logs.iter_mut().zip(floors).enumerate() {
        if Some(index) != fixed {
            *log = log.map(|log| log.max(floor));
        }
    }
    let (mut damping, mut matrix) = (1e-3, [[0.0; TERMS]; TERMS]);
    let mut at = joint.at(&logs, Some(&mut matrix));
    for _ in 0..STEPS {
        let slopes = slopes(joint, &logs, fixed);
        let mut next = logs;
        let (mut better, mut longest) = (None, 0.0_f64);
        while damping < 1e9 {
            let step = solve(&matrix, &slopes, &logs, fixed, damping);
            next = logs;
            longest = 0.0;
            for ((log, step), floor) in next.iter_mut().zip(step).zip(floors) {
                if let Some(log) = log.as_mut().filter(|_| step != 0.0) {
                    let to = (*log + step.clamp(-LONGEST, LONGEST)).max(floor);
                    longest = longest.max((to - *log).abs());
                    *log = to;
                }
            }
            let then = joint.at(&next, None);
            if then.minimum <= at.minimum {
                better = Some(then);
                damping *= 0.1;
                break;
            }
            damping *= 8.0;
        }
        let Some(then) = better else { break };
        let gain = at.minimum - then.minimum;
        logs = next;
        matrix = [[0.0; TERMS]; TERMS];
        at = joint.at(&logs, Some(&mut matrix));
        damping = damping.max(1e-9);
        if longest < 1e-5 || gain < enough {
            break;
        }
    }
    Best { logs, minimum: at.minimum, residual: at.residual }
}

/// Half the derivatives of −2 ln likelihood; zero for what is not in the model or is fixed.
fn slopes(joint: &Joint, logs: &Logs, fixed: Option<usize>) -> PerTerm {
    let mut slopes = [0.0; TERMS];
    for (index, (slope, log)) in slopes.iter_mut().zip(logs).enumerate() {
        if log.is_some() && Some(index) != fixed {
            let moved = |by: f64| {
                let mut logs = *logs;
                if let Some(Some(log)) = logs.get_mut(index) {
                    *log += by;
                }
                joint.at(&logs, None).minimum
            };
            *slope = (moved(DELTA) - moved(-DELTA)) / (4.0 * DELTA);
        }
    }
    slopes
}

/// The step −(M + damping·diagonal)⁻¹ slope, by Cholesky's factorisation of the matrix scaled to a unit diagonal.
fn solve(
    matrix: &Matrix,
    slopes: &PerTerm,
    logs: &Logs,
    fixed: Option<usize>,
    damping: f64,
) -> PerTerm {
    let mut scale = [0.0; TERMS];
    for i in 0..TERMS {
        if logs[i].is_some() && Some(i) != fixed {
            // A term that is hardly there moves as if a millionth of a degree of freedom knew it.
            scale[i] = 1.0 / libm::sqrt(matrix[i][i].max(1e-6));
        }
    }
    let mut factor = [[0.0; TERMS]; TERMS];
    let mut x = [0.0; TERMS];
    for i in 0..TERMS {
        for j in 0..=i {
            let mut sum = matrix[i][j] * scale[i] * scale[j];
            if i == j {
                sum = 1.0 + damping;
            }
            for (a, b) in factor[i].iter().zip(factor[j]).take(j) {
                sum -= a * b;
            }
            factor[i][j] = if i == j { libm::sqrt(sum.max(1e-12)) } else { sum / factor[j][j] };
        }
        let mut sum = -slopes[i] * scale[i];
        for (a, known) in factor[i].iter().zip(x).take(i) {
            sum -= a * known;
        }
        x[i] = sum / factor[i][i];
    }
    for i in (0..TERMS).rev() {
        let mut sum = x[i];
        for (row, known) in factor.iter().zip(x).skip(i + 1) {
            sum -= row[i] * known;
        }
        x[i] = sum / factor[i][i];
    }
    for (x, scale) in x.iter_mut().zip(scale) {
        *x *= scale;
    }
    x
}
