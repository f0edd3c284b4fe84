//! The five-term curve through the Allan variance, and its minimum: what imu_utils prints.
//!
//! For comparison in `imu demo`: the method of imu_utils (gaowenliang, its `fitallan_gyr.cpp` and
//! `fitallan_acc.cpp`). The model a₀/τ² + a₁/τ + a₂ + a₃τ + a₄τ² (Q, N, B, K, R of IEEE Std 952),
//! each term ≥ 0 as a square, is fitted to the logarithms of the variances, all with the same
//! weight, from a linear fit of the deviation as a start.
//!
//! The tool then throws the fitted K away. Its `gyr_n` is the fitted deviation at τ = 1 s, times
//! √rate: the discrete sd of a sample, N/√dt. Its `gyr_w` is the **minimum of the fitted deviation**,
//! with N and K alone √(2NK/√3), in the unit of the signal: a mark of bias instability that is often
//! copied into places where a random walk K belongs.

use imu_core::allan::Octave;

/// Damped steps at most; the tool's solver stops after 50.
const STEPS: usize = 200;
/// Powers of τ in the model.
const POWERS: [i32; 5] = [-2, -1, 0, 1, 2];

/// What imu_utils prints of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImuUtilsReading {
    /// `gyr_n` or `acc_n`: sd of a sample (N/√dt), in the unit of the signal.
    pub white_noise: f64,
    /// `gyr_w` or `acc_w`: minimum of the fitted deviation over the averaging times there were, in
    /// the unit of the signal.
    pub minimum: f64,
}

/// Reads the octaves of one axis, sampled every `tau0_s` seconds; `None` with fewer than five that
/// have a variance.
#[must_use]
pub fn imu_utils(octaves: &[Octave], tau0_s: f64) -> Option<ImuUtilsReading> {
    let curve: Vec<(f64, f64)> = octaves
        .iter()
        .filter(|o| o.differences > 0 && o.variance > 0.0)
        .map(|o| (o.samples as f64 * tau0_s, o.variance))
        .filter(|(tau, variance)| tau.is_finite() && *tau > 0.0 && variance.is_finite())
        .collect();
    let roots = fit(&curve)?;
    let deviation = |tau: f64| variance(&roots, tau).sqrt();
    let minimum = curve.iter().map(|(tau, _)| deviation(*tau)).min_by(f64::total_cmp)?;
    let white_noise = deviation(1.0) / tau0_s.sqrt();
    (white_noise.is_finite() && minimum.is_finite())
        .then_some(ImuUtilsReading { white_noise, minimum })
}

/// The model, of the square roots of the terms.
fn variance(roots: &[f64; 5], tau: f64) -> f64 {
    roots.iter().zip(POWERS).map(|(root, power)| root * root * tau.powi(power)).sum()
}

