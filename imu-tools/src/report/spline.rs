//! A curve through poses for a person and for programs.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::table::{duration, short};
use crate::recording::Note;
use crate::spline::{Choice, Distance, Fit, Fitted};

/// For a person at a terminal.
#[must_use]
pub fn text(fitted: &Fitted) -> String {
    let Fitted { path, poses, span_s, fit, choices, .. } = fitted;
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{path}: {} poses in {}, {} a second",
        poses.len(),
        if *span_s < 60.0 { format!("{span_s:.2} s") } else { duration(*span_s) },
        short((poses.len() as f64 - 1.0) / span_s)
    );
    let smooth = choices.first().and_then(|made| made.smooth_hz);
    let how = match (fit.interpolates, smooth) {
        (true, _) => "through every pose".to_owned(),
        (false, None) => "by least squares".to_owned(),
        (false, Some(hz)) => format!("by least squares, smoothed at {} Hz", short(hz)),
    };
    let _ = writeln!(
        text,
        "curve: {}, {} control points {} s apart, {how}\n",
        fit.form.name(),
        fit.control.len(),
        short(step_s(fit)),
    );
    distance(&mut text, fitted);
    if let Some(jitter) = fit.jitter {
        let _ = writeln!(
            text,
            "\nThe poses jitter by {} mm and {}° rms an axis, and the curve makes of that\n\
             {} m/s² of acceleration and {} rad/s of angular rate",
            short(1e3 * jitter.poses.position_m),
            short(jitter.poses.rotation_rad.to_degrees()),
            short(jitter.acceleration),
            short(jitter.angular_rate),
        );
    }
    let [x, y, z] = fitted.mean_force.map(|force| format!("{force:.2}"));
    let _ = writeln!(
        text,
        "An accelerometer along it would read {x}, {y}, {z} m/s² on average: is that how it sits?"
    );
    others(&mut text, choices);
    text
}

fn step_s(fit: &Fit) -> f64 {
    f64::from(fit.knots.step_ns()) / 1e9
}

fn distance(text: &mut String, fitted: &Fitted) {
    let Distance {
        rms_position_m,
        largest_position_m,
        largest_position_at_ns,
        rms_rotation_rad,
        largest_rotation_rad,
        largest_rotation_at_ns,
    } = fitted.fit.error;
    let begin = fitted.poses.first().map_or(0, |pose| pose.stamp_ns);
    let at = |stamp_ns: i64| format!("{:.3} s", stamp_ns.abs_diff(begin) as f64 / 1e9);
    let _ = writeln!(
        text,
        "{:<28}{:>14}{:>14}{:>16}",
        "From poses to the curve", "rms", "largest", "after"
    );
    for (what, rms, largest, at_ns) in [
        ("  position, m", rms_position_m, largest_position_m, largest_position_at_ns),
        (
            "  attitude, °",
            rms_rotation_rad.to_degrees(),
            largest_rotation_rad.to_degrees(),
            largest_rotation_at_ns,
        ),
    ] {
        let (rms, largest) = (short(rms), short(largest));
        let _ = writeln!(text, "{what:<28}{rms:>14}{largest:>14}{:>16}", at(at_ns));
    }
}

/// What else there is to choose from, and at what price.
fn others(text: &mut String, choices: &[Choice]) {
    let _ = writeln!(
        text,
        "\nWider knots (--spacing) or smoothing (--smooth) take noise out, and the curve from the poses:\n\
         {:>9}{:>12}{:>14}{:>14}{:>14}{:>14}{:>14}",
        "knots, s", "smooth, Hz", "rms, m", "largest, m", "rms, °", "noise, m/s²", "noise, rad/s"
    );
    for Choice { smooth_hz, fit } in choices {
        let noise = |of: fn(&crate::spline::JitterOfCurve) -> f64| {
            fit.jitter.as_ref().map_or("-".into(), |jitter| short(of(jitter)))
        };
        let _ = writeln!(
            text,
            "{:>9}{:>12}{:>14}{:>14}{:>14}{:>14}{:>14}",
            short(step_s(fit)),
            smooth_hz.map_or("-".into(), short),
            short(fit.error.rms_position_m),
            short(fit.error.largest_position_m),
            short(fit.error.rms_rotation_rad.to_degrees()),
            noise(|jitter| jitter.acceleration),
            noise(|jitter| jitter.angular_rate),
        );
    }
}

/// For programs.
#[must_use]
pub fn json(fitted: &Fitted) -> Value {
    let of = |warning: bool| -> Vec<&str> {
        let told = fitted.notes.iter().filter_map(|note| match note {
            Note::Warning(text) if warning => Some(text.as_str()),
            Note::Info(text) if !warning => Some(text.as_str()),
            _ => None,
        });
        told.collect()
    };
    let (first, last) = fitted.fit.span_ns;
    json!({
        "poses": {
            "path": fitted.path,
            "count": fitted.poses.len(),
            "span_s": fitted.span_s,
            "mean_specific_force_m_s2": fitted.mean_force,
            "remarks": of(false),
            "warnings": of(true),
        },
        "curve": {
            "form": fitted.fit.form.name(),
            "control_points": fitted.fit.control.len(),
            "from_ns": first,
            "to_ns": last,
            "interpolates": fitted.fit.interpolates,
            "bridged_gaps": fitted.fit.bridged,
        },
        // The one that was made, then others.
        "choices": fitted.choices.iter().map(choice).collect::<Vec<_>>(),
    })
}

fn choice(choice: &Choice) -> Value {
    let Choice { smooth_hz, fit } = choice;
    let error = &fit.error;
    json!({
        "step_s": step_s(fit),
        "smooth_hz": smooth_hz,
        "position_rms_m": error.rms_position_m,
        "position_largest_m": error.largest_position_m,
        "position_largest_at_ns": error.largest_position_at_ns,
        "rotation_rms_deg": error.rms_rotation_rad.to_degrees(),
        "rotation_largest_deg": error.largest_rotation_rad.to_degrees(),
        "rotation_largest_at_ns": error.largest_rotation_at_ns,
        "jitter": fit.jitter.map(|jitter| json!({
            "position_m": jitter.poses.position_m,
            "rotation_deg": jitter.poses.rotation_rad.to_degrees(),
            "acceleration_m_s2": jitter.acceleration,
            "angular_rate_rad_s": jitter.angular_rate,
        })),
    })
}
