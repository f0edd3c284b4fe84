//! The sentences of the report.

use imu_core::allan::Parameter;

use super::span;
use crate::calibrate::verdict::{Grade, Inflation, Known, record_for_walk_s, walk_for_filter};
use crate::calibrate::{AxisNoise, Calibration, SensorKind, SensorNoise};
use crate::report::Quantity;
use crate::report::table::short;

pub(super) const ALLAN: &str = "Average the signal over blocks of τ seconds: the Allan deviation is how much neighbouring blocks \
     differ. On the left it falls, as white noise averages out (slope −½); on the right it rises, as \
     the bias walks away (slope +½). Dots are measured, bands are their 90 % intervals, the thick \
     line is the fit, dashed lines are its terms. Circles: N is the dashed line of white noise \
     read at 1 s, K that of the random walk read at 3 s, and one is the lowest point of the \
     fit, often called bias instability: averaging longer than that makes a bias worse, not better. \
     (The B of a fit is 1/0.664 of a flat that white noise and walk do not explain.) \
     Grey averaging times decided nothing.";

pub(super) const RESIDUAL: &str = "Measured over fitted: where the bars (90 % intervals) touch 1, the fitted terms \
     explain the sensor. Of ten bars one may miss it by chance. Below 1 on the left: a low-pass \
     filter. Above 1 in the middle or on the right: bias instability, drift, temperature or motion.";

pub(super) const SIGNAL: &str = "The signal about its mean: the band is its range, the line its mean. Grey was left out, because \
     the sensor was moved or touched; yellow warmed up, and decided nothing about K.";

pub(super) const WHY_MORE: &str = "The numbers above are those of the sensor at rest, at the temperature of this recording. In \
     motion a filter sees more: errors of scale and alignment (half a per cent of 1 rad/s is \
     0.005 rad/s), vibration, stamps that are off, and a bias that follows temperature. That is why \
     people multiply the numbers by 2 to 10, and N of cheap sensors on shaking machines by more. Take \
     the numbers as they are where the motion is gentle and the filter estimates what else there is; \
     raise them until its innovations are as large as it says they are. What this recording itself \
     shows beyond N and K:";

/// The first letter in upper case.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |c| c.to_uppercase().chain(letters).collect())
}

/// What was recorded.
pub(super) fn recorded(calibration: &Calibration) -> String {
    format!("{}, {} long.", calibration.path, span(calibration.span_s))
}

/// Samples, rate, losses, and the averaging times that decided.
pub(super) fn sampling(sensor: &SensorNoise) -> String {
    let stamps = &sensor.stamps;
    let lost = match stamps.missing {
        0 => "none missing".to_owned(),
        n => format!("{n} missing in {} gaps", stamps.gap_count),
    };
    let used = sensor.tau_used_s.map_or_else(String::new, |(first, last)| {
        format!(" Averaging times from {} to {} s decided.", short(first), short(last))
    });
    let rate =
        if stamps.rate_hz > 0.0 { format!(" at {:.3} Hz", stamps.rate_hz) } else { String::new() };
    format!("{}: {} samples{rate}, {lost}.{used}", sensor.topic, stamps.samples)
}

