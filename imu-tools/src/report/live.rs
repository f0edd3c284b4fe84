//! A running session in words: a line for a person, an object for programs.

use imu_core::allan::Parameter;
use serde_json::{Value, json};

use super::Quantity;
use super::table::{duration, short};
use crate::calibrate::{SensorKind, SensorNoise};
use crate::live::goal::{half, left_s};
use crate::live::session::View;

/// N or K of a sensor, all axes together, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Number {
    /// `gyroscope N`.
    pub name: String,
    /// The value with its unit, or below what it lies.
    pub value: String,
    /// `±12 %`, empty where it does not show.
    pub half: String,
    /// When it will be known well enough, such as `±10 % in 2 h`.
    pub when: String,
}

/// The sensors of a view, gyroscope first.
pub(crate) fn sensors(view: &View) -> impl Iterator<Item = &SensorNoise> {
    let calibration = &view.snapshot.calibration;
    [&calibration.gyroscope, &calibration.accelerometer].into_iter().flatten()
}

/// N and K of each sensor, and how long until they are known to the part `within`.
#[must_use]
pub fn numbers(view: &View, within: f64) -> Vec<Number> {
    let of = |sensor: &SensorNoise| {
        let noise = &sensor.pooled;
        let (n, k) = (Quantity::NoiseDensity(sensor.kind), Quantity::RandomWalk(sensor.kind));
        let span = sensor.stamps.span_s;
        [('N', n, noise.noise_density), ('K', k, noise.random_walk)].map(
            |(letter, quantity, parameter)| {
                number(sensor, letter, quantity, parameter, span, within)
            },
        )
    };
    sensors(view).flat_map(of).collect()
}

fn number(
    sensor: &SensorNoise,
    letter: char,
    quantity: Quantity,
    parameter: Parameter,
    span_s: f64,
    within: f64,
) -> Number {
    let unit = quantity.unit();
    let value = match parameter {
        Parameter::Observable { value, .. } => format!("{value:.3e} {unit}"),
        Parameter::NotObservable { upper90, .. } if upper90.is_finite() => {
            format!("< {upper90:.2e} {unit}")
        }
        Parameter::NotObservable { .. } => "not known yet".into(),
    };
    let percent = |part: f64| format!("±{} %", rounded(100.0 * part));
    let known = half(parameter);
    let wanted = percent(within);
    let when = match (known, left_s(parameter, span_s, within)) {
        (_, Some(0.0)) if known.is_some() => format!("{wanted} reached"),
        (Some(_), Some(left)) => format!("{wanted} in {}", about(left)),
        (None, Some(left)) if left > 0.0 => format!("may show in {}", about(left)),
        _ => String::new(),
    };
    let half = known.map(percent).unwrap_or_default();
    Number { name: format!("{} {letter}", sensor.kind.name()), value, half, when }
}

/// Two digits, or all of a number from ten on.
fn rounded(percent: f64) -> String {
    if percent < 1.0 {
        format!("{percent:.2}")
    } else if percent < 10.0 {
        format!("{percent:.1}")
    } else {
        format!("{percent:.0}")
    }
}

/// A time to come, no more exact than it is known.
fn about(seconds: f64) -> String {
    let step = match seconds {
        s if s < 120.0 => 10.0,
        s if s < 7200.0 => 60.0,
        s if s < 36_000.0 => 600.0,
        _ => 3600.0,
    };
    duration((seconds / step).ceil().max(1.0) * step)
}

/// Rate, gaps, bytes refused and temperature, each where it is known, and what is not kept.
#[must_use]
pub fn link(view: &View) -> Vec<String> {
    let link = &view.link;
    let mut said: Vec<String> = link.protocol.map(str::to_owned).into_iter().collect();
    if let Some(sensor) = sensors(view).next() {
        let stamps = &sensor.stamps;
        let clock = link.clock;
        let (rate, sd, jitter) = clock
            .map_or((stamps.rate_hz, stamps.rate_sd_hz, stamps.jitter_s), |clock| {
                (clock.rate_hz, clock.rate_sd_hz, clock.jitter_s)
            });
        if rate > 0.0 {
            let is_known = sd > 0.0 && sd.is_finite();
            let sd = if is_known { format!(" ± {sd:.1e}") } else { String::new() };
            said.push(format!("{rate:.4}{sd} Hz"));
            said.push(format!("jitter {} ms", short(1e3 * jitter)));
        }
        let lost = match clock.filter(|clock| !clock.lost_is_certain && clock.lost > 0) {
            Some(_) => " (guessed from arrivals)",
            None => "",
        };
        let plural = |n: u64| if n == 1 { "" } else { "s" };
        let (missing, gaps) = (stamps.missing, stamps.gap_count);
        said.push(format!(
            "{missing} sample{} missing in {gaps} gap{}{lost}",
            plural(missing),
            plural(gaps)
        ));
        let restarts = sensor.record_means.len().saturating_sub(1) as u64 + stamps.restarts;
        if restarts > 0 {
            said.push(format!("{restarts} restart{}", plural(restarts)));
        }
    }
    if link.bytes > 0 {
        let share = 100.0 * link.refused_share();
        said.push(format!("{} bytes refused ({} %)", link.refused, rounded(share)));
    }
    if let Some(celsius) = view.celsius {
        said.push(format!("{celsius:.1} °C"));
    }
    said.extend(view.lost.iter().cloned());
    said
}

