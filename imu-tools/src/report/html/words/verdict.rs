//! Is it good enough, and of which class?

use imu_core::allan::Parameter;

use super::{axes, list, lost, percent, short};
use crate::calibrate::filter::{Basis, FilterValue};
use crate::calibrate::verdict::{Enough, Grade, Known, interval};
use crate::calibrate::{SensorKind, SensorNoise};
use crate::report::Quantity;
use crate::report::plot::lowest;

/// Yes or no, of all sensors, and where good enough ends.
pub(in super::super) fn overall(sensors: &[&SensorNoise]) -> String {
    let Some(worst) = sensors.iter().map(|sensor| Enough::of(sensor)).max() else {
        return "No: there is nothing in this recording.".into();
    };
    let names: Vec<&str> = sensors
        .iter()
        .filter(|sensor| Enough::of(sensor) == worst)
        .map(|sensor| sensor.kind.name())
        .collect();
    let (names, limit) = (list(&names), percent(Known::ENOUGH));
    match worst {
        Enough::Yes => format!(
            "Yes. What a filter needs of the {names} is known to {limit} or better of all axes together, which is good enough."
        ),
        Enough::BoundOfWalk => format!(
            "Yes for N, no for K of the {names}. Good enough is {limit} or better of all axes together. The blocks for your filter \
             hold a safe upper bound of K in its place; a longer recording gives a smaller one."
        ),
        Enough::NotKnown => format!(
            "No. Of the {names} too little is known; good enough is {limit} or better. Record longer."
        ),
        Enough::NotAtRest => format!(
            "No. The {names} did not show healthy values at rest: see the warnings, mend that, and record again."
        ),
    }
}

/// How well the numbers of a sensor are known, and what class it is of.
pub(in super::super) fn verdict(sensor: &SensorNoise) -> String {
    let n = match Known::of(sensor.pooled.noise_density) {
        Known::Well(half) => format!("White noise is known well, to {}.", percent(half)),
        Known::Fairly(half) => format!("White noise is known to {}: good enough.", percent(half)),
        Known::Roughly(half) => format!("White noise is known only to {}.", percent(half)),
        Known::Below(_) => "White noise does not show; only its bound is known.".into(),
        Known::Reading => "White noise is a reading off a line, without an interval.".into(),
        Known::NotAtAll => "Nothing is known of white noise.".into(),
    };
    let missing = lost(sensor).map_or_else(String::new, |share| {
        format!(" {share} of its samples are missing; the fit allows for that.")
    });
    format!("{n} {}{missing} {}", walk(sensor), classes(sensor))
}

/// How well K is known.
fn walk(sensor: &SensorNoise) -> String {
    let pooled = sensor.pooled.random_walk;
    let unit = Quantity::RandomWalk(sensor.kind).unit();
    let Some(FilterValue { value, basis }) = FilterValue::random_walk(sensor) else {
        return "Nothing is known of the walk of the bias: record longer.".into();
    };
    let value = short(value);
    match (basis, Known::of(pooled)) {
        (Basis::Reading, _) => {
            "The walk of the bias is a reading off a line, without an interval.".into()
        }
        (Basis::Estimate, Known::Well(half)) => {
            format!("The walk of the bias is known well, to {}.", percent(half))
        }
        (Basis::Estimate, Known::Fairly(half) | Known::Roughly(half)) => {
            format!("The walk of the bias is known to {}: good enough for a filter.", percent(half))
        }
        (Basis::Estimate, _) => "The walk of the bias is known.".into(),
        (Basis::CoversFlicker, _) => format!(
            "Its bias shows flicker (B), which hides the walk K. Filters are given {value} {unit} for K, with which \
             the bias goes as far in 100 s as by both."
        ),
        (Basis::UpperBound, _) => {
            let seen = if sensor.misfit.contains(&true) {
                "There is more in the signal than what was fitted, so K is no more than a bound"
                    .into()
            } else {
                roughly(sensor)
            };
            format!(
                "{seen}. Filters are given {value} {unit}, an upper bound that covers all axes."
            )
        }
    }
}

/// What is seen of a K that is not known well enough.
fn roughly(sensor: &SensorNoise) -> String {
    let unit = Quantity::RandomWalk(sensor.kind).unit();
    let shows =
        sensor.axes.each_ref().map(|axis| matches!(axis.random_walk, Parameter::Observable { .. }));
    match (axes(shows), sensor.pooled.random_walk) {
        (None, Parameter::NotObservable { .. }) => {
            "The walk of the bias does not show in a record of this length".into()
        }
        (Some(axes), _) if shows.contains(&false) => {
            format!("The walk of the bias shows on {axes} only")
        }
        (Some(_), Parameter::NotObservable { .. }) => {
            "The walk of the bias does not show on all axes together".into()
        }
        (_, Parameter::Observable { value, low90, high90, .. }) => {
            let (low, high) = interval(value, low90, high90);
            format!(
                "The walk of the bias is known only roughly, {} to {} {unit}",
                short(low),
                short(high)
            )
        }
    }
}

/// The class by N, that by the bias, and which counts where they differ.
fn classes(sensor: &SensorNoise) -> String {
    let Parameter::Observable { value, .. } = sensor.pooled.noise_density else {
        return String::new();
    };
    let twin = Quantity::NoiseDensity(sensor.kind).twin();
    let density = value * twin.per_si;
    let by_noise = Grade::of(sensor.kind, density);
    let mut text = format!(
        "By its white noise ({} {}) it is {}. ({}.)",
        short(density),
        twin.unit,
        grade(by_noise),
        borders(Grade::borders(sensor.kind), twin.unit)
    );
    let (SensorKind::Gyroscope, Some((_, deviation))) = (sensor.kind, lowest(sensor)) else {
        return text;
    };
    let twin = Quantity::BiasInstability(sensor.kind).twin();
    let bias = deviation * twin.per_si;
    let by_bias = Grade::of_bias_instability(bias);
    text.push_str(&format!(
        " By the lowest point of its Allan curve ({} {}) it is {}. ({}: borders of our own choice.)",
        short(bias),
        twin.unit,
        if by_bias == by_noise { "of the same class" } else { grade(by_bias) },
        borders(Grade::BIAS_INSTABILITY, twin.unit)
    ));
    if by_bias != by_noise {
        text.push_str(
            " The two differ: white noise decides for tracking of motion over seconds, the bias for navigation \
             without other sensors over minutes.",
        );
    }
    text
}

/// Where classes end.
fn borders([navigation, tactical, industrial, consumer]: [f64; 4], unit: &str) -> String {
    format!(
        "Up to {navigation} {unit} is navigation, {tactical} tactical, {industrial} industrial, {consumer} consumer"
    )
}

fn grade(grade: Grade) -> &'static str {
    match grade {
        Grade::Navigation => "of navigation class, as in airliners and ships",
        Grade::Tactical => "of tactical class, among the best of small sensors",
        Grade::Industrial => "of industrial class, a good MEMS",
        Grade::Consumer => "of consumer class, as in telephones and drones",
        Grade::Beyond => {
            "noisier than consumer sensors usually are: see whether its range and filter are set well"
        }
    }
}
