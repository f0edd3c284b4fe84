//! Allan deviation over averaging time, log-log: what is measured, what is fitted, and where the
//! numbers are read.

use imu_core::allan::{Parameter, interval};

use super::chart::Chart;
use super::scale::Scale;
use super::svg::Shapes;
use super::{AXES, Figure, WIDTH};
use crate::calibrate::{Calibration, SensorKind, SensorNoise};
use crate::report::Quantity;
use crate::report::table::short;

const HEIGHT: f64 = 440.0;
/// Points of the fitted curve.
const CURVE: usize = 200;

/// Both sensors: deviations of x, y and z with 90 % intervals, the fit of all axes and its terms,
/// and the averaging times that decided nothing.
#[must_use]
pub fn allan(calibration: &Calibration) -> Figure {
    let sensors: Vec<_> = [&calibration.gyroscope, &calibration.accelerometer]
        .into_iter()
        .flatten()
        .filter(|sensor| !sensor.deviation.is_empty())
        .collect();
    let description =
        "Allan deviation over averaging time, measured and fitted, of gyroscope and accelerometer";
    let charts = sensors.iter().enumerate().map(|(k, sensor)| chart(sensor, k as f64 * HEIGHT));
    Figure::new(description.into(), charts, HEIGHT)
}

/// An estimate; zero where there is none.
pub(super) fn estimate(parameter: Parameter) -> f64 {
    match parameter {
        Parameter::Observable { value, .. } => value,
        Parameter::NotObservable { .. } => 0.0,
    }
}

/// The deviation at τ of white noise N, a random walk K and a drift R (IEEE Std 952, annex C).
pub(super) fn model(n: f64, k: f64, ramp: f64, tau: f64) -> f64 {
    (n * n / tau + k * k * tau / 3.0 + 0.5 * (ramp * tau).powi(2)).sqrt()
}

fn chart(sensor: &SensorNoise, top: f64) -> Shapes {
    let unit = sensor.kind.unit();
    let taus = || sensor.deviation.iter().map(|d| d.tau_s);
    let measured = sensor.deviation.iter().flat_map(|d| &d.octaves);
    let deviations = measured.filter(|o| o.differences > 0).map(|o| o.deviation());
    let x = Scale::decades(taus());
    let (mut low, high) = Scale::decades(deviations).ends();
    // K is read at 3 s, where it may be far below what is measured.
    let k = estimate(sensor.pooled.random_walk);
    if k > low / 100.0 {
        low = low.min(k / 1.5);
    }
    let mut chart = Chart::new(
        (0.0, top),
        (WIDTH, HEIGHT),
        x,
        // Room for the intervals of the longest τ and for names.
        Scale::decades([low / 1.5, high * 1.5].into_iter()),
    );
    let (first, last) = x.ends();
    if let Some((shortest, longest)) = sensor.tau_used_s {
        if taus().any(|tau| tau < 0.99 * shortest) {
            chart.stripe("left-out", first, shortest / 1.414);
        }
        if taus().any(|tau| tau > 1.01 * longest) {
            chart.stripe("left-out", longest * 1.414, last);
        }
    }
    for (axis, class) in AXES.iter().enumerate() {
        let rows: Vec<_> = sensor
            .deviation
            .iter()
            .filter(|d| d.octaves[axis].differences > 0 && d.octaves[axis].variance > 0.0)
            .map(|d| {
                let (low, high) = interval(d.octaves[axis].variance, d.edf[axis], 0.9);
                (d.tau_s, d.octaves[axis].deviation(), low.sqrt(), high.sqrt())
            })
            .collect();
        let band: Vec<_> = rows.iter().map(|&(tau, _, low, high)| (tau, low, high)).collect();
        let line: Vec<_> = rows.iter().map(|&(tau, deviation, ..)| (tau, deviation)).collect();
        chart.band(&format!("band {class}"), &band);
        chart.line(&format!("line {class}"), &line);
        chart.dots(&format!("dot {class}"), &line);
    }
    fitted(&mut chart, sensor, (first, last));
    for (class, name) in [
        ("line x", "x"),
        ("line y", "y"),
        ("line z", "z"),
        ("line fit", "fit"),
        ("line term", "N, K"),
    ] {
        chart.name(class, name);
    }
    let name = match sensor.kind {
        SensorKind::Gyroscope => "gyroscope",
        SensorKind::Accelerometer => "accelerometer",
    };
    let id = format!("allan-{name}");
    let title = format!("{name}: Allan deviation");
    chart.finish(&id, &title, "averaging time τ, s", &format!("Allan deviation, {unit}"))
}

/// The fit of all axes, its terms, and where N, K and the minimum are read.
fn fitted(chart: &mut Chart, sensor: &SensorNoise, (first, last): (f64, f64)) {
    let (n, k) = (estimate(sensor.pooled.noise_density), estimate(sensor.pooled.random_walk));
    let ramp = sensor.ramp.map_or(0.0, |r| (r.iter().map(|r| r * r).sum::<f64>() / 3.0).sqrt());
    let step = (last / first).powf(1.0 / CURVE as f64);
    let curve = |n: f64, k: f64, ramp: f64| -> Vec<(f64, f64)> {
        (0..=CURVE)
            .map(|i| first * step.powi(i as i32))
            .map(|tau| (tau, model(n, k, ramp, tau)))
            .filter(|(_, y)| *y > 0.0)
            .collect()
    };
    chart.line("line term", &curve(n, 0.0, 0.0));
    chart.line("line term", &curve(0.0, k, 0.0));
    chart.line("line fit", &curve(n, k, ramp));
    let kind = sensor.kind;
    if n > 0.0 {
        let unit = Quantity::NoiseDensity(kind).unit();
        chart.mark("mark", (1.0, n), false, &format!("N = {} {unit}, at 1 s", short(n)));
    }
    if k > 0.0 {
        let unit = Quantity::RandomWalk(kind).unit();
        chart.mark("mark", (3.0, k), false, &format!("K = {} {unit}, at 3 s", short(k)));
    }
    if n > 0.0 && k > 0.0 {
        let tau = 3_f64.sqrt() * n / k;
        let least = model(n, k, 0.0, tau);
        let text = format!("least: {} {} at {} s", short(least), kind.unit(), short(tau));
        chart.mark("mark", (tau, least), true, &text);
    }
}
