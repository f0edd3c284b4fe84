//! The sentences of the report.

use imu_core::allan::Parameter;

use super::span;
use crate::calibrate::verdict::{Grade, Inflation, Known, Margin, NextRecord, walk_for_filter};
use crate::calibrate::{AxisNoise, Calibration, SensorKind, SensorNoise};
use crate::report::Quantity;
use crate::report::json::AXES;
use crate::report::plot::lowest;
use crate::report::table::short;

pub(super) const ALLAN: &str = "Average the signal over blocks of τ seconds: the Allan deviation is how much neighbouring blocks \
     differ. On the left it falls, as white noise averages out (slope −½); on the right it rises, as \
     the bias walks away (slope +½). Dots are measured, bands are their 90 % intervals. The thick \
     line is the fit of all three axes together (the row “all” of the tables), dashed lines are its \
     terms. Circles: N is the dashed line of white noise read at 1 s, K that of the random walk read at \
     3 s; the lowest point of the fit, where the recording reaches it, is often called bias \
     instability. (The B of a fit is 1/0.664 of a flat that white noise and walk do not explain.) \
     Violet averaging times, if there are any, were not used for the fit.";

pub(super) const RESIDUAL: &str = "Measured over fitted, a number without a unit. Each axis is divided by its own fit (the rows x, y \
     and z of the tables), not by the line of all axes that is drawn above. Where the bars (90 % \
     intervals) touch 1, the fit explains the sensor; of ten bars one may miss it by chance. Below 1 on \
     the left: a low-pass filter. Above 1 on the right: drift, temperature or motion. Above 1 in the \
     middle and below it on the right: flicker (bias instability) that was not fitted.";

pub(super) const SIGNAL: &str = "The signal about its mean: the band is its range, the line its mean. Where the bands of the axes lie \
     on each other they look grey. Violet, if there is any, was found to be moved, touched or frozen; \
     in yellow the sensor warmed up. What was done about it is among the warnings.";

pub(super) const HERE: &str = "The factors in this table are what this recording itself asks for: how much larger the true value may \
     be, how much noisier the noisiest axis is than all together, and what else was seen. The filter’s \
     value should be at least the last column times the value in the blocks below.";

pub(super) const NOT_KNOWABLE: &str = "No recording at rest can tell what comes on top in use: vibration, a bias that follows temperature, \
     errors of scale and alignment (half a per cent of 1 rad/s is 0.005 rad/s), and time stamps that are \
     off. It is customary to multiply both N and K by 2 (gentle motion, a warm sensor) to 10 (a cheap \
     sensor on a drone or an engine), or by the table’s factor where that is larger. The reason: with numbers that are too large a filter is a \
     little less accurate than it might be; with numbers that are too small it trusts errors and may \
     diverge. If your filter shows its innovations (measured minus predicted), raise the factor until \
     they are no larger than the filter expects.";

/// The first letter in upper case.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |c| c.to_uppercase().chain(letters).collect())
}

/// What was recorded.
pub(super) fn recorded(calibration: &Calibration) -> String {
    format!("{}, {} long.", calibration.path, span(calibration.span_s))
}

/// Samples, rate, losses, and the averaging times of the fit.
pub(super) fn sampling(sensor: &SensorNoise) -> String {
    let stamps = &sensor.stamps;
    let lost = match stamps.missing {
        0 => "none missing".to_owned(),
        n => format!("{n} missing in {} gaps", stamps.gap_count),
    };
    let used = sensor.tau_used_s.map_or_else(String::new, |(first, last)| {
        format!(
            " Averaging times from {} to {} s were used for the fit.",
            short(first),
            short(last)
        )
    });
    let rate =
        if stamps.rate_hz > 0.0 { format!(" at {:.3} Hz", stamps.rate_hz) } else { String::new() };
    format!("{}: {} samples{rate}, {lost}.{used}", sensor.topic, stamps.samples)
}

