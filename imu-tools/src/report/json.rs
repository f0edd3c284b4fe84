//! The result for programs, one JSON object.
//!
//! A parameter is `{"observable":true,"value","sd","low90","high90","unit"}`, or where the record
//! cannot show it `{"observable":false,"upper90","may_show_from_s","unit"}`; a sensor that the
//! recording does not have, a term that it did not ask for, and a number that is not known, are `null`.

use imu_core::allan::Parameter;
use serde_json::{Value, json};

use super::Quantity;
use crate::calibrate::filter::FilterValue;
use crate::calibrate::{AxisNoise, Calibration, SensorKind, SensorNoise};
use crate::recording::ClockStep;

/// Names of the axes, in order.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// The whole calibration.
#[must_use]
pub fn calibration(calibration: &Calibration) -> Value {
    json!({
        "recording": {
            "path": calibration.path,
            "paths": calibration.paths,
            "span_s": calibration.span_s,
            "remarks": calibration.remarks,
            "warnings": calibration.warnings,
        },
        "gyroscope": calibration.gyroscope.as_ref().map(sensor),
        "accelerometer": calibration.accelerometer.as_ref().map(sensor),
    })
}

fn sensor(sensor: &SensorNoise) -> Value {
    let stamps = &sensor.stamps;
    let gaps: Vec<_> =
        stamps.gaps.iter().map(|g| json!({"at_s": g.at_s, "missing": g.missing})).collect();
    let axes: Vec<_> = AXES
        .iter()
        .zip(&sensor.axes)
        .map(|(name, axis)| {
            let mut value = noise(axis, sensor.kind);
            if let Value::Object(fields) = &mut value {
                fields.insert("axis".into(), json!(name));
            }
            value
        })
        .collect();
    let deviation: Vec<_> = sensor
        .deviation
        .iter()
        .map(|d| {
            json!({
                "tau_s": d.tau_s,
                "adev": d.octaves.map(|o| (o.differences > 0).then(|| o.deviation())),
                "edf": d.edf,
            })
        })
        .collect();
    let disturbed: Vec<_> =
        sensor.disturbed.iter().map(|s| json!({"from_s": s.from_s, "to_s": s.to_s})).collect();
    let steps = |steps: &[ClockStep]| -> Vec<_> {
        steps.iter().map(|s| json!({"at_s": s.at_s, "by_s": s.by_s})).collect()
    };
    let (clock_steps, breaks) = (steps(&stamps.clock_steps), steps(&stamps.breaks));
    let checks = &sensor.checks;
    json!({
        "topic": sensor.topic,
        "samples": stamps.samples,
        "rate_hz": stamps.rate_hz,
        "span_s": stamps.span_s,
        "gaps": gaps,
        "gap_count": stamps.gap_count,
        "missing": stamps.missing,
        "duplicates": stamps.duplicates,
        "backward": stamps.backward,
        "restarts": stamps.restarts,
        "breaks": breaks,
        "non_finite": sensor.rejected,
        "clock_steps": clock_steps,
        "rate_sd_hz": stamps.rate_sd_hz,
        "jitter_s": stamps.jitter_s,
        "disturbed": disturbed,
        "warm_up_s": sensor.warm_up_s,
        "ramp_per_s": sensor.ramp,
        "checks": {
            "range": checks.range.map(|(low, high)| [low, high]),
            "step": checks.step,
            "stuck": checks.stuck,
            "saturated": checks.saturated,
            "held": checks.held,
            "longest_hold": checks.longest_hold,
        },
        "mean": sensor.mean,
        "tau_used_s": sensor.tau_used_s.map(|(first, last)| [first, last]),
        "axes": axes,
        "pooled": noise(&sensor.pooled, sensor.kind),
        "for_filters": {
            "noise_density": FilterValue::noise_density(sensor).map(|found| found.value),
            "random_walk": FilterValue::random_walk(sensor).map(|found| found.value),
        },
        "deviation": deviation,
    })
}

fn noise(noise: &AxisNoise, kind: SensorKind) -> Value {
    json!({
        "noise_density": parameter(noise.noise_density, Quantity::NoiseDensity(kind)),
        "random_walk": parameter(noise.random_walk, Quantity::RandomWalk(kind)),
        "bias_instability": asked(noise.bias_instability, Quantity::BiasInstability(kind)),
        "quantisation": asked(noise.quantisation, Quantity::Quantisation(kind)),
        "rate_ramp": asked(noise.rate_ramp, Quantity::RateRamp(kind)),
    })
}

/// A parameter that is `null` where the record did not ask for it.
fn asked(asked: Option<Parameter>, quantity: Quantity) -> Value {
    asked.map_or(Value::Null, |found| parameter(found, quantity))
}

fn parameter(parameter: Parameter, quantity: Quantity) -> Value {
    let unit = quantity.unit();
    match parameter {
        Parameter::Observable { value, sd, low90, high90 } => json!({
            "observable": true, "value": value, "sd": sd, "low90": low90, "high90": high90,
            "unit": unit,
        }),
        // An infinite bound becomes null.
        Parameter::NotObservable { upper90, record_at_least_s } => json!({
            "observable": false, "upper90": upper90, "may_show_from_s": record_at_least_s,
            "unit": unit,
        }),
    }
}
