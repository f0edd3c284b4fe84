//! Exact Gaussian maximum likelihood of white noise N and random walk K on block means.
//!
//! The benchmark that the fit to octaves is measured against (`--estimator ml`): no estimator of
//! this model knows K better on a long record. The likelihood is computed by a Kalman filter (Kalman
//! 1960; Schweppe 1965, *Evaluation of likelihood functions for Gaussian signals*) with one state,
//! the bias, unknown at first. It is that of the differences of block means, whose covariance is
//! tridiagonal for a record without holes, and stays exact with whole blocks missing, for
//! O(blocks) a ratio K/N. A block in which only some samples are missing counts their white noise
//! exactly and takes its bias for that of the whole block.
//!
//! With κ = K/N fixed, every variance is N² times a known number and the best N has a closed form:
//! what is left is a search over κ. The 90 % intervals are those of the profile likelihood: the
//! extremes of ln N and ln K where −2 ln likelihood is within 2.7055 of its minimum.
//!
//! **Short τ may lie**: a sensor's low-pass filter takes white noise from short blocks, and exact
//! maximum likelihood believes them. So blocks are half a second long at least, or as long as the
//! shortest averaging time that the fit to octaves found trustworthy, if that is longer.
//!
//! ```
//! use imu_core::allan::Parameter;
//! use imu_core::noise::{RandomWalk, Sensor, Stage, ThreeAxis, White};
//! use imu_tools::calibrate::{block_means::BlockMeans, maximum_likelihood};
//!
//! // Half an hour at 100 Hz.
//! let terms = (White { noise_density: 0.02 }, RandomWalk { random_walk: 2e-3 });
//! let mut sensor = ThreeAxis::prepare([terms; 3], 0.01, 1, Sensor::GYROSCOPE)?;
//! let mut means = BlockMeans::new();
//! for _ in 0..180_000 {
//!     means.extend(&[sensor.step([0.0; 3])]);
//! }
//! let fit = maximum_likelihood::fit(&means, 0.01, 0.0);
//! let Parameter::Observable { low90, high90, .. } = fit.pooled.random_walk else { panic!() };
//! assert!(low90 < 2e-3 && 2e-3 < high90);
//! # Ok::<(), imu_core::Error>(())
//! ```

use imu_core::allan::Parameter;

use super::AxisNoise;
use super::block_means::BlockMeans;

/// Blocks are not shorter than this, s.
const SHORTEST_BLOCK_S: f64 = 0.5;
/// −2 ln likelihood ratio at the ends of a two-sided 90 % interval (1.645²), and of a one-sided
/// bound (1.2816²); the latter also decides what is observable. As in `imu_core::allan::fit_noise`.
const INTERVAL: f64 = 2.7055;
const UPPER: f64 = 1.6424;
/// Step of the coarse search over ln κ, and where a refinement ends.
const COARSE: f64 = 0.6;
const FINE: f64 = 1e-3;

/// What maximum likelihood says of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaximumLikelihood {
    /// Each axis by itself.
    pub axes: [AxisNoise; 3],
    /// All axes as records of one noise: their log likelihoods add.
    pub pooled: AxisNoise,
    /// Length of the blocks, s: the shortest averaging time that was used.
    pub block_s: f64,
}

/// Fits N and K to a record sampled every `tau0_s` seconds, in blocks of at least `shortest_tau_s`
/// seconds (and half a second).
///
/// Never a NaN: what the record does not show is [`Parameter::NotObservable`].
#[must_use]
pub fn fit(means: &BlockMeans, tau0_s: f64, shortest_tau_s: f64) -> MaximumLikelihood {
    let samples = (shortest_tau_s.max(SHORTEST_BLOCK_S) / tau0_s * (1.0 - 1e-9)).ceil();
    let means = means.merged(samples as u64);
    let estimate =
        |axes: &[usize]| Likelihood::new(&means, tau0_s, axes).map_or(NOTHING, |l| l.estimate());
    MaximumLikelihood {
        axes: [0, 1, 2].map(|axis| estimate(&[axis])),
        pooled: estimate(&[0, 1, 2]),
        block_s: means.length() as f64 * tau0_s,
    }
}

/// The record says nothing at all.
const NOTHING: AxisNoise = {
    let p = Parameter::NotObservable { upper90: f64::INFINITY, record_at_least_s: 0.0 };
    AxisNoise::of_two(p, p)
};

/// The likelihood of one axis, or of several together.
struct Likelihood<'a> {
    means: &'a BlockMeans,
    tau0_s: f64,
    axes: &'a [usize],
    /// Differences between blocks, over all axes.
    count: f64,
    /// The longest stretch between restarts, s.
    span: f64,
}

/// −2 ln likelihood at one ratio: `minimum` at the best N; at others
/// `minimum + count·(e^(−d) − 1 + d)`, where d = ln N² − `log_white`.
#[derive(Clone, Copy)]
struct Point {
    /// ln κ.
    x: f64,
    minimum: f64,
    log_white: f64,
}

