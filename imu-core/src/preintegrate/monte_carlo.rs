//! The covariance against what simulated noise does.

use super::tests::{Matrix9, dense, densities, error, felt, sample, step_200_hz};
use super::*;
use crate::delta::Delta;
use crate::integrate::{Midpoint, Rule, ThreeSample};
use crate::noise::{Sensor, Stage, ThreeAxis, White};
use crate::sample::{Bias, Sample};

const RUNS: u32 = 2000;

/// L of a covariance L Lᵀ (Cholesky).
fn factor(covariance: &Matrix9) -> Matrix9 {
    let mut lower = Matrix9::zeros();
    for column in 0..9 {
        for row in column..9 {
            let known: f64 = (0..column).map(|k| lower[(row, k)] * lower[(column, k)]).sum();
            let rest = covariance[(row, column)] - known;
            lower[(row, column)] =
                if row == column { rest.sqrt() } else { rest / lower[(column, column)] };
        }
    }
    lower
}

/// L⁻¹e: nine independent normal numbers, if L is right.
fn whitened(lower: &Matrix9, error: &[f64]) -> [f64; 9] {
    let mut white = [0.0; 9];
    for row in 0..9 {
        let known: f64 = (0..row).map(|k| lower[(row, k)] * white[k]).sum();
        white[row] = (error[row] - known) / lower[(row, row)];
    }
    white
}

/// Mean products of the whitened errors of many runs of `n` steps, whose densities are believed to be `belief` times
/// the true ones: 1 if all is right. White noise on every sample, of standard deviation N/√dt.
fn products<R: Rule<f64, Input = Sample<f64>>>(
    start: impl Fn(&Sample<f64>) -> R,
    n: u32,
    belief: f64,
) -> Matrix9 {
    let (dt, noise) = (step_200_hz(), densities::<f64>());
    let believed = NoiseDensities {
        gyro_noise_density: noise.gyro_noise_density * belief,
        accel_noise_density: noise.accel_noise_density * belief,
        ..noise
    };
    let mut mean = Mean::new(start(&sample(0)), Bias::default());
    (1..=n).for_each(|k| mean.step(&sample(k), &dt));
    let truth: Delta<f64> = mean.delta();
    let mut sum = Matrix9::zeros();
    for seed in 0..RUNS {
        let white = |noise_density, sensor| {
            ThreeAxis::prepare([(White { noise_density },); 3], 0.005, seed.into(), sensor).unwrap()
        };
        let mut gyroscope = white(noise.gyro_noise_density, Sensor::GYROSCOPE);
        let mut accelerometer = white(noise.accel_noise_density, Sensor::ACCELEROMETER);
        let mut noisy = |k| {
            let (rate, force) = felt(k);
            Sample::new(gyroscope.step(rate.into()).into(), accelerometer.step(force.into()).into())
                .unwrap()
        };
        let mut run = WithCovariance::new(start(&noisy(0)), Bias::default(), &believed).unwrap();
        (1..=n).for_each(|k| run.step(&noisy(k), &dt));
        let errors = error(&truth, &run.delta());
        let errors = [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|i: usize| errors[i / 3][i % 3]);
        let white = whitened(&factor(&dense(&run.covariance())), &errors);
        let white = nalgebra::SVector::<f64, 9>::from(white);
        sum += white * white.transpose();
    }
    sum / f64::from(RUNS)
}

/// The mean NEES is χ² of 9·2000 degrees of freedom over 2000, of sd √(18/2000) = 0.095: within 5 of them a correct
/// program is wrong once in 1.7 million. Each product has sd √(2/2000) = 0.032 on the diagonal, 0.022 beside it: 45
/// of them are all within 5.7 once in 1.9 million. To both the end samples of one interval add a part in 2n.
fn is_right(products: &Matrix9, n: u32) -> bool {
    let ends = 0.5 / f64::from(n);
    let nees = products.trace();
    (nees - 9.0).abs() < 5.0 * 0.095 + 9.0 * ends
        && (0..81).all(|i| {
            let (row, column) = (i / 9, i % 9);
            let (expected, sd) = if row == column { (1.0, 0.032) } else { (0.0, 0.022) };
            (products[(row, column)] - expected).abs() < 5.7 * sd + 2.0 * ends
        })
}

#[test]
fn errors_scatter_as_the_covariance_says() {
    for n in [100, 200] {
        let products = products(Midpoint::new, n, 1.0);
        assert!(is_right(&products, n), "{products:.3}");
    }
    let products = products(ThreeSample::new, 100, 1.0);
    assert!(is_right(&products, 100), "{products:.3}");
}

/// The trap: independent noise on both ends of every step, averaged, is ½N²dt a step, as if N were smaller by √2.
#[test]
fn the_test_above_notices_a_halved_variance() {
    let products = products(Midpoint::new, 100, 0.5_f64.sqrt());
    assert!(!is_right(&products, 100));
    assert!((products.trace() - 18.0).abs() < 1.1, "{products:.3}");
}
