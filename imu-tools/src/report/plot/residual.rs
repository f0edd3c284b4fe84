//! What the fit leaves: each deviation over what the fitted terms say it should be.

use imu_core::allan::interval;

use super::allan::Curve;
use super::chart::{Chart, Drawn};
use super::scale::Scale;
use super::{AXES, Figure, WIDTH};
use crate::calibrate::{Calibration, SensorNoise};

const HEIGHT: f64 = 270.0;
/// The axis goes no further than this, so that what decides can be seen.
const MOST: f64 = 3.0;

/// Both sensors: deviation over fit with its 90 % interval, at every averaging time.
#[must_use]
pub fn residual(calibration: &Calibration) -> Figure {
    let sensors = [&calibration.gyroscope, &calibration.accelerometer];
    let sensors: Vec<_> =
        sensors.into_iter().flatten().filter(|sensor| !sensor.deviation.is_empty()).collect();
    let charts = sensors.iter().enumerate().map(|(k, sensor)| chart(sensor, k as f64 * HEIGHT));
    Figure::new("Measured Allan deviation over the fitted one".into(), charts, HEIGHT)
}

fn chart(sensor: &SensorNoise, top: f64) -> Drawn {
    let x = Scale::decades(sensor.deviation.iter().map(|d| d.tau_s));
    let mut rows: [Vec<(f64, f64, f64, f64)>; 3] = Default::default();
    for (axis, rows) in rows.iter_mut().enumerate() {
        let fit = Curve::of(&sensor.axes[axis], sensor.ramp.map_or(0.0, |ramp| ramp[axis]));
        for d in sensor.deviation.iter().filter(|d| d.octaves[axis].variance > 0.0) {
            let expected = fit.at(d.tau_s);
            if expected > 0.0 {
                let (low, high) = interval(d.octaves[axis].variance, d.edf[axis], 0.9);
                let [value, low, high] =
                    [d.octaves[axis].variance, low, high].map(|v| v.sqrt() / expected);
                // Side by side, not on top of each other.
                let tau = d.tau_s * 1.06_f64.powi(axis as i32 - 1);
                rows.push((tau, value, low, high));
            }
        }
    }
    let highest = rows.iter().flatten().map(|row| row.3).fold(1.5, f64::max).min(MOST);
    let mut chart = Chart::new((0.0, top), (WIDTH, HEIGHT), x, Scale::between(0.0, highest));
    let (first, last) = x.ends();
    if let Some((shortest, longest)) = sensor.tau_used_s {
        let taus = || sensor.deviation.iter().map(|d| d.tau_s);
        let shorter = taus().any(|tau| tau < 0.99 * shortest);
        let longer = taus().any(|tau| tau > 1.01 * longest);
        if shorter {
            chart.stripe("left-out", first, shortest / 1.414);
        }
        if longer {
            chart.stripe("left-out", longest * 1.414, last);
        }
        if shorter || longer {
            chart.name("left-out", "not used for the fit");
        }
    }
    chart.line("line fit", &[(first, 1.0), (last, 1.0)]);
    for (class, rows) in AXES.iter().zip(&rows) {
        for &(tau, value, low, high) in rows {
            chart.bar(&format!("line {class}"), tau, low, high.min(2.0 * MOST));
            chart.dots(&format!("dot {class}"), &[(tau, value)]);
        }
    }
    for (class, name) in [("line x", "x"), ("line y", "y"), ("line z", "z")] {
        chart.name(class, name);
    }
    let name = sensor.kind.name();
    let title = format!("{name}: measured over fitted");
    chart.finish(&format!("residual-{name}"), &title, "averaging time τ, s", "ratio")
}
