//! Where knots are: as asked, or as far apart as a wanted error allows.

use imu_core::spline::{Form, Knots};

use super::{Fit, FitError, Options, TimedPose, fit_every, through};

/// Candidates are this many to an octave, from all of the record down to the median time between poses.
const TO_AN_OCTAVE: i32 = 4;
/// More control points than this are refused: a fit of so many takes 1.7 GB and a minute.
const MOST_KNOTS: i128 = 5_000_000;

/// How far apart control points are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spacing {
    /// As far as the poses: a knot each where their stamps are equally spaced but for rounding, else the median time
    /// between them.
    AsPoses,
    /// As near to this far, ns, as equal parts of the whole are: poses at the beginning of an interval would decide
    /// little of it.
    Every(u32),
    /// As far as they can be, in equal parts of the whole, four candidates to an octave, so that no pose is further
    /// from the curve than this.
    Within {
        /// m.
        position_m: f64,
        /// rad.
        rotation_rad: f64,
    },
}

/// Why there are no such knots.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SpacingError {
    /// Longer than all of the poses.
    #[error("knots {0} s apart are further apart than the first pose is from the last ({1} s)")]
    TooLong(f64, f64),
    /// Poses further apart than knots can be.
    #[error("the poses are {0} s apart, and knots can be 4.29 s apart at most: give more poses")]
    TooRare(f64),
    /// Beyond the range of time.
    #[error("the first stamp, {0} ns, has no time before it; take an epoch nearer to the poses")]
    Epoch(i64),
    /// Too many to hold.
    #[error(
        "knots {0} s apart would be {1} control points for these poses; take them further apart"
    )]
    TooMany(f64, i128),
    /// No spacing down to that of the poses does it.
    #[error(
        "no curve stays within what was asked of every pose: with knots as close as the poses, {0} s apart, the \
         largest distances are {1} m and {2} rad; ask for that, or look for poses that jump"
    )]
    NotWithin(f64, f64, f64),
}

/// The fit of the spacing that was asked for.
pub(super) fn fitted<F: Form<f64>>(
    poses: &[TimedPose],
    options: &Options,
) -> Result<Fit, FitError> {
    let (position_m, rotation_rad) = match options.spacing {
        Spacing::AsPoses => return fit_every::<F>(poses, options, step_of_poses_ns(poses)?),
        Spacing::Every(step_ns) => return fit_every::<F>(poses, options, part_ns(poses, step_ns)),
        Spacing::Within { position_m, rotation_rad } => (position_m, rotation_rad),
    };
    let least = step_of_poses_ns(poses)?;
    let span = span_ns(poses);
    let octaves = (span as f64 / f64::from(least)).log2();
    for k in (1..=(octaves * f64::from(TO_AN_OCTAVE)) as i32).rev() {
        let step = f64::from(least) * (f64::from(k) / f64::from(TO_AN_OCTAVE)).exp2();
        // The last interval as long as the others: poses at the beginning of one decide little of it.
        let parts = (span as f64 / step).ceil() as u64;
        let Ok(step) = u32::try_from(span.div_ceil(parts.max(1))) else { continue };
        // Knots so far apart that neighbours turn by half a turn are just too far apart.
        match fit_every::<F>(poses, options, step) {
            Ok(fit) if is_within(&fit, position_m, rotation_rad) => return Ok(fit),
            Ok(_)
            | Err(
                FitError::Turn
                | FitError::Undecided(_)
                | FitError::Unsettled(_)
                | FitError::Numbers(_)
                | FitError::Spacing(_),
            ) => {}
            Err(other) => return Err(other),
        }
    }
    let fit = fit_every::<F>(poses, options, least)?;
    if is_within(&fit, position_m, rotation_rad) {
        return Ok(fit);
    }
    let error = &fit.error;
    Err(SpacingError::NotWithin(
        f64::from(least) / 1e9,
        error.largest_position_m,
        error.largest_rotation_rad,
    )
    .into())
}

fn is_within(fit: &Fit, position_m: f64, rotation_rad: f64) -> bool {
    fit.error.largest_position_m <= position_m && fit.error.largest_rotation_rad <= rotation_rad
}

/// The equal part of the whole that is nearest to this step; a step that cannot be stays as it is.
fn part_ns(poses: &[TimedPose], step_ns: u32) -> u32 {
    let (span, step) = (u128::from(span_ns(poses)), u128::from(step_ns));
    if step == 0 || step > span {
        return step_ns;
    }
    let parts = (span + step / 2) / step;
    u32::try_from(span.div_ceil(parts)).unwrap_or(step_ns)
}

/// The time between poses, ns: all of the record in equal parts where each pose is near the end of one, else the
/// median.
fn step_of_poses_ns(poses: &[TimedPose]) -> Result<u32, SpacingError> {
    let parts = (poses.len() as u64).saturating_sub(1).max(1);
    let equal = u32::try_from(span_ns(poses).div_ceil(parts)).ok();
    if let Some(step_ns) = equal.filter(|step_ns| through::are_near(poses, *step_ns)) {
        return Ok(step_ns);
    }
    let mut steps: Vec<_> =
        poses.windows(2).map(|two| two[1].stamp_ns.abs_diff(two[0].stamp_ns)).collect();
    let middle = steps.len() / 2;
    let (_, median, _) = steps.select_nth_unstable(middle);
    u32::try_from(*median).map_err(|_| SpacingError::TooRare(*median as f64 / 1e9))
}

fn span_ns(poses: &[TimedPose]) -> u64 {
    let (first, last) = ends_ns(poses);
    last.abs_diff(first)
}

/// The instants of the first pose and of the last, ns.
pub(super) fn ends_ns(poses: &[TimedPose]) -> (i64, i64) {
    let at = |pose: Option<&TimedPose>| pose.map_or(0, |pose| pose.stamp_ns);
    (at(poses.first()), at(poses.last()))
}

/// Knots this far apart whose curve spans the poses, from the first on.
pub(super) fn knots(poses: &[TimedPose], step_ns: u32) -> Result<Knots<f64>, FitError> {
    let (span, seconds) = (span_ns(poses), f64::from(step_ns) / 1e9);
    let (first, _) = ends_ns(poses);
    let too_long = SpacingError::TooLong(seconds, span as f64 / 1e9);
    if u64::from(step_ns) > span || step_ns == 0 {
        return Err(too_long.into());
    }
    let count = i128::from(span.div_ceil(u64::from(step_ns))) + 3;
    if count > MOST_KNOTS {
        return Err(SpacingError::TooMany(seconds, count).into());
    }
    let beyond = SpacingError::Epoch(first);
    let start = first.checked_sub(i64::from(step_ns)).ok_or(beyond)?;
    Knots::new(start, step_ns, count as usize).map_err(|_| beyond.into())
}
