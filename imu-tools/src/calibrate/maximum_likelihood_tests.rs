use super::*;
use imu_core::noise::{RandomWalk, Sensor, Stage, ThreeAxis, White};

/// A record of white noise and random walk, three axes alike.
fn record(n: usize, tau0_s: f64, [white, walk]: [f64; 2], seed: u64) -> Vec<[f64; 3]> {
    let terms = (White { noise_density: white }, RandomWalk { random_walk: walk });
    let mut sensor =
        ThreeAxis::prepare([terms; 3], tau0_s, seed, Sensor::GYROSCOPE).expect("a valid scene");
    let mut samples = vec![[0.0; 3]; n];
    sensor.apply(&mut samples);
    samples
}

fn collect(samples: &[[f64; 3]]) -> BlockMeans {
    let mut means = BlockMeans::new();
    means.extend(samples);
    means
}

/// −2 ln likelihood at the best N, from the eigenvalues of the covariance of the differences of
/// block means: c0 + 2 c1 cos(πk/(n+1)), eigenvectors of the sine transform (by the definition).
fn by_sine_transform(means: &BlockMeans, axis: usize, walk: f64) -> f64 {
    let m = means.length() as f64;
    let values: Vec<f64> = means.segments()[0].iter().map(|b| b.sum[axis] / m).collect();
    let differences: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).collect();
    let n = differences.len() as f64;
    let c0 = walk * (2.0 * m * m + 1.0) / (3.0 * m) + 2.0 / m;
    let c1 = walk * (m * m - 1.0) / (6.0 * m) - 1.0 / m;
    let (mut squares, mut logs) = (0.0, 0.0);
    for k in 1..=differences.len() {
        let angle = std::f64::consts::PI * k as f64 / (n + 1.0);
        let sum: f64 =
            differences.iter().enumerate().map(|(j, d)| d * (angle * (j + 1) as f64).sin()).sum();
        let eigenvalue = c0 + 2.0 * c1 * angle.cos();
        squares += 2.0 / (n + 1.0) * sum * sum / eigenvalue;
        logs += eigenvalue.ln();
    }
    n * (squares / n).ln() + n + logs
}

#[test]
fn the_filter_is_the_exact_likelihood_of_the_differences() {
    let tau0_s = 0.02;
    let means = collect(&record(1200, tau0_s, [0.01, 0.02], 5)).merged(8);
    for x in [-6.0, -2.0, 0.0, 1.0, 3.0] {
        let walk = (f64::exp(x) * tau0_s).powi(2);
        let each = [0, 1, 2].map(|axis| by_sine_transform(&means, axis, walk));
        for (axis, expected) in each.iter().enumerate() {
            let axes = [axis];
            let likelihood = Likelihood::new(&means, tau0_s, &axes).expect("noise");
            // Sums of 150 terms of order 10: rounding below 150·10·2⁻⁵² ≈ 3e-13 an operation.
            let found = likelihood.at(x).minimum;
            assert!((found - expected).abs() < 1e-8, "axis {axis}, {x}: {found} {expected}");
        }
    }
}

/// −2 ln likelihood at the best N from the dense covariance of the means of the blocks that are
/// there, differenced, by Cholesky's factorisation.
fn by_covariance(means: &BlockMeans, axis: usize, walk: f64) -> f64 {
    let m = means.length() as f64;
    let there: Vec<(f64, f64, f64)> = means.segments()[0]
        .iter()
        .enumerate()
        .filter(|(_, b)| b.samples > 0)
        .map(|(i, b)| (i as f64, 1.0 / b.samples as f64, b.sum[axis] / b.samples as f64))
        .collect();
    let covariance = |a: &(f64, f64, f64), b: &(f64, f64, f64)| {
        let begins = a.0.min(b.0) * m * walk; // variance of the bias where the earlier one begins
        if a.0 == b.0 {
            begins + walk * (m - 1.0) * (2.0 * m - 1.0) / (6.0 * m) + a.1
        } else {
            begins + walk * (m - 1.0) / 2.0
        }
    };
    let n = there.len() - 1;
    let mut factor = vec![vec![0.0; n]; n];
    let (mut squares, mut logs) = (0.0, 0.0);
    let mut solved = vec![0.0; n];
    for i in 0..n {
        for j in 0..=i {
            let (a, b) = (&there[i..=i + 1], &there[j..=j + 1]);
            let c = covariance(&a[1], &b[1]) - covariance(&a[1], &b[0]) - covariance(&a[0], &b[1])
                + covariance(&a[0], &b[0]);
            let dot: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            factor[i][j] = if i == j { (c - dot).sqrt() } else { (c - dot) / factor[j][j] };
        }
        let dot: f64 = (0..i).map(|k| factor[i][k] * solved[k]).sum();
        solved[i] = (there[i + 1].2 - there[i].2 - dot) / factor[i][i];
        squares += solved[i] * solved[i];
        logs += 2.0 * factor[i][i].ln();
    }
    let n = n as f64;
    n * (squares / n).ln() + n + logs
}

