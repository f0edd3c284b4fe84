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

/// The minimum over ln(K/N) in low…high by golden section.
pub(super) fn refine(likelihood: &Likelihood, mut low: f64, mut high: f64) -> Point {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let point = |x| Point { x, at: likelihood.at(x) };
    let mut a = point(high - GOLDEN * (high - low));
    let mut b = point(low + GOLDEN * (high - low));
    while high - low > 2e-4 {
        if a.at.minimum < b.at.minimum {
            high = b.x;
            b = a;
            a = point(high - GOLDEN * (high - low));
        } else {
            low = a.x;
            a = b;
            b = point(low + GOLDEN * (high - low));
        }
    }
    if a.at.minimum < b.at.minimum { a } else { b }
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
