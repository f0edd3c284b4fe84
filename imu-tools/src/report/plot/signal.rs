//! The signal over time: its range and mean, and what was left out.

use super::chart::{Chart, Drawn};
use super::scale::{Scale, time};
use super::{AXES, Figure, WIDTH};
use crate::calibrate::{Calibration, Column, SensorNoise};

const HEIGHT: f64 = 270.0;

/// Both sensors, each axis about its mean; empty where a calibration kept no signal
/// ([`Options::keep_signal`](crate::calibrate::Options::keep_signal)).
#[must_use]
pub fn signal(calibration: &Calibration) -> Figure {
    let sensors = [&calibration.gyroscope, &calibration.accelerometer];
    let sensors: Vec<_> =
        sensors.into_iter().flatten().filter(|sensor| !sensor.signal.is_empty()).collect();
    let charts = sensors.iter().enumerate().map(|(k, sensor)| chart(sensor, k as f64 * HEIGHT));
    Figure::new("The signal over time, and what was left out".into(), charts, HEIGHT)
}

fn chart(sensor: &SensorNoise, top: f64) -> Drawn {
    let columns = &sensor.signal;
    let end = columns.iter().map(|column| column.to_s).fold(0.0, f64::max);
    let (unit, per_second) = time(end);
    let middle = |column: &Column| 0.5 * (column.from_s + column.to_s) * per_second;
    let ends = columns.iter().flat_map(|column| {
        let about = |axis: usize, x: f64| x - sensor.mean[axis];
        (0..3).flat_map(move |axis| [about(axis, column.low[axis]), about(axis, column.high[axis])])
    });
    // A knock does not hide the rest: a hundredth of the columns may reach beyond the frame.
    let mut reach: Vec<f64> = ends.map(f64::abs).filter(|x| x.is_finite()).collect();
    reach.sort_unstable_by(f64::total_cmp);
    let quiet = reach.get(reach.len() * 98 / 100).copied().unwrap_or(1.0);
    let most = reach.last().copied().unwrap_or(1.0).min(4.0 * quiet);
    let y = Scale::around([-most, most].into_iter());
    let mut chart =
        Chart::new((0.0, top), (WIDTH, HEIGHT), Scale::between(0.0, end * per_second), y);
    for stretch in &sensor.disturbed {
        chart.stripe("left-out", stretch.from_s * per_second, stretch.to_s * per_second);
    }
    if !sensor.disturbed.is_empty() {
        chart.name("left-out", "moved or touched");
    }
    if let Some(warm_up_s) = sensor.warm_up_s {
        chart.stripe("warm-up", 0.0, warm_up_s * per_second);
        chart.name("warm-up", "warming up");
    }
    for (axis, class) in AXES.iter().enumerate() {
        let about = |x: f64| x - sensor.mean[axis];
        // A hole ends a line.
        for run in columns.split(|column| column.samples == 0) {
            let band: Vec<_> =
                run.iter().map(|c| (middle(c), about(c.low[axis]), about(c.high[axis]))).collect();
            let line: Vec<_> = run.iter().map(|c| (middle(c), about(c.mean[axis]))).collect();
            chart.band(&format!("band {class}"), &band);
            chart.line(&format!("line {class}"), &line);
        }
        chart.name(["line x", "line y", "line z"][axis], class);
    }
    let name = sensor.kind.name();
    let title = format!("{name}: signal about its mean");
    let x_name = format!("time, {unit}");
    chart.finish(&format!("signal-{name}"), &title, &x_name, sensor.kind.unit())
}