/// What the number means, in the sensor's terms.
pub(super) fn meaning(quantity: Quantity, pooled: Parameter, noise: &AxisNoise) -> String {
    let (value, by) = match pooled {
        Parameter::Observable { value, .. } => (value, "by"),
        Parameter::NotObservable { upper90, .. } if upper90.is_finite() => {
            (upper90, "by less than")
        }
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
            "How the bias wanders: {by} {} °/s in a minute and {} °/s in an hour (one standard \
             deviation).",
            short((value * 60_f64.sqrt()).to_degrees()),
            short((value * 60.0).to_degrees())
        )),
        Quantity::RandomWalk(SensorKind::Accelerometer) => walk(format!(
            "How the bias wanders: {by} {} m/s² in a minute and {} m/s² in an hour (one standard \
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
    format!("{n} {}{}{}", walk(sensor), grade_by_noise(sensor), grade_by_bias(sensor))
}

/// How well K is known.
fn walk(sensor: &SensorNoise) -> String {
    let pooled = sensor.pooled.random_walk;
    if sensor.misfit.contains(&true)
        && let Parameter::Observable { high90, .. } = pooled
        && high90.is_finite()
    {
        return format!(
            "There is more in the signal than what was fitted: take the walk of the bias for at most \
             about {} {}, its upper bound.",
            short(high90),
            Quantity::RandomWalk(sensor.kind).unit()
        );
    }
    let shown: Vec<&str> = AXES
        .into_iter()
        .zip(&sensor.axes)
        .filter(|(_, axis)| matches!(axis.random_walk, Parameter::Observable { .. }))
        .map(|(name, _)| name)
        .collect();
    match (Known::of(pooled), pooled) {
        (Known::Roughly(_), Parameter::Observable { low90, high90, .. }) => {
            let where_from = match shown.as_slice() {
                [axis] => format!("The walk of the bias shows on axis {axis} only, and is"),
                _ => "The walk of the bias is".into(),
            };
            let next = match NextRecord::of(sensor) {
                NextRecord::HiddenByFlicker => {
                    "flicker hides it, and filters take a walk that covers both"
                }
                _ => "record longer",
            };
            format!(
                "{where_from} known only roughly: it lies between {} and {} {}; {next}.",
                short(low90),
                short(high90),
                Quantity::RandomWalk(sensor.kind).unit()
            )
        }
        (Known::Well(half), _) => {
            format!("The walk of the bias is known well, to {}.", percent(half))
        }
        (Known::Fairly(half), _) => {
            format!("The walk of the bias is known to {}: good enough for a filter.", percent(half))
        }
        (Known::Below(_), _) => {
            "The walk of the bias does not show in a record of this length; its upper bound is safe to \
             use."
                .into()
        }
        (Known::Reading, _) => {
            "The walk of the bias is a reading off a line, without an interval.".into()
        }
        (Known::NotAtAll | Known::Roughly(_), _) => {
            "Nothing is known of the walk of the bias: record longer.".into()
        }
    }
}

/// The class by N, and where the classes end.
fn grade_by_noise(sensor: &SensorNoise) -> String {
    let Parameter::Observable { value, .. } = sensor.pooled.noise_density else {
        return String::new();
    };
    let twin = Quantity::NoiseDensity(sensor.kind).twin();
    let density = value * twin.per_si;
    let [navigation, tactical, industrial, consumer] = Grade::borders(sensor.kind);
    let unit = twin.unit;
    format!(
        " By its white noise alone ({} {unit}) it is {}. (Navigation grade ends at {navigation} {unit}, \
         tactical at {tactical}, industrial at {industrial}, consumer at {consumer}.)",
        short(density),
        grade(Grade::of(sensor.kind, density))
    )
}

/// The class by the bias instability that a datasheet would print: of a gyroscope whose curve has a lowest point.
fn grade_by_bias(sensor: &SensorNoise) -> String {
    let (SensorKind::Gyroscope, Some((deviation, _))) = (sensor.kind, bias_instability(sensor))
    else {
        return String::new();
    };
    let twin = Quantity::BiasInstability(sensor.kind).twin();
    let value = deviation * twin.per_si;
    format!(
        " By its bias instability ({} {}) it is {}.",
        short(value),
        twin.unit,
        grade(Grade::of_bias_instability(value))
    )
}

fn grade(grade: Grade) -> &'static str {
    match grade {
        Grade::Navigation => "of navigation grade, as in airliners and ships",
        Grade::Tactical => "of tactical grade, among the best of small sensors",
        Grade::Industrial => "of industrial grade, a good MEMS",
        Grade::Consumer => "of consumer grade, as in telephones and drones",
        Grade::Beyond => {
            "noisier than consumer sensors usually are; the numbers hold all the same, but look \
             whether its range and filter are set as they should be, and whether it was at rest"
        }
    }
}

