//! What the user of a calibration should know before believing it, in sentences.

use imu_core::allan::{Octave, Parameter};

use super::filter::{Basis, Factors, FilterValue, walk_for_filter};
use super::verdict::NextRecord;
use super::{AxisNoise, Deviation, SensorNoise, Stretch};
use crate::recording::Summary;
use crate::scene::display_duration;

const AXES: [&str; 3] = ["x", "y", "z"];
/// Stretches that a sentence names, at most.
const NAMED: usize = 4;

/// No sensor warms up in less, s.
const SHORT_S: f64 = 20.0;
/// Short τ that contradict longer ones are those of motion where the sensor goes so many times as far
/// as the noise of the longer ones.
const MOTION: f64 = 2.0;
/// Differences from which on a deviation is known well enough for that.
const KNOWN: u64 = 64;

/// What is wrong with a sensor, its recording or its result; `keep_all` says that nothing was left
/// out.
pub(super) fn warnings(sensor: &SensorNoise, keep_all: bool) -> Vec<String> {
    let mut sentences = Vec::new();
    of_rest(&mut sentences, sensor, keep_all);
    of_small_ramp(&mut sentences, sensor, keep_all);
    of_noise(&mut sentences, sensor);
    of_values(&mut sentences, sensor);
    of_stamps(&mut sentences, &sensor.stamps);
    let name = sensor.kind.name();
    sentences.iter().map(|sentence| format!("{name}: {sentence}")).collect()
}

/// Where the sensor was not at rest, or not warm.
fn of_rest(to: &mut Vec<String>, sensor: &SensorNoise, keep_all: bool) {
    of_frozen(to, sensor, keep_all);
    let frozen = |s: &&Stretch| sensor.checks.frozen.iter().any(|(_, frozen)| frozen == *s);
    let moved: Vec<Stretch> = sensor.disturbed.iter().filter(|s| !frozen(s)).copied().collect();
    if !moved.is_empty() {
        let total: f64 = moved.iter().map(|s| s.to_s - s.from_s).sum();
        let what = if keep_all {
            "kept, because --keep-all is given: N and K are those of the motion"
        } else {
            "left out (--keep-all would keep it)"
        };
        to.push(format!(
            "moved, touched or shaken for {} in all ({}): {what}",
            seconds(total),
            named(&moved)
        ));
    }
    if let Some(warm_up_s) = sensor.warm_up_s {
        let what = if keep_all {
            "kept, because --keep-all is given, and read as random walk: K is too large"
        } else {
            "not used for K (--keep-all would use it)"
        };
        let (length, how) = if warm_up_s < SHORT_S {
            (
                format!("{warm_up_s:.1} s"),
                "go further than the noise of the rest does (the sensor settles, or is moved)",
            )
        } else {
            (seconds(warm_up_s), "drift as a sensor does that warms up")
        };
        to.push(format!("the first {length} {how}: {what}"));
    }
    if let Some(slope) = sensor.ramp {
        let unit = sensor.kind.unit();
        let hourly = slope.map(|s| format!("{:+.2e}", s * 3600.0)).join(", ");
        let what = if keep_all {
            match sensor.pooled.rate_ramp {
                Some(_) => "kept, because --keep-all is given, and fitted as a ramp beside K",
                None => {
                    "kept, because --keep-all is given, and read as random walk: K is too large"
                }
            }
        } else {
            "K is read from the Hadamard variance, which is blind to it"
        };
        to.push(format!(
            "drifts over all of the record by {hourly} {unit} an hour (x, y, z), as temperature makes \
             it do: {what}"
        ));
    }
}

/// A ramp too small to be seen in the way of the mean, but not in the long averaging times.
fn of_small_ramp(to: &mut Vec<String>, sensor: &SensorNoise, keep_all: bool) {
    if let (None, Some(Parameter::Observable { value, .. })) =
        (sensor.ramp, sensor.pooled.rate_ramp)
    {
        let past = if keep_all { "beside it" } else { "past it, from the Hadamard variance" };
        to.push(format!(
            "the long averaging times ask for a ramp, of {:.2e} {} an hour: K is read {past}",
            value * 3600.0,
            sensor.kind.unit()
        ));
    }
}

/// Where an axis stood still that otherwise never does.
fn of_frozen(to: &mut Vec<String>, sensor: &SensorNoise, keep_all: bool) {
    let what = if keep_all {
        "kept, because --keep-all is given: N is too small and K too large"
    } else {
        "left out (--keep-all would keep it)"
    };
    let mut kinds: Vec<[bool; 3]> = Vec::new();
    for (axes, _) in &sensor.checks.frozen {
        if !kinds.contains(axes) {
            kinds.push(*axes);
        }
    }
    for kind in kinds {
        let of_kind = sensor.checks.frozen.iter().filter(|(axes, _)| *axes == kind);
        let stretches: Vec<Stretch> = of_kind.map(|(_, stretch)| *stretch).collect();
        let axes: Vec<&str> = AXES
            .into_iter()
            .zip(kind)
            .filter(|(_, frozen)| *frozen)
            .map(|(axis, _)| axis)
            .collect();
        let who = match axes.as_slice() {
            [axis] => format!("axis {axis}"),
            [first, second] => format!("axes {first} and {second}"),
            _ => "all axes".into(),
        };
        to.push(format!(
            "{who} stood still ({}), as a sensor or a driver does that hangs: {what}",
            named(&stretches)
        ));
    }
}