/// What the number means, in the sensor's terms.
pub(super) fn meaning(quantity: Quantity, pooled: Parameter, noise: &AxisNoise) -> String {
    let value = match pooled {
        Parameter::Observable { value, .. } => value,
        Parameter::NotObservable { upper90, .. } if upper90.is_finite() => upper90,
        Parameter::NotObservable { .. } => {
            return "Too little was recorded to say anything of it.".into();
        }
    };
    let walk = |text: String| match walk_for_filter(noise) {
        Some(walk) => format!(
            "{text} This is K beside B: the part of the wandering that grows as the root of time. For a \
             filter that knows N and K only put {} {}, which goes as far in {:.0} s as both together.",
            short(walk),
            quantity.unit(),
            Inflation::OVER_S
        ),
        None => text,
    };
    match quantity {
        Quantity::BiasInstability(kind) => format!(
            "Flicker: the deviation of the bias stays at {} {} however long one averages. Beside it K is \
             known less well (by a third where there is little of it), and a K without it would \
             stand for both.",
            short(value * (2.0 * std::f64::consts::LN_2 / std::f64::consts::PI).sqrt()),
            kind.unit()
        ),
        Quantity::Quantisation(_) => format!(
            "The sensor counts its integral in steps of {} {} (√12 Q). Errors of neighbouring samples \
             cancel: it is no white noise, and integration does not see it grow.",
            short(value * 12_f64.sqrt()),
            quantity.unit()
        ),
        Quantity::RateRamp(kind) => format!(
            "A steady drift, {} {} in an hour, of either sign. K is read past it, from the Hadamard \
             variance.",
            short(value * 3600.0),
            kind.unit()
        ),
        Quantity::NoiseDensity(SensorKind::Gyroscope) => format!(
            "White noise of the angular rate. Integrated over an hour it turns the attitude by \
             {} ° (one standard deviation), and by {} ° in a minute.",
            short((value * 60.0).to_degrees()),
            short((value * 60_f64.sqrt()).to_degrees())
        ),
        Quantity::NoiseDensity(SensorKind::Accelerometer) => format!(
            "White noise of the specific force. Integrated over a minute it changes the velocity by \
             {} m/s (one standard deviation).",
            short(value * 60_f64.sqrt())
        ),
        Quantity::RandomWalk(SensorKind::Gyroscope) => walk(format!(
            "How the bias wanders: by {} °/s in a minute and {} °/s in an hour (one standard \
             deviation).",
            short((value * 60_f64.sqrt()).to_degrees()),
            short((value * 60.0).to_degrees())
        )),
        Quantity::RandomWalk(SensorKind::Accelerometer) => walk(format!(
            "How the bias wanders: by {} m/s² in a minute and {} m/s² in an hour (one standard \
             deviation).",
            short(value * 60_f64.sqrt()),
            short(value * 60.0)
        )),
    }
}

/// How well the numbers of a sensor are known, and what grade it is of.
pub(super) fn verdict(sensor: &SensorNoise) -> String {
    let n = match Known::of(sensor.pooled.noise_density) {
        Known::Well(half) => format!("White noise is known well, to {}.", percent(half)),
        Known::Fairly(half) => format!("White noise is known to {}: good enough.", percent(half)),
        Known::Roughly(half) => format!("White noise is known only to {}.", percent(half)),
        Known::Below(_) => "White noise does not show; only its bound is known.".into(),
        Known::Reading => "White noise is a reading off a line, without an interval.".into(),
        Known::NotAtAll => "Nothing is known of white noise.".into(),
    };
    let k = match Known::of(sensor.pooled.random_walk) {
        Known::Well(half) => format!("The walk of the bias is known well, to {}.", percent(half)),
        Known::Fairly(half) => {
            format!("The walk of the bias is known to {}: good enough for a filter.", percent(half))
        }
        Known::Roughly(half) => format!(
            "The walk of the bias is known only to {}: right in its order of magnitude; record longer.",
            percent(half)
        ),
        Known::Below(_) => {
            "The walk of the bias does not show in a record of this length; the bound below which it \
             lies is safe to use."
                .into()
        }
        Known::Reading => "The walk of the bias is a reading off a line, without an interval.".into(),
        Known::NotAtAll => "Nothing is known of the walk of the bias: record longer.".into(),
    };
    let beyond = if sensor.misfit.contains(&true) {
        " There is more in the signal than what was fitted: take K for an upper limit."
    } else {
        ""
    };
    let grade = match sensor.pooled.noise_density {
        Parameter::Observable { value, .. } => {
            let twin = Quantity::NoiseDensity(sensor.kind).twin();
            let density = value * twin.per_si;
            format!(
                " By its white noise ({} {}) it is {}.",
                short(density),
                twin.unit,
                grade(Grade::of(sensor.kind, density))
            )
        }
        Parameter::NotObservable { .. } => String::new(),
    };
    format!("{n} {k}{beyond}{grade}")
}