/// Sums over the differences of a record at N² = τ0, that is for samples of unit white variance.
struct Innovations {
    /// Squares of the differences over their variances, axis by axis.
    squares: [f64; 3],
    /// ln of the product of the variances.
    log_variances: f64,
    count: u64,
}

/// The Kalman filter, where `walk` is the variance of the bias's step from sample to sample over
/// the variance of a sample's white noise.
fn innovations(means: &BlockMeans, walk: f64) -> Innovations {
    let m = means.length() as f64;
    // A block that begins with the bias b has the mean b + a + white noise; the next one begins
    // with b + s. Variances of a and s, and their covariance:
    let var_a = walk * (m - 1.0) * (2.0 * m - 1.0) / (6.0 * m);
    let var_s = walk * m;
    let covariance = walk * (m - 1.0) / 2.0;
    let mut sums = Innovations { squares: [0.0; 3], log_variances: 0.0, count: 0 };
    let mut product = 1.0_f64;
    for segment in means.segments() {
        let mut blocks = segment.iter().skip_while(|block| block.samples == 0);
        let Some(first) = blocks.next() else { continue };
        let white = 1.0 / first.samples as f64;
        // The prediction of the next block's first bias, and its variance; after the first block
        // it is that block's mean.
        let mut bias = first.sum.map(|sum| sum * white);
        let mut variance = walk + var_a + white;
        for block in blocks {
            if block.samples == 0 {
                variance += var_s;
                continue;
            }
            let white = 1.0 / block.samples as f64;
            let of_difference = variance + var_a + white;
            let precision = 1.0 / of_difference;
            let shared = variance + covariance;
            let gain = shared * precision;
            for ((bias, sum), squares) in bias.iter_mut().zip(block.sum).zip(&mut sums.squares) {
                let difference = sum * white - *bias;
                *squares += difference * difference * precision;
                *bias += gain * difference;
            }
            variance += var_s - shared * gain;
            sums.count += 1;
            // One logarithm serves many factors.
            product *= of_difference;
            if !(1e-100..1e100).contains(&product) {
                sums.log_variances += product.ln();
                product = 1.0;
            }
        }
    }
    sums.log_variances += product.ln();
    sums
}

impl<'a> Likelihood<'a> {
    /// `None` when there is nothing to fit: fewer than three differences, or no noise at all.
    fn new(means: &'a BlockMeans, tau0_s: f64, axes: &'a [usize]) -> Option<Self> {
        let longest = means.segments().iter().map(Vec::len).max().unwrap_or(0) as f64;
        let span = longest * means.length() as f64 * tau0_s;
        let flat = innovations(means, 0.0);
        let enough = flat.count >= 3 && span > 0.0 && span < f64::MAX;
        let noisy = axes.iter().all(|&axis| {
            let squares = flat.squares[axis];
            squares > f64::MIN_POSITIVE && squares < f64::MAX
        });
        let count = flat.count as f64 * axes.len() as f64;
        (enough && noisy).then_some(Self { means, tau0_s, axes, count, span })
    }

    fn at(&self, x: f64) -> Point {
        let ratio = x.exp() * self.tau0_s;
        let sums = innovations(self.means, ratio * ratio);
        let squares: f64 = self.axes.iter().map(|&axis| sums.squares[axis]).sum();
        let log_variance = (squares / self.count).ln();
        Point {
            x,
            minimum: self.count * (log_variance + 1.0)
                + self.axes.len() as f64 * sums.log_variances,
            log_white: log_variance + self.tau0_s.ln(),
        }
    }

    /// The range of ln κ in which the record can tell one from another: at its lower end the walk
    /// is a millionth of the variance of the whole record, at its upper end white noise is a
    /// millionth of that of a block.
    fn range(&self) -> (f64, f64) {
        let block_s = self.means.length() as f64 * self.tau0_s;
        (0.5 * 3e-6_f64.ln() - self.span.ln(), 0.5 * 3e6_f64.ln() - block_s.ln())
    }

    fn estimate(&self) -> AxisNoise {
        let (low, high) = self.range();
        let steps = ((high - low) / COARSE).ceil().max(1.0) as usize;
        let ends = [self.at(low), self.at(high)];
        let best = (1..steps)
            .map(|i| self.at(low + (high - low) * i as f64 / steps as f64))
            .chain(ends)
            .min_by(|a, b| a.minimum.total_cmp(&b.minimum))
            .unwrap_or(ends[0]);
        let (from, to) = ((best.x - COARSE).max(low), (best.x + COARSE).min(high));
        let best = self.search(from, to, |point| -point.minimum);
        AxisNoise::of_two(self.noise_density(&best, ends), self.random_walk(&best, ends))
    }

    /// The point of low…high where `goal` is largest, by golden section.
    fn search(&self, mut low: f64, mut high: f64, goal: impl Fn(&Point) -> f64) -> Point {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let tolerance = (FINE * (high - low)).max(1e-9);
        let mut a = self.at(high - GOLDEN * (high - low));
        let mut b = self.at(low + GOLDEN * (high - low));
        while high - low > tolerance {
            if goal(&a) > goal(&b) {
                high = b.x;
                b = a;
                a = self.at(high - GOLDEN * (high - low));
            } else {
                low = a.x;
                a = b;
                b = self.at(low + GOLDEN * (high - low));
            }
        }
        if goal(&a) > goal(&b) { a } else { b }
    }

