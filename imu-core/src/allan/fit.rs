//! The noise that explains a ladder: N (white noise) and K (random walk), with intervals.
//!
//! The Allan variance of white noise and random walk is N²/τ + K²τ/3 (IEEE Std 952-1997, annex C;
//! Hadamard: N²/τ + K²τ/6). N and K are fitted to the octaves of a ladder by the likelihood of
//! their cube roots, correlations and all: over 4 h the error of K is within a few per cent of what
//! is possible at all (`docs/estimators.md` has the Monte Carlo), without a matrix, a heap or a
//! failure.
//!
//! **Short τ may lie.** A sensor's low-pass filter makes its short-τ variances too small, and those
//! have the smallest intervals: they would decide the fit and ruin it. So octaves are taken in from
//! the longest down; when one contradicts the fit of the longer ones by more than 4 standard
//! deviations, and so does the next shorter one, both and all shorter ones are left out, and
//! [`NoiseFit::contradiction`] says so. Two longer octaves go with them: what contradicts by 4
//! standard deviations at τ is still there at 2τ and 4τ, half and a quarter of it (that is how a
//! low-pass fades), hidden in a scatter that only grows by √2.
//!
//! The same contradiction arises where the *long* octaves are something else (flicker, drift). The
//! shortest octaves tell: if they are white noise among themselves, no filter is at work, nothing is
//! left out, and [`NoiseFit::misfit`] says that N and K are not all there is.
//!
//! **Not observable** is an answer: when the record cannot tell a parameter from zero (with 90 %
//! confidence), the fit gives the bound below which it lies, and how long to record.
//!
//! ```
//! use imu_core::allan::{AllanLadder, Difference, Parameter, Sampling, fit_noise};
//!
//! let mut ladder: AllanLadder<f64, 1, 24, 4> = AllanLadder::new();
//! let mut state = 1_u32;
//! for _ in 0..100_000 {
//!     // Uniform noise of sd 0.1 at 100 Hz: N = 0.1·√0.01 s = 0.01.
//!     state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
//!     ladder.push(&[0.1 * 12_f64.sqrt() * (f64::from(state) / 4_294_967_296.0 - 0.5)]);
//! }
//! let sampling =
//!     Sampling { tau0_s: 0.01, difference: Difference::Allan, windows: 4, records: 1 };
//! let fit = fit_noise(&ladder.octaves(0), sampling);
//! let Parameter::Observable { value, .. } = fit.noise_density else { panic!() };
//! assert!((value - 0.01).abs() < 1e-4);
//! assert!(matches!(fit.random_walk, Parameter::NotObservable { .. }));
//! ```

use super::likelihood::Likelihood;
use super::scan::{Contradiction, contradiction};
use super::search::{Point, best, misfits};
use super::{Octave, Sampling};

/// A noise parameter as far as a record shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameter {
    /// The record shows it.
    Observable {
        /// The estimate.
        value: f64,
        /// Its standard deviation.
        sd: f64,
        /// Lower end of the 90 % confidence interval.
        low90: f64,
        /// Upper end of the 90 % confidence interval.
        high90: f64,
    },
    /// The record cannot tell it from zero.
    NotObservable {
        /// It is below this with 90 % confidence; infinite when the record says nothing at all.
        upper90: f64,
        /// A record shorter than this (s) will not show it.
        record_at_least_s: f64,
    },
}

/// White noise and random walk of one signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseFit {
    /// N, in the signal's unit /√Hz (angle or velocity random walk).
    pub noise_density: Parameter,
    /// K, in the signal's unit /s/√Hz (rate or acceleration random walk).
    pub random_walk: Parameter,
    /// Indices of the shortest and longest octave that were used; `None`: there was nothing to use.
    pub used: Option<(usize, usize)>,
    /// Why shorter ones were not.
    pub contradiction: Option<Contradiction>,
    /// The octaves used are not white noise plus random walk (a flicker, a drift, a vibration is in
    /// them): N and K are of the curve of that form that comes closest, and scatter more than their
    /// intervals say. The sum of squared standardised residuals is beyond n + 6√(2n).
    pub misfit: bool,
}

/// −2 ln likelihood ratio at the ends of a two-sided 90 % interval: 1.645².
pub(super) const INTERVAL: f64 = 2.7055;
/// The same for a bound, one-sided 90 %: 1.2816². A parameter for which zero lies within such a
/// bound is not observable.
pub(super) const UPPER: f64 = 1.6424;
/// Half-distance of numerical derivatives over ln(K/N).
const DELTA: f64 = 0.02;

