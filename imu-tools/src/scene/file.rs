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
//! lowpass_hz = 42                  # one-pole bandwidth; left out: none
//!
//! [accelerometer]                  # m/s²
//! noise_density = 0.019
//! ```

use std::fmt;

use serde::Deserialize;
use serde::de::{self, Deserializer, SeqAccess, Visitor};

use super::{Path, Rate, Scene, SensorErrors, parse_duration};
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
    gyroscope: Sensor,
    #[serde(default)]
    accelerometer: Sensor,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum Motion {
    Rest,
    Ellipse,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Sensor {
    noise_density: Axes,
    random_walk: Axes,
    constant_bias: Axes,
    lowpass_hz: Option<f64>,
}

/// One number for all axes, or one for each.
#[derive(Clone, Copy, Default)]
struct Axes([f64; 3]);

impl<'de> Deserialize<'de> for Axes {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Numbers;

        impl<'de> Visitor<'de> for Numbers {
            type Value = Axes;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number for all axes, or three, [x, y, z]")
            }

            fn visit_f64<E: de::Error>(self, x: f64) -> Result<Axes, E> {
                Ok(Axes([x; 3]))
            }

            fn visit_i64<E: de::Error>(self, x: i64) -> Result<Axes, E> {
                Ok(Axes([x as f64; 3]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Axes, A::Error> {
                let mut axes = [0.0; 3];
                for (i, axis) in axes.iter_mut().enumerate() {
                    *axis = seq
                        .next_element::<f64>()?
                        .ok_or_else(|| de::Error::invalid_length(i, &self))?;
                }
                if seq.next_element::<f64>()?.is_some() {
                    return Err(de::Error::invalid_length(4, &self));
                }
                Ok(Axes(axes))
            }
        }

        from.deserialize_any(Numbers)
    }
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

impl Sensor {
    fn errors(&self) -> SensorErrors {
        SensorErrors {
            noise_density: self.noise_density.0,
            random_walk: self.random_walk.0,
            constant_bias: self.constant_bias.0,
            lowpass_hz: self.lowpass_hz,
        }
    }
}

impl SensorErrors {
    fn check(&self, sensor: &str) -> Result<(), Error> {
        for (key, values) in
            [("noise_density", self.noise_density), ("random_walk", self.random_walk)]
        {
            if let Some(bad) = values.iter().find(|x| !(0.0..=1e6).contains(*x)) {
                return Err(Error::usage(format!(
                    "{key} = {bad} of the {sensor} cannot be: give a number from 0 (term left \
                     out) to 1e6"
                )));
            }
        }
        if let Some(bad) = self.constant_bias.iter().find(|x| !(-1e6..=1e6).contains(*x)) {
            return Err(Error::usage(format!(
                "constant_bias = {bad} of the {sensor} cannot be: give a number within ±1e6"
            )));
        }
        match self.lowpass_hz {
            Some(hz) if !(hz > 0.0 && hz <= 1e6) => Err(Error::usage(format!(
                "a low-pass at {hz} Hz of the {sensor} cannot be: give a cut-off above 0, up to 1e6"
            ))),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
