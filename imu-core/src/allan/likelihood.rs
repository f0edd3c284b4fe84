//! How likely a ratio of random walk to white noise makes the variances of a ladder.
//!
//! The cube root of a variance over its expectation is nearly Gaussian for any number ν of degrees
//! of freedom down to one, with mean 1 − 2/9ν and variance 2/9ν (Wilson & Hilferty 1931). A Gaussian
//! likelihood of the cube roots therefore has neither the low bias of one of the variances
//! themselves (13 % of K at N/K = 300 s, 4 h) nor its narrow intervals, nor is it at the mercy of
//! one small value as the logarithms are. Octaves err together ([`super::correlation`]); each is
//! conditioned on the two longer ones next to it, which is as good as the full covariance (rms error
//! within 1 %, by Monte Carlo) and needs no matrix.
//!
//! With κ = K/N fixed, the model is N² times known numbers, and the best N solves a quadratic
//! equation: what is left is a function of κ alone.

use super::correlation::covariance;
use super::{Difference, Mixture, Octave, Sampling, edf};

/// The octaves of a fit: from index `from` on, but for one.
#[derive(Clone, Copy)]
pub(super) struct Likelihood<'a> {
    pub octaves: &'a [Octave],
    pub sampling: Sampling,
    pub from: usize,
    pub without: Option<usize>,
}

/// −2 ln likelihood at one ratio, at the best N and, to second order, near it:
/// `minimum + information·(ln N² − log_white)²`.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtRatio {
    /// At the best N.
    pub minimum: f64,
    /// The sum of squared standardised residuals in it.
    pub residual: f64,
    /// The best ln N².
    pub log_white: f64,
    /// The reciprocal of its variance.
    pub information: f64,
}

/// An octave in the chain of conditioning. With θ = N^(−2/3), its standardised cube root is
/// `root·θ − mean`.
#[derive(Clone, Copy)]
struct Link {
    level: usize,
    root: f64,
    mean: f64,
    /// Variance of the octave's variance over the square of the model, in one record.
    relative: f64,
    /// The model for N = 1.
    model: f64,
}