    /// The largest (`side` = 1) or smallest (−1) ln N² at this ratio whose −2 ln likelihood is
    /// within `level` of the best.
    fn log_white_end(&self, point: &Point, best: &Point, level: f64, side: f64) -> f64 {
        // e^(−d) − 1 + d = rest, by Newton's method from d²/2 = rest.
        let rest = ((level - (point.minimum - best.minimum)) / self.count).max(0.0);
        let mut d = side * (2.0 * rest).sqrt();
        for _ in 0..8 {
            let slope = -(-d).exp_m1();
            if slope != 0.0 {
                d -= ((-d).exp_m1() + d - rest) / slope;
            }
        }
        point.log_white + d
    }

    /// Where the likelihood at the best N leaves `level` on the way from `best` to `end`; `end`
    /// itself if it never does.
    fn edge(&self, best: &Point, end: &Point, level: f64) -> f64 {
        let above = |point: &Point| point.minimum - best.minimum;
        let (mut inside, mut outside) = (*best, *end);
        if above(end) <= level {
            return end.x;
        }
        let direction = (end.x - best.x).signum();
        let mut step = 0.1;
        while (end.x - best.x) * direction > step {
            let point = self.at(best.x + direction * step);
            if above(&point) > level {
                outside = point;
                break;
            }
            inside = point;
            step *= 2.0;
        }
        while (outside.x - inside.x).abs() > FINE * (outside.x - best.x).abs() {
            let point = self.at(0.5 * (inside.x + outside.x));
            if above(&point) > level {
                outside = point;
            } else {
                inside = point;
            }
        }
        inside.x
    }

    /// The largest or smallest `weight`·ln κ + ln N² within `level` of the best, and the ln κ
    /// there: ln N² with weight 0, ln K² with weight 2. The search goes towards `end`.
    fn extreme(&self, best: &Point, end: &Point, level: f64, weight: f64, side: f64) -> (f64, f64) {
        let edge = self.edge(best, end, level);
        let value = |p: &Point| weight * p.x + self.log_white_end(p, best, level, side);
        let (low, high) = (best.x.min(edge), best.x.max(edge));
        let inner = self.search(low, high, |p| side * value(p));
        [inner, self.at(edge)]
            .iter()
            .map(|p| (value(p), p.x))
            .max_by(|a, b| (side * a.0).total_cmp(&(side * b.0)))
            .unwrap_or((value(best), best.x))
    }

    fn random_walk(&self, best: &Point, [low, high]: [Point; 2]) -> Parameter {
        if low.minimum - best.minimum > UPPER {
            let value = 0.5 * (2.0 * best.x + best.log_white);
            let (low90, _) = self.extreme(best, &low, INTERVAL, 2.0, -1.0);
            let (high90, _) = self.extreme(best, &high, INTERVAL, 2.0, 1.0);
            return observable(value, 0.5 * low90, 0.5 * high90);
        }
        let (log_upper, x) = self.extreme(best, &high, UPPER, 2.0, 1.0);
        if high.minimum - best.minimum <= UPPER {
            return Parameter::NotObservable {
                upper90: f64::INFINITY,
                record_at_least_s: 2.0 * self.span,
            };
        }
        // √(2N/(K T)), the sd of ln K, must fall to a third; K is at most the bound.
        Parameter::NotObservable {
            upper90: (0.5 * log_upper).exp(),
            record_at_least_s: (18.0 * (-x).exp()).max(2.0 * self.span),
        }
    }

    fn noise_density(&self, best: &Point, [low, high]: [Point; 2]) -> Parameter {
        // More walk leaves less white noise: the largest N is on the way to the smallest ratio.
        let against_zero = high.minimum - best.minimum;
        if against_zero > UPPER {
            let (low90, _) = self.extreme(best, &high, INTERVAL, 0.0, -1.0);
            let (high90, _) = self.extreme(best, &low, INTERVAL, 0.0, 1.0);
            return observable(0.5 * best.log_white, 0.5 * low90, 0.5 * high90);
        }
        let (log_upper, _) = self.extreme(best, &low, UPPER, 0.0, 1.0);
        Parameter::NotObservable {
            upper90: (0.5 * log_upper).exp(),
            record_at_least_s: self.span * (UPPER / against_zero.max(0.01)).max(2.0),
        }
    }
}

/// From the logarithms of an estimate and of the ends of its interval.
fn observable(value: f64, low: f64, high: f64) -> Parameter {
    let [value, low90, high90] = [value, low.min(value), high.max(value)].map(f64::exp);
    let sd = (high90 - low90) / (2.0 * INTERVAL.sqrt());
    Parameter::Observable { value, sd, low90, high90 }
}

#[cfg(test)]
#[path = "maximum_likelihood_tests.rs"]
mod tests;