/// What the fit says.
fn of_noise(to: &mut Vec<String>, sensor: &SensorNoise) {
    if let Some(contradiction) = sensor.contradiction {
        let longest = sensor.deviation.get(contradiction.octave).map_or(0.0, |d| d.tau_s);
        let sigmas = contradiction.sigmas;
        let decide = format!(
            "averaging times up to {longest:.3} s are not used for the fit: they contradict the longer ones, \
             the longest that does by {sigmas:.0} standard deviations; the two after it are left out too"
        );
        to.push(match motion(sensor, contradiction.octave) {
            Some((times, tau_s)) => format!(
                "moved or shaken all the time: at τ = {tau_s:.2} s it goes {times:.1} times as far as \
                 white noise that is as large at longer τ; {decide}; record it at rest"
            ),
            None => format!("{decide}, as a low-pass filter or a vibration makes them do"),
        });
    }
    for (axis, _) in AXES.iter().zip(sensor.misfit).filter(|(_, misfit)| *misfit) {
        to.push(format!(
            "axis {axis} has more in it than {} (drift, temperature, motion): take its K for an upper \
             limit, and the intervals for too narrow",
            fitted(sensor)
        ));
    }
    if let Some(Parameter::Observable { .. }) = sensor.pooled.bias_instability {
        let unit = sensor.kind.walk_unit();
        let walk = walk_for_filter(&sensor.pooled).unwrap_or_default();
        to.push(format!(
            "there is flicker (bias instability B), and beside it K is known less well than alone; filters know \
             no B, so their files hold {walk:.2e} {unit} for K, with which the bias goes as far in {:.0} s as by \
             B and K together",
            Factors::OVER_S
        ));
    }
    if let Some(times) = spread_of_axes(sensor) {
        to.push(format!(
            "one axis has {times:.1} times the white noise of another; what is pooled fits neither: \
             take each axis by itself"
        ));
    }
    if let Parameter::NotObservable { upper90, .. } = sensor.pooled.random_walk
        && upper90.is_finite()
    {
        to.push(format!(
            "the record is too short to show the random walk of the bias{}",
            longer(sensor)
        ));
    } else if let Some(FilterValue { value, basis: Basis::UpperBound }) =
        FilterValue::random_walk(sensor)
    {
        let unit = sensor.kind.walk_unit();
        to.push(format!(
            "K is not known well: files for filters hold {value:.2e} {unit}, a bound that covers all axes{}",
            longer(sensor)
        ));
    }
}

/// What length would make K known well enough, where it is length that is wanting.
fn longer(sensor: &SensorNoise) -> String {
    NextRecord::enough_s(sensor)
        .map_or_else(String::new, |enough_s| format!("; record at least {}", seconds(enough_s)))
}

/// The terms that were fitted, in words.
fn fitted(sensor: &SensorNoise) -> &'static str {
    let AxisNoise { bias_instability, quantisation, rate_ramp, .. } = sensor.pooled;
    if bias_instability.is_none() && quantisation.is_none() && rate_ramp.is_none() {
        "white noise and a random walk"
    } else {
        "the terms that were fitted"
    }
}

/// Whether a sensor was moved or shaken all the time, so that its numbers are those of the motion.
pub(super) fn moved_throughout(sensor: &SensorNoise) -> bool {
    sensor.contradiction.is_some_and(|c| motion(sensor, c.octave).is_some())
}

/// How many times as far the axes go at a τ, up to that of `octave`, as white noise would that goes as far
/// as they do at some longer τ; and that τ, s. A swing averages out faster than noise does, while behind
/// a low-pass filter noise averages out more slowly.
fn motion(sensor: &SensorNoise, octave: usize) -> Option<(f64, f64)> {
    let far = |deviation: &Deviation| {
        let square = |axis: &Octave| axis.deviation() * axis.deviation();
        (deviation.octaves.iter().map(square).sum::<f64>() / 3.0 * deviation.tau_s).sqrt()
    };
    let known =
        |deviation: &&Deviation| deviation.octaves.iter().all(|axis| axis.differences >= KNOWN);
    // The shortest τ is that of steps and of noise that is not white, too.
    let short = sensor.deviation.iter().take(octave + 1).enumerate().skip(1);
    let (peak, most) = short.max_by(|a, b| far(a.1).total_cmp(&far(b.1)))?;
    let longer = sensor.deviation.iter().skip(peak + 1).take_while(known).map(far);
    let times = far(most) / longer.min_by(f64::total_cmp)?;
    (times > MOTION).then_some((times, most.tau_s))
}

