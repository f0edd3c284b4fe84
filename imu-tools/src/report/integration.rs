//! Dead reckoning for a person, a line for each rule, and for programs.

use std::fmt::Write as _;

use imu_core::nalgebra::Vector3;
use serde_json::{Value, json};

use super::table::duration;
use crate::integrate::{Begun, Errors, GravityFrom, Integration, Motion, Start};

/// For a person at a terminal.
#[must_use]
pub fn text(integration: &Integration) -> String {
    let Integration { path, steps, span_s, kind, begun, .. } = integration;
    let mut text = String::new();
    let _ = writeln!(text, "{path}: {steps} steps in {}, samples {kind}", duration(*span_s));
    let from = match (begun.from, &integration.truth) {
        (Start::Truth, Some(truth)) => format!("the truth, {truth}"),
        (Start::Truth, None) => "the truth".into(),
        (Start::Rest, _) => "rest".into(),
    };
    let gravity = match begun.gravity_from {
        GravityFrom::Given => "as given",
        GravityFrom::Rest => "as measured at rest",
        GravityFrom::Place => "of the place, on the turning Earth",
        GravityFrom::Usual => "unless --gravity or --latitude says another",
    };
    let _ = writeln!(text, "start: {from}; gravity {} m/s², {gravity}", number(begun.gravity));
    bias(&mut text, begun);
    text.push('\n');
    match integration.outcomes.iter().find_map(|outcome| outcome.errors.as_ref()) {
        Some(errors) => compare(&mut text, integration, errors.instants),
        None => last_states(&mut text, integration),
    }
    text
}

fn bias(text: &mut String, begun: &Begun) {
    let (rate, force) = (begun.bias.angular_rate(), begun.bias.specific_force());
    let list = |v: Vector3<f64>| v.iter().map(|x| number(*x)).collect::<Vec<_>>().join(", ");
    for (sensor, value, unit) in [("gyroscope", rate, "rad/s"), ("accelerometer", force, "m/s²")] {
        if value != Vector3::zeros() {
            let _ = writeln!(text, "bias taken off the {sensor}: {} {unit}", list(value));
        }
    }
}

/// Errors against the truth.
fn compare(text: &mut String, integration: &Integration, instants: u64) {
    let _ = writeln!(text, "Error against the truth at {instants} instants after the start");
    let _ = writeln!(
        text,
        "{:<20}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}",
        "", "position", "", "attitude", "", "velocity", "ATE"
    );
    let _ = writeln!(
        text,
        "{:<20}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}",
        "rule", "RMSE, m", "final, m", "RMSE, °", "final, °", "final, m/s", "RMSE, m"
    );
    for outcome in &integration.outcomes {
        let Some(e) = &outcome.errors else { continue };
        let _ = writeln!(
            text,
            "{:<20}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}",
            outcome.method.name(),
            number(e.position_rmse_m),
            number(e.position_final_m),
            number(e.rotation_rmse_rad.to_degrees()),
            number(e.rotation_final_rad.to_degrees()),
            e.velocity_final_m_s.map_or("-".into(), number),
            number(e.ate_m),
        );
    }
}

/// Where each rule ended, where that is all there is to say.
fn last_states(text: &mut String, integration: &Integration) {
    let _ = writeln!(text, "The last state");
    let _ = writeln!(
        text,
        "{:<20}{:>12}{:>12}{:>12}{:>12}{:>14}",
        "rule", "x, m", "y, m", "z, m", "speed, m/s", "from start, m"
    );
    for outcome in &integration.outcomes {
        let Motion { position_w: p, velocity_w, .. } = outcome.last;
        let length = |v: Vector3<f64>| v.dot(&v).sqrt();
        let _ = writeln!(
            text,
            "{:<20}{:>12}{:>12}{:>12}{:>12}{:>14}",
            outcome.method.name(),
            number(p.x),
            number(p.y),
            number(p.z),
            velocity_w.map_or("-".into(), |v| number(length(v))),
            number(length(p - integration.begun.motion.position_w)),
        );
    }
}

/// Five significant digits, six from 1 up; with an exponent where zeros would lead.
fn number(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 || !x.is_finite() {
        format!("{x}")
    } else if !(0.01..1e6).contains(&size) {
        format!("{x:.4e}")
    } else {
        let most = if size < 1.0 { 4.0 } else { 5.0 };
        let digits = (most - size.log10().floor()).max(0.0) as usize;
        format!("{x:.digits$}")
    }
}

/// For programs.
#[must_use]
pub fn json(integration: &Integration) -> Value {
    let Begun { from, stamp_ns, motion: start, bias, gravity, .. } = &integration.begun;
    let rules: Vec<Value> = integration
        .outcomes
        .iter()
        .map(|outcome| {
            json!({
                "rule": outcome.method.name(),
                "errors": outcome.errors.as_ref().map(errors),
                "last": motion(&outcome.last),
            })
        })
        .collect();
    json!({
        "recording": {
            "path": integration.path,
            "samples": integration.kind.name(),
            "steps": integration.steps,
            "span_s": integration.span_s,
            "remarks": integration.remarks,
            "warnings": integration.warnings,
        },
        "truth": integration.truth,
        "start": {
            "from": match from { Start::Truth => "truth", Start::Rest => "rest" },
            "stamp_ns": stamp_ns,
            "state": motion(start),
            "gyroscope_bias_rad_s": list(&bias.angular_rate()),
            "accelerometer_bias_m_s2": list(&bias.specific_force()),
            "gravity_m_s2": gravity,
        },
        "rules": rules,
    })
}

fn errors(errors: &Errors) -> Value {
    json!({
        "instants": errors.instants,
        "position_rmse_m": errors.position_rmse_m,
        "position_final_m": errors.position_final_m,
        "rotation_rmse_deg": errors.rotation_rmse_rad.to_degrees(),
        "rotation_final_deg": errors.rotation_final_rad.to_degrees(),
        "velocity_final_m_s": errors.velocity_final_m_s,
        "ate_m": errors.ate_m,
    })
}

fn motion(motion: &Motion) -> Value {
    let q = motion.attitude_wb;
    json!({
        "position_m": list(&motion.position_w),
        "attitude_wxyz": [q.w, q.i, q.j, q.k],
        "velocity_m_s": motion.velocity_w.as_ref().map(list),
    })
}

fn list(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z]
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn five_digits() {
        assert_eq!(number(0.482_31), "0.48231");
        assert_eq!(number(1.042_29), "1.04229");
        assert_eq!(number(7.4776e-4), "7.4776e-4");
        assert_eq!(number(0.0), "0");
        assert_eq!(number(-123_456.7), "-123457");
    }
}
