//! How likely a set of terms makes the variances of a ladder: the likelihood of [`super::super::likelihood`], for
//! five terms.
//!
//! The same law (Wilson & Hilferty 1931: cube roots are nearly Gaussian), the same conditioning of each octave on
//! the two longer ones, and the same value for the same N and K; but no term is singled out, so the search is
//! [`super::descent`]'s.

use super::super::Octave;
use super::super::likelihood::Likelihood;
use super::model::{PerTerm, RAMP, TERMS, noises, of_ones};
use super::spread::{Shares, covariance, spread};

/// ln of Q², N², B², K², R²; `None` for one that is not in the model.
pub(super) type Logs = [Option<f64>; TERMS];

/// A matrix over the terms.
pub(super) type Matrix = [PerTerm; TERMS];

/// −2 ln likelihood.
#[derive(Clone, Copy, Debug)]
pub(super) struct At {
    pub minimum: f64,
    /// The sum of squared standardised residuals in it.
    pub residual: f64,
}

/// An octave in the chain of conditioning; its standardised cube root is `root − mean`.
#[derive(Clone, Copy)]
struct Link {
    level: usize,
    root: f64,
    mean: f64,
    model: f64,
    noises: Shares,
    /// Standard deviation of the octave's variance; the part of it that is of a ramp's ends.
    sd: f64,
    ramp_sd: f64,
    /// d root/d ln(square of a term).
    slopes: PerTerm,
}

/// The octaves, and how they came about.
#[derive(Clone, Copy)]
pub(super) struct Joint<'a>(pub Likelihood<'a>);

impl Joint<'_> {
    /// How many octaves there are.
    pub fn count(&self) -> usize {
        self.0.usable().count()
    }

    /// What these terms make of the variance of an octave.
    pub fn variance(&self, octave: &Octave, logs: &Logs) -> f64 {
        let ones = of_ones(octave, &self.0.sampling);
        ones.iter().zip(logs).map(|(one, log)| log.map_or(0.0, |log| one * libm::exp(log))).sum()
    }

    /// Degrees of freedom of an octave, in one record, where the terms make these variances of it.
    pub fn degrees(&self, octave: &Octave, variances: &PerTerm) -> f64 {
        let sampling = &self.0.sampling;
        let shares = noises(octave, sampling, variances);
        let scatter = spread(
            sampling.difference,
            sampling.windows,
            level_of(octave),
            octave.differences,
            &shares,
            variances[RAMP],
        );
        let model: f64 = variances.iter().sum();
        2.0 * model * model / (scatter.noise + scatter.ramp)
    }

    #[inline(never)] // Its memory is not needed while conditioning.
    fn link(&self, (level, octave): (usize, &Octave), squares: &PerTerm) -> Link {
        let sampling = &self.0.sampling;
        let mut variances = of_ones(octave, sampling);
        for (variance, square) in variances.iter_mut().zip(squares) {
            *variance *= square;
        }
        let noises = noises(octave, sampling, &variances);
        let scatter = spread(
            sampling.difference,
            sampling.windows,
            level_of(octave),
            octave.differences,
            &noises,
            variances[RAMP],
        );
        let model: f64 = variances.iter().sum();
        let variance = scatter.noise + scatter.ramp;
        let ninth = variance / (9.0 * model * model * f64::from(sampling.records.max(1)));
        let scale = 1.0 / libm::sqrt(ninth);
        let root = libm::cbrt(octave.variance / model) * scale;
        let slopes = variances.map(|v| -root / 3.0 * v / model);
        Link {
            level,
            root,
            mean: (1.0 - ninth) * scale,
            model,
            noises,
            sd: libm::sqrt(variance),
            ramp_sd: libm::sqrt(scatter.ramp),
            slopes,
        }
    }

    /// Correlation of the octave of `short` with that of `long`, one or two octaves above.
    fn correlation(&self, short: &Link, long: &Link) -> f64 {
        let Some(octave) = self.0.octaves.get(short.level) else { return 0.0 };
        let sampling = &self.0.sampling;
        let apart = long.level.wrapping_sub(short.level);
        let level = level_of(octave);
        let noise = covariance(sampling.difference, sampling.windows, level, apart, &short.noises)
            / octave.differences as f64;
        // The ends of a ramp move all octaves together.
        let covariance = noise + short.ramp_sd * long.ramp_sd;
        (covariance / (short.sd * long.sd)).clamp(-0.95, 0.95)
    }

    /// −2 ln likelihood of these terms. Adds half of its expected second derivatives over ln of the terms' squares
    /// to `normal`.
    pub fn at(&self, logs: &Logs, mut normal: Option<&mut Matrix>) -> At {
        let squares = logs.map(|log| log.map_or(0.0, libm::exp));
        let mut at = At { minimum: 0.0, residual: 0.0 };
        let mut longer: [Option<Link>; 2] = [None, None];
        for indexed in self.0.usable().rev() {
            let link = self.link(indexed, &squares);
            let mut given = link;
            let mut variance = 1.0;
            let near = longer[0].map_or(0.0, |l| self.correlation(&link, &l));
            let far = longer[1].map_or(0.0, |l| self.correlation(&link, &l));
            let between = match (&longer[0], &longer[1]) {
                (Some(near), Some(far)) => self.correlation(near, far),
                _ => 0.0,
            };
            let scale = 1.0 / (1.0 - between * between);
            let weights = [(near - between * far) * scale, (far - between * near) * scale];
            for ((other, weight), rho) in longer.iter().flatten().zip(weights).zip([near, far]) {
                given.root -= weight * other.root;
                given.mean -= weight * other.mean;
                variance -= weight * rho;
                for (slope, other) in given.slopes.iter_mut().zip(other.slopes) {
                    *slope -= weight * other;
                }
            }
            let variance = variance.max(0.05);
            let off = given.root - given.mean;
            at.residual += off * off / variance;
            at.minimum +=
                libm::log(variance) + 2.0 * libm::log(link.sd) - 4.0 / 3.0 * libm::log(link.model);
            if let Some(normal) = normal.as_deref_mut() {
                // (root² + 1)/9 of a cube root by itself: its slope, and the logarithm's.
                let alone = link.slopes.map(|slope| slope / link.root);
                for (row, (a, c)) in normal.iter_mut().zip(given.slopes.iter().zip(alone)) {
                    for (cell, (b, d)) in row.iter_mut().zip(given.slopes.iter().zip(alone)) {
                        *cell += a * b / variance + c * d;
                    }
                }
            }
            longer[1] = longer[0];
            longer[0] = Some(link);
        }
        at.minimum += at.residual;
        at
    }

    /// The square of each term at which it alone explains all of some octave, and less than all of every other.
    pub fn largest(&self) -> PerTerm {
        let mut largest = [f64::INFINITY; TERMS];
        for (_, octave) in self.0.usable() {
            for (most, one) in largest.iter_mut().zip(of_ones(octave, &self.0.sampling)) {
                if one > 0.0 {
                    *most = most.min(octave.variance / one);
                }
            }
        }
        largest
    }
}

/// log₂ of τ in samples.
fn level_of(octave: &Octave) -> usize {
    octave.samples.checked_ilog2().unwrap_or_default() as usize
}