#[test]
fn holes_and_losses_are_in_the_likelihood() {
    let tau0_s = 0.02;
    let samples = record(1200, tau0_s, [0.01, 0.02], 6);
    let mut means = BlockMeans::new();
    for (k, sample) in samples.iter().enumerate() {
        if k % 7 == 3 || (500..690).contains(&k) {
            means.missing(1);
        } else {
            means.extend(&[*sample]);
        }
    }
    let means = means.merged(8);
    for x in [-4.0, 0.0, 2.0] {
        let walk = (f64::exp(x) * tau0_s).powi(2);
        let expected = by_covariance(&means, 1, walk);
        let found = Likelihood::new(&means, tau0_s, &[1]).expect("noise").at(x).minimum;
        assert!((found - expected).abs() < 1e-8, "{x}: {found} {expected}");
    }
}

#[test]
fn segments_add() {
    let samples = record(4000, 0.5, [0.01, 1e-3], 9);
    let mut means = collect(&samples[..1500]);
    means.restart();
    means.extend(&samples[1500..]);
    let (first, second) = (collect(&samples[..1500]), collect(&samples[1500..]));
    for walk in [1e-6, 1e-3] {
        let whole = innovations(&means, walk);
        let parts = [innovations(&first, walk), innovations(&second, walk)];
        assert_eq!(whole.count, parts[0].count + parts[1].count);
        let logs = parts[0].log_variances + parts[1].log_variances;
        assert!((whole.log_variances - logs).abs() < 1e-8);
        let squares = parts[0].squares[2] + parts[1].squares[2];
        assert!((whole.squares[2] / squares - 1.0).abs() < 1e-9);
    }
}

/// The interval of a parameter is where the likelihood, maximised over the other one, falls to
/// `INTERVAL`: compared with a search over the plane.
#[test]
fn intervals_are_those_of_the_profile_likelihood() {
    let means = collect(&record(2000, 0.5, [0.015, 1e-3], 3));
    let likelihood = Likelihood::new(&means, 0.5, &[0]).expect("noise");
    let estimate = likelihood.estimate();
    let (Parameter::Observable { low90, high90, .. }, Parameter::Observable { value: n, .. }) =
        (estimate.random_walk, estimate.noise_density)
    else {
        panic!("both show");
    };
    // −2 ln likelihood at K, minimised over ln κ on a grid of 1e-3.
    let at_walk = |k: f64| {
        let centre = (k / n).ln();
        (-150..=150)
            .map(|i| likelihood.at(centre + 1e-3 * f64::from(i)))
            .map(|p| {
                let d = 2.0 * (k.ln() - p.x) - p.log_white;
                p.minimum + likelihood.count * ((-d).exp_m1() + d)
            })
            .fold(f64::INFINITY, f64::min)
    };
    let best = likelihood.search(-8.0, 0.0, |p| -p.minimum).minimum;
    for end in [low90, high90] {
        // The grid misses the minimum by at most ½·2000·(2·5e-4)² = 1e-3; the interval's own search
        // ends within 1e-3 of its half-width, 2·1e-3·2.7 in the likelihood.
        let deviance = at_walk(end) - best;
        assert!((deviance - INTERVAL).abs() < 0.02, "{end}: {deviance}");
    }
}

