//! What other choices would make of the same poses: wider knots, or smoothing.

use std::f64::consts::TAU;

use super::{Fit, Options, Spacing, TimedPose, fit};

/// Half is left of what moves with so many times the rate of the knots.
const SMOOTHER: [f64; 2] = [0.25, 0.125];

/// A fit, and what was asked for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Half is left of what moves with so many Hz; none: not smoothed.
    pub smooth_hz: Option<f64>,
    /// What came of it.
    pub fit: Fit,
}

/// The fit that was made, knots twice and four times as far apart, and two degrees of smoothing: those of which a
/// curve comes.
#[must_use]
pub fn choices(poses: &[TimedPose], options: &Options, made: &Fit) -> Vec<Choice> {
    let hertz = |smoothing_s: f64| (smoothing_s > 0.0).then(|| 1.0 / (TAU * smoothing_s));
    let step_ns = made.knots.step_ns();
    let wider = [2, 4].map(|times| (step_ns.checked_mul(times), options.smoothing_s));
    let smoother = SMOOTHER.map(|part| (Some(step_ns), 1.0 / (TAU * part * made.knots.rate())));
    let others = wider.into_iter().chain(smoother).filter_map(|(step_ns, smoothing_s)| {
        let spacing = Spacing::Every(step_ns?);
        let fit = fit(poses, &Options { spacing, smoothing_s, ..*options }).ok()?;
        Some(Choice { smooth_hz: hertz(smoothing_s), fit })
    });
    let first = Choice { smooth_hz: hertz(options.smoothing_s), fit: made.clone() };
    std::iter::once(first).chain(others).collect()
}