/// What sensor and driver did to the values.
fn of_values(to: &mut Vec<String>, sensor: &SensorNoise) {
    let checks = &sensor.checks;
    if sensor.rejected > 0 {
        to.push(format!(
            "{} samples are not finite or absurdly large and count as missing",
            sensor.rejected
        ));
    }
    for (k, axis) in AXES.iter().enumerate() {
        if checks.stuck[k] {
            to.push(format!(
                "axis {axis} never changes: it is stuck, or finer than the recording's digits"
            ));
        } else if checks.saturated[k] > 0 {
            let (low, high) = checks.range[k];
            to.push(format!(
                "axis {axis} stays at an end of its range ({low:.4} to {high:.4}) for {} samples: it is \
                 saturated there",
                checks.saturated[k]
            ));
        }
        // From a step of 2σ on, rounding is no longer a small white noise of its own.
        if let Some(step) = checks.step[k]
            && let Some(sigma) = sensor.deviation.first().map(|d| d.octaves[k].deviation())
            && sigma > 0.0
            && step > 2.0 * sigma
        {
            to.push(format!(
                "axis {axis} moves in steps of {step:.2e}, larger than its noise ({sigma:.2e}): N is of \
                 the steps; set the sensor to a smaller range"
            ));
        }
    }
    let samples = sensor.stamps.samples;
    if checks.is_held(samples) {
        // A longer run is a sensor that hangs.
        let row = match checks.longest_hold {
            longest @ ..64 => format!(", up to {longest} in a row"),
            _ => String::new(),
        };
        to.push(format!(
            "{:.0} % of the samples repeat the one before{row}: the driver publishes faster than the \
             sensor measures, and N is not that of the sensor; record at its own rate",
            100.0 * checks.held as f64 / samples.max(1) as f64,
        ));
    }
}

/// What the clocks did.
fn of_stamps(to: &mut Vec<String>, stamps: &Summary) {
    let Summary { samples, gap_count, missing, duplicates, backward, restarts, .. } = *stamps;
    if gap_count > 0 {
        let longest = stamps.longest_gap.filter(|_| stamps.rate_hz > 0.0);
        let longest = longest.map_or_else(String::new, |gap| {
            let length = gap.missing as f64 / stamps.rate_hz;
            let at = seconds(gap.at_s);
            format!(
                ", the longest of {} samples ({length:.3} s), {at} after the start",
                gap.missing
            )
        });
        to.push(format!("samples missing: {missing}, gaps: {gap_count}{longest}"));
    }
    if duplicates > samples / 2 {
        to.push(
            "most stamps are the same as the one before: they are too coarse, and the rate (and with \
             it N and K) may be wrong"
                .into(),
        );
    } else if duplicates > 0 {
        to.push(format!("stamps that are the same as the one before: {duplicates}"));
    }
    if backward > 0 {
        to.push(format!("stamps that are earlier than the one before: {backward}"));
    }
    if let Some(step) = stamps.clock_steps.first() {
        to.push(format!(
            "times that the clock was set while samples went on: {} (first by {:+.3} s, {} after the \
             start)",
            stamps.clock_steps.len(),
            step.by_s,
            seconds(step.at_s)
        ));
    }
    if let Some(first) = stamps.breaks.first() {
        let at = seconds(first.at_s);
        let what = if first.by_s > 0.0 {
            format!("nothing was recorded for {}, {at} after the start", seconds(first.by_s))
        } else {
            format!("the clock was set back by {}, {at} after the start", seconds(-first.by_s))
        };
        let more = match restarts {
            1 => String::new(),
            n => format!(" (the first of {n} such breaks)"),
        };
        to.push(format!("{what}{more}: no averaging time spans that"));
    }
}

/// How many times the least noisy axis the noisiest one has of white noise, if that is twice or
/// more.
fn spread_of_axes(sensor: &SensorNoise) -> Option<f64> {
    let densities = sensor.axes.iter().filter_map(|axis| match axis.noise_density {
        Parameter::Observable { value, .. } => Some(value),
        Parameter::NotObservable { .. } => None,
    });
    let (least, most) =
        densities.fold((f64::INFINITY, 0.0_f64), |(low, high), n| (low.min(n), high.max(n)));
    (most >= 2.0 * least).then(|| most / least)
}

/// The first few of some stretches, and how many more there are.
fn named(stretches: &[Stretch]) -> String {
    let named: Vec<String> = stretches.iter().take(NAMED).map(stretch).collect();
    let more = stretches.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{more}", named.join(", "))
}

fn stretch(stretch: &Stretch) -> String {
    format!("{:.0} to {:.0} s", stretch.from_s, stretch.to_s)
}

fn seconds(seconds: f64) -> String {
    display_duration((seconds.clamp(0.0, 1e9).round() * 1e9) as u64)
}

#[cfg(test)]
#[path = "advice_tests.rs"]
mod tests;