/// The square roots of the terms, by Levenberg's and Marquardt's method.
fn fit(curve: &[(f64, f64)]) -> Option<[f64; 5]> {
    // The start: deviation = Σ c τ^(power/2), with weights one.
    let mut normal = Normal::default();
    for (tau, variance) in curve {
        normal.add(POWERS.map(|power| tau.powf(0.5 * f64::from(power))), variance.sqrt());
    }
    if curve.len() < 5 {
        return None;
    }
    let mut roots = normal.solve(0.0)?.map(f64::abs);
    let cost = |roots: &[f64; 5]| -> f64 {
        curve.iter().map(|(tau, v)| (variance(roots, *tau) / v).ln().powi(2)).sum()
    };
    let (mut now, mut damping) = (cost(&roots), 1e-3);
    for _ in 0..STEPS {
        let mut normal = Normal::default();
        for (tau, measured) in curve {
            let model = variance(&roots, *tau);
            let mut slopes = [0.0; 5];
            for ((slope, root), power) in slopes.iter_mut().zip(roots).zip(POWERS) {
                *slope = 2.0 * root * tau.powi(power) / model;
            }
            normal.add(slopes, (measured / model).ln());
        }
        let Some(step) = normal.solve(damping) else { break };
        let mut next = roots;
        for (next, step) in next.iter_mut().zip(step) {
            *next += step;
        }
        let then = cost(&next);
        if then < now {
            let done = now - then < 1e-12 * now;
            (roots, now, damping) = (next, then, damping * 0.2);
            if done {
                break;
            }
        } else {
            damping *= 5.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    now.is_finite().then_some(roots)
}

/// Normal equations of five unknowns.
#[derive(Default)]
struct Normal {
    matrix: [[f64; 5]; 5],
    right: [f64; 5],
}

impl Normal {
    /// Adds an equation `row`·x = `value`.
    fn add(&mut self, row: [f64; 5], value: f64) {
        for i in 0..5 {
            for j in 0..5 {
                self.matrix[i][j] += row[i] * row[j];
            }
            self.right[i] += row[i] * value;
        }
    }

    /// The solution, by Cholesky's factorisation of the matrix scaled to a unit diagonal, to which
    /// `damping` is added. An unknown that is in no equation is 0.
    fn solve(&self, damping: f64) -> Option<[f64; 5]> {
        let mut scale = [1.0; 5];
        for (i, scale) in scale.iter_mut().enumerate() {
            if self.matrix[i][i] > 0.0 {
                *scale = 1.0 / self.matrix[i][i].sqrt();
            }
        }
        let mut factor = [[0.0; 5]; 5];
        let mut x = [0.0; 5];
        for i in 0..5 {
            for j in 0..=i {
                let one = if i == j { f64::EPSILON + damping } else { 0.0 };
                let mut sum = self.matrix[i][j] * scale[i] * scale[j] + one;
                for (a, b) in factor[i].iter().zip(factor[j]).take(j) {
                    sum -= a * b;
                }
                factor[i][j] = if i == j { sum.sqrt() } else { sum / factor[j][j] };
            }
            let known: f64 = (0..i).map(|k| factor[i][k] * x[k]).sum();
            x[i] = (self.right[i] * scale[i] - known) / factor[i][i];
        }
        for i in (0..5).rev() {
            let known: f64 = (i + 1..5).map(|k| factor[k][i] * x[k]).sum();
            x[i] = (x[i] - known) / factor[i][i];
        }
        for (x, scale) in x.iter_mut().zip(scale) {
            *x *= scale;
        }
        x.iter().all(|x| x.is_finite()).then_some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octaves(terms: [f64; 5], tau0_s: f64, count: u32) -> Vec<Octave> {
        let roots = terms.map(f64::sqrt);
        (0..count)
            .map(|level| Octave {
                samples: 1 << level,
                differences: 1000,
                variance: variance(&roots, f64::from(1 << level) * tau0_s),
                white_gain: 1.0,
            })
            .collect()
    }

    #[test]
    fn the_minimum_of_white_noise_and_random_walk() {
        // √(2NK/√3) at τ = √3 N/K, which is made an octave: 2^17·0.005 s = 655.36 s.
        let (n, tau_min, dt) = (0.015_f64, 655.36, 0.005_f64);
        let k = 3_f64.sqrt() * n / tau_min;
        let curve = octaves([0.0, n * n, 0.0, k * k / 3.0, 0.0], dt, 21);
        let reading = imu_utils(&curve, dt).unwrap();
        let expected = (2.0 * n * k / 3_f64.sqrt()).sqrt();
        // The fit is exact in principle; the search ends within 1e-4 of it.
        assert!((reading.minimum / expected - 1.0).abs() < 1e-4, "{}", reading.minimum);
        let expected = (n * n + k * k / 3.0).sqrt() / dt.sqrt();
        assert!((reading.white_noise / expected - 1.0).abs() < 1e-4, "{}", reading.white_noise);
    }

    #[test]
    fn all_five_terms_are_found() {
        let terms = [1e-8, 1e-4, 4e-6, 1e-7, 1e-11];
        let curve = octaves(terms, 0.01, 20);
        let points: Vec<_> = curve.iter().map(|o| (o.samples as f64 * 0.01, o.variance)).collect();
        let roots = fit(&points).unwrap();
        for (found, term) in roots.iter().zip(terms) {
            assert!((found * found / term - 1.0).abs() < 1e-2, "{found} {term}");
        }
    }

    #[test]
    fn too_little_is_none() {
        let terms = [0.0, 1e-4, 0.0, 1e-9, 0.0];
        assert_eq!(imu_utils(&octaves(terms, 0.01, 4), 0.01), None);
        assert_eq!(imu_utils(&octaves([0.0; 5], 0.01, 20), 0.01), None);
        assert_eq!(imu_utils(&[], 0.01), None);
        assert_eq!(imu_utils(&octaves(terms, f64::NAN, 20), f64::NAN), None);
    }
}
