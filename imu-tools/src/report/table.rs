//! The result for a person at a terminal.

use std::fmt::Write as _;

use imu_core::allan::Parameter;

use super::Quantity;
use super::json::AXES;
use crate::calibrate::verdict::{Known, NextRecord, interval};
use crate::calibrate::{AxisNoise, Calibration, SensorNoise};
use crate::scene::display_duration;

/// What was recorded, then N and K, and what else was fitted, of every axis and of all together, each with its
/// 90 % interval and its datasheet twin.
#[must_use]
pub fn calibration(calibration: &Calibration) -> String {
    let mut text = String::new();
    for sensor in [&calibration.gyroscope, &calibration.accelerometer].into_iter().flatten() {
        self::sensor(&mut text, sensor);
        text.push('\n');
    }
    text
}

fn sensor(text: &mut String, sensor: &SensorNoise) {
    let stamps = &sensor.stamps;
    let gaps = match stamps.gap_count {
        0 => "no gaps".to_owned(),
        n => format!("gaps: {n} (samples missing: {})", stamps.missing),
    };
    let _ = writeln!(
        text,
        "{} {}: {} samples at {:.3} Hz, {}, {gaps}",
        sensor.kind.name(),
        sensor.topic,
        stamps.samples,
        stamps.rate_hz,
        duration(stamps.span_s),
    );
    if let Some((first, last)) = sensor.tau_used_s {
        let _ = writeln!(text, "  averaging times used: {} to {} s", short(first), short(last));
    }
    for (quantity, of) in Quantity::fitted(sensor) {
        block(text, sensor, quantity, of);
    }
    if let Some(enough_s) = NextRecord::enough_s(sensor) {
        let within = 100.0 * Known::ENOUGH;
        let enough = duration(enough_s);
        let _ = writeln!(text, "  for K of all axes to ±{within:.0} % record at least {enough}");
    }
    if let NextRecord::AtLeast(wanted_s) = NextRecord::of(sensor) {
        let _ = writeln!(
            text,
            "  for K of each axis to ±{:.0} % record at least {}",
            100.0 * NextRecord::WITHIN,
            duration(wanted_s)
        );
    }
}

fn block(
    text: &mut String,
    sensor: &SensorNoise,
    quantity: Quantity,
    of: impl Fn(&AxisNoise) -> Option<Parameter>,
) {
    let twin = quantity.twin();
    let _ = writeln!(
        text,
        "  {:<28}{:>12}    90 % interval                 {}",
        quantity.name(),
        quantity.unit(),
        twin.unit
    );
    let rows = AXES.iter().zip(&sensor.axes).chain([(&"all axes", &sensor.pooled)]);
    for (name, axis) in rows {
        let Some(parameter) = of(axis) else {
            let _ = writeln!(text, "    {name:<26}the record does not ask for it");
            continue;
        };
        let _ = match parameter {
            Parameter::NotObservable { upper90, .. } if upper90.is_infinite() => {
                writeln!(text, "    {name:<26}not observable: nothing is known of it")
            }
            Parameter::Observable { value, high90, .. } if high90.is_infinite() => writeln!(
                text,
                "    {name:<26}{value:>12.4e}    a reading, no interval        {}",
                short(value * twin.per_si)
            ),
            Parameter::Observable { value, low90, high90, .. } => {
                let (low, high) = interval(value, low90, high90);
                let low = if low > 0.0 { format!("{low:.4e}") } else { "0".into() };
                let between = format!("{low} to {high:.4e}");
                let twin = short(value * twin.per_si);
                writeln!(text, "    {name:<26}{value:>12.4e}    {between:<22}      {twin}")
            }
            Parameter::NotObservable { upper90, .. } => writeln!(
                text,
                "    {name:<26}not observable: below {upper90:.2e} ({} {})",
                short(upper90 * twin.per_si),
                twin.unit
            ),
        };
    }
}

/// A time as words, to the second.
pub(crate) fn duration(seconds: f64) -> String {
    display_duration((seconds.clamp(0.0, 1e9).round() * 1e9) as u64)
}

/// Four significant digits without an exponent, where that is short.
pub(super) fn short(x: f64) -> String {
    if !x.is_finite() || x == 0.0 {
        return format!("{x}");
    }
    let digits = (3.0 - x.abs().log10().floor()).clamp(0.0, 12.0) as usize;
    if x.abs() >= 1e-4 && x.abs() < 1e7 { format!("{x:.digits$}") } else { format!("{x:.3e}") }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn four_digits() {
        assert_eq!(short(51.5662), "51.57");
        assert_eq!(short(0.005), "0.005000");
        assert_eq!(short(1234.5), "1234");
        assert_eq!(short(3.2e-9), "3.200e-9");
        assert_eq!(short(f64::INFINITY), "inf");
    }
}
