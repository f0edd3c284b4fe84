//! Warm-up and ramps: is the way that the mean has gone explained by the noise that was fitted?
//!
//! A random walk K wanders K√t in a time t. A sensor that warms up goes further, and its drift,
//! taken for a random walk, makes K several times too large. Two rules, on the means of blocks
//! ([`BlockMeans`]):
//!
//! - **Warm-up.** The record's second half shows what is usual. From there towards the beginning,
//!   each half of what is left is looked at: where the mean goes further in it than [`TOO_FAR`]
//!   standard deviations of white noise and random walk, the warm-up has not ended. The time up to
//!   twice that end decides nothing about long averaging times (a warm-up fades).
//! - **Ramp.** If after that the whole record still goes further than the Hadamard variance allows,
//!   which is blind to a linear drift, there is a ramp, and K is read from the Hadamard variance.
//!   So it is where the fit of the octaves asks for a ramp ([`super::terms`]).
//!
//! Distance: the means of the first and last quarter of a stretch of length L differ by a variance
//! of ⅔K²L + 8N²/L (¾L between their centres, less ⅓ of a quarter for averaging over each).

use imu_core::allan::{
    Difference, Ladder, NoiseFit, Octave, Parameter, Sampling, average_octaves, fit_noise_from,
};

use super::LEVELS;
use super::block_means::{Block, BlockMeans};

/// Standard deviations that noise alone does not go.
const TOO_FAR: f64 = 5.0;
/// Noise is estimated anew until no more than this part of the record is left to look at: a longer
/// rest shows little more of it.
const LEARN: usize = 8;
/// A stretch of fewer blocks is not looked at.
const FEWEST: usize = 16;
/// Octaves of a ladder of blocks that have fewer than four windows, and are not used.
const COARSE: usize = 2;

/// What the long averaging times say.
#[derive(Clone, Debug)]
pub(super) struct Drift {
    /// Samples at the beginning that are still warming up.
    pub(super) warm_up: u64,
    /// Octaves of each axis, long ones without the warm-up.
    pub(super) octaves: [[Octave; LEVELS]; 3],
    /// Unit per second, of each axis, where there is a ramp.
    pub(super) slope: Option<[f64; 3]>,
    /// What is not blind to anything but a ramp.
    pub(super) hadamard: Hadamard,
}

/// The Hadamard variances of the means of blocks.
#[derive(Clone, Debug)]
pub(super) struct Hadamard {
    pub(super) octaves: [[Octave; LEVELS]; 3],
    pub(super) sampling: Sampling,
    /// The first octave that is to be trusted.
    pub(super) from: usize,
}

impl Hadamard {
    /// The octaves of all axes that are no constant as one.
    pub(super) fn pooled(&self) -> ([Octave; LEVELS], Sampling) {
        let live: Vec<_> =
            self.octaves.iter().filter(|axis| axis[COARSE].variance > 0.0).copied().collect();
        (average_octaves(&live), Sampling { records: live.len() as u32, ..self.sampling })
    }
}

/// Largest N and K that are plausible.
#[derive(Clone, Copy)]
struct Noise {
    white: f64,
    walk: f64,
}

impl Noise {
    fn of(fit: &NoiseFit) -> Self {
        let plausible = |p: Parameter| match p {
            Parameter::Observable { value, high90, .. } => 0.5 * (value + high90),
            Parameter::NotObservable { upper90, .. } => upper90,
        };
        Self { white: plausible(fit.noise_density), walk: plausible(fit.random_walk) }
    }
}