impl Likelihood<'_> {
    /// Averaging time of an octave in seconds.
    pub fn tau(&self, octave: &Octave) -> f64 {
        octave.samples as f64 * self.sampling.tau0_s
    }

    /// How long the record is, in seconds, missing samples not counted.
    pub fn span(&self) -> f64 {
        self.octaves.first().map_or(0.0, |o| o.differences as f64 + 1.0) * self.sampling.tau0_s
    }

    /// White and walk parts of the variance of an octave, for N = 1 and K = `ratio`.
    fn shares(&self, octave: &Octave, ratio: f64) -> (f64, f64) {
        let tau = self.tau(octave);
        let m2 = (octave.samples as f64) * (octave.samples as f64);
        let walk = match self.sampling.difference {
            Difference::Allan => tau / 3.0 * (1.0 + 0.5 / m2),
            Difference::Hadamard => tau / 6.0 * (1.0 + 1.0 / m2),
        };
        (octave.white_gain / tau, ratio * ratio * walk)
    }

    /// Equivalent degrees of freedom of an octave in one record, at K/N = `ratio` (1/s).
    pub fn degrees(&self, octave: &Octave, ratio: f64) -> f64 {
        let (white, random_walk) = self.shares(octave, ratio);
        let stride = (octave.samples / u64::from(self.sampling.windows.max(1))).max(1);
        let mixture = Mixture { white, random_walk, ..Mixture::default() };
        edf(self.sampling.difference, octave.samples, stride, octave.differences, mixture)
    }

    /// An octave with as many `degrees` of freedom in one record.
    #[inline(never)] // As for `given`.
    fn link(&self, (level, octave): (usize, &Octave), ratio: f64, degrees: f64) -> Link {
        let (white, walk) = self.shares(octave, ratio);
        let model = white + walk;
        let ninth = 2.0 / (9.0 * degrees * f64::from(self.sampling.records.max(1)));
        let scale = 1.0 / libm::sqrt(ninth);
        let root = libm::cbrt(octave.variance / model) * scale;
        Link { level, root, mean: (1.0 - ninth) * scale, relative: 2.0 / degrees, model }
    }

    /// Correlation of the octave of `short` with that of `long`, one or two octaves above.
    fn correlation(&self, short: &Link, long: &Link, ratio: f64) -> f64 {
        let Some(octave) = self.octaves.get(short.level) else { return 0.0 };
        let (white, walk) = self.shares(octave, ratio);
        let apart = long.level.wrapping_sub(short.level);
        let Sampling { difference, windows, .. } = self.sampling;
        let covariance = covariance(difference, windows, short.level, apart, white, walk)
            / (octave.differences as f64 * short.model * long.model);
        (covariance / libm::sqrt(short.relative * long.relative)).clamp(-0.95, 0.95)
    }

    /// Root, mean and variance of an octave where the one or two `longer` ones next to it are known.
    #[inline(never)] // Its memory is not needed while the degrees of freedom are worked out.
    fn given(&self, link: &Link, longer: &[Option<Link>; 2], ratio: f64) -> (f64, f64, f64) {
        let (mut root, mut mean, mut variance) = (link.root, link.mean, 1.0);
        let near = longer[0].map_or(0.0, |l| self.correlation(link, &l, ratio));
        let far = longer[1].map_or(0.0, |l| self.correlation(link, &l, ratio));
        let between = match (&longer[0], &longer[1]) {
            (Some(near), Some(far)) => self.correlation(near, far, ratio),
            _ => 0.0,
        };
        let scale = 1.0 / (1.0 - between * between);
        let weights = [(near - between * far) * scale, (far - between * near) * scale];
        for ((link, weight), rho) in longer.iter().flatten().zip(weights).zip([near, far]) {
            root -= weight * link.root;
            mean -= weight * link.mean;
            variance -= weight * rho;
        }
        (root, mean, variance.max(0.05))
    }

    /// The likelihood at K/N = e^`log_ratio` (1/s).
    pub fn at(&self, log_ratio: f64) -> AtRatio {
        let ratio = libm::exp(log_ratio);
        // Σ (root θ − mean)²/variance = a θ² − 2 b θ + c, and ln of the Jacobian.
        let (mut a, mut b, mut c, mut log_scale, mut count) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let mut longer: [Option<Link>; 2] = [None, None];
        for (level, octave) in self.usable().rev() {
            let degrees = self.degrees(octave, ratio);
            let link = self.link((level, octave), ratio, degrees);
            let (root, mean, variance) = self.given(&link, &longer, ratio);
            a += root * root / variance;
            b += root * mean / variance;
            c += mean * mean / variance;
            // The variance of the standardised root, and what turns it into the variance itself.
            log_scale += libm::log(variance * link.relative) + 2.0 / 3.0 * libm::log(link.model);
            count += 1.0;
            longer[1] = longer[0];
            longer[0] = Some(link);
        }
        // a θ² − 2 b θ − 2 n ln θ is smallest at a θ² − b θ − n = 0.
        let theta = (b + libm::sqrt(b * b + 4.0 * a * count)) / (2.0 * a.max(f64::MIN_POSITIVE));
        let log_theta = libm::log(theta);
        let residual = (a * theta - 2.0 * b) * theta + c;
        AtRatio {
            minimum: residual + log_scale - 2.0 * count * log_theta,
            residual,
            log_white: -3.0 * log_theta,
            information: (a * theta * theta + count) / 9.0,
        }
    }

    /// The octaves that have something to say, shortest first. One or two differences would say
    /// little, and their scatter is the least Gaussian.
    pub fn usable(&self) -> impl DoubleEndedIterator<Item = (usize, &Octave)> {
        let enough = if self.sampling.windows > 1 { 6 } else { 3 };
        self.octaves.iter().enumerate().skip(self.from).filter(move |&(index, o)| {
            Some(index) != self.without
                && o.samples > 0
                && o.differences >= enough
                && o.variance > 1e-200
                && o.variance < 1e200 // far from where squares of it are lost
                && (1e-6..1e6).contains(&o.white_gain)
        })
    }

    /// The range of ln(K/N) in which the octaves can tell one from another: the walk is a
    /// millionth of the longest at its lower end, white noise of the shortest at its upper end.
    pub fn range(&self) -> Option<(f64, f64)> {
        let (_, shortest) = self.usable().next()?;
        let (_, longest) = self.usable().next_back()?;
        let low = 0.5 * libm::log(3e-6) - libm::log(self.tau(longest));
        let high = 0.5 * libm::log(3e6) - libm::log(self.tau(shortest));
        (low < high && low > f64::MIN && high < f64::MAX).then_some((low, high))
    }
}
