//! The noise variance of one sample: what a program wants that takes samples one by one, such as the covariances of
//! `sensor_msgs/Imu`.
//!
//! Over 2ᵏ samples, the variance about their mean is half the sum of the first k octaves of the Allan variance (the
//! orthogonal decomposition of Haar 1910: a pair of block means holds half of its AVAR), whatever the noise is; what
//! is left of white noise in that mean is half of the last octave once more. So it is exact for white noise, and right
//! behind a low-pass filter too, where neighbours resemble each other and the first octave alone is too small. It stops
//! at τ = 10 s: slower wandering is the bias, which filters estimate and do not take for noise.

use super::SensorNoise;

/// The longest averaging time that counts as noise of a sample, s.
const LONGEST_S: f64 = 10.0;

/// The noise variance of one sample on each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneSample {
    /// x, y, z, in the sensor's unit squared.
    pub variance: [f64; 3],
    /// The longest averaging time that was summed, s.
    pub up_to_s: f64,
}

impl OneSample {
    /// That of a sensor; `None` where an axis has none.
    #[must_use]
    pub fn of(sensor: &SensorNoise) -> Option<Self> {
        let mut found: Option<Self> = None;
        let (mut sum, mut rest) = ([0.0; 3], [0.0; 3]);
        for deviation in &sensor.deviation {
            // One octave is better than none where samples are seconds apart.
            if found.is_some() && deviation.tau_s > LONGEST_S {
                break;
            }
            let octaves = &deviation.octaves;
            if octaves.iter().any(|octave| octave.differences == 0) {
                break;
            }
            for ((sum, rest), octave) in sum.iter_mut().zip(&mut rest).zip(octaves) {
                *rest = 0.5 * octave.variance / octave.white_gain.max(1.0);
                *sum += *rest;
            }
            let variance = [sum[0] + rest[0], sum[1] + rest[1], sum[2] + rest[2]];
            found = Some(Self { variance, up_to_s: deviation.tau_s });
        }
        found.filter(|found| found.variance.iter().all(|variance| *variance > 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::{Options, calibrate};
    use crate::scene::{Preset, Scene, Simulator};

    fn gyroscope(scene: &Scene) -> SensorNoise {
        let source = Box::new(Simulator::new(scene).unwrap());
        calibrate(source, "simulated", &Options::default(), |_| {}).unwrap().gyroscope.unwrap()
    }

    /// N = 0.015 at 200 Hz for 600 s: N²·200 Hz = 0.045, and a one-pole low-pass at a tenth of the rate leaves
    /// (1 − a)/(1 + a) of it, a = exp(−0.2π): 0.3042. A variance of n samples that are alike over (1 + a²)/(1 − a²)
    /// of them scatters by √(2·1.8/120 000) = 0.5 %: five of those. The walk goes 5e-5·√10 in 10 s, nothing.
    #[test]
    fn variance_of_one_sample_with_and_without_a_low_pass() {
        let scene = Scene { duration_ns: 600_000_000_000, ..Preset::Mid.scene() };
        let white = 0.015_f64.powi(2) * 200.0;
        let a = (-0.2 * std::f64::consts::PI).exp();
        let mut filtered = scene.clone();
        filtered.gyroscope.lowpass_hz = Some(20.0);
        for (scene, expected) in [(&scene, white), (&filtered, white * (1.0 - a) / (1.0 + a))] {
            let sensor = gyroscope(scene);
            let found = OneSample::of(&sensor).unwrap();
            assert!((5.0..=10.0).contains(&found.up_to_s), "{found:?}");
            for variance in found.variance {
                assert!((variance / expected - 1.0).abs() < 0.025, "{variance} {expected}");
            }
        }
    }

    /// A ramp over the whole record, 3 standard deviations of a sample far, is bias: 1e-3·600 = 0.6 against 0.21.
    #[test]
    fn slow_drift_is_not_noise() {
        let mut scene = Scene { duration_ns: 600_000_000_000, ..Preset::Mid.scene() };
        scene.gyroscope.rate_ramp = [1e-3; 3];
        let found = OneSample::of(&gyroscope(&scene)).unwrap();
        for variance in found.variance {
            assert!((variance / 0.045 - 1.0).abs() < 0.025, "{variance}");
        }
    }

    #[test]
    fn an_axis_that_never_changes_has_none() {
        let scene = Scene { duration_ns: 60_000_000_000, ..Preset::Mid.scene() };
        let mut sensor = gyroscope(&scene);
        for deviation in &mut sensor.deviation {
            deviation.octaves[1].variance = 0.0;
        }
        assert_eq!(OneSample::of(&sensor), None);
        sensor.deviation.clear();
        assert_eq!(OneSample::of(&sensor), None);
    }
}
