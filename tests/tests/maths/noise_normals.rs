//! The law of the normal numbers, against statrs' functions and rand_distr's numbers.
//!
//! Seeds are fixed. Every bound is one that a correct generator breaks with a chance below 1e-7: a
//! quantile of the exact law where there is one, 5.5 standard deviations elsewhere, and for
//! empirical distributions Massart's form of the Dvoretzky-Kiefer-Wolfowitz inequality,
//! P(sup|F_n − F| > ε) ≤ 2 exp(−2nε²).

use imu_core::noise::{
    Axis, Channel, Normal, Sensor, Stage, Term, TermId, White, Xoshiro256PlusPlus,
};
use rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal as Law};

/// Chance that a correct generator fails one check.
const CHANCE: f64 = 1e-7;

fn numbers<T: Normal>(seed: u64, n: usize) -> impl Iterator<Item = f64> {
    let mut rng = T::Generator::seed_from_u64(seed);
    (0..n).map(move |_| T::standard_normal(&mut rng).to_f64())
}

fn standard() -> Law {
    Law::standard()
}

/// sup|F_n − F| of an empirical law.
fn distance(mut values: Vec<f64>, cdf: impl Fn(f64) -> f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len() as f64;
    values.iter().enumerate().fold(0.0, |worst: f64, (i, &x)| {
        let f = cdf(x);
        worst.max((f - i as f64 / n).abs()).max((f - (i + 1) as f64 / n).abs())
    })
}

/// The ε of Massart's inequality for `n` values.
fn massart(n: usize) -> f64 {
    ((2.0 / CHANCE).ln() / (2.0 * n as f64)).sqrt()
}

fn moments<T: Normal>() {
    let n = 10_000_000;
    let mut sums = [0.0; 6];
    for x in numbers::<T>(1, n) {
        let mut power = 1.0;
        for sum in &mut sums {
            power *= x;
            *sum += power;
        }
    }
    // E xᵏ is 0, 1, 0, 3, 0, 15; var xᵏ = E x²ᵏ − (E xᵏ)².
    let expected = [0.0, 1.0, 0.0, 3.0, 0.0, 15.0];
    let variance: [f64; 6] = [1.0, 2.0, 15.0, 96.0, 945.0, 10_170.0];
    for (k, sum) in sums.into_iter().enumerate() {
        let sd = (variance[k] / n as f64).sqrt();
        let mean = sum / n as f64;
        assert!((mean - expected[k]).abs() < 5.5 * sd, "moment {}: {mean}", k + 1);
    }
}

