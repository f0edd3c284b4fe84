//! The sentences of the report, a section a file.

mod filters;
mod next_time;
mod numbers;
mod plots;
mod verdict;

pub(super) use filters::{ADVICE, HERE, factors, found};
pub(super) use next_time::next_time;
pub(super) use numbers::{lowest_point, meaning, row_of_all, sampling};
pub(super) use plots::{ALLAN, RESIDUAL, SIGNAL};
pub(super) use verdict::{overall, verdict};

use super::span;
use crate::calibrate::{Calibration, SensorNoise};
use crate::report::json::AXES;
use crate::report::table::short;

/// What the words mean that all sections use.
pub(super) const TERMS: &str = "An IMU (inertial measurement unit) is a gyroscope, which measures the rate of turning in rad/s, and \
     an accelerometer, which measures acceleration, with gravity, in m/s². N is the white noise of either, per √Hz; K \
     is how its bias (the slowly changing error) walks, per second and √Hz. Every ± and interval is of 90 %: nine of \
     ten hold the true value.";

/// The first letter in upper case.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |c| c.to_uppercase().chain(letters).collect())
}

/// What was recorded.
pub(super) fn recorded(calibration: &Calibration) -> String {
    format!("{}, {} long.", calibration.path, span(calibration.span_s))
}

/// Half an interval over its value.
fn percent(half: f64) -> String {
    format!(
        "±{} %",
        short((1000.0 * half).round().max(1.0) / 10.0).trim_end_matches('0').trim_end_matches('.')
    )
}

/// A share of samples that are missing, in per cent; nothing where there are none.
fn lost(sensor: &SensorNoise) -> Option<String> {
    let stamps = &sensor.stamps;
    let all = stamps.samples + stamps.missing;
    (stamps.missing > 0).then(|| {
        let share = 100.0 * stamps.missing as f64 / all as f64;
        if share < 0.01 { "less than 0.01 %".into() } else { format!("{share:.2} %") }
    })
}

/// Names in a row: `x`, `x and y`, `x, y and z`.
fn list(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The axes for which something holds: `axis x`, `axes x and y`; `None` for no axis.
fn axes(holds: [bool; 3]) -> Option<String> {
    let names: Vec<&str> =
        AXES.into_iter().zip(holds).filter(|(_, holds)| *holds).map(|(axis, _)| axis).collect();
    match names.len() {
        0 => None,
        1 => Some(format!("axis {}", list(&names))),
        _ => Some(format!("axes {}", list(&names))),
    }
}
