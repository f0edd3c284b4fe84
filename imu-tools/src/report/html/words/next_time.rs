//! What to record next time.

use super::{list, percent, span};
use crate::calibrate::SensorNoise;
use crate::calibrate::verdict::NextRecord;

/// What to do better.
pub(in super::super) fn next_time(sensors: &[&SensorNoise]) -> Vec<String> {
    let mut sentences: Vec<String> = sensors.iter().filter_map(|sensor| length(sensor)).collect();
    let named = |holds: fn(&SensorNoise) -> bool| {
        let names = sensors.iter().filter(|sensor| holds(sensor)).map(|sensor| sensor.kind.name());
        let names: Vec<&str> = names.collect();
        (!names.is_empty()).then(|| list(&names))
    };
    if let Some(names) = named(|sensor| sensor.contradiction.is_some()) {
        sentences.push(format!(
            "{names}: set the low-pass filter wider (or off) and publish at the full rate, if you want to see N \
             at short averaging times; the numbers here do not need it."
        ));
    }
    if let Some(names) = named(|sensor| !sensor.disturbed.is_empty()) {
        sentences.push(format!("{names}: leave it alone, on something solid, away from people."));
    }
    if let Some(names) = named(|sensor| sensor.stamps.missing > 0) {
        sentences.push(format!(
            "{names}: samples were lost on the way. Look at the cable, the driver’s queue and the disk: a filter \
             in use would miss them too."
        ));
    }
    sentences.push("Let it warm up for half an hour first, at an even temperature.".into());
    sentences
}

/// How long to record.
fn length(sensor: &SensorNoise) -> Option<String> {
    let name = sensor.kind.name();
    let within = percent((100.0 * NextRecord::WITHIN).round() / 100.0);
    let this = span(sensor.stamps.span_s);
    match NextRecord::of(sensor) {
        NextRecord::AtLeast(wanted_s) => {
            let wanted = span(wanted_s);
            Some(match NextRecord::enough_s(sensor) {
                Some(enough_s) => format!(
                    "{name}: record at least {}, for a K of all axes together that is good enough (this was {this}). Then \
                     look here again: K is known too roughly to say more. For K of each axis to {within} it would be \
                     {wanted} or longer.",
                    span(enough_s)
                ),
                None => format!(
                    "{name}: this was {this}, and enough for a filter. For K of each axis to {within} record at least \
                     {wanted}."
                ),
            })
        }
        NextRecord::LongEnough if sensor.misfit.contains(&true) => Some(format!(
            "{name}: a longer record alone does not help; find what else is in it (temperature, motion)."
        )),
        NextRecord::LongEnough => {
            Some(format!("{name}: this was long enough for K of each axis to {within}."))
        }
        NextRecord::HiddenByFlicker => Some(format!(
            "{name}: a longer record says little more of K, which flicker hides; a filter does not need it."
        )),
        NextRecord::Unknown => None,
    }
}