/// What the sensor does, where that should be known to its user.
#[must_use]
pub fn hint(view: &View) -> Option<String> {
    if let Some(why) = &view.link.gone {
        return Some(format!("{why}: waiting for it to come back"));
    }
    if let Some(silent_s) = view.link.silent_s {
        return Some(format!("nothing came for {}: has the sensor power?", duration(silent_s)));
    }
    if let Some(why) = &view.link.amiss {
        return Some(why.clone());
    }
    if view.paused {
        return Some("paused: samples are passed over".into());
    }
    let disturbed = sensors(view).map(|sensor| sensor.disturbed.len()).max().unwrap_or(0);
    match (view.moving, disturbed) {
        (Some(true), _) => Some("the sensor is moving: this stretch is left out".into()),
        (Some(false), 1) => Some("at rest; 1 disturbed stretch left out".into()),
        (Some(false), n) if n > 1 => Some(format!("at rest; {n} disturbed stretches left out")),
        (Some(false), _) => Some("at rest".into()),
        (None, _) => None,
    }
}

/// One line for a person.
#[must_use]
pub fn line(view: &View, within: f64) -> String {
    let span = view.snapshot.calibration.span_s;
    let mut parts = vec![duration(span)];
    for number in numbers(view, within) {
        let Number { name, value, half, when } = number;
        let when = if when.is_empty() { when } else { format!(" ({when})") };
        let half = if half.is_empty() { half } else { format!(" {half}") };
        parts.push(format!("{name} {value}{half}{when}"));
    }
    parts.extend(link(view));
    parts.extend(hint(view).filter(|hint| hint != "at rest"));
    parts.join("; ")
}

/// One object for programs: `{"kind":"status", …}`.
#[must_use]
pub fn json(view: &View, within: f64) -> Value {
    let calibration = &view.snapshot.calibration;
    let parameter = |parameter: Parameter, span: f64| {
        let left = left_s(parameter, span, within);
        match parameter {
            Parameter::Observable { value, low90, high90, .. } => json!({
                "value": value, "low90": low90, "high90": high90, "enough_in_s": left,
            }),
            Parameter::NotObservable { upper90, .. } => json!({
                "value": null, "upper90": upper90.is_finite().then_some(upper90), "enough_in_s": left,
            }),
        }
    };
    let sensor = |sensor: &SensorNoise| {
        let (stamps, noise) = (&sensor.stamps, &sensor.pooled);
        json!({
            "samples": stamps.samples,
            "rate_hz": stamps.rate_hz,
            "rate_sd_hz": stamps.rate_sd_hz,
            "jitter_s": stamps.jitter_s,
            "missing": stamps.missing,
            "gaps": stamps.gap_count,
            "restarts": stamps.restarts + sensor.record_means.len().saturating_sub(1) as u64,
            "disturbed": sensor.disturbed.len(),
            "noise_density": parameter(noise.noise_density, stamps.span_s),
            "random_walk": parameter(noise.random_walk, stamps.span_s),
        })
    };
    let link = &view.link;
    json!({
        "kind": "status",
        "span_s": calibration.span_s,
        "moving": view.moving,
        "paused": view.paused,
        "celsius": view.celsius,
        "lost": view.lost,
        "marks": view.marks.iter().map(|mark| mark.at_s).collect::<Vec<_>>(),
        "link": {
            "name": link.name,
            "protocol": link.protocol,
            "gone": link.gone,
            "silent_s": link.silent_s,
            "amiss": link.amiss,
            "bytes": link.bytes,
            "refused": link.refused,
            "bad_checksums": link.bad_checksums,
            "messages": link.messages,
            "clock": link.clock.map(|clock| json!({
                "by_arrival": clock.by_arrival,
                "rate_hz": clock.rate_hz,
                "rate_sd_hz": clock.rate_sd_hz,
                "jitter_s": clock.jitter_s,
                "lost": clock.lost,
                "lost_is_certain": clock.lost_is_certain,
                "restarts": clock.restarts,
            })),
        },
        SensorKind::Gyroscope.name(): calibration.gyroscope.as_ref().map(sensor),
        SensorKind::Accelerometer.name(): calibration.accelerometer.as_ref().map(sensor),
    })
}
