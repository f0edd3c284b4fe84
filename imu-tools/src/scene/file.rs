//! Scene files: TOML, every key optional, an unknown one an error that names it.
//!
//! ```toml
//! rate_hz = 200                    # of both sensors
//! duration = "4h"                  # or a number of seconds
//! seed = 7
//! start_ns = 1600000000000000000   # stamp of the first sample
//! motion = "ellipse"               # or "rest"
//! gravity = 9.81                   # m/s²
//!
//! [gyroscope]                      # rad/s
//! noise_density = 0.015            # N, for all axes
//! random_walk = [5e-5, 5e-5, 0]    # K, for x, y, z; 0 leaves the term out
//! constant_bias = 0.01
//! turn_on_bias = 1e-3              # standard deviation of an offset drawn once
//! rate_ramp = 1e-9                 # R: growth of the bias a second
//! lowpass_hz = 42                  # one-pole bandwidth; left out: none
//! saturation = 35                  # full scale
//! quantisation = 1.3e-4            # one count
//!
//! [gyroscope.flicker]              # bias instability B, flat between two averaging times
//! bias_instability = 1e-4
//! shortest_tau_s = 1
//! longest_tau_s = 1000
//!
//! [gyroscope.gauss_markov]
//! standard_deviation = 1e-4
//! correlation_time_s = 300
//!
//! [gyroscope.vibration]            # one frequency
//! amplitude = [0.01, 0, 0]
//! frequency_hz = 47
//!
//! [gyroscope.band_vibration]       # a band about a frequency
//! standard_deviation = 0.01
//! frequency_hz = 30
//! bandwidth_hz = 10
//!
//! [accelerometer]                  # m/s²
//! noise_density = 0.019
//! ```

use std::fmt;

use serde::Deserialize;
use serde::de::{self, Deserializer, Visitor};

use super::errors::SensorTable;
use super::{Path, Rate, Scene, parse_duration};
use crate::error::Error;

/// A file's keys as they stand in it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    rate_hz: Option<f64>,
    duration: Option<Length>,
    seed: Option<u64>,
    start_ns: Option<i64>,
    motion: Option<Motion>,
    gravity: Option<f64>,
    #[serde(default)]
    gyroscope: SensorTable,
    #[serde(default)]
    accelerometer: SensorTable,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum Motion {
    Rest,
    Ellipse,
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
        let file: File = toml::from_str(text).map_err(|error| {
            let line = error.span().map_or(1, |span| {
                1 + text.bytes().take(span.start).filter(|&byte| byte == b'\n').count()
            });
            let message = error.message().lines().collect::<Vec<_>>().join(" ");
            Error::data(format!("scene {name}, line {line}: {message}"))
        })?;
        let base = Self::default();
        let named = |error: Error| Error::data(format!("scene {name}: {error}"));
        let scene = Self {
            motion: match file.motion {
                None | Some(Motion::Rest) => Path::Rest,
                Some(Motion::Ellipse) => Path::Ellipse,
            },
            gravity: file.gravity.unwrap_or(base.gravity),
            rate: file.rate_hz.map_or(Ok(base.rate), Rate::from_hz).map_err(named)?,
            duration_ns: file.duration.map_or(base.duration_ns, |Length(ns)| ns),
            seed: file.seed.unwrap_or(base.seed),
            start_ns: file.start_ns.unwrap_or(base.start_ns),
            gyroscope: file.gyroscope.errors(),
            accelerometer: file.accelerometer.errors(),
        };
        scene.check().map_err(named)?;
        Ok(scene)
    }

    /// That every number of the scene can be.
    ///
    /// # Errors
    /// One sentence naming the first that cannot.
    pub fn check(&self) -> Result<(), Error> {
        if !(self.gravity.is_finite() && self.gravity.abs() <= 1e3) {
            return Err(Error::usage(format!(
                "gravity = {} cannot be: give m/s², such as 9.81",
                self.gravity
            )));
        }
        if self.start_ns < 0 {
            return Err(Error::usage(format!(
                "start_ns = {} is before 1970: stamps count nanoseconds from there",
                self.start_ns
            )));
        }
        let last = u64::try_from(i64::MAX - self.start_ns).unwrap_or(0);
        if self.duration_ns >= last {
            return Err(Error::usage(
                "the last stamp is beyond the year 2262, where 64-bit nanoseconds end: start \
                 earlier or make the duration shorter",
            ));
        }
        for (sensor, errors) in
            [("gyroscope", &self.gyroscope), ("accelerometer", &self.accelerometer)]
        {
            errors.check(sensor)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{
        Axes, BandVibrationTerm, FlickerTerm, GaussMarkovTerm, SensorErrors, VibrationTerm,
    };

    #[test]
    fn every_term_has_its_key() {
        let text = "[gyroscope]\nturn_on_bias = 1e-3\nrate_ramp = [1e-9, 0, -1e-9]\n\
             saturation = 35\nquantisation = 1.3e-4\n\
             [gyroscope.flicker]\nbias_instability = 1e-4\nshortest_tau_s = 1\n\
             longest_tau_s = 1000\n\
             [gyroscope.gauss_markov]\nstandard_deviation = [1, 2, 3]\ncorrelation_time_s = 300\n\
             [accelerometer.vibration]\namplitude = 0.5\nfrequency_hz = 47\n\
             [accelerometer.band_vibration]\nstandard_deviation = 0.1\nfrequency_hz = 30\n\
             bandwidth_hz = 10\n";
        let scene = Scene::from_toml(text, "a.toml").unwrap();
        let gyroscope = SensorErrors {
            turn_on_bias: [1e-3; 3],
            rate_ramp: [1e-9, 0.0, -1e-9],
            saturation: Some(35.0),
            quantisation: Some(1.3e-4),
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
            vibration: Some(VibrationTerm { amplitude: Axes([0.5; 3]), frequency_hz: 47.0 }),
            band_vibration: Some(BandVibrationTerm {
                standard_deviation: Axes([0.1; 3]),
                frequency_hz: 30.0,
                bandwidth_hz: 10.0,
            }),
            ..SensorErrors::default()
        };
        assert_eq!((scene.gyroscope, scene.accelerometer), (gyroscope, accelerometer));
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
        ] {
            let error = Scene::from_toml(text, "a.toml").unwrap_err().to_string();
            for word in words {
                assert!(error.contains(word), "{text}: {error}");
            }
            assert!(!error.contains('\n'), "{error}");
        }
    }
}
