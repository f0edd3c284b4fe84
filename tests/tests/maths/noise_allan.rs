//! The whole chain's Allan variance is the one its parameters promise: N²/τ + (K²τ/3)(1 + 1/(2m²))
//! (IEEE Std 952; the last factor for a random walk that is sampled and not averaged).
//!
//! Looked at over disjoint *pairs* of blocks of m samples: their differences are independent and
//! normal, so M·(estimate)/(truth) follows χ² with M degrees of freedom exactly, and the bounds are
//! its quantiles at 1e-8 over all 2 × 6 × 21 checks.

use imu_core::noise::{Normal, RandomWalk, Sensor, Stage, ThreeAxis, White};
use statrs::distribution::{ChiSquared, ContinuousCDF};

const LEVELS: usize = 21;

/// Half the mean square of the differences within pairs of blocks of 2^level samples, and their
/// number M.
fn pairs(values: &[f64]) -> Vec<(f64, f64)> {
    let mut sums = values.to_vec();
    (0..LEVELS)
        .map(|level| {
            let m = f64::from(1 << level);
            let mut square = 0.0;
            let halved: Vec<f64> = sums
                .as_chunks()
                .0
                .iter()
                .map(|[a, b]| {
                    square += ((b - a) / m).powi(2);
                    a + b
                })
                .collect();
            let count = halved.len() as f64;
            sums = halved;
            (square / (2.0 * count), count)
        })
        .collect()
}

fn chain<T: Normal>(sensor: Sensor, truth: [f64; 3]) {
    // N = K√(200 s) or so: the octaves go from nearly all white to nearly all walk.
    let (n, k, dt): (f64, f64, f64) = (0.019, 2e-3, 0.005);
    let terms =
        (White { noise_density: T::from_f64(n) }, RandomWalk { random_walk: T::from_f64(k) });
    let mut stages =
        ThreeAxis::prepare([terms; 3], T::from_f64(dt), 11, sensor).expect("valid parameters");
    let true_value = truth.map(T::from_f64);
    let mut axes = [const { Vec::new() }; 3];
    for _ in 0..1 << LEVELS {
        let measured = stages.step(true_value);
        for (axis, x) in axes.iter_mut().zip(measured) {
            axis.push(x.to_f64());
        }
    }
    for axis in axes {
        for (level, (variance, count)) in pairs(&axis).into_iter().enumerate() {
            let m = f64::from(1 << level);
            let tau = m * dt;
            let expected = n * n / tau + k * k * tau / 3.0 * (1.0 + 0.5 / (m * m));
            let law = ChiSquared::new(count).expect("M > 0");
            let chance = 1e-8 / (2.0 * 6.0 * LEVELS as f64);
            let low = law.inverse_cdf(chance / 2.0) / count;
            let high = law.inverse_cdf(1.0 - chance / 2.0) / count;
            let ratio = variance / expected;
            assert!((low..high).contains(&ratio), "m = {m}: {low} {ratio} {high}");
        }
    }
}

#[test]
fn double_precision() {
    chain::<f64>(Sensor::GYROSCOPE, [0.0; 3]);
}

/// Under gravity, where a sample is rounded to 5e-7: a variance of 1e-13 beside N²/dt = 0.07.
#[test]
fn single_precision() {
    chain::<f32>(Sensor::ACCELEROMETER, [0.0, 0.0, 9.81]);
}