/// The bias instability that a datasheet would print, in the sensor's unit, and where it comes from.
fn bias_instability(sensor: &SensorNoise) -> Option<(f64, String)> {
    if let Some(Parameter::Observable { value, .. }) = sensor.pooled.bias_instability {
        let flat = value * (2.0 * std::f64::consts::LN_2 / std::f64::consts::PI).sqrt();
        return Some((
            flat,
            "the flat part of the curve, 0.664 B; B was found in this recording".into(),
        ));
    }
    let (tau, deviation) = lowest(sensor)?;
    let from = format!(
        "the lowest point of the fit, at {} s; no flicker was found, so this is where white noise and the \
         walk of the bias meet, not a noise of its own",
        short(tau)
    );
    Some((deviation, from))
}

/// The bias instability as datasheets print it.
pub(super) fn datasheet(sensor: &SensorNoise) -> String {
    let twin = Quantity::BiasInstability(sensor.kind).twin();
    match bias_instability(sensor) {
        Some((deviation, from)) => format!(
            "Bias instability as datasheets print it: {} {} ({} {}; {from}).",
            short(deviation * twin.per_si),
            twin.unit,
            short(deviation),
            sensor.kind.unit()
        ),
        None => format!(
            "Bias instability as datasheets print it ({}) does not show: at the longest averaging time \
             used the curve still falls.",
            twin.unit
        ),
    }
}

/// By how much N and K of a sensor should grow for what this recording shows: name, by the interval, by the noisiest
/// axis, by what was seen beside, and all together at least.
pub(super) fn margins(sensor: &SensorNoise) -> [[String; 5]; 2] {
    let Inflation { noise_density, random_walk } = Inflation::of(sensor);
    let noise = sensor.axes.each_ref().map(|axis| axis.noise_density);
    let walks = sensor.axes.each_ref().map(|axis| axis.random_walk);
    let name = |letter: &str| format!("{} {letter}", sensor.kind.name());
    let n = margin(noise, sensor.pooled.noise_density, noise_density, "vibration");
    let k = match (walk_for_filter(&sensor.pooled), sensor.pooled.random_walk) {
        (Some(walk), Parameter::Observable { value, .. }) if value > 0.0 => {
            let times = format!("flicker: {:.1} times K", walk / value);
            ["–".into(), "–".into(), times, "1.00 (the blocks hold it)".into()]
        }
        (Some(_), _) => {
            ["–".into(), "–".into(), "flicker".into(), "1.00 (the blocks hold it)".into()]
        }
        (None, pooled) => margin(walks, pooled, random_walk, "drift"),
    };
    let misfit = sensor.misfit.contains(&true);
    [(name("N"), n), (name("K"), k)].map(|(name, [interval, axes, beside, most])| {
        let most = if misfit { format!("{most}, or more: see the warnings") } else { most };
        [name, interval, axes, beside, most]
    })
}

fn margin(axes: [Parameter; 3], pooled: Parameter, beside: f64, what: &str) -> [String; 4] {
    let none = || "–".to_owned();
    let seen = if beside > 1.0 { format!("{beside:.2} ({what})") } else { none() };
    match (Margin::of(axes, pooled), pooled) {
        (Some(margin), _) => [
            format!("{:.2}", margin.interval),
            format!("{:.2}", margin.axes),
            seen,
            format!("{:.2}", margin.most().max(beside)),
        ],
        (None, Parameter::NotObservable { upper90, .. }) if upper90.is_finite() => {
            [none(), none(), seen, format!("{beside:.2} (the blocks hold its upper bound)")]
        }
        (None, _) => [none(), none(), seen, "not known".into()],
    }
}

