//! Scene files: TOML, every key optional, an unknown one an error that names it.
//!
//! What each key means, its unit and its default: `docs/scenes.md`. The keys of a sensor are the fields
//! of [`SensorErrors`], those of `[clock]` and `[temperature]` the fields of [`ClockErrors`] and
//! [`Temperature`]. A `trajectory` is read from beside the file.
//!
//! ```
//! use imu_tools::scene::{Path, Scene};
//! let scene = Scene::from_toml(
//!     "motion = 'ellipse'
//!      [gyroscope]
//!      noise_density = 0.015           # N, for all axes
//!      random_walk = [5e-5, 5e-5, 0]   # K, for x, y, z; 0 leaves the term out",
//!     "scene.toml",
//! )?;
//! assert_eq!(scene.motion, Path::Ellipse);
//! # Ok::<(), imu_tools::error::Error>(())
//! ```

use std::fmt;

use serde::Deserialize;
use serde::de::{self, Deserializer, Visitor};

use super::check::{self, Bad};
use super::located::{impossible, refused};
use super::trajectory::{Instead, Own};
use super::{ClockErrors, Path, Rate, Scene, SensorErrors, Temperature, parse_duration};
use crate::error::Error;
use crate::recording::SampleKind;

/// A file's keys as they stand in it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    rate_hz: Option<f64>,
    duration: Option<Length>,
    seed: Option<u64>,
    start_ns: Option<i64>,
    motion: Option<Path>,
    trajectory: Option<Own>,
    gravity: Option<f64>,
    samples: Option<SampleKind>,
    temperature: Option<Temperature>,
    #[serde(default)]
    clock: ClockErrors,
    #[serde(default)]
    gyroscope: SensorErrors,
    #[serde(default)]
    accelerometer: SensorErrors,
}

/// A duration in nanoseconds, from `"4h"` or a number of seconds.
struct Length(u64);

impl<'de> Deserialize<'de> for Length {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Text;

        impl Visitor<'_> for Text {
            type Value = Length;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a duration such as \"4h\", or a number of seconds")
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<Length, E> {
                parse_duration(text).map(Length).map_err(de::Error::custom)
            }

            fn visit_f64<E: de::Error>(self, seconds: f64) -> Result<Length, E> {
                self.visit_str(&seconds.to_string())
            }

            fn visit_i64<E: de::Error>(self, seconds: i64) -> Result<Length, E> {
                self.visit_str(&seconds.to_string())
            }
        }

        from.deserialize_any(Text)
    }
}

impl Scene {
    /// The scene that a TOML file's text describes; what it leaves out is as in
    /// [`Scene::default`].
    ///
    /// # Errors
    /// One sentence naming `name` (the file), the line and the key: for bad TOML, an unknown key, or
    /// a value that cannot be.
    pub fn from_toml(text: &str, name: &str) -> Result<Self, Error> {
        Self::from_toml_with(text, name, &Instead::default())
    }

    /// The same, with some of its values given in the place of the file's.
    ///
    /// # Errors
    /// As of [`Scene::from_toml`].
    pub fn from_toml_with(text: &str, name: &str, instead: &Instead) -> Result<Self, Error> {
        let file: File = toml::from_str(text).map_err(|error| refused(text, name, &error))?;
        let ideal = Self::default();
        let rate = file.rate_hz.map_or(Ok(ideal.rate), Rate::from_hz);
        let bad =
            |key: &str, error: Error| impossible(text, name, Bad::new(key, error.to_string()));
        let rate = rate.map_err(|error| bad("rate_hz", error))?;
        let rate = instead.rate.unwrap_or(rate);
        let samples = instead.samples.or(file.samples).unwrap_or(ideal.samples);
        let base = match (&file.trajectory, &file.motion) {
            (Some(_), Some(_)) => {
                return Err(bad("motion", Error::usage("give a motion or a trajectory, not both")));
            }
            (Some(own), None) => {
                let route = own.route(name).map_err(|error| bad("trajectory", error))?;
                Self::along(route, rate, samples)
            }
            (None, motion) => Self { motion: motion.clone().unwrap_or(Path::Rest), ..ideal },
        };
        let start_ns = file.start_ns.unwrap_or(base.start_ns);
        // All that is left of a trajectory.
        let later = start_ns.saturating_sub(base.start_ns);
        let rest_ns = match base.motion {
            Path::Along(_) => base.duration_ns.saturating_sub(u64::try_from(later).unwrap_or(0)),
            Path::Rest | Path::Ellipse => base.duration_ns,
        };
        let given_ns = instead.duration_ns.or(file.duration.map(|Length(ns)| ns));
        let scene = Self {
            motion: base.motion,
            gravity: file.gravity.unwrap_or(base.gravity),
            rate,
            duration_ns: given_ns.unwrap_or(rest_ns),
            seed: file.seed.unwrap_or(base.seed),
            start_ns,
            samples,
            temperature: file.temperature,
            clock: file.clock,
            gyroscope: file.gyroscope,
            accelerometer: file.accelerometer,
        };
        check::check(&scene).map_err(|bad| impossible(text, name, bad))?;
        Ok(scene)
    }

