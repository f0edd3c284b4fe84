//! What each number means.

use imu_core::allan::Parameter;

use super::short;
use crate::calibrate::filter::{Basis, Factors, FilterValue, walk_for_filter};
use crate::calibrate::{SensorKind, SensorNoise};
use crate::report::Quantity;
use crate::report::plot::lowest;

/// Samples, rate, losses, and the averaging times of the fit.
pub(in super::super) fn sampling(sensor: &SensorNoise) -> String {
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
pub(in super::super) fn meaning(
    quantity: Quantity,
    pooled: Parameter,
    sensor: &SensorNoise,
) -> String {
    let bound = match (quantity, FilterValue::random_walk(sensor)) {
        (Quantity::RandomWalk(_), Some(FilterValue { value, basis: Basis::UpperBound })) => {
            Some(value)
        }
        _ => None,
    };
    let (value, by) = match (bound, pooled) {
        (Some(bound), _) => (bound, "by less than"),
        (None, Parameter::Observable { value, .. }) => (value, "by"),
        (None, Parameter::NotObservable { upper90, .. }) if upper90.is_finite() => {
            (upper90, "by less than")
        }
        (None, Parameter::NotObservable { .. }) => {
            return "Too little was recorded to say anything of it.".into();
        }
    };
    let walk = |text: String| match walk_for_filter(&sensor.pooled) {
        Some(walk) => format!(
            "{text} That is K alone, without the flicker B. With both the bias goes as far in {:.0} s as with a K of {} {} \
             by itself.",
            Factors::OVER_S,
            short(walk),
            quantity.unit()
        ),
        None => text,
    };
    match quantity {
        Quantity::BiasInstability(kind) => format!(
            "Flicker: a bias that wanders slowly, so that longer averages are no better. It holds the curve up at \
             0.664 B, here {} {}. B is what IEEE Std 952 calls bias instability, and is fitted, not read. \
             Where there is flicker, less is known of K.",
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
            "White noise of the acceleration. Integrated over a minute it changes the velocity by \
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

/// What to say of the row of all axes: something where it lies outside of the rows of the axes, or where some of them
/// show a value and others do not.
pub(in super::super) fn row_of_all(
    axes: [Option<Parameter>; 3],
    pooled: Option<Parameter>,
) -> Option<&'static str> {
    let shows = |parameter: &Parameter| matches!(parameter, Parameter::Observable { .. });
    let value = |parameter: Parameter| match parameter {
        Parameter::Observable { value, .. } => value,
        Parameter::NotObservable { upper90, .. } => upper90,
    };
    let all = pooled?;
    let axes = || axes.into_iter().flatten();
    let showing = axes().filter(shows).count();
    let (least, most) = axes()
        .map(value)
        .fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    let mixed = showing > 0 && (showing < axes().count() || !shows(&all));
    (mixed || value(all) > most || value(all) < least).then_some(
        "The row “all” is one fit to the three curves, not their mean, and may lie \
         outside of the three rows.",
    )
}

/// The lowest point of the Allan curve.
pub(in super::super) fn lowest_point(sensor: &SensorNoise) -> String {
    let twin = Quantity::BiasInstability(sensor.kind).twin();
    const WHAT: &str =
        "The lowest point of the Allan curve, which most datasheets print as bias instability";
    let Some((tau, deviation)) = lowest(sensor) else {
        return format!(
            "{WHAT}, was not reached: at the longest averaging time used the fit of all axes still falls."
        );
    };
    let found = match sensor.pooled.bias_instability {
        Some(Parameter::Observable { .. }) => "",
        _ => {
            " No flicker was found: here white noise and the walk of the bias meet, it is no noise of its own."
        }
    };
    format!(
        "{WHAT}: {} {} ({} {}, at {} s).{found}",
        short(deviation * twin.per_si),
        twin.unit,
        short(deviation),
        sensor.kind.unit(),
        short(tau)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_row_of_all_is_explained_where_it_surprises() {
        let known = |value| Some(Parameter::Observable { value, sd: 0.1, low90: 0.0, high90: 9.0 });
        let hidden = |upper90| Some(Parameter::NotObservable { upper90, record_at_least_s: 1.0 });
        let three = [known(1.0), known(2.0), known(3.0)];
        assert_eq!(row_of_all(three, known(2.5)), None);
        assert!(row_of_all(three, known(3.5)).is_some() && row_of_all(three, known(0.5)).is_some());
        assert!(row_of_all(three, hidden(2.0)).is_some());
        assert!(row_of_all([known(1.0), hidden(2.0), known(3.0)], known(2.0)).is_some());
        assert_eq!(row_of_all([hidden(1.0), hidden(2.0), hidden(3.0)], hidden(2.0)), None);
        assert_eq!(row_of_all(three, None), None);
    }
}
