//! Curves fitted to poses: what a user's own trajectory becomes before an IMU can follow it.
//!
//! Poses at equal steps are interpolated where a control point each is asked for; all else is a least-squares fit, with
//! knots at equal steps of the caller's choice, or as far apart as a wanted error allows, and as smooth as asked for.
//! A [`Fit`] knows how far it is from its poses, and what the poses' own jitter makes of rates and accelerations: a
//! second derivative multiplies noise by 1/h².
//!
//! ```
//! use imu_core::nalgebra::Vector3;
//! use imu_core::{se3::Pose, so3};
//! use imu_tools::spline::{FormName, Options, Spacing, TimedPose, fit};
//!
//! let poses: Vec<_> = (0..200_i64)
//!     .map(|k| {
//!         let t = 0.05 * k as f64;
//!         let pose = Pose::new(so3::exp(Vector3::new(0.0, 0.2 * t.sin(), 0.3 * t)), Vector3::new(t.sin(), t, 1.0))?;
//!         Ok(TimedPose { stamp_ns: 50_000_000 * k, pose })
//!     })
//!     .collect::<Result<_, imu_core::Error>>()?;
//! let within = Spacing::Within { position_m: 1e-3, rotation_rad: 1e-3 };
//! let fit = fit(&poses, &Options { form: Some(FormName::Symmetric), spacing: within, smoothing_s: 0.0 }).unwrap();
//! assert!(fit.error.largest_position_m < 1e-3 && fit.knots.step_ns() > 200_000_000);
//! # Ok::<(), imu_core::Error>(())
//! ```

pub mod asked;
mod banded;
mod bridge;
mod choices;
mod distance;
mod felt;
pub mod file;
mod fitted;
mod jitter;
mod least_squares;
mod order;
mod outline;
mod poses;
mod route;
pub mod sampled;
mod spacing;
mod through;

pub use choices::{Choice, choices};
pub use distance::Distance;
pub use felt::FeltAlong;
pub use fitted::Fitted;
pub use jitter::{Jitter, JitterOfCurve};
pub use outline::Outline;
pub use poses::Given;
pub use route::Route;
pub use spacing::Spacing;

use imu_core::se3::Pose;
use imu_core::so3;
use imu_core::spline::{Form, Knots, OneSided, TimeSymmetric};

use crate::recording::Note;
use least_squares::LeastSquares;

/// The fewest poses that make a cubic curve.
pub const FEWEST_POSES: usize = 4;

/// A pose and its instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedPose {
    /// Nanoseconds since any beginning; later than that of the pose before.
    pub stamp_ns: i64,
    /// `T_wb`.
    pub pose: Pose<f64>,
}

/// Which curve of attitudes runs through control points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormName {
    /// The cumulative product ([`OneSided`]): what other programs take control points for.
    Plain,
    /// The time-symmetric one ([`TimeSymmetric`]), of order 4.
    Symmetric,
}

impl FormName {
    /// `plain` or `symmetric`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Symmetric => "symmetric",
        }
    }
}

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Which curve; the plain one where nothing is said.
    pub form: Option<FormName>,
    /// Where its knots are.
    pub spacing: Spacing,
    /// τ in s: of what moves with 1/(2πτ) Hz half is left, of what moves twice as fast a 65th; 0: no smoothing beyond
    /// that of the knots' spacing.
    pub smoothing_s: f64,
}

/// Why there is no curve.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// A cubic needs four poses.
    #[error("a curve needs {FEWEST_POSES} poses or more, and there are {0}")]
    TooFew(usize),
    /// Stamps have to rise.
    #[error("pose {0} is not later than the one before")]
    Backwards(usize),
    /// No knots as asked.
    #[error("{0}")]
    Spacing(#[from] spacing::SpacingError),
    /// Neighbouring control points half a turn apart.
    #[error(
        "neighbouring control points of the curve would be half a turn apart: take knots closer to each other, or \
         look for poses that jump"
    )]
    Turn,
    /// Numbers beyond those of a curve.
    #[error(
        "the control points of the curve would be no poses on Earth ({0}): look for poses that jump"
    )]
    Numbers(imu_core::Error),
    /// Numbers beyond what can be factored.
    #[error(
        "the poses do not decide a curve with knots {0} s apart; take them further apart, or smooth less"
    )]
    Undecided(f64),
    /// Sweeps that do not settle.
    #[error(
        "the attitudes of a curve with knots {0} s apart do not settle: they turn too far from one knot to the next; \
         take knots closer to each other, or give more poses"
    )]
    Unsettled(f64),
}

impl From<imu_core::Error> for FitError {
    fn from(error: imu_core::Error) -> Self {
        match error {
            imu_core::Error::OutOfRange("turn between neighbours") => Self::Turn,
            other => Self::Numbers(other),
        }
    }
}