/// Counts in bins of equal probability: a ziggurat with a wrong wedge or edge bends them.
fn bins<T: Normal>() {
    const BINS: usize = 4096;
    let n = 16_000_000;
    let law = standard();
    let mut counts = [0_u32; BINS];
    for x in numbers::<T>(2, n) {
        counts[((law.cdf(x) * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let expected = n as f64 / BINS as f64;
    let statistic: f64 =
        counts.iter().map(|&count| (f64::from(count) - expected).powi(2) / expected).sum();
    let law = ChiSquared::new((BINS - 1) as f64).expect("valid");
    let (low, high) = (law.inverse_cdf(CHANCE / 2.0), law.inverse_cdf(1.0 - CHANCE / 2.0));
    assert!((low..high).contains(&statistic), "{low} {statistic} {high}");
}

fn whole_law<T: Normal>() {
    let n = 4_000_000;
    let law = standard();
    let found = distance(numbers::<T>(3, n).collect(), |x| law.cdf(x));
    assert!(found < massart(n), "{found}");
}

/// Beyond the last layer another algorithm takes over: its numbers, of both signs, have the
/// normal's conditional law, and are as many as they should be.
fn tail<T: Normal>(r: f64) {
    let n = 30_000_000;
    let law = standard();
    let beyond: Vec<f64> = numbers::<T>(4, n).filter(|x| x.abs() > r).collect();
    let chance = 2.0 * law.sf(r);
    let expected = chance * n as f64;
    let count = beyond.len() as f64;
    assert!((count - expected).abs() < 5.5 * expected.sqrt(), "{count} of {expected}");
    let positive = beyond.iter().filter(|x| **x > 0.0).count() as f64;
    assert!((positive - count / 2.0).abs() < 5.5 * (count / 4.0).sqrt(), "{positive} of {count}");
    assert!(beyond.iter().any(|x| x.abs() > 5.0), "P(none) = exp(-17)");
    let n = beyond.len();
    let sizes = beyond.into_iter().map(f64::abs).collect();
    let found = distance(sizes, |x| 1.0 - 2.0 * law.sf(x) / chance);
    assert!(found < massart(n), "{found}");
}

#[test]
fn f32_moments() {
    moments::<f32>();
}

#[test]
fn f64_moments() {
    moments::<f64>();
}

#[test]
fn f32_bins() {
    bins::<f32>();
}

#[test]
fn f64_bins() {
    bins::<f64>();
}

#[test]
fn f32_whole_law() {
    whole_law::<f32>();
}

#[test]
fn f64_whole_law() {
    whole_law::<f64>();
}

#[test]
fn f32_tail() {
    tail::<f32>(3.442_62);
}

#[test]
fn f64_tail() {
    tail::<f64>(3.654_153);
}

/// Two samples of n: by the triangle inequality their distance is below twice Massart's bound.
#[test]
fn the_law_is_that_of_rand_distr() {
    let n = 2_000_000;
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut theirs: Vec<f64> = (0..n).map(|_| StandardNormal.sample(&mut rng)).collect();
    theirs.sort_by(f64::total_cmp);
    let cdf = |x: f64| theirs.partition_point(|&y| y <= x) as f64 / n as f64;
    let found = distance(numbers::<f64>(6, n).collect(), cdf);
    assert!(found < 2.0 * massart(n) + 1.0 / n as f64, "{found}");
}

/// Σxy/√n is standard normal to first order for independent streams: 5.5, with two decimals more
/// for the 300 pairs looked at.
#[test]
fn streams_and_neighbours_in_a_stream_are_uncorrelated() {
    let n = 400_000;
    let mut streams = Vec::new();
    for seed in [0, 1] {
        for sensor in [Sensor::GYROSCOPE, Sensor::ACCELEROMETER] {
            for axis in Axis::ALL {
                for term in [TermId::WHITE, TermId::RANDOM_WALK] {
                    let channel = Channel::new(seed, sensor, axis);
                    let mut rng: Xoshiro256PlusPlus = channel.stream(term);
                    let stream: Vec<f64> = (0..n).map(|_| f64::standard_normal(&mut rng)).collect();
                    streams.push(stream);
                }
            }
        }
    }
    let correlation = |a: &[f64], b: &[f64]| {
        a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() / (a.len().min(b.len()) as f64).sqrt()
    };
    for (i, a) in streams.iter().enumerate() {
        for lag in [1, 2, 3] {
            let found = correlation(a, &a[lag..]);
            assert!(found.abs() < 6.3, "stream {i}, lag {lag}: {found}");
        }
        for (j, b) in streams.iter().enumerate().skip(i + 1) {
            let found = correlation(a, b);
            assert!(found.abs() < 6.3, "streams {i} and {j}: {found}");
        }
    }
}

/// The white stage is the truth plus N/√dt times its stream's numbers.
#[test]
fn a_white_stage_scales_its_stream() {
    let channel = Channel::new(7, Sensor::ACCELEROMETER, Axis::Z);
    let mut stage = White { noise_density: 0.019 }.prepare(0.005, channel).expect("valid");
    let mut rng: Xoshiro256PlusPlus = channel.stream(TermId::WHITE);
    let sd = 0.019 / 0.005_f64.sqrt();
    for _ in 0..1000 {
        assert_eq!(stage.step(9.81), 9.81 + sd * f64::standard_normal(&mut rng));
    }
}