/// Fits N and K to all octaves that do not contradict longer ones.
///
/// `octaves` are [`Ladder::octaves`](super::Ladder::octaves) of one axis (or an average of several,
/// [`average_octaves`]). Anything may be in them: the result is never a NaN, and says *not
/// observable* where there is nothing to see. Needs no heap, and less than 2 KB of stack on a
/// Cortex-M4F.
#[must_use]
pub fn fit_noise(octaves: &[Octave], sampling: Sampling) -> NoiseFit {
    let mut likelihood = Likelihood { octaves, sampling, from: 0, without: None };
    let contradiction = contradiction(&likelihood);
    likelihood.from = contradiction.map_or(0, |c| c.octave + 1);
    let mut fit = fit(&likelihood);
    fit.contradiction = contradiction;
    fit
}

/// Fits N and K to the octaves from index `from` on, whatever they say of one another.
#[must_use]
pub fn fit_noise_from(octaves: &[Octave], sampling: Sampling, from: usize) -> NoiseFit {
    fit(&Likelihood { octaves, sampling, from, without: None })
}

/// The octaves of several axes as one: their joint likelihood is that of the average, with
/// [`Sampling::records`] set to the number of axes.
#[must_use]
pub fn average_octaves<const LEVELS: usize>(axes: &[[Octave; LEVELS]]) -> [Octave; LEVELS] {
    let mut level = 0;
    [(); LEVELS].map(|()| {
        let index = level;
        level += 1;
        let mut average =
            Octave { samples: 1 << (index & 63), differences: 0, variance: 0.0, white_gain: 0.0 };
        let mut total = 0.0;
        for octave in axes.iter().filter_map(|axis| axis.get(index)) {
            let n = octave.differences as f64;
            total += n;
            average.differences = average.differences.saturating_add(octave.differences);
            average.variance += n * octave.variance;
            average.white_gain += n * octave.white_gain;
        }
        if total > 0.0 {
            average.variance /= total;
            average.white_gain /= total;
        } else {
            average.white_gain = 1.0;
        }
        average.differences =
            average.differences.checked_div(axes.len() as u64).unwrap_or_default();
        average
    })
}

/// Equivalent degrees of freedom of an octave under the noise that was fitted (white noise where
/// nothing was).
#[must_use]
pub fn fitted_edf(octave: &Octave, sampling: Sampling, fit: &NoiseFit) -> f64 {
    let estimate = |p: Parameter| match p {
        Parameter::Observable { value, .. } => value,
        Parameter::NotObservable { .. } => 0.0,
    };
    let (n, k) = (estimate(fit.noise_density), estimate(fit.random_walk));
    let ratio = if n > 0.0 {
        k / n
    } else if k > 0.0 {
        1e9 / sampling.tau0_s
    } else {
        0.0
    };
    let records = f64::from(sampling.records.max(1));
    records * Likelihood { octaves: &[], sampling, from: 0, without: None }.degrees(octave, ratio)
}

fn fit(likelihood: &Likelihood) -> NoiseFit {
    let nothing = Parameter::NotObservable { upper90: f64::INFINITY, record_at_least_s: 0.0 };
    let fit = NoiseFit {
        noise_density: nothing,
        random_walk: nothing,
        used: None,
        contradiction: None,
        misfit: false,
    };
    let (Some(range), Some((first, _)), Some((last, _))) =
        (likelihood.range(), likelihood.usable().next(), likelihood.usable().next_back())
    else {
        return fit;
    };
    if !(1e-12..1e12).contains(&likelihood.sampling.tau0_s) {
        return fit;
    }
    let best = best(likelihood, range);
    NoiseFit {
        noise_density: noise_density(likelihood, range, best),
        random_walk: random_walk(likelihood, range, best),
        used: Some((first, last)),
        contradiction: None,
        misfit: misfits(likelihood, &best),
    }
}

/// ln K² that goes with a ratio.
fn log_walk(point: &Point) -> f64 {
    2.0 * point.x + point.at.log_white
}

/// The likelihood and its derivatives over x = ln(K/N) at a point.
struct Slopes {
    /// dP/dx and ½ d²P/dx² of −2 ln likelihood at the best N.
    first: f64,
    half_second: f64,
    /// d(ln N²)/dx of the best N.
    log_white: f64,
}

fn slopes(likelihood: &Likelihood, point: &Point) -> Slopes {
    let (before, after) = (likelihood.at(point.x - DELTA), likelihood.at(point.x + DELTA));
    Slopes {
        first: (after.minimum - before.minimum) / (2.0 * DELTA),
        half_second: (after.minimum - 2.0 * point.at.minimum + before.minimum)
            / (2.0 * DELTA * DELTA),
        log_white: (after.log_white - before.log_white) / (2.0 * DELTA),
    }
}

/// −2 ln likelihood of the K that goes with this point, at the N that suits that K best, relative
/// to the overall best: P(x) less what moving along constant K gains, to second order.
fn deviance_of_walk(likelihood: &Likelihood, point: &Point, best: &Point) -> f64 {
    let s = slopes(likelihood, point);
    let along = 2.0 + s.log_white;
    let curvature = s.half_second.max(0.0) + point.at.information * along * along;
    let gain = if curvature > 0.0 { s.first * s.first / (4.0 * curvature) } else { 0.0 };
    (point.at.minimum - gain - best.at.minimum).max(0.0)
}

