//! A curve of poses with its logarithms cached: what an IMU can follow.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use imu_core::Error as CoreError;
use imu_core::se3::Pose;
use imu_core::sensor::Kinematics;
use imu_core::spline::{Full, Knot, Knots, SplitSpline, SymmetricSplitSpline, cache};
use imu_core::trajectory::{AlongSpline, GRAVITY, Motion, Trajectory};

use super::felt::FeltAlong;
use super::file::{self, Opened};
use super::fitted::no_curve;
use super::{Fit, FormName, Options, fit};
use crate::error::Error;
use crate::recording::Note;

/// A curve, and what there is to tell of where it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    form: FormName,
    knots: Knots<f64>,
    span_ns: (i64, i64),
    cached: Vec<Knot<f64>>,
    file: Option<PathBuf>,
    notes: Vec<Note>,
}

impl Route {
    /// Of control poses, one for every knot; the poses that they come from begin and end at the instants `span_ns`, and
    /// so does the route.
    ///
    /// # Errors
    /// [`OutOfRange`](CoreError::OutOfRange) where there are not as many control poses as knots, or where the span is
    /// not within that of the knots; as of [`cache`].
    pub fn new(
        form: FormName,
        knots: Knots<f64>,
        span_ns: (i64, i64),
        control: &[Pose<f64>],
        notes: Vec<Note>,
    ) -> Result<Self, CoreError> {
        if knots.count() != control.len() {
            return Err(CoreError::OutOfRange("knots"));
        }
        let ((first, last), (begin, end)) = (knots.span(), span_ns);
        if !(first <= begin && begin <= end && end <= last) {
            return Err(CoreError::OutOfRange("span_ns"));
        }
        let mut cached = vec![Knot::default(); control.len()];
        cache(control, &mut cached)?;
        Ok(Self { form, knots, span_ns, cached, file: None, notes })
    }

    /// The curve in a file of `imu spline fit`, as it stands there, or one that is fitted to the poses in it.
    ///
    /// # Errors
    /// When the file cannot be read or no curve comes of it, in one sentence.
    pub fn open(path: &Path, options: &Options) -> Result<Self, Error> {
        let given = match file::open(path)? {
            Opened::Poses(given) => given,
            Opened::Curve(_) if *options != Options::default() => {
                return Err(Error::usage(format!(
                    "{} is a curve already, and stays as it is: leave form, spacing, within and smoothing out, or \
                     give its poses",
                    path.display()
                )));
            }
            Opened::Curve(route) => return Ok(Self { file: Some(path.to_owned()), ..route }),
        };
        let none = |error: &dyn Display| no_curve(path, error, &given.notes);
        let fit = fit(&given.poses, options).map_err(|error| none(&error))?;
        let route = fit.route().map_err(|error| none(&error))?;
        let mut notes = given.notes;
        notes.push(Note::Info(told(&fit, given.poses.len())));
        notes.extend(fit.gaps());
        notes.extend(route.felt(GRAVITY).suspicion(route.span_ns.0).map(Note::Warning));
        Ok(Self { file: Some(path.to_owned()), notes, ..route })
    }

    /// Which curve it is.
    #[must_use]
    pub fn form(&self) -> FormName {
        self.form
    }

    /// The instants of the first and the last pose that it was fitted to, ns.
    #[must_use]
    pub fn span_ns(&self) -> (i64, i64) {
        self.span_ns
    }

    /// When its control points are.
    #[must_use]
    pub fn knots(&self) -> &Knots<f64> {
        &self.knots
    }

    /// Its control points.
    pub fn control(&self) -> impl Iterator<Item = Pose<f64>> {
        self.cached.iter().map(Knot::pose)
    }

    /// The file that it was read from.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// What there is to tell of its poses and of the fit.
    #[must_use]
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Pose, velocities and accelerations.
    ///
    /// # Errors
    /// [`OutOfRange`](CoreError::OutOfRange), naming `t_ns`, outside the span of its knots.
    pub fn full(&self, t_ns: i64) -> Result<Full<f64>, CoreError> {
        match self.form {
            FormName::Plain => SplitSpline::of_checked(self.knots, &self.cached).full(t_ns),
            FormName::Symmetric => {
                SymmetricSplitSpline::of_checked(self.knots, &self.cached).full(t_ns)
            }
        }
    }

    /// Asks the motion along it, under this gravity in m/s².
    fn ask<R>(&self, gravity: f64, question: impl FnOnce(&dyn Trajectory<f64>) -> R) -> R {
        match self.form {
            FormName::Plain => {
                let curve = SplitSpline::of_checked(self.knots, &self.cached);
                question(&AlongSpline { curve, gravity })
            }
            FormName::Symmetric => {
                let curve = SymmetricSplitSpline::of_checked(self.knots, &self.cached);
                question(&AlongSpline { curve, gravity })
            }
        }
    }

    /// The motion at an instant of the poses' clock; every number is NaN outside the span.
    #[must_use]
    pub fn motion(&self, gravity: f64, t_ns: i64) -> Motion<f64> {
        self.ask(gravity, |along| along.at(t_ns))
    }

    /// What an IMU along it feels under this gravity in m/s², looked at in the middles of equal parts of the route, four
    /// to an interval if those are not too many.
    #[must_use]
    pub fn felt(&self, gravity: f64) -> FeltAlong {
        const MOST: u64 = 100_000;
        let (begin, end) = self.span_ns;
        let length = end.abs_diff(begin);
        let parts = (4 * length / u64::from(self.knots.step_ns())).clamp(1, MOST);
        let mut felt = FeltAlong::default();
        for part in 0..parts {
            let middle = u128::from(length) * u128::from(2 * part + 1) / u128::from(2 * parts);
            let t_ns = begin.saturating_add_unsigned(middle as u64);
            let Kinematics { specific_force, angular_rate, .. } =
                self.kinematics(gravity, t_ns, 0.0);
            for (mean, force) in felt.mean_specific_force.iter_mut().zip(specific_force) {
                *mean += force / parts as f64;
            }
            let largest = |[x, y, z]: [f64; 3], before: (f64, i64)| {
                let size = x.hypot(y).hypot(z);
                if size > before.0 { (size, t_ns) } else { before }
            };
            felt.largest_force = largest(specific_force, felt.largest_force);
            felt.largest_rate = largest(angular_rate, felt.largest_rate);
        }
        felt
    }

    /// What an ideal sensor feels `offset_s` after an instant of the poses' clock.
    #[must_use]
    pub fn kinematics(&self, gravity: f64, t_ns: i64, offset_s: f64) -> Kinematics<f64> {
        self.ask(gravity, |along| along.kinematics(t_ns, offset_s))
    }
}

/// What there is to tell of a fit in one sentence.
fn told(fit: &Fit, poses: usize) -> String {
    let distance = &fit.error;
    let noise = fit.jitter.map_or(String::new(), |jitter| {
        format!(
            "; what the poses jitter makes {:.2e} m/s² and {:.2e} rad/s rms an axis of it",
            jitter.acceleration, jitter.angular_rate
        )
    });
    format!(
        "a {} curve with knots {} s apart through {poses} poses, {:.2e} m and {:.2e}° rms from them{noise}",
        fit.form.name(),
        f64::from(fit.knots.step_ns()) / 1e9,
        distance.rms_position_m,
        distance.rms_rotation_rad.to_degrees(),
    )
}