    /// That every number of the scene can be.
    ///
    /// # Errors
    /// One sentence naming the first that cannot.
    pub fn check(&self) -> Result<(), Error> {
        Ok(check::check(self)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{
        Axes, BandVibrationTerm, FlickerTerm, GaussMarkovTerm, Poles, SensorErrors, VibrationTerm,
    };

    #[test]
    fn every_term_has_its_key() {
        let text = "[gyroscope]\nturn_on_bias = 1e-3\nrate_ramp = [1e-9, 0, -1e-9]\n\
             saturation = 35\nquantisation = 1.3e-4\nincrement_quantisation = 1e-6\n\
             lever_arm_m = [0.1, 0, -0.2]\nscale_error = 0.01\n\
             misalignment_rad = [[1e-3, 0], [0, 2e-3], [0, 0]]\ng_sensitivity = [1e-4, 0, 2e-4]\n\
             temperature_coefficient = 1e-4\nlowpass_hz = 80\nlowpass_poles = 2\n\
             [gyroscope.flicker]\nbias_instability = 1e-4\nshortest_tau_s = 1\n\
             longest_tau_s = 1000\n\
             [gyroscope.gauss_markov]\nstandard_deviation = [1, 2, 3]\ncorrelation_time_s = 300\n\
             [accelerometer]\nscale_misalignment = [[1, 0, 0], [0, 1, 0], [0, 0.1, 1]]\n\
             [accelerometer.vibration]\namplitude = 0.5\nfrequency_hz = 47\n\
             [accelerometer.band_vibration]\nstandard_deviation = 0.1\nfrequency_hz = 30\n\
             bandwidth_hz = 10\n\
             [temperature]\nstart_c = 5\nrise_k = 20\ntime_constant_s = 180\nrate_k_s = 1e-3\n\
             [clock]\noffset_s = 0.01\ndrift_ppm = -20\njitter_s = 1e-4\n\
             jitter_uniform_s = 2e-4\nlost_fraction = 0.01\nlost_burst = 5\n";
        let text = &format!("samples = \"mean\"\n{text}");
        let scene = Scene::from_toml(text, "a.toml").unwrap();
        let gyroscope = SensorErrors {
            turn_on_bias: [1e-3; 3],
            rate_ramp: [1e-9, 0.0, -1e-9],
            saturation: Some(35.0),
            quantisation: Some(1.3e-4),
            increment_quantisation: Some(1e-6),
            lever_arm_m: [0.1, 0.0, -0.2],
            scale_error: [0.01; 3],
            misalignment_rad: [[1e-3, 0.0], [0.0, 2e-3], [0.0, 0.0]],
            g_sensitivity: [[1e-4, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 2e-4]],
            temperature_coefficient: [1e-4; 3],
            lowpass_hz: Some(80.0),
            lowpass_poles: Poles::Two,
            flicker: Some(FlickerTerm {
                bias_instability: Axes([1e-4; 3]),
                shortest_tau_s: 1.0,
                longest_tau_s: 1000.0,
            }),
            gauss_markov: Some(GaussMarkovTerm {
                standard_deviation: Axes([1.0, 2.0, 3.0]),
                correlation_time_s: 300.0,
            }),
            ..SensorErrors::default()
        };
        let accelerometer = SensorErrors {
            scale_misalignment: Some([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.1, 1.0]]),
            vibration: Some(VibrationTerm { amplitude: Axes([0.5; 3]), frequency_hz: 47.0 }),
            band_vibration: Some(BandVibrationTerm {
                standard_deviation: Axes([0.1; 3]),
                frequency_hz: 30.0,
                bandwidth_hz: 10.0,
            }),
            ..SensorErrors::default()
        };
        assert_eq!((scene.gyroscope, scene.accelerometer), (gyroscope, accelerometer));
        let temperature = Temperature {
            start_c: Some(5.0),
            rise_k: 20.0,
            time_constant_s: Some(180.0),
            rate_k_s: 1e-3,
            ..Temperature::default()
        };
        let clock = ClockErrors {
            offset_s: 0.01,
            drift_ppm: -20.0,
            jitter_s: 1e-4,
            jitter_uniform_s: 2e-4,
            lost_fraction: 0.01,
            lost_burst: Some(5.0),
        };
        assert_eq!((scene.samples, scene.clock), (SampleKind::Mean, clock));
        assert_eq!(scene.temperature, Some(temperature));
    }

    #[test]
    fn a_full_file_is_read() {
        let scene = Scene::from_toml(
            "rate_hz = 100\nduration = \"1h30m\"\nseed = 7\nstart_ns = 5\nmotion = \"ellipse\"\n\
             gravity = 9.8\n[gyroscope]\nnoise_density = 0.015\nrandom_walk = [5e-5, 1, 0]\n\
             lowpass_hz = 42\n[accelerometer]\nconstant_bias = [0.1, -0.2, 0]\n",
            "a.toml",
        )
        .unwrap();
        let expected = Scene {
            motion: Path::Ellipse,
            gravity: 9.8,
            rate: Rate::from_hz(100.0).unwrap(),
            duration_ns: 5_400_000_000_000,
            seed: 7,
            start_ns: 5,
            gyroscope: SensorErrors {
                noise_density: [0.015; 3],
                random_walk: [5e-5, 1.0, 0.0],
                lowpass_hz: Some(42.0),
                ..SensorErrors::default()
            },
            accelerometer: SensorErrors {
                constant_bias: [0.1, -0.2, 0.0],
                ..SensorErrors::default()
            },
            ..Scene::default()
        };
        assert_eq!(scene, expected);
        assert_eq!(Scene::from_toml("", "empty").unwrap(), Scene::default());
        assert_eq!(Scene::from_toml("duration = 90", "b").unwrap().duration_ns, 90_000_000_000);
    }

    #[test]
    fn what_is_wrong_is_said_in_one_sentence_with_line_and_key() {
        for (text, words) in [
            ("seed = 1\ncolour = 3", &["a.toml, line 2", "`colour`", "rate_hz"][..]),
            ("[gyroscope]\nbias = 3", &["line 2", "`bias`", "constant_bias"]),
            ("seed = -3", &["line 1", "-3"]),
            ("rate_hz = 0", &["a.toml", "0 Hz"]),
            ("rate_hz = \"fast\"", &["line 1", "fast"]),
            ("duration = \"soon\"", &["line 1", "soon", "4h"]),
            ("duration = -5", &["negative"]),
            ("motion = \"circle\"", &["`circle`", "`rest`"]),
            ("[gyroscope]\nnoise_density = [1, 2]", &["line 2", "three"]),
            ("[gyroscope]\nnoise_density = [1, 2, 3, 4]", &["line 2", "three"]),
            ("[gyroscope]\nnoise_density = -1", &["noise_density = -1", "gyroscope"]),
            ("[accelerometer]\nrandom_walk = nan", &["random_walk = NaN", "accelerometer"]),
            ("[accelerometer]\nlowpass_hz = 0", &["low-pass at 0 Hz"]),
            ("[gyroscope]\nturn_on_bias = -1", &["turn_on_bias = -1", "gyroscope"]),
            ("[gyroscope]\nquantisation = 0", &["quantisation = 0", "above 0"]),
            ("[gyroscope.flicker]\nbias_instability = 1", &["line 1", "`shortest_tau_s`"]),
            (
                "[gyroscope.vibration]\namplitude = 1\nfrequency_hz = -3",
                &["vibration.frequency_hz = -3", "gyroscope"],
            ),
            ("start_ns = -1", &["start_ns = -1"]),
            ("start_ns = 9223372036854775807", &["2262"]),
            ("gravity = inf", &["gravity = inf"]),
            ("seed = = 1", &["line 1"]),
            ("seed = 1\nrate_hz = 0", &["line 2", "0 Hz"]),
            ("\n[gyroscope]\n\nrandom_walk = -1", &["line 4", "random_walk = -1"]),
            ("[gyroscope]\nnoise_densty = 1", &["line 2", "`noise_densty`", "`noise_density`"]),
            ("samples = \"increment\"", &["line 1", "`increment`", "`increments`"]),
            ("[gyroscope]\nsaturation = \"2000 deg/s\"", &["line 2", "gyroscope.saturation"]),
            ("[gyroscope]\nnoise_density = \"0.1 deg/s\"", &["gyroscope.noise_density", "plain"]),
            ("[gyroscope]\nlowpass_hz = 9\nlowpass_poles = 3", &["line 3", "give 1 or 2"]),
            ("[gyroscope]\nlowpass_poles = 2", &["line 2", "needs a lowpass_hz"]),
            ("[gyroscope]\ng_sensitivity = [1, 2]", &["line 2", "a matrix"]),
            ("[gyroscope]\nlever_arm_m = 0.1", &["line 2", "gyroscope.lever_arm_m"]),
            ("[gyroscope]\nlever_arm_m = [0, 0, nan]", &["line 2", "lever_arm_m = NaN"]),
            ("[gyroscope]\nscale_error = 1\nscale_misalignment = 1", &["line 3", "not both"]),
            ("[accelerometer]\ng_sensitivity = 1", &["line 2", "gyroscope"]),
            ("[gyroscope]\ntemperature_coefficient = 1", &["line 2", "[temperature]"]),
            ("[temperature]\nrise_k = 1", &["line 2", "time_constant_s"]),
            ("[temperature]\nstart_c = -300", &["line 2", "start_c = -300"]),
            ("[clock]\nlost_fraction = 1", &["line 2", "lost_fraction = 1", "below 1"]),
            ("[clock]\nlost_burst = 3", &["line 2", "lost_fraction"]),
            ("[clock]\nlost_fraction = 0.9\nlost_burst = 2", &["line 3", "from 9"]),
            ("[clock]\njitter_s = -1", &["line 2", "jitter_s = -1"]),
            ("start_ns = 0\n[clock]\noffset_s = -1", &["line 3", "before 1970"]),
        ] {
            let error = Scene::from_toml(text, "a.toml").unwrap_err().to_string();
            for word in words {
                assert!(error.contains(word), "{text}: {error}");
            }
            assert!(!error.contains('\n'), "{error}");
        }
    }
}