/// What was found in a recording beside white noise and a random walk; `warned` says that there are warnings of this
/// sensor.
pub(super) fn found(sensor: &SensorNoise, warned: bool) -> Vec<String> {
    let mut found = Vec::new();
    if sensor.misfit.contains(&true) {
        let axes: Vec<&str> =
            AXES.into_iter().zip(sensor.misfit).filter(|(_, m)| *m).map(|(axis, _)| axis).collect();
        found.push(format!(
            "more than was fitted, on {} {} (drift, temperature, motion): K is an upper limit there",
            if axes.len() == 1 { "axis" } else { "axes" },
            axes.join(", ")
        ));
    }
    let Inflation { noise_density, random_walk } = Inflation::of(sensor);
    if noise_density > 1.0 {
        found.push(format!(
            "short averaging times show {} times N (vibration, or a resonance): a filter that takes \
             every sample sees that",
            short(noise_density)
        ));
    } else if sensor.contradiction.is_some() {
        found.push(
            "short averaging times show no more than N, as behind a low-pass filter: neighbouring \
             samples are alike, and N holds for longer times"
                .into(),
        );
    }
    if random_walk > 1.0 {
        found.push(format!(
            "a drift over this recording moves the bias {} times as far in {:.0} s as K does: \
             multiply K by that, or estimate the drift",
            short(random_walk),
            Inflation::OVER_S
        ));
    } else if sensor.ramp.is_some() || sensor.pooled.rate_ramp.is_some() {
        found.push("a steady drift, which in a filter’s time is less than K covers".into());
    }
    if let Some(walk) = walk_for_filter(&sensor.pooled) {
        found.push(format!(
            "flicker (bias instability), which the filters below have no term for: in the place of K \
             stands {} {}, which covers both",
            short(walk),
            Quantity::RandomWalk(sensor.kind).unit()
        ));
    }
    if let Some(warm_up_s) = sensor.warm_up_s {
        found.push(format!(
            "the bias still moves in the first {}: let it warm up, or start with a wide uncertainty of \
             the bias",
            span(warm_up_s)
        ));
    }
    if !sensor.disturbed.is_empty() {
        found.push("it was moved, touched or stood still, as the warnings say".into());
    }
    if found.is_empty() {
        let walk_shows = matches!(sensor.pooled.random_walk, Parameter::Observable { .. });
        let length = span(sensor.stamps.span_s);
        found.push(match (walk_shows, warned) {
            (false, _) => {
                format!("nothing; a record of {length} is too short to show even the walk")
            }
            (true, true) => "nothing in the noise, but see the warnings above".into(),
            (true, false) => format!("nothing that a record of {length} can show"),
        });
    }
    found.iter().map(|sentence| format!("{}: {sentence}.", sensor.kind.name())).collect()
}

/// What to do better.
pub(super) fn next_time(sensors: &[&SensorNoise]) -> Vec<String> {
    let mut sentences = Vec::new();
    for sensor in sensors {
        let name = sensor.kind.name();
        match NextRecord::of(sensor) {
            NextRecord::AtLeast(wanted_s) => {
                let rough = !matches!(
                    Known::of(sensor.pooled.random_walk),
                    Known::Well(_) | Known::Fairly(_)
                );
                let more = if rough {
                    " It may take several times as long: K read from a short record tends to be too large."
                } else {
                    ""
                };
                sentences.push(format!(
                    "{name}: for K of each axis to 10 % (one standard deviation) record at least {}; this \
                     was {}.{more}",
                    span(wanted_s),
                    span(sensor.stamps.span_s)
                ));
            }
            NextRecord::LongEnough if sensor.misfit.contains(&true) => sentences.push(format!(
                "{name}: a longer record alone does not help; find what else is in it (temperature, \
                 motion)."
            )),
            NextRecord::LongEnough => sentences.push(format!(
                "{name}: this was long enough for K of each axis to 10 % (one standard deviation)."
            )),
            NextRecord::HiddenByFlicker => sentences.push(format!(
                "{name}: a longer record says little more of K, which flicker hides; a filter does not \
                 need it."
            )),
            NextRecord::Unknown => {}
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
