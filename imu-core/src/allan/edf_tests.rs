extern crate std;
use super::*;
use std::vec;
use std::vec::Vec;

const WHITE: Mixture = Mixture { white: 1.0, flicker: 0.0, random_walk: 0.0 };
const FLICKER: Mixture = Mixture { white: 0.0, flicker: 1.0, random_walk: 0.0 };
const WALK: Mixture = Mixture { white: 0.0, flicker: 0.0, random_walk: 1.0 };
const BIG: u64 = 1 << 20;

/// One block difference as weights on the samples of a record of length `n`.
fn difference_weights(kind: Difference, m: usize, start: usize, n: usize) -> Vec<f64> {
    let signs: &[f64] = match kind {
        Difference::Allan => &[-1.0, 1.0],
        Difference::Hadamard => &[1.0, -2.0, 1.0],
    };
    let mut weights = vec![0.0; n];
    for (i, weight) in weights.iter_mut().skip(start).take(signs.len() * m).enumerate() {
        *weight = signs[i / m];
    }
    weights
}

/// The same on the increments of a random walk: weights summed from the end.
fn on_increments(mut weights: Vec<f64>) -> Vec<f64> {
    let mut sum = 0.0;
    for weight in weights.iter_mut().rev() {
        sum += *weight;
        *weight = sum;
    }
    weights
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// (tr C)²/tr C², C the covariance of the differences, from the weights of independent deviates.
fn edf_by_brute_force(kind: Difference, m: usize, s: usize, count: usize, mix: Mixture) -> f64 {
    let n = (count - 1) * s + kind.blocks() as usize * m;
    let rows: Vec<_> = (0..count)
        .map(|k| {
            let white = difference_weights(kind, m, k * s, n);
            let walk = on_increments(white.clone());
            (white, walk)
        })
        .collect();
    let norms = (dot(&rows[0].0, &rows[0].0), dot(&rows[0].1, &rows[0].1));
    let mut squares = 0.0;
    for a in &rows {
        for b in &rows {
            let c =
                mix.white * dot(&a.0, &b.0) / norms.0 + mix.random_walk * dot(&a.1, &b.1) / norms.1;
            squares += c * c;
        }
    }
    let trace = count as f64 * (mix.white + mix.random_walk);
    trace * trace / squares
}

#[test]
fn white_noise_and_sampled_random_walk_equal_brute_force_covariances() {
    for kind in [Difference::Allan, Difference::Hadamard] {
        for mix in [WHITE, WALK, Mixture { white: 3.0, flicker: 0.0, random_walk: 1.3 }] {
            for m in [1_usize, 2, 3, 8] {
                for s in [1, (m / 4).max(1), m] {
                    for count in [1_usize, 2, 5, 40] {
                        let want = edf_by_brute_force(kind, m, s, count, mix);
                        let got = edf(kind, m as u64, s as u64, count as u64, mix);
                        // Sums of 40² products: rounding only.
                        assert!(
                            (got / want - 1.0).abs() < 1e-11,
                            "{kind:?} {mix:?} m={m} s={s} M={count}: {got}, not {want}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn closed_forms_of_disjoint_blocks() {
    for count in [1_u64, 2, 3, 10, 1000] {
        let m = count as f64;
        let white = edf(Difference::Allan, BIG, BIG, count, WHITE);
        assert!((white / (2.0 * m * m / (3.0 * m - 1.0)) - 1.0).abs() < 1e-12);
        // In the limit of large m, which 1/m² = 1e-12 has reached.
        let walk = edf(Difference::Allan, BIG, BIG, count, WALK);
        assert!((walk / (8.0 * m * m / (9.0 * m - 1.0)) - 1.0).abs() < 1e-11);
    }
}

#[test]
fn factors_of_long_records() {
    // Overlapped, times M/m, in the limit of large M and m; known to 3-4 digits.
    let count = 1 << 50;
    let long = |kind, mix| edf(kind, BIG, 1, count, mix) * BIG as f64 / count as f64;
    let table = [
        (Difference::Allan, WHITE, 1.5),
        (Difference::Allan, FLICKER, 1.169),
        (Difference::Allan, WALK, 0.927),
        (Difference::Hadamard, WHITE, 1.286),
        (Difference::Hadamard, FLICKER, 1.003),
        (Difference::Hadamard, WALK, 0.968),
    ];
    for (kind, mix, factor) in table {
        let got = long(kind, mix);
        // Half of the last digit printed, and the documented cut of the flicker's sum.
        assert!((got - factor).abs() < 5e-4 + 2e-4 * mix.flicker, "{kind:?} {mix:?}: {got}");
    }
    let disjoint = edf(Difference::Allan, BIG, BIG, count, FLICKER) / count as f64;
    assert!((1.0 / disjoint - 1.135).abs() < 5e-4, "{disjoint}");
    for (mix, ratio) in [(WHITE, 0.93), (WALK, 1.0)] {
        let quarter = edf(Difference::Allan, BIG, BIG / 4, count * 4 / BIG, mix);
        let got = quarter / edf(Difference::Allan, BIG, 1, count, mix);
        assert!((got - ratio).abs() < 5e-3, "{mix:?}: {got}");
    }
}

/// Flicker as a sum of Gauss-Markov processes with T_i = 0.2·√2ⁱ samples up to 10⁷: white in
/// ln T, so 1/f between. Covariances of the differences from those of the samples.
#[test]
fn flicker_equals_a_sum_of_gauss_markov_processes() {
    let m = 64_usize;
    let covariance: Vec<f64> = (0..16 * m)
        .map(|k| {
            let mut t = 0.2;
            let mut sum = 0.0;
            while t < 1e7 {
                sum += libm::exp(-(k as f64) / t);
                t *= core::f64::consts::SQRT_2;
            }
            sum
        })
        .collect();
    let block = |lag: i64| -> f64 {
        let m = m as i64;
        (1 - m..m)
            .map(|d| (m - d.abs()) as f64 * covariance[(lag + d).unsigned_abs() as usize])
            .sum()
    };
    let m_signed = m as i64;
    for (kind, weights) in [
        (Difference::Allan, &[-1.0, 2.0, -1.0][..]),
        (Difference::Hadamard, &[1.0, -4.0, 6.0, -4.0, 1.0][..]),
    ] {
        let half = (weights.len() / 2) as i64;
        let at = |lag: i64| -> f64 {
            (-half..).zip(weights).map(|(i, w)| w * block(lag + i * m_signed)).sum()
        };
        let zero = at(0);
        let squares: f64 = (1..12 * m_signed).map(|j| (at(j) / zero) * (at(j) / zero)).sum();
        let want = 1.0 / (1.0 + 2.0 * squares);
        let got = edf(kind, m as u64, 1, 1 << 40, FLICKER) / 2_f64.powi(40);
        // The band's ends change the variance by some 0.5 % (aliasing at T near one sample).
        assert!((got / want - 1.0).abs() < 0.01, "{kind:?}: {got}, not {want}");
    }
}

#[test]
fn a_mixture_lies_between_its_parts_and_coarse_grids_agree_with_fine_ones() {
    for kind in [Difference::Allan, Difference::Hadamard] {
        let at = |mix, m: u64| edf(kind, m, 1, 100 * m, mix);
        for mix in [WHITE, WALK, FLICKER] {
            // 511 samples a block are summed one by one, 512 and more on the coarser grid.
            for m in [512, 4096 + 513, 1 << 30] {
                let ratio = at(mix, m) / at(mix, 511);
                // 2/511²·(white's slope −3 at zero): documented 2e-5.
                assert!((ratio - 1.0).abs() < 2e-5, "{kind:?} {mix:?} {m}: {ratio}");
            }
        }
        let mixed = at(Mixture { white: 1.0, flicker: 0.5, random_walk: 1.0 }, 256);
        assert!(at(WALK, 256) < mixed && mixed < at(WHITE, 256));
    }
}

#[test]
fn degenerate_arguments_give_finite_answers() {
    let kind = Difference::Hadamard;
    assert_eq!(edf(kind, 4, 4, 0, WHITE), 0.0);
    assert_eq!(edf(kind, 4, 4, 1, WALK), 1.0);
    let nothing = [
        Mixture::default(),
        Mixture { white: f64::NAN, flicker: -1.0, random_walk: f64::INFINITY },
    ];
    for mixture in nothing {
        assert_eq!(edf(kind, 4, 4, 9, mixture), edf(kind, 4, 4, 9, WHITE));
    }
    assert_eq!(edf(kind, 0, 0, 9, WALK), edf(kind, 1, 1, 9, WALK));
    let huge = Mixture { white: f64::MAX, flicker: f64::MAX, random_walk: f64::MAX };
    let unit = Mixture { white: 1.0, flicker: 1.0, random_walk: 1.0 };
    assert_eq!(edf(kind, 8, 2, 9, huge), edf(kind, 8, 2, 9, unit));
    for (m, s, count) in [(u64::MAX, 1, u64::MAX), (1, u64::MAX, u64::MAX), (3, 1, u64::MAX)] {
        let value = edf(kind, m, s, count, unit);
        assert!((1.0..=count as f64).contains(&value));
    }
}

#[test]
fn intervals_contain_the_estimate_or_say_nothing() {
    let (low, high) = interval(2.0, 10.0, 0.9);
    // 20/18.307038 and 20/3.940299: any printed χ² table.
    assert!((low - 1.092_476_0).abs() < 1e-6 && (high - 5.075_756).abs() < 1e-5);
    assert_eq!(interval(0.0, 10.0, 0.9), (0.0, 0.0));
    let unknown = (0.0, f64::INFINITY);
    for (variance, edf, confidence) in [
        (f64::NAN, 5.0, 0.9),
        (-1.0, 5.0, 0.9),
        (f64::INFINITY, 5.0, 0.9),
        (1.0, 0.0, 0.9),
        (1.0, f64::NAN, 0.9),
        (1.0, 5.0, 1.0),
        (1.0, 5.0, f64::NAN),
    ] {
        assert_eq!(interval(variance, edf, confidence), unknown);
    }
}

/// Intervals from records of white noise and random walk, mixed evenly at m = 8, overlapped.
#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    let (m, count, records) = (8_usize, 60_usize, 3000);
    let mut state = 42_u64;
    let mut uniform = || {
        // SplitMix64 (Steele, Lea & Flood 2014).
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / 2_f64.powi(53)
    };
    // Box & Muller (1958).
    let mut normal = || {
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - uniform()));
        radius * libm::cos(core::f64::consts::TAU * uniform())
    };
    let mixture = Mixture { white: 1.0, flicker: 0.0, random_walk: 1.0 };
    let nu = edf(Difference::Allan, m as u64, 1, count as u64, mixture);
    // White of variance m, walk of step q: variances 1 and q m(1 + 1/2m²)/3 at m samples.
    let mf = m as f64;
    let step = libm::sqrt(3.0 / (mf * (1.0 + 0.5 / (mf * mf))));
    let (mut held, mut sum, mut squares) = (0, 0.0, 0.0);
    for _ in 0..records {
        let mut walk = 0.0;
        let values: Vec<f64> = (0..count + 2 * m - 1)
            .map(|_| {
                walk += step * normal();
                walk + libm::sqrt(mf) * normal()
            })
            .collect();
        let variance = (0..count)
            .map(|k| {
                let d = dot(&values, &difference_weights(Difference::Allan, m, k, values.len()));
                0.5 * d * d / (mf * mf)
            })
            .sum::<f64>()
            / count as f64;
        let (low, high) = interval(variance, nu, 0.9);
        held += u32::from(low < 2.0 && 2.0 < high);
        sum += variance;
        squares += variance * variance;
    }
    let n = f64::from(records);
    // 5 binomial standard deviations, 5·√(0.09/3000) = 0.027, and 0.01 for a law that is only
    // nearly χ².
    assert!((f64::from(held) / n - 0.9).abs() < 0.037, "held {held} of {records}");
    let mean = sum / n;
    // Relative sd of a variance estimate √(2/ν): 5 sd of the mean of the records.
    assert!((mean / 2.0 - 1.0).abs() < 5.0 * libm::sqrt(2.0 / (nu * n)), "mean {mean}");
    let scattered = 2.0 * mean * mean / (squares / n - mean * mean);
    // Relative sd √((2 + 12/ν)/n) for the scatter (kurtosis of χ²), doubled for the weights
    // that make the law's tail longer than χ²; 5 sd.
    let allowed = 5.0 * 2.0 * libm::sqrt((2.0 + 12.0 / nu) / n);
    assert!((scattered / nu - 1.0).abs() < allowed, "edf {nu}, scatter {scattered}");
}

/// The sums that the compiler works out, term by term: at most 11 terms, of some ten roundings of 1e-16 each,
/// and sums of up to ten times the result.
#[test]
fn what_the_compiler_sums_equals_the_sum() {
    for difference in [Difference::Allan, Difference::Hadamard] {
        for (block, per_block) in [(1, 1), (4, 1), (64, 2), (8, 4), (1 << 40, 4)] {
            for (white, random_walk) in [(1.0, 0.0), (0.0, 1.0), (0.7, 0.3), (1e-9, 5.0)] {
                let mixture = Mixture { white, flicker: 0.0, random_walk };
                let kernel = Kernel::new(difference, block as f64, mixture);
                let first = difference.blocks() * 4;
                assert!(kernel.sums(difference, block, block / per_block, first - 1).is_none());
                for count in [first, first + 1, 1000, 1 << 50] {
                    let stride = block / per_block;
                    let terms = (1..).map(|j| f64::from(j) / per_block as f64);
                    let sum: f64 = terms
                        .take_while(|x| *x < difference.blocks() as f64)
                        .map(|x| {
                            let r = kernel.at(x);
                            (1.0 - x * per_block as f64 / count as f64) * r * r
                        })
                        .sum();
                    let nu = edf(difference, block, stride, count, mixture);
                    let expected = (count as f64 / (1.0 + 2.0 * sum)).max(1.0);
                    assert!(kernel.sums(difference, block, stride, count).is_some());
                    assert!((nu / expected - 1.0).abs() < 1e-13, "{nu} {expected}");
                }
            }
        }
    }
}
