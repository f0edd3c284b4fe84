//! The classic slope reading: N and K where lines of slope −½ and +½ lie on the Allan deviation.
//!
//! For people who want to compare (`--estimator slope`): the method of kalibr_allan (rpng, its
//! `gen_chart.m`). The deviations of the axes are averaged; a line of slope −½ is laid through all
//! points before the minimum, one of slope +½ through all points after it, both by the mean
//! of the logarithms; N is the first at τ = 1 s, K the second at τ = 3 s. The tool has 2000 points
//! and leaves out 50 of them (a factor of 1.6 in τ) on either side of the minimum; octaves leave
//! out the minimum itself.
//!
//! What is wrong with it: near the minimum the deviation has slope 0 and not ½, so that both readings
//! are too large; the points at the longest τ have the largest errors and the same weight; and when the
//! minimum is the last point, nothing is left to read K from. The tool then prints NaN.

use imu_core::allan::Octave;

/// What the two lines read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeReading {
    /// N, in the signal's unit /√Hz; `None` where the tool has nothing before the minimum.
    pub noise_density: Option<f64>,
    /// K, in the signal's unit /s/√Hz; `None` where the tool prints NaN.
    pub random_walk: Option<f64>,
}

/// Reads the mean Allan deviation of `axes`, the octaves of one axis or of several, sampled every
/// `tau0_s` seconds.
#[must_use]
pub fn kalibr_allan(axes: &[&[Octave]], tau0_s: f64) -> SlopeReading {
    let curve = mean_deviation(axes, tau0_s);
    let lowest = curve.iter().enumerate().min_by(|a, b| a.1.1.total_cmp(&b.1.1));
    let Some((lowest, _)) = lowest else {
        return SlopeReading { noise_density: None, random_walk: None };
    };
    SlopeReading {
        noise_density: line_at(&curve[..lowest], -0.5, 1.0),
        random_walk: line_at(&curve[lowest + 1..], 0.5, 3.0),
    }
}

/// τ in seconds and the mean of the axes' deviations, where all axes have one.
fn mean_deviation(axes: &[&[Octave]], tau0_s: f64) -> Vec<(f64, f64)> {
    let Some(first) = axes.first() else { return Vec::new() };
    let at = |(level, octave): (usize, &Octave)| {
        let sum = axes.iter().try_fold(0.0, |sum, axis| {
            let octave = axis.get(level).filter(|o| o.differences > 0 && o.variance > 0.0)?;
            Some(sum + octave.deviation())
        })?;
        Some((octave.samples as f64 * tau0_s, sum / axes.len() as f64))
    };
    first.iter().enumerate().filter_map(at).filter(|p| p.0 > 0.0 && p.1.is_finite()).collect()
}

/// The value at `tau_s` of the line of this slope, on double logarithmic paper, that fits best.
fn line_at(points: &[(f64, f64)], slope: f64, tau_s: f64) -> Option<f64> {
    let sum: f64 = points.iter().map(|(tau, deviation)| deviation.ln() - slope * tau.ln()).sum();
    (!points.is_empty()).then(|| (sum / points.len() as f64 + slope * tau_s.ln()).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octaves(variance: impl Fn(f64) -> f64, tau0_s: f64, count: u32) -> Vec<Octave> {
        (0..count)
            .map(|level| Octave {
                samples: 1 << level,
                differences: 1000,
                variance: variance(f64::from(1 << level) * tau0_s),
                white_gain: 1.0,
            })
            .collect()
    }

    #[test]
    fn lines_on_a_pointed_curve_are_read_exactly() {
        let (n, k) = (0.015, 5e-5);
        // White noise below τ = √3 N/K = 520 s, random walk above.
        let curve = octaves(|tau| (n * n / tau).max(k * k * tau / 3.0), 0.005, 21);
        let reading = kalibr_allan(&[&curve, &curve], 0.005);
        assert!((reading.noise_density.unwrap() / n - 1.0).abs() < 1e-12);
        assert!((reading.random_walk.unwrap() / k - 1.0).abs() < 1e-12);
    }

    #[test]
    fn both_noises_together_read_too_large() {
        // σ² = N²/τ·(1 + (τ/τm)²) with τm = √3 N/K, here the octave 4096 s: ln of the line is off by
        // the mean of ½ ln(1 + 4^(−j)), j = 1…12, and of the same over j = 1, 2.
        let (n, tau_min) = (0.01_f64, 4096.0);
        let k = 3_f64.sqrt() * n / tau_min;
        let curve = octaves(|tau| n * n / tau + k * k * tau / 3.0, 1.0, 15);
        let reading = kalibr_allan(&[&curve], 1.0);
        let off = |count: i32| {
            let sum: f64 = (1..=count).map(|j| 0.5 * (1.0 + 0.25_f64.powi(j)).ln()).sum();
            (sum / f64::from(count)).exp()
        };
        assert!((reading.noise_density.unwrap() / (n * off(12)) - 1.0).abs() < 1e-12);
        assert!((reading.random_walk.unwrap() / (k * off(2)) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_would_be_nan_is_none() {
        let white = octaves(|tau| 1.0 / tau, 0.01, 10);
        let reading = kalibr_allan(&[&white], 0.01);
        assert!(reading.noise_density.is_some() && reading.random_walk.is_none());
        let walk = octaves(|tau| tau, 0.01, 10);
        let reading = kalibr_allan(&[&walk], 0.01);
        assert!(reading.noise_density.is_none() && reading.random_walk.is_some());
        let empty = octaves(|_| 0.0, 0.01, 10);
        for axes in [&[][..], &[&empty[..]], &[&white, &empty]] {
            let reading = kalibr_allan(axes, 0.01);
            assert_eq!(reading, SlopeReading { noise_density: None, random_walk: None });
        }
    }
}