/// A curve, and how far it is from its poses.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Which curve.
    pub form: FormName,
    /// The instants of the control points.
    pub knots: Knots<f64>,
    /// The control points.
    pub control: Vec<Pose<f64>>,
    /// The first pose's instant and the last one's, ns: beyond them the curve is a guess.
    pub span_ns: (i64, i64),
    /// From the poses to the curve.
    pub error: Distance,
    /// Whether it was made to go through every pose, in place of near.
    pub interpolates: bool,
    /// Gaps between poses that are many knots long: crossed the straight way and by the shortest turn.
    pub bridged: usize,
    /// What the poses' jitter makes of it; `None` where there are too few poses to tell.
    pub jitter: Option<JitterOfCurve>,
}

impl Fit {
    /// What to tell of gaps that were bridged.
    fn gaps(&self) -> Option<Note> {
        let gaps = match self.bridged {
            0 => return None,
            1 => "a gap between poses is".to_owned(),
            count => format!("{count} gaps between poses are"),
        };
        let step_s = f64::from(self.knots.step_ns()) / 1e9;
        Some(Note::Warning(format!(
            "{gaps} longer than 16 knots {step_s} s apart: crossed straight on, at an even rate; wider knots would bend"
        )))
    }

    /// The curve itself, as a file of it would be read.
    ///
    /// # Errors
    /// As of [`Route::new`]; none of what [`fit`] made.
    pub fn route(&self) -> Result<Route, imu_core::Error> {
        let control: Vec<_> = self.control.iter().copied().map(file::settled).collect();
        Route::new(self.form, self.knots, self.span_ns, &control, Vec::new())
    }
}

/// Fits a curve to poses in the order of their stamps.
///
/// # Errors
/// A sentence for each in [`FitError`].
pub fn fit(poses: &[TimedPose], options: &Options) -> Result<Fit, FitError> {
    if poses.len() < FEWEST_POSES {
        return Err(FitError::TooFew(poses.len()));
    }
    if let Some(at) = poses.windows(2).position(|two| two[0].stamp_ns >= two[1].stamp_ns) {
        return Err(FitError::Backwards(at + 2));
    }
    match options.form.unwrap_or(FormName::Plain) {
        FormName::Plain => spacing::fitted::<OneSided>(poses, options),
        FormName::Symmetric => spacing::fitted::<TimeSymmetric>(poses, options),
    }
}

/// A fit with knots of this spacing.
fn fit_every<F: Form<f64>>(
    poses: &[TimedPose],
    options: &Options,
    step_ns: u32,
) -> Result<Fit, FitError> {
    let knots = spacing::knots(poses, step_ns)?;
    let through = match options.smoothing_s == 0.0 && through::are_near(poses, step_ns) {
        true => through::control::<F>(poses, &knots)?,
        false => None,
    };
    let interpolates = through.is_some();
    let undecided = FitError::Undecided(f64::from(step_ns) / 1e9);
    let held = bridge::bridged(poses, step_ns);
    let solver = LeastSquares::new(&held, &knots, options.smoothing_s);
    let control = if let Some(control) = through {
        control
    } else {
        let solver = solver.as_ref().ok_or(undecided)?;
        // From the first pose: the digits of a place far from home would be lost where little decides.
        let home = poses[0].pose.translation();
        let ways: Vec<_> = held.iter().map(|pose| pose.pose.translation() - home).collect();
        let places = solver.vectors(&ways).ok_or(undecided)?;
        let mut control = begin(poses, &knots)
            .zip(places)
            .map(|(attitude, place)| Pose::new(attitude, place + home))
            .collect::<Result<Vec<_>, _>>()?;
        if !solver.attitudes::<F>(&held, &knots, &mut control)? {
            return Err(FitError::Unsettled(f64::from(step_ns) / 1e9));
        }
        control
    };
    let error = Distance::of::<F>(poses, &knots, &control)?;
    let jitter = solver.and_then(|solver| Jitter::of(poses)?.on(&solver, poses, &held, &knots));
    let span_ns = spacing::ends_ns(poses);
    let bridged = if interpolates { 0 } else { bridge::count(poses, step_ns) };
    let form = options.form.unwrap_or(FormName::Plain);
    Ok(Fit { form, knots, control, span_ns, error, interpolates, bridged, jitter })
}

/// The attitude of the poses at every control point: between two of them along the shortest turn.
fn begin<'a>(
    poses: &'a [TimedPose],
    knots: &Knots<f64>,
) -> impl Iterator<Item = imu_core::nalgebra::Quaternion<f64>> + use<'a> {
    let (start_ns, step_ns) = (i128::from(knots.start_ns()), i128::from(knots.step_ns()));
    (0..knots.count() as i128).map(move |k| {
        let t = start_ns + k * step_ns;
        let after =
            poses.partition_point(|pose| i128::from(pose.stamp_ns) < t).clamp(1, poses.len() - 1);
        let (a, b) = (&poses[after - 1], &poses[after]);
        let share = (t - i128::from(a.stamp_ns)) as f64 / (b.stamp_ns - a.stamp_ns) as f64;
        let (from, to) = (a.pose.rotation(), b.pose.rotation());
        let turn = so3::log(&so3::product(&so3::inverse(&from), &to));
        so3::product(&from, &so3::exp(turn * share.clamp(0.0, 1.0)))
    })
}

#[cfg(test)]
mod tests;