/// The point between `best` and `end` where the deviance of K reaches `level`, or `end`.
fn walk_bound(likelihood: &Likelihood, best: &Point, end: f64, level: f64) -> Point {
    let point = |x| Point { x, at: likelihood.at(x) };
    // The root of the deviance is nearly a straight line.
    let beyond =
        |point: &Point| libm::sqrt(deviance_of_walk(likelihood, point, best)) - libm::sqrt(level);
    // Outward in growing steps.
    let direction = if end > best.x { 1.0 } else { -1.0 };
    let (mut inside, mut step) = ((best.x, -libm::sqrt(level)), 0.1);
    let mut outside = loop {
        let x = inside.0 + direction * step;
        let at_end = (end - x) * direction <= 0.0;
        let there = point(if at_end { end } else { x });
        let off = beyond(&there);
        if off > 0.0 {
            break (there.x, off);
        }
        if at_end {
            return there;
        }
        inside = (x, off);
        step *= 2.0;
    };
    // Then along the chord, whose end that stays is halved in weight (the Illinois rule: Dowell and Jarratt 1971).
    let mut there = point(outside.0);
    let mut stayed = 0_i8;
    for _ in 0..40 {
        if (outside.0 - inside.0).abs() < 2e-3 {
            break;
        }
        let x = outside.0 - outside.1 * (outside.0 - inside.0) / (outside.1 - inside.1);
        there = point(x);
        let off = beyond(&there);
        if off.abs() < 1e-3 {
            break;
        }
        if off > 0.0 {
            outside = (x, off);
            if stayed > 0 {
                inside.1 *= 0.5;
            }
            stayed = 1;
        } else {
            inside = (x, off);
            if stayed < 0 {
                outside.1 *= 0.5;
            }
            stayed = -1;
        }
    }
    there
}

fn random_walk(likelihood: &Likelihood, (low, high): (f64, f64), best: Point) -> Parameter {
    let value = |point: &Point| libm::exp(0.5 * log_walk(point));
    if likelihood.at(low).minimum - best.at.minimum > UPPER {
        let estimate = value(&best);
        // Where the walk decides alone, K scatters with the scale and not with the ratio K/N.
        let scale = libm::sqrt(INTERVAL / best.at.information);
        let end = |to| log_walk(&walk_bound(likelihood, &best, to, INTERVAL)) - log_walk(&best);
        let low90 = estimate * libm::exp(-0.5 * libm::hypot(end(low).min(0.0), scale));
        let high90 = estimate * libm::exp(0.5 * libm::hypot(end(high).max(0.0), scale));
        let sd = (high90 - low90) / (2.0 * libm::sqrt(INTERVAL));
        return Parameter::Observable { value: estimate, sd, low90, high90 };
    }
    let bound = walk_bound(likelihood, &best, high, UPPER);
    let span = likelihood.span();
    if bound.x >= high {
        return Parameter::NotObservable { upper90: f64::INFINITY, record_at_least_s: 2.0 * span };
    }
    // sd(ln K) = √(2N/(K T)) must fall to a third before K can be told from zero; K is at most
    // the bound.
    Parameter::NotObservable {
        upper90: value(&bound),
        record_at_least_s: (18.0 * libm::exp(-bound.x)).max(2.0 * span),
    }
}

fn noise_density(likelihood: &Likelihood, (low, high): (f64, f64), best: Point) -> Parameter {
    let against_zero = likelihood.at(high).minimum - best.at.minimum;
    if against_zero > UPPER {
        // ln N is Gaussian to a good approximation: its information, less what is spent on K/N.
        let s = slopes(likelihood, &best);
        let ratio = s.half_second.max(0.0);
        let shared = best.at.information * s.log_white * s.log_white;
        let information = if ratio > 0.0 {
            best.at.information * ratio / (ratio + shared)
        } else {
            best.at.information
        };
        let sd_log = 0.5 / libm::sqrt(information);
        let value = libm::exp(0.5 * best.at.log_white);
        let spread = libm::exp(libm::sqrt(INTERVAL) * sd_log);
        return Parameter::Observable {
            value,
            sd: value * sd_log,
            low90: value / spread,
            high90: value * spread,
        };
    }
    // The largest N among the ratios that cannot be excluded: the one with least walk.
    let mut least = best.x;
    while least > low && likelihood.at(least).minimum - best.at.minimum < UPPER {
        least -= 0.25;
    }
    let at = likelihood.at(least.max(low));
    let log_upper = at.log_white + libm::sqrt(UPPER / at.information);
    Parameter::NotObservable {
        upper90: libm::exp(0.5 * log_upper),
        record_at_least_s: likelihood.span() * (UPPER / against_zero.max(0.01)).max(2.0),
    }
}

#[cfg(test)]
#[path = "fit_tests.rs"]
mod tests;
