//! A file of poses and what was made of it: all that there is to report.

use std::path::Path;

use imu_core::trajectory::GRAVITY;

use super::{Choice, Fit, Given, Options, Outline, Route, TimedPose, choices, file, fit, order};
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
    /// This one and its alternatives.
    pub choices: Vec<Choice>,
}

impl Fitted {
    /// Reads poses and fits a curve to them.
    ///
    /// # Errors
    /// When the file cannot be read or no curve comes of it, in one sentence.
    pub fn to(path: &Path, options: &Options) -> Result<Self, Error> {
        if file::read(path)?.is_some() {
            return Err(Error::data(format!(
                "{} is a curve already: sample it with imu spline sample, or give poses",
                path.display()
            )));
        }
        let given = Given::read(path)?;
        let span_s = given.span_s();
        let Given { poses, notes } = given;
        let fit = fit(&poses, options).map_err(|error| no_curve(path, error))?;
        Ok(Self {
            path: path.display().to_string(),
            span_s,
            notes,
            mean_force: order::mean_vertical(&poses).map(|part| GRAVITY * part),
            choices: choices(&poses, options, &fit),
            poses,
            fit,
        })
    }

    /// What there is to draw.
    ///
    /// # Errors
    /// None, of a fit.
    pub fn outline(&self) -> Result<Outline, Error> {
        let Fit { form, knots, span_ns, control, .. } = &self.fit;
        let route = Route::new(*form, *knots, *span_ns, control, Vec::new());
        let route = route.map_err(|error| no_curve(Path::new(&self.path), error))?;
        Ok(Outline::of(&route, &self.poses))
    }
}

/// Why there is no curve, and of what.
pub(super) fn no_curve(path: &Path, error: impl std::fmt::Display) -> Error {
    Error::data(format!("{}: {error}", path.display()))
}
