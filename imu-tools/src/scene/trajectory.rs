//! Scenes that follow a user's own trajectory: the key `trajectory`, from when to when, and how a curve is made of it.
//!
//! `trajectory = "poses.tum"`, or a table: `file`, `form`, `spacing_s` or `within`, `smooth_hz`. The file stands
//! beside the scene; it is one of poses (TUM, EuRoC) or a curve of `imu spline fit`.

use std::fmt;
use std::path::Path as FilePath;
use std::sync::Arc;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, Deserializer, MapAccess, Visitor};

use super::check::Bad;
use super::{Path, Rate, Scene};
use crate::error::Error;
use crate::recording::{Note, SampleKind};
use crate::spline::{Options, Route, Spacing, asked};

/// Values in the place of those of a scene file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instead {
    /// Samples a second.
    pub rate: Option<Rate>,
    /// What a sample is.
    pub samples: Option<SampleKind>,
    /// The length.
    pub duration_ns: Option<u64>,
}

/// The key's value.
pub(super) struct Own {
    file: String,
    options: Options,
}

/// The keys of its table.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    file: String,
    form: Option<String>,
    spacing_s: Option<f64>,
    within: Option<String>,
    smooth_hz: Option<f64>,
}

impl Keys {
    fn options(&self) -> Result<Options, String> {
        let Self { form, spacing_s, within, smooth_hz, .. } = self;
        let spacing = match (spacing_s, within) {
            (Some(_), Some(_)) => return Err("give spacing_s or within, not both".into()),
            (Some(seconds), None) => asked::every(*seconds).map_err(|e| e.to_string())?,
            (None, Some(text)) => asked::within(text).map_err(|e| e.to_string())?,
            (None, None) => Spacing::AsPoses,
        };
        let smoothing = smooth_hz.map(asked::smoothing_s).transpose();
        Ok(Options {
            form: form.as_deref().map(str::parse).transpose()?,
            spacing,
            smoothing_s: smoothing.map_err(|e| e.to_string())?.unwrap_or(0.0),
        })
    }
}

impl<'de> Deserialize<'de> for Own {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct FileOrTable;

        impl<'de> Visitor<'de> for FileOrTable {
            type Value = Own;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(
                    "a file of poses, or a table with file, form, spacing_s, within, smooth_hz",
                )
            }

            fn visit_str<E: de::Error>(self, file: &str) -> Result<Own, E> {
                Ok(Own { file: file.to_owned(), options: Options::default() })
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Own, A::Error> {
                let keys = Keys::deserialize(MapAccessDeserializer::new(map))?;
                let options = keys.options().map_err(de::Error::custom)?;
                Ok(Own { file: keys.file, options })
            }
        }

        from.deserialize_any(FileOrTable)
    }
}

impl Own {
    /// The curve, of a file beside the scene of this name.
    pub(super) fn route(&self, scene: &str) -> Result<Arc<Route>, Error> {
        let beside = FilePath::new(scene).with_file_name(&self.file);
        Route::open(&beside, &self.options).map(Arc::new)
    }
}

impl Path {
    /// What there is to tell of it.
    pub(super) fn notes(&self) -> &[Note] {
        match self {
            Self::Rest | Self::Ellipse => &[],
            Self::Along(route) => route.notes(),
        }
    }
}

impl Scene {
    /// The same scene with these values.
    #[must_use]
    pub fn with(self, instead: &Instead) -> Self {
        Self {
            rate: instead.rate.unwrap_or(self.rate),
            samples: instead.samples.unwrap_or(self.samples),
            duration_ns: instead.duration_ns.unwrap_or(self.duration_ns),
            ..self
        }
    }

    /// Ideal sensors along a curve, from its first instant (for means and increments one interval later, so that the
    /// first of them is whole) to its last.
    #[must_use]
    pub fn along(route: Arc<Route>, rate: Rate, samples: SampleKind) -> Self {
        let (first, last) = route.span_ns();
        let start_ns = first.saturating_add(before_ns(rate, samples));
        let duration_ns = u64::try_from(i128::from(last) - i128::from(start_ns)).unwrap_or(0);
        let motion = Path::Along(route);
        Self { motion, rate, samples, start_ns, duration_ns, ..Self::default() }
    }
}

impl Scene {
    /// Samples of each sensor, lost ones included: those before the end of the duration, and one at the very end of a
    /// curve that is followed to its last instant.
    pub(super) fn samples_due(&self) -> u64 {
        let ends_with_curve = match &self.motion {
            Path::Along(route) => {
                let (_, last) = route.span_ns();
                self.start_ns.checked_add_unsigned(self.duration_ns) == Some(last)
            }
            Path::Rest | Path::Ellipse => false,
        };
        let at_end = ends_with_curve && self.rate.is_due_at(self.duration_ns);
        self.rate.samples_in(self.duration_ns) + u64::from(at_end)
    }
}

/// How long before a sample's stamp it begins to feel, ns.
fn before_ns(rate: Rate, samples: SampleKind) -> i64 {
    match samples {
        SampleKind::Instantaneous => 0,
        SampleKind::Mean | SampleKind::Increments => (1e9 * rate.interval_s()).ceil() as i64,
    }
}

/// That there is motion from the first sample to the last.
pub(super) fn check(scene: &Scene) -> Result<(), Bad> {
    let Path::Along(route) = &scene.motion else { return Ok(()) };
    let (first, last) = route.span_ns();
    let seconds = |ns: i128| ns as f64 / 1e9;
    let begin = i128::from(scene.start_ns) - i128::from(before_ns(scene.rate, scene.samples));
    let early = i128::from(first) - begin;
    if early > 0 {
        let of_means = match scene.samples {
            SampleKind::Instantaneous => "",
            SampleKind::Mean | SampleKind::Increments => {
                ", the interval of the first sample included,"
            }
        };
        return Err(Bad::new(
            "start_ns",
            format!(
                "the scene begins {} s before its trajectory{of_means} which knows nothing before {first} ns",
                seconds(early)
            ),
        ));
    }
    // Samples are due before the end of the duration.
    let late = i128::from(scene.start_ns) + i128::from(scene.duration_ns) - i128::from(last);
    if late > 1 {
        let most = i128::from(last) - i128::from(scene.start_ns);
        return Err(Bad::new(
            "duration",
            format!(
                "the scene is {} s longer than its trajectory: make the duration {} s or shorter",
                seconds(late),
                seconds(most.max(0))
            ),
        ));
    }
    Ok(())
}

#[cfg(test)]
#[path = "trajectory_tests.rs"]
mod tests;