/// Looks for warm-up and ramp. `octaves` are those of the whole record, `from` is the index of the
/// first that is to be trusted, and `tau0_s` the time between samples.
pub(super) fn examine(
    means: &BlockMeans,
    octaves: [[Octave; LEVELS]; 3],
    tau0_s: f64,
    from: usize,
) -> Drift {
    let block_s = means.length() as f64 * tau0_s;
    let hadamard = hadamard(means, 0, block_s, from);
    let mut drift = Drift { warm_up: 0, octaves, slope: None, hadamard };
    let Some(first) = means.segments().first() else { return drift };
    let sampling = Sampling { tau0_s, difference: Difference::Allan, windows: 4, records: 1 };

    // From the middle towards the beginning.
    let half = first.len() / 2;
    let noise_after = |cut: usize| {
        without_start(&octaves, means, cut)
            .map(|axis| Noise::of(&fit_noise_from(&axis, sampling, from)))
    };
    let mut noise = noise_after(half);
    let mut cut = half;
    let mut end_of_warm_up = None;
    while cut >= FEWEST {
        if cut < half && cut * LEARN >= first.len() {
            noise = noise_after(cut);
        }
        let strange = |from: usize| {
            let stretch = first.get(from..cut).unwrap_or_default();
            goes_too_far(stretch, block_s, &noise).is_some()
        };
        if strange(cut / 2) || strange(0) {
            end_of_warm_up = Some(cut);
            if strange(cut / 2) {
                break;
            }
        }
        cut /= 2;
    }
    let cut = end_of_warm_up.map_or(0, |end| (2 * end).min(half));
    if cut > 0 {
        drift.warm_up = cut as u64 * means.length();
        drift.octaves = without_start(&octaves, means, cut);
        drift.hadamard = self::hadamard(means, cut, block_s, from);
    }
    drift.slope = slope(means, cut, block_s, &drift.hadamard);
    drift
}

/// How far the mean of each axis goes from the first to the last quarter of a stretch, per second,
/// where that is too far for an axis.
fn goes_too_far(stretch: &[Block], block_s: f64, noise: &[Noise; 3]) -> Option<[f64; 3]> {
    if stretch.len() < FEWEST {
        return None;
    }
    let quarter = stretch.len() / 4;
    let mean = |blocks: &[Block]| {
        let samples: u64 = blocks.iter().map(|block| block.samples).sum();
        let sum = |axis: usize| blocks.iter().map(|block| block.sum[axis]).sum::<f64>();
        (samples > 0).then(|| [sum(0), sum(1), sum(2)].map(|sum| sum / samples as f64))
    };
    let before = mean(stretch.get(..quarter)?)?;
    let after = mean(stretch.get(stretch.len() - quarter..)?)?;
    let length = stretch.len() as f64 * block_s;
    let way = [0, 1, 2].map(|axis| after[axis] - before[axis]);
    let too_far = way.iter().zip(noise).any(|(way, noise)| {
        let variance =
            noise.walk * noise.walk * length * 2.0 / 3.0 + 8.0 * noise.white * noise.white / length;
        way.abs() > TOO_FAR * variance.sqrt() // not where a bound is infinite
    });
    too_far.then(|| way.map(|way| way / (0.75 * length)))
}

/// The octaves with those of long averaging times made anew, without the first `cut` blocks.
fn without_start(
    octaves: &[[Octave; LEVELS]; 3],
    means: &BlockMeans,
    cut: usize,
) -> [[Octave; LEVELS]; 3] {
    let ladder = ladder::<1>(means, cut);
    let shift = means.length().trailing_zeros() as usize;
    let mut all = *octaves;
    for (axis, octaves) in all.iter_mut().enumerate() {
        let long = ladder.octaves(axis);
        let long = long.iter().skip(COARSE);
        for (octave, long) in octaves.iter_mut().skip(shift + COARSE).zip(long) {
            octave.differences = long.differences;
            octave.variance = long.variance;
        }
    }
    all
}

/// The Hadamard variances from block `cut` on.
fn hadamard(means: &BlockMeans, cut: usize, block_s: f64, from: usize) -> Hadamard {
    let ladder = ladder::<2>(means, cut);
    let shift = means.length().trailing_zeros() as usize;
    Hadamard {
        octaves: [0, 1, 2].map(|axis| ladder.octaves(axis)),
        sampling: Sampling {
            tau0_s: block_s,
            difference: Difference::Hadamard,
            windows: 4,
            records: 1,
        },
        from: from.saturating_sub(shift).max(COARSE),
    }
}

/// The way of each axis per second, if the record goes further than its Hadamard variance allows.
fn slope(means: &BlockMeans, cut: usize, block_s: f64, hadamard: &Hadamard) -> Option<[f64; 3]> {
    let Hadamard { octaves, sampling, from } = hadamard;
    let noise = octaves.map(|axis| Noise::of(&fit_noise_from(&axis, *sampling, *from)));
    // The longest stretch shows a ramp best.
    let longest = stretches(means, cut).max_by_key(|stretch| stretch.len())?;
    goes_too_far(longest, block_s, &noise)
}