fn grade(grade: Grade) -> &'static str {
    match grade {
        Grade::Navigation => "of navigation grade, as in airliners and ships",
        Grade::Tactical => "of tactical grade, among the best of small sensors",
        Grade::Industrial => "of industrial grade, a good MEMS",
        Grade::Consumer => "of consumer grade, as in telephones and drones",
        Grade::Beyond => {
            "noisier than sensors that are sold: it was shaken, is badly set, or is simulated"
        }
    }
}

/// What a filter has to allow for, by what was seen here.
pub(super) fn inflation(sensors: &[&SensorNoise]) -> Vec<String> {
    let mut sentences = Vec::new();
    for sensor in sensors {
        let name = sensor.kind.name();
        let Inflation { noise_density, random_walk } = Inflation::of(sensor);
        if noise_density > 1.0 {
            sentences.push(format!(
                "{name}: short averaging times show {} times N (vibration, or a resonance): a filter \
                 that takes every sample sees that.",
                short(noise_density)
            ));
        }
        if random_walk > 1.0 {
            sentences.push(format!(
                "{name}: its drift over this recording moves the bias {} times as far in {:.0} s as K \
                 does: multiply K by that, or estimate the drift.",
                short(random_walk),
                Inflation::OVER_S
            ));
        }
        if let Some(walk) = walk_for_filter(&sensor.pooled) {
            sentences.push(format!(
                "{name}: flicker (bias instability), which the filters above have no term for: the random \
                 walk that stands there for them is {} {}, in the place of K.",
                short(walk),
                Quantity::RandomWalk(sensor.kind).unit()
            ));
        }
        if let Some(warm_up_s) = sensor.warm_up_s {
            sentences.push(format!(
                "{name}: the bias still moves in the first {}: let it warm up, or start with a wide \
                 uncertainty of the bias.",
                span(warm_up_s)
            ));
        }
    }
    if sentences.is_empty() {
        sentences.push("Nothing: the sensor at rest is white noise and a random walk.".into());
    }
    sentences
}

/// What to do better.
pub(super) fn next_time(sensors: &[&SensorNoise]) -> Vec<String> {
    let mut sentences = Vec::new();
    for sensor in sensors {
        let name = sensor.kind.name();
        let recorded = sensor.stamps.span_s;
        match (record_for_walk_s(sensor), sensor.pooled.random_walk) {
            (Some(wanted), _) if wanted > 1.05 * recorded => sentences.push(format!(
                "{name}: for K of each axis to 10 % record {}; this was {}.",
                span(wanted),
                span(recorded)
            )),
            (Some(_), _) => {
                sentences.push(format!("{name}: long enough for K of each axis to 10 %."));
            }
            (None, Parameter::NotObservable { record_at_least_s, .. })
                if record_at_least_s > 0.0 =>
            {
                sentences.push(format!(
                    "{name}: the walk of the bias shows in {} at the earliest.",
                    span(record_at_least_s)
                ));
            }
            (None, _) => {}
        }
        if sensor.contradiction.is_some() {
            sentences.push(format!(
                "{name}: set its low-pass filter wider (or off) and publish at its full rate, if you \
                 want to see N at short averaging times; the numbers here do not need it."
            ));
        }
        if !sensor.disturbed.is_empty() {
            sentences
                .push(format!("{name}: leave it alone, on something solid, away from people."));
        }
    }
    sentences.push("Let it warm up for half an hour first, at an even temperature.".into());
    sentences
}

fn percent(half: f64) -> String {
    format!(
        "±{} %",
        short((1000.0 * half).round().max(1.0) / 10.0).trim_end_matches('0').trim_end_matches('.')
    )
}
