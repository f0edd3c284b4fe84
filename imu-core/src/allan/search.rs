//! The best ratio of random walk to white noise: a search along one line, which cannot diverge.

use super::likelihood::{AtRatio, Likelihood};

/// Step of the coarse search over ln(K/N).
const COARSE: f64 = 0.6;

/// A point of the search: ln(K/N), and the likelihood there.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub x: f64,
    pub at: AtRatio,
}

/// How near to the minimum is near enough: a ten-thousandth of K.
const NEAR: f64 = 1e-4;

/// The minimum over ln(K/N) in low…high: the vertex of the parabola through the three best points, or a golden
/// section of the longer side where that is not to be trusted (Brent 1973, chapter 5).
pub(super) fn refine(likelihood: &Likelihood, mut low: f64, mut high: f64) -> Point {
    /// (3 − √5)/2
    const SECTION: f64 = 0.381_966_011_250_105_1;
    let point = |x| Point { x, at: likelihood.at(x) };
    let mut best = point(low + SECTION * (high - low));
    let (mut second, mut third) = (best, best);
    let (mut step, mut step_before) = (0.0_f64, 0.0_f64);
    // Each golden section leaves 0.62: from the widest range, with as many parabolas between them.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (best.x - middle).abs() + 0.5 * (high - low) <= 2.0 * NEAR {
            break;
        }
        let (to_second, to_third) = (best.x - second.x, best.x - third.x);
        let r = to_second * (best.at.minimum - third.at.minimum);
        let q = to_third * (best.at.minimum - second.at.minimum);
        let (above, below) = (to_third * q - to_second * r, 2.0 * (r - q));
        let vertex = above / below;
        // Also where the parabola is none, and its vertex no number.
        let trusted = vertex.abs() < 0.5 * step_before.abs()
            && best.x + vertex > low + NEAR
            && best.x + vertex < high - NEAR;
        if trusted {
            (step_before, step) = (step, vertex);
        } else {
            step_before = if best.x < middle { high - best.x } else { low - best.x };
            step = SECTION * step_before;
        }
        let next =
            point(best.x + if step.abs() < NEAR { libm::copysign(NEAR, step) } else { step });
        if next.at.minimum <= best.at.minimum {
            if next.x < best.x {
                high = best.x;
            } else {
                low = best.x;
            }
            (third, second, best) = (second, best, next);
        } else {
            if next.x < best.x {
                low = next.x;
            } else {
                high = next.x;
            }
            if next.at.minimum <= second.at.minimum || second.x == best.x {
                (third, second) = (second, next);
            } else if next.at.minimum <= third.at.minimum
                || third.x == best.x
                || third.x == second.x
            {
                third = next;
            }
        }
    }
    best
}

/// The best ratio in the whole range.
pub(super) fn best(likelihood: &Likelihood, (low, high): (f64, f64)) -> Point {
    let mut best = Point { x: low, at: likelihood.at(low) };
    let steps = libm::ceil((high - low) / COARSE).clamp(1.0, 200.0);
    for i in 1..=steps as u32 {
        let x = low + (high - low) * f64::from(i) / steps;
        let at = likelihood.at(x);
        if at.minimum < best.at.minimum {
            best = Point { x, at };
        }
    }
    refine(likelihood, (best.x - COARSE).max(low), (best.x + COARSE).min(high))
}

/// Whether the octaves are further from a fit than their scatter explains.
pub(super) fn misfits(likelihood: &Likelihood, fit: &Point) -> bool {
    let n = likelihood.usable().count() as f64;
    fit.at.residual > n + 6.0 * libm::sqrt(2.0 * n)
}

/// The minimum near a neighbouring fit, or wherever it is if that fit did not know better.
pub(super) fn nearby(likelihood: &Likelihood, neighbour: &Point) -> Option<Point> {
    let (low, high) = likelihood.range()?;
    let within = |x: f64| x.max(low).min(high);
    let (from, to) = (within(neighbour.x - COARSE), within(neighbour.x + COARSE));
    let point = refine(likelihood, from, to);
    let at_the_edge = (point.x - neighbour.x).abs() > 0.9 * COARSE;
    Some(if at_the_edge { best(likelihood, (low, high)) } else { point })
}