/// The stretches between restarts, from block `cut` on.
fn stretches(means: &BlockMeans, cut: usize) -> impl Iterator<Item = &[Block]> {
    means.segments().iter().enumerate().map(move |(k, segment)| {
        let skipped = if k == 0 { cut } else { 0 };
        segment.get(skipped..).unwrap_or_default()
    })
}

/// The variances of the means of blocks from `cut` on. A block that misses more than half of its
/// samples counts as missing.
fn ladder<const ORDER: usize>(means: &BlockMeans, cut: usize) -> Ladder<f64, 3, LEVELS, 4, ORDER> {
    type Any<const ORDER: usize> = Ladder<f64, 3, LEVELS, 4, ORDER>;
    let mut ladder = Any::with_reference([0.0; 3], [Any::<ORDER>::limit(); 3]).unwrap_or_default();
    let is_there = |block: &Block| block.samples > 0 && 2 * block.samples >= means.length();
    let mut run = Vec::new();
    for stretch in stretches(means, cut) {
        ladder.restart();
        for blocks in stretch.chunk_by(|a, b| is_there(a) == is_there(b)) {
            if blocks.first().is_some_and(is_there) {
                run.clear();
                run.extend(
                    blocks.iter().map(|block| block.sum.map(|sum| sum / block.samples as f64)),
                );
                ladder.extend(&run);
            } else {
                ladder.missing(blocks.len() as u64);
            }
        }
    }
    ladder
}

#[cfg(test)]
mod tests {
    use super::*;
    use imu_core::allan::AllanLadder;

    /// White noise of standard deviation 1 and steps of `walk` at 10 Hz (sums of twelve uniforms),
    /// to which `drift` adds what it gives for the time.
    fn record(seconds: usize, walk: f64, drift: impl Fn(f64) -> f64) -> Drift {
        let mut state = 0x1234_5678_9abc_def1_u64;
        let mut normal = move || {
            let mut sum = -6.0;
            for _ in 0..12 {
                state ^= state >> 12;
                state ^= state << 25;
                state ^= state >> 27;
                sum +=
                    (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64;
            }
            sum
        };
        let mut bias = [0.0; 3];
        let values: Vec<[f64; 3]> = (0..10 * seconds)
            .map(|k| {
                bias = bias.map(|b| b + walk * normal());
                let drift = drift(k as f64 / 10.0);
                bias.map(|b| b + drift + normal())
            })
            .collect();
        let mut means = BlockMeans::new();
        let mut ladder = AllanLadder::<f64, 3, LEVELS, 4>::new();
        means.extend(&values);
        ladder.extend(&values);
        examine(&means, [0, 1, 2].map(|axis| ladder.octaves(axis)), 0.1, 0)
    }

    #[test]
    fn noise_neither_warms_up_nor_drifts() {
        for walk in [0.0, 0.003, 0.03] {
            let drift = record(7000, walk, |_| 0.0);
            assert!(drift.warm_up == 0 && drift.slope.is_none(), "{walk}: {drift:?}");
        }
    }

    /// Ten minutes of warm-up: at least those are left out, at most the quarter of the record that
    /// is the next octave but one.
    #[test]
    fn a_warm_up_is_left_out() {
        for walk in [0.0, 0.003] {
            let drift = record(7000, walk, |t| 5.0 * (t / 600.0).min(1.0));
            assert!((6000..=18_000).contains(&drift.warm_up), "{walk}: {}", drift.warm_up);
            assert!(drift.slope.is_none());
        }
    }

    #[test]
    fn a_ramp_is_found_and_k_read_past_it() {
        // K = walk·√10 Hz; three axes together scatter by some 10 %: five of those.
        let walk = 0.01;
        let drift = record(7000, walk, |t| 5e-3 * t);
        for slope in drift.slope.expect("a ramp") {
            // The walk goes 0.03·√4700 = 2 between the quarters (five of which are 10), the ramp 26.
            assert!((slope / 5e-3 - 1.0).abs() < 0.4, "{slope}");
        }
        let (octaves, sampling) = drift.hadamard.pooled();
        let fit = fit_noise_from(&octaves, sampling, drift.hadamard.from);
        let Parameter::Observable { value, .. } = fit.random_walk else { panic!() };
        let k = walk * 10_f64.sqrt();
        assert!((value / k - 1.0).abs() < 0.5, "{value} {k}");
    }
}
