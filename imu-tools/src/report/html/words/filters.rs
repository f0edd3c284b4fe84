//! What to put into a filter, and by how much to multiply it.

use imu_core::allan::Parameter;

use super::{axes, list, short, span};
use crate::calibrate::SensorNoise;
use crate::calibrate::filter::{Basis, Factors, FilterValue, walk_for_filter};
use crate::report::Quantity;

pub(in super::super) const HERE: &str = "The blocks below are not multiplied by anything. The last three columns say what this recording itself asks \
     for: how much larger the true value may be, how much noisier the noisiest axis is, and vibration or drift that was \
     seen.";

pub(in super::super) const ADVICE: &str = " It is twice the largest of the three, of a bound too: the 2 stands for what no recording at rest can know: vibration, a bias \
     that follows temperature, errors of scale and alignment, time stamps that are off. For a cheap sensor on a \
     drone, a car or an engine take 5 to 10 in its place. Too large costs a filter a little accuracy; too small, \
     it trusts errors and may diverge. If yours shows its innovations (measured minus predicted), raise the \
     factor until they are no larger than it expects.";

/// By how much N and K of a sensor should grow: name, what to multiply by, and what for: by the interval, by the noisiest
/// axis, by what was seen beside.
pub(in super::super) fn factors(sensor: &SensorNoise) -> [[String; 5]; 2] {
    let basis = |value: Option<FilterValue>| value.map(|value| value.basis);
    [
        (
            "N",
            "vibration",
            Factors::noise_density(sensor),
            basis(FilterValue::noise_density(sensor)),
        ),
        ("K", "drift", Factors::random_walk(sensor), basis(FilterValue::random_walk(sensor))),
    ]
    .map(|(letter, what, factors, basis)| {
        let name = match basis {
            Some(Basis::CoversFlicker) => format!("{} {letter}, with flicker", sensor.kind.name()),
            _ => format!("{} {letter}", sensor.kind.name()),
        };
        let none = || "–".to_owned();
        let Some(factors) = factors else {
            return [name, "not known".into(), none(), none(), none()];
        };
        let number = |factor: Option<f64>| match (factor, basis) {
            (Some(factor), _) => format!("{factor:.2}"),
            (None, Some(Basis::UpperBound)) => "1 (a bound)".into(),
            (None, _) => none(),
        };
        let seen =
            if factors.beside > 1.0 { format!("{:.2} ({what})", factors.beside) } else { none() };
        let advised = format!("{:.1}", factors.advised());
        let misfit = sensor.misfit.contains(&true);
        let advised =
            if misfit { format!("{advised}, or more: see the warnings") } else { advised };
        [name, advised, number(factors.interval), number(factors.axes), seen]
    })
}

/// What was found in a recording beside white noise and a random walk; `warned` says whether there are warnings of a
/// sensor. What holds of both sensors is said once.
pub(in super::super) fn found(
    sensors: &[&SensorNoise],
    warned: impl Fn(&SensorNoise) -> bool,
) -> Vec<String> {
    let mut sentences: Vec<(Vec<&str>, String)> = Vec::new();
    for sensor in sensors {
        for sentence in found_in(sensor, warned(sensor)) {
            match sentences.iter_mut().find(|(_, known)| *known == sentence) {
                Some((names, _)) => names.push(sensor.kind.name()),
                None => sentences.push((vec![sensor.kind.name()], sentence)),
            }
        }
    }
    sentences.iter().map(|(names, sentence)| format!("{}: {sentence}.", list(names))).collect()
}

fn found_in(sensor: &SensorNoise, warned: bool) -> Vec<String> {
    let mut found = Vec::new();
    if let Some(axes) = axes(sensor.misfit) {
        found.push(format!(
            "more than was fitted, on {axes} (drift, temperature, motion): K is an upper limit there"
        ));
    }
    let beside = |factors: Option<Factors>| factors.map_or(1.0, |factors| factors.beside);
    let noise_density = beside(Factors::noise_density(sensor));
    let random_walk = beside(Factors::random_walk(sensor));
    if noise_density > 1.0 {
        found.push(format!(
            "short averaging times show {} times N (vibration, or a resonance): a filter that takes \
             every sample sees that",
            short(noise_density)
        ));
    } else if sensor.contradiction.is_some() {
        found.push(
            "short averaging times show less than N, as behind a low-pass filter: neighbouring \
             samples are alike there, and N holds for longer times"
                .into(),
        );
    }
    if random_walk > 1.0 {
        found.push(format!(
            "a drift over this recording moves the bias {} times as far in {:.0} s as the walk in the blocks does: \
             multiply K by that, or estimate the drift",
            short(random_walk),
            Factors::OVER_S
        ));
    } else if sensor.ramp.is_some() || sensor.pooled.rate_ramp.is_some() {
        found.push("a steady drift, which in a filter’s time is less than K covers".into());
    }
    if let Some(walk) = walk_for_filter(&sensor.pooled) {
        found.push(format!(
            "flicker (bias instability B), which these filters have no term for: their K is {} {}, with which \
             the bias goes as far in {:.0} s as by both",
            short(walk),
            Quantity::RandomWalk(sensor.kind).unit(),
            Factors::OVER_S
        ));
    }
    if let Some(warm_up_s) = sensor.warm_up_s {
        found.push(format!(
            "the bias still moves in the first {}: let it warm up, or start with a wide uncertainty of \
             the bias",
            span(warm_up_s)
        ));
    }
    let hung = sensor.checks.frozen.len();
    if sensor.disturbed.len() > hung {
        found.push("moved or touched now and then, as the warnings say".into());
    }
    if hung > 0 {
        found.push("hung for a time (its values did not change), as the warnings say".into());
    }
    if found.is_empty() {
        let mut noises = sensor.axes.iter().chain([&sensor.pooled]);
        let walk_shows =
            noises.any(|noise| matches!(noise.random_walk, Parameter::Observable { .. }));
        let length = span(sensor.stamps.span_s);
        found.push(match (walk_shows, warned) {
            (false, _) => {
                format!("nothing; a record of {length} is too short to show even the walk")
            }
            (true, true) => "nothing in the noise, but see the warnings above".into(),
            (true, false) => format!("nothing that a record of {length} can show"),
        });
    }
    found
}
