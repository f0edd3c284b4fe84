//! `imu.yaml`: the six keys that Kalibr reads, in continuous-time units, with their intervals.

use std::fmt::Write as _;

use imu_core::allan::Parameter;

use super::table::{duration, short};
use super::{Quantity, harmless};
use crate::calibrate::filter::{Basis, Factors, FilterValue};
use crate::calibrate::verdict::{NextRecord, interval};
use crate::calibrate::{Calibration, SensorKind, SensorNoise};

/// The file, all axes of a sensor pooled. A parameter that the record does not show well enough has an upper
/// 90 % bound of all axes for a value (Kalibr wants a number above zero), and says so; where there is a bias
/// instability, the random walk covers it, because Kalibr has no term for it ([`FilterValue`]).
#[must_use]
pub fn kalibr(calibration: &Calibration) -> String {
    let mut text = format!(
        "# IMU noise for Kalibr, estimated from {} ({:.0} s).\n\
         # Continuous-time densities; x, y and z together. Intervals are of 90 % confidence.\n\
         # As measured, not multiplied: for a filter in motion make them larger.\n",
        harmless(&calibration.path, ""),
        calibration.span_s
    );
    text.push_str(&warnings(calibration));
    text.push('\n');
    let sensors = [
        (SensorKind::Accelerometer, &calibration.accelerometer),
        (SensorKind::Gyroscope, &calibration.gyroscope),
    ];
    for (kind, sensor) in sensors {
        match sensor {
            Some(sensor) => lines(&mut text, kind, sensor),
            None => {
                let _ = writeln!(text, "# No {} in the recording.", kind.name());
            }
        }
    }
    if let Some(sensor) = calibration.gyroscope.as_ref().or(calibration.accelerometer.as_ref()) {
        let _ = writeln!(text, "\nrostopic: {}", topic(sensor));
        let _ = writeln!(text, "update_rate: {:.6}  # Hz", sensor.stamps.rate_hz);
    }
    text
}

/// The warnings of a calibration as comments: they touch whatever stands below them.
pub(super) fn warnings(calibration: &Calibration) -> String {
    let lines = calibration.warnings.iter();
    lines.map(|warning| format!("# Warning: {}\n", harmless(warning, ""))).collect()
}

/// The topic of a sensor in quotes; where the recording names none, `/imu0` and a remark.
pub(super) fn topic(sensor: &SensorNoise) -> String {
    // The columns of a CSV are no topic: no topic has a space in its name.
    match sensor.topic.contains(' ') {
        true => format!("{}  # the recording names no topic: put yours here", quoted("/imu0")),
        false => quoted(&sensor.topic),
    }
}

fn lines(text: &mut String, kind: SensorKind, sensor: &SensorNoise) {
    let name = kind.name();
    let pooled = &sensor.pooled;
    for (key, quantity, parameter, value) in [
        (
            "noise_density",
            Quantity::NoiseDensity(kind),
            pooled.noise_density,
            FilterValue::noise_density(sensor),
        ),
        (
            "random_walk",
            Quantity::RandomWalk(kind),
            pooled.random_walk,
            FilterValue::random_walk(sensor),
        ),
    ] {
        let unit = quantity.unit();
        let Some(FilterValue { value, basis }) = value else {
            let _ = writeln!(text, "# {name}_{key}: nothing is known of it ({unit})");
            continue;
        };
        let remark = match basis {
            Basis::Estimate => between(quantity, parameter),
            Basis::Reading => ", a reading without an interval".into(),
            Basis::CoversFlicker => format!(
                "; covers bias instability too, which Kalibr has no term for: as far in {:.0} s as B and K \
                 below go together",
                Factors::OVER_S
            ),
            Basis::UpperBound => {
                let next = NextRecord::enough_s(sensor).map_or_else(String::new, |enough_s| {
                    format!("; record at least {}", duration(enough_s))
                });
                format!(
                    "; NOT KNOWN WELL: the largest upper end of x, y, z and all axes together{next}"
                )
            }
        };
        let _ = writeln!(text, "{name}_{key}: {value:.6e}  # {unit}{remark}");
        if matches!(basis, Basis::CoversFlicker | Basis::UpperBound) {
            let _ = writeln!(text, "# {name} {}: {}", quantity.name(), known(quantity, parameter));
        }
    }
    // What Kalibr has no key for.
    for (quantity, of) in Quantity::all(kind).into_iter().skip(2) {
        if let Some(parameter) = of(pooled) {
            let _ = writeln!(text, "# {name} {}: {}", quantity.name(), known(quantity, parameter));
        }
    }
}

/// The interval of a value, and the value in the unit of datasheets.
fn between(quantity: Quantity, parameter: Parameter) -> String {
    let Parameter::Observable { value, low90, high90, .. } = parameter else {
        return String::new();
    };
    let (low, high) = interval(value, low90, high90);
    let twin = quantity.twin();
    let low = if low > 0.0 { format!("{low:.3e}") } else { "0".into() };
    format!(", {low} to {high:.3e}; {} {}", short(value * twin.per_si), twin.unit)
}

/// A parameter in a comment: value, unit, interval.
fn known(quantity: Quantity, parameter: Parameter) -> String {
    let unit = quantity.unit();
    match parameter {
        Parameter::Observable { value, .. } => {
            format!("{value:.3e} {unit}{}", between(quantity, parameter))
        }
        Parameter::NotObservable { upper90, .. } if upper90.is_finite() => {
            format!("all axes together do not show it, and are below {upper90:.3e} {unit}")
        }
        Parameter::NotObservable { .. } => "nothing is known of it".into(),
    }
}

/// A YAML string, in which `\u000a` is the character itself: a topic is a file's word, and may hold anything.
fn quoted(text: &str) -> String {
    let text = text.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{}\"", harmless(&text, ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_cannot_break_out_of_their_quotes() {
        assert_eq!(quoted("/imu\"\n: x\\"), "\"/imu\\\"\\u000a: x\\\\\"");
    }
}
