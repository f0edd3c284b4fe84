//! A file of poses and what was made of it: all that there is to report.

use std::fmt::Display;
use std::path::Path;

use imu_core::trajectory::GRAVITY;

use super::file::{self, Opened};
use super::{Choice, Fit, Given, Options, Outline, TimedPose, choices, fit};
use crate::error::Error;
use crate::recording::Note;

/// Poses, their curve, and what others there would be.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// The file of the poses.
    pub path: String,
    /// The poses that were used.
    pub poses: Vec<TimedPose>,
    /// From the first to the last, s.
    pub span_s: f64,
    /// What there is to tell of them.
    pub notes: Vec<Note>,
    /// What an accelerometer along them reads on average, body axes, m/s².
    pub mean_force: [f64; 3],
    /// The curve.
    pub fit: Fit,
    /// What there is to draw of it.
    pub outline: Outline,
    /// This one and its alternatives.
    pub choices: Vec<Choice>,
}

impl Fitted {
    /// Reads poses and fits a curve to them.
    ///
    /// # Errors
    /// When the file cannot be read or no curve comes of it, in one sentence.
    pub fn to(path: &Path, options: &Options) -> Result<Self, Error> {
        let given = match file::open(path)? {
            Opened::Poses(given) => given,
            Opened::Curve(_) => {
                return Err(Error::data(format!(
                    "{} is a curve already: sample it with imu spline sample, or give poses",
                    path.display()
                )));
            }
        };
        let span_s = given.span_s();
        let Given { poses, mut notes } = given;
        let fit = fit(&poses, options).map_err(|error| no_curve(path, &error, &notes))?;
        let route = fit.route().map_err(|error| no_curve(path, &error, &notes))?;
        let felt = route.felt(GRAVITY);
        notes.extend(fit.gaps());
        notes.extend(felt.suspicion(route.span_ns().0).map(Note::Warning));
        Ok(Self {
            path: path.display().to_string(),
            span_s,
            notes,
            mean_force: felt.mean_specific_force,
            choices: choices(&poses, options, &fit),
            outline: Outline::of(&route, &poses),
            poses,
            fit,
        })
    }
}

/// Why there is no curve, and of what.
pub(super) fn no_curve(path: &Path, error: &dyn Display, notes: &[Note]) -> Error {
    let warning = notes.iter().find_map(|note| match note {
        Note::Warning(text) => Some(format!(" ({text})")),
        Note::Info(_) => None,
    });
    Error::data(format!("{}: {error}{}", path.display(), warning.unwrap_or_default()))
}
