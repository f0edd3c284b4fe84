//! Allan deviation over averaging time, log-log: what is measured, what is fitted, and where the
//! numbers are read.

use imu_core::allan::{Parameter, interval};

use super::chart::{Chart, Drawn};
use super::scale::Scale;
use super::{AXES, Figure, WIDTH};
use crate::calibrate::{AxisNoise, Calibration, SensorKind, SensorNoise};
use crate::report::Quantity;
use crate::report::table::short;

const HEIGHT: f64 = 440.0;
/// Points of the fitted curve.
const CURVE: usize = 200;

/// Both sensors: deviations of x, y and z with 90 % intervals, the fit of all axes and its terms,
/// and the averaging times that were not used for it.
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

/// The terms of a fit as numbers; 0 for what there is not.
#[derive(Clone, Copy, Default)]
pub(super) struct Curve {
    q: f64,
    n: f64,
    b: f64,
    k: f64,
    r: f64,
}

impl Curve {
    /// The estimates of an axis; `ramp` is the drift that was measured where none was fitted.
    pub(super) fn of(noise: &AxisNoise, ramp: f64) -> Self {
        let asked = |parameter: Option<Parameter>| parameter.map(estimate);
        Self {
            q: asked(noise.quantisation).unwrap_or(0.0),
            n: estimate(noise.noise_density),
            b: asked(noise.bias_instability).unwrap_or(0.0),
            k: estimate(noise.random_walk),
            r: asked(noise.rate_ramp).unwrap_or(ramp),
        }
    }

    /// The deviation at τ (IEEE Std 952, annex C).
    pub(super) fn at(&self, tau: f64) -> f64 {
        let Self { q, n, b, k, r } = *self;
        let quantisation = 3.0 * (q / tau).powi(2);
        let flat = 2.0 * std::f64::consts::LN_2 / std::f64::consts::PI * b * b;
        (quantisation + n * n / tau + flat + k * k * tau / 3.0 + 0.5 * (r * tau).powi(2)).sqrt()
    }

    /// Each term by itself.
    fn terms(&self) -> [Self; 5] {
        let none = Self::default();
        [
            Self { q: self.q, ..none },
            Self { n: self.n, ..none },
            Self { b: self.b, ..none },
            Self { k: self.k, ..none },
            Self { r: self.r, ..none },
        ]
    }
}

/// The lowest point of the fit of all axes: averaging time, s, and deviation in the sensor's unit. `None` where the
/// fit still falls at the longest averaging time that it used.
pub(in crate::report) fn lowest(sensor: &SensorNoise) -> Option<(f64, f64)> {
    let (shortest, longest) = sensor.tau_used_s?;
    let fit = Curve::of(&sensor.pooled, 0.0);
    let step = (longest / shortest).powf(1.0 / CURVE as f64);
    let taus = (0..=CURVE).map(|i| shortest * step.powi(i as i32));
    let (tau, deviation) = taus.map(|tau| (tau, fit.at(tau))).min_by(|a, b| a.1.total_cmp(&b.1))?;
    (tau < longest / step.sqrt() && deviation > 0.0).then_some((tau, deviation))
}

fn chart(sensor: &SensorNoise, top: f64) -> Drawn {
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
        ("line fit", "fit of all axes"),
        ("line term", "its terms"),
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

/// The fit of all axes, its terms, and where they and the minimum are read.
fn fitted(chart: &mut Chart, sensor: &SensorNoise, (first, last): (f64, f64)) {
    let ramp = sensor.ramp.map_or(0.0, |r| (r.iter().map(|r| r * r).sum::<f64>() / 3.0).sqrt());
    let fit = Curve::of(&sensor.pooled, ramp);
    let step = (last / first).powf(1.0 / CURVE as f64);
    let points = |curve: &Curve| -> Vec<(f64, f64)> {
        (0..=CURVE)
            .map(|i| first * step.powi(i as i32))
            .map(|tau| (tau, curve.at(tau)))
            .filter(|(_, y)| *y > 0.0)
            .collect()
    };
    for term in fit.terms() {
        chart.line("line term", &points(&term));
    }
    chart.line("line fit", &points(&fit));
    let kind = sensor.kind;
    let Curve { q, n, b, k, r } = fit;
    if n > 0.0 {
        let unit = Quantity::NoiseDensity(kind).unit();
        chart.mark("mark", (1.0, n), false, &format!("N = {} {unit}, at 1 s", short(n)));
    }
    if k > 0.0 {
        let unit = Quantity::RandomWalk(kind).unit();
        // Below its own line, which rises to the right.
        chart.mark("mark", (3.0, k), true, &format!("K = {} {unit}, at 3 s", short(k)));
    }
    if q > 0.0 {
        let unit = Quantity::Quantisation(kind).unit();
        let text = format!("Q = {} {unit}, at √3 s", short(q));
        chart.mark("mark", (3_f64.sqrt(), q), false, &text);
    }
    if r > 0.0 && sensor.pooled.rate_ramp.is_some() {
        let unit = Quantity::RateRamp(kind).unit();
        let text = format!("R = {} {unit}, at √2 s", short(r));
        chart.mark("mark", (2_f64.sqrt(), r), false, &text);
    }
    if let Some((tau, deviation)) = lowest(sensor) {
        let unit = kind.unit();
        let text = format!("lowest: {} {unit} at {} s", short(deviation), short(tau));
        chart.mark("mark", (tau, deviation), true, &text);
    }
    if b > 0.0 {
        // On the left, below the curve, where nothing else is written.
        let tau = first * (last / first).powf(0.2);
        let flat = Curve { b, ..Curve::default() }.at(1.0);
        let text = format!("0.664 B, with B = {} {}", short(b), kind.unit());
        chart.mark("mark", (tau, flat), false, &text);
    }
}