#[test]
fn statistics_over_four_hours() {
    // Only K·T/N matters: 4 h at 2 Hz instead of 200, white noise per second alike.
    for (white, walk, seeds) in [(0.015, 5e-5, 0..8), (0.019, 5e-4, 100..108)] {
        let duration_s = 4.0 * 3600.0;
        let limit = f64::sqrt(2.0 * white / (walk * duration_s));
        let (mut logs, mut held, mut pooled) = (Vec::new(), 0, Vec::new());
        for seed in seeds {
            let means = collect(&record(28_800, 0.5, [white, walk], seed));
            let fit = fit(&means, 0.5, 0.0);
            for estimate in fit.axes {
                let Parameter::Observable { value, low90, high90, .. } = estimate.random_walk
                else {
                    panic!("seed {seed}: {:?}", estimate.random_walk);
                };
                logs.push((value / walk).ln());
                held += usize::from(low90 < walk && walk < high90);
                let Parameter::Observable { value, .. } = estimate.noise_density else {
                    panic!("seed {seed}: {:?}", estimate.noise_density);
                };
                // sd(ln N) = 1/√(2·28 800) = 0.42 %, a little more for K's sake: 6 of 0.5 %.
                assert!((value / white - 1.0).abs() < 0.03, "seed {seed}: N {value}");
            }
            let Parameter::Observable { value, .. } = fit.pooled.random_walk else {
                panic!("seed {seed}: {:?}", fit.pooled.random_walk);
            };
            pooled.push((value / walk).ln());
        }
        let rms =
            |logs: &[f64]| (logs.iter().map(|x| x * x).sum::<f64>() / logs.len() as f64).sqrt();
        // ln K̂ scatters by 1.0-1.1 of the limit; rms over 24: χ²₂₄ is in 24·(0.17…2.95) with
        // probability 1 − 1e-6, over 8 below 8·5.3; so (0.40…1.1·1.72), and below 1.1·2.3.
        let ratio = rms(&logs) / limit;
        assert!((0.4..1.9).contains(&ratio), "N/K = {} s: {ratio} of the limit", white / walk);
        let ratio = rms(&pooled) / (limit / 3_f64.sqrt());
        assert!(ratio < 2.6, "N/K = {} s: pooled {ratio} of the limit", white / walk);
        // Binomial, 24 of 0.88: below 12 with probability 5e-7.
        assert!(held >= 12, "N/K = {} s: {held} of 24 intervals hold K", white / walk);
    }
}

#[test]
fn what_a_record_does_not_show_is_said() {
    let nothing = Parameter::NotObservable { upper90: f64::INFINITY, record_at_least_s: 0.0 };
    for samples in [0, 1, 3, 14, 200] {
        let fit = fit(&collect(&record(samples, 0.005, [0.01, 1e-4], 1)), 0.005, 0.0);
        assert_eq!(fit.pooled.random_walk, nothing, "{samples} samples");
    }
    let constant = fit(&collect(&[[1.0, 2.0, 3.0]; 5000]), 0.005, 0.0);
    assert_eq!(constant.pooled, NOTHING);

    // White noise alone, 1000 s: K stays below √(2N/(K T)) ≈ 1, a longer record is wanted.
    let white = fit(&collect(&record(2000, 0.5, [0.01, 0.0], 4)), 0.5, 0.0);
    let Parameter::NotObservable { upper90, record_at_least_s } = white.pooled.random_walk else {
        panic!("{:?}", white.pooled.random_walk);
    };
    assert!((1e-7..2e-4).contains(&upper90), "{upper90}");
    assert!((2000.0..1e7).contains(&record_at_least_s), "{record_at_least_s}");
    assert!(matches!(white.pooled.noise_density, Parameter::Observable { .. }));

    // A walk alone: N stays below what half a second of the walk would hide, N ≪ K·0.5 s.
    let walk = fit(&collect(&record(20_000, 0.05, [0.0, 1e-2], 4)), 0.05, 0.0);
    let Parameter::NotObservable { upper90, .. } = walk.pooled.noise_density else {
        panic!("{:?}", walk.pooled.noise_density);
    };
    assert!(upper90 < 1e-2 * 0.5, "{upper90}");
    let Parameter::Observable { value, .. } = walk.pooled.random_walk else {
        panic!("{:?}", walk.pooled.random_walk);
    };
    // 3·1562 differences: sd 1/√(2·4686) = 1.0 %.
    assert!((value / 1e-2 - 1.0).abs() < 0.06, "{value}");
}

#[test]
fn a_low_pass_filter_does_not_ruin_it() {
    // One pole at 20 Hz before sampling at 200 Hz, an hour, N/K = 38 s. Half a second of filtered
    // noise has 1 − 0.9·(8 ms/0.5 s) ≈ 98.5 % of its variance.
    let (white, walk, dt) = (0.019, 5e-4, 1.0 / 200.0);
    let pole = 1.0 - (-std::f64::consts::TAU * 20.0 * dt).exp();
    let mut state = [0.0; 3];
    let filtered: Vec<[f64; 3]> = record(720_000, dt, [white, walk], 21)
        .iter()
        .map(|sample| {
            for (state, x) in state.iter_mut().zip(sample) {
                *state += pole * (x - *state);
            }
            state
        })
        .collect();
    let fit = fit(&collect(&filtered), dt, 1.0);
    assert!(fit.block_s >= 1.0);
    let (Parameter::Observable { value: n, .. }, Parameter::Observable { value: k, .. }) =
        (fit.pooled.noise_density, fit.pooled.random_walk)
    else {
        panic!("{:?}", fit.pooled);
    };
    // sd(ln N) = 1/√(2·3·2800) = 0.8 %, and 1 % from the filter; sd(ln K) = 14.5 %/√3 = 8.4 %.
    assert!((n / white - 1.0).abs() < 0.05, "{n}");
    assert!((k / walk).ln().abs() < 0.5, "{k}");
}
