//! What a recording holds and what is wrong with it, for a person and for a program.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::json::AXES;
use super::table::{duration, short};
use crate::calibrate::{Examined, SensorKind, SensorNoise, gravity};
use crate::recording::Stream;

/// For a person at a terminal.
#[must_use]
pub fn text(examined: &Examined) -> String {
    let mut text = String::new();
    let calibration = &examined.calibration;
    let _ = writeln!(text, "{}: {}", calibration.path, duration(calibration.span_s));
    for remark in &calibration.remarks {
        let _ = writeln!(text, "  {remark}");
    }
    streams(&mut text, &examined.streams);
    for sensor in [&calibration.gyroscope, &calibration.accelerometer].into_iter().flatten() {
        self::sensor(&mut text, sensor);
    }
    if let Some(range) = examined.temperature {
        let _ = writeln!(
            text,
            "\ntemperature: {:.2} to {:.2} °C, {:.2} at first and {:.2} at last ({} readings)",
            range.low, range.high, range.first, range.last, range.readings
        );
    }
    let refusal = examined.refusal.as_ref().map(ToString::to_string);
    let wrong: Vec<&String> = refusal.iter().chain(&calibration.warnings).collect();
    if wrong.is_empty() {
        let _ = writeln!(text, "\nNothing is wrong with it that can be seen.");
    } else {
        let _ = writeln!(text, "\nWhat is wrong with it:");
        for sentence in wrong {
            let _ = writeln!(text, "  - {sentence}");
        }
    }
    text
}

fn streams(text: &mut String, streams: &[Stream]) {
    let longest = |of: fn(&Stream) -> &str| {
        streams.iter().map(|stream| of(stream).chars().count()).max().unwrap_or(0)
    };
    let (names, types) = (longest(|s| &s.name), longest(|s| &s.type_name));
    for Stream { name, type_name, messages, used } in streams {
        let used = if *used { "  used" } else { "" };
        let _ = writeln!(text, "  {name:names$}  {type_name:types$}  {messages:>10}{used}");
    }
}

fn sensor(text: &mut String, sensor: &SensorNoise) {
    let stamps = &sensor.stamps;
    let unit = unit(sensor.kind);
    let _ = writeln!(text, "\n{} ({})", sensor.kind.name(), sensor.topic);
    let mut row = |name: &str, what: String| {
        let _ = writeln!(text, "  {name:<16}{what}");
    };
    row("samples", format!("{} in {}", stamps.samples, duration(stamps.span_s)));
    let error = match stamps.rate_sd_hz {
        sd if sd > 0.0 => format!(" ± {sd:.1e}"),
        _ => String::new(),
    };
    row(
        "rate",
        match stamps.rate_hz {
            rate if rate > 0.0 => format!("{rate:.6}{error} Hz"),
            _ => "unknown: no two stamps differ".into(),
        },
    );
    row("jitter", format!("{} ms rms", short(1e3 * stamps.jitter_s)));
    row("gaps", format!("{}, samples missing: {}", stamps.gap_count, stamps.missing));
    row(
        "stamps",
        format!(
            "duplicated: {}, backwards: {}, clock steps: {}, restarts: {}",
            stamps.duplicates,
            stamps.backward,
            stamps.clock_steps.len(),
            stamps.restarts
        ),
    );
    let checks = &sensor.checks;
    let any = sensor.rejected < stamps.samples;
    for (k, axis) in AXES.iter().enumerate().filter(|_| any) {
        let (low, high) = checks.range[k];
        let step = match checks.step[k] {
            Some(step) => format!(", in steps of {step:.3e}"),
            None => String::new(),
        };
        let [mean, low, high] = [sensor.mean[k], low, high].map(decimal);
        row(axis, format!("mean {mean} {unit}, from {low} to {high}{step}"));
    }
    if !any {
        row("values", "none is finite, or small enough for a sensor".into());
    } else if sensor.kind == SensorKind::Accelerometer {
        let norm = decimal(gravity::norm(sensor.mean));
        row("norm of mean", format!("{norm} m/s² (gravity is 9.78 to 9.83)"));
    }
    let constant = checks.stuck == [true; 3];
    row(
        "held samples",
        if constant {
            "all: no axis ever changes".into()
        } else {
            format!("{}, longest run {}", checks.held, checks.longest_hold)
        },
    );
    row("not finite", format!("{} (or absurdly large)", sensor.rejected));
    if !sensor.disturbed.is_empty() {
        let total: f64 = sensor.disturbed.iter().map(|s| s.to_s - s.from_s).sum();
        row("not at rest", format!("{} in {} stretches", duration(total), sensor.disturbed.len()));
    }
    if let Some(contradiction) = sensor.contradiction {
        let longest = sensor.deviation.get(contradiction.octave).map_or(0.0, |d| d.tau_s);
        row("low-pass", format!("or vibration, seen up to τ = {} s", short(longest)));
    }
}

/// Five decimals where they show the number, an exponent where they do not.
fn decimal(x: f64) -> String {
    let shown = x == 0.0 || (1e-5..1e7).contains(&x.abs());
    if shown { format!("{x:.5}") } else { format!("{x:.5e}") }
}

fn unit(kind: SensorKind) -> &'static str {
    match kind {
        SensorKind::Gyroscope => "rad/s",
        SensorKind::Accelerometer => "m/s²",
    }
}

/// For a program: the object of `imu calibrate --json`, and what is only here.
#[must_use]
pub fn json(examined: &Examined) -> Value {
    let mut value = super::json::calibration(&examined.calibration);
    let streams: Vec<_> = examined
        .streams
        .iter()
        .map(|s| {
            json!({"name": s.name, "type": s.type_name, "messages": s.messages, "used": s.used})
        })
        .collect();
    let temperature = examined.temperature.map(|range| {
        json!({
            "first": range.first, "last": range.last, "low": range.low, "high": range.high,
            "readings": range.readings, "unit": "°C",
        })
    });
    if let Value::Object(fields) = &mut value {
        fields.insert("streams".into(), json!(streams));
        fields.insert("temperature".into(), json!(temperature));
        fields.insert("refusal".into(), json!(examined.refusal.as_ref().map(ToString::to_string)));
    }
    value
}

#[cfg(test)]
mod tests {
    use super::decimal;

    #[test]
    fn numbers_of_any_size_are_short() {
        for (x, shown) in [
            (0.0, "0.00000"),
            (-9.806_65, "-9.80665"),
            (3.2e-9, "3.20000e-9"),
            (1e308, "1.00000e308"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(decimal(x), shown);
        }
    }
}
