//! What the user of a calibration should know before believing it, in sentences.

use imu_core::allan::Parameter;

use super::{SensorNoise, Stretch};
use crate::recording::Summary;
use crate::scene::display_duration;

const AXES: [&str; 3] = ["x", "y", "z"];
/// Stretches that a sentence names, at most.
const NAMED: usize = 4;

/// What is wrong with a sensor, its recording or its result; `keep_all` says that nothing was left
/// out.
pub(super) fn warnings(sensor: &SensorNoise, keep_all: bool) -> Vec<String> {
    let mut sentences = Vec::new();
    of_rest(&mut sentences, sensor, keep_all);
    of_noise(&mut sentences, sensor);
    of_values(&mut sentences, sensor);
    of_stamps(&mut sentences, &sensor.stamps);
    let name = sensor.kind.name();
    sentences.iter().map(|sentence| format!("{name}: {sentence}")).collect()
}

/// Where the sensor was not at rest, or not warm.
fn of_rest(to: &mut Vec<String>, sensor: &SensorNoise, keep_all: bool) {
    if !sensor.disturbed.is_empty() {
        let total: f64 = sensor.disturbed.iter().map(|s| s.to_s - s.from_s).sum();
        let named: Vec<String> = sensor.disturbed.iter().take(NAMED).map(stretch).collect();
        let more = sensor.disturbed.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let what = if keep_all {
            "kept, because --keep-all is given: N and K are those of the motion"
        } else {
            "left out (--keep-all would keep it)"
        };
        to.push(format!(
            "moved, touched or shaken for {} in all ({}{more}): {what}",
            seconds(total),
            named.join(", ")
        ));
    }
    if let Some(warm_up_s) = sensor.warm_up_s {
        let what = if keep_all {
            "kept, because --keep-all is given, and read as random walk: K is too large"
        } else {
            "they decide nothing about K (--keep-all would let them)"
        };
        to.push(format!(
            "the first {} drift as a sensor does that warms up: {what}",
            seconds(warm_up_s)
        ));
    }
    if let Some(slope) = sensor.ramp {
        let unit = sensor.kind.unit();
        let hourly = slope.map(|s| format!("{:+.2e}", s * 3600.0)).join(", ");
        let what = if keep_all {
            "kept, because --keep-all is given, and read as random walk: K is too large"
        } else {
            "K is read from the Hadamard variance, which is blind to it"
        };
        to.push(format!(
            "drifts over all of the record by {hourly} {unit} an hour (x, y, z), as temperature makes \
             it do: {what}"
        ));
    }
}

/// What the fit says.
fn of_noise(to: &mut Vec<String>, sensor: &SensorNoise) {
    if let Some(contradiction) = sensor.contradiction {
        let longest = sensor.deviation.get(contradiction.octave).map_or(0.0, |d| d.tau_s);
        to.push(format!(
            "averaging times up to {longest:.3} s decide nothing: they contradict the longer ones by \
             {:.0} standard deviations, as a low-pass filter or a vibration makes them do",
            contradiction.sigmas
        ));
    }
    for (axis, _) in AXES.iter().zip(sensor.misfit).filter(|(_, misfit)| *misfit) {
        to.push(format!(
            "axis {axis} has more in it than white noise and a random walk (bias instability, drift, \
             temperature, motion): take its K for an upper limit, and the intervals for too narrow"
        ));
    }
    if let Some(times) = spread_of_axes(sensor) {
        to.push(format!(
            "one axis has {times:.1} times the white noise of another; what is pooled fits neither: \
             take each axis by itself"
        ));
    }
    if let Parameter::NotObservable { upper90, record_at_least_s } = sensor.pooled.random_walk
        && upper90.is_finite()
    {
        to.push(format!(
            "the record is too short to show the random walk of the bias; record at least {}, better \
             for hours",
            seconds(record_at_least_s)
        ));
    }
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
        to.push(format!(
            "{:.0} % of the samples repeat the one before, up to {} in a row: the driver publishes \
             faster than the sensor measures, and N is not that of the sensor; record at its own rate",
            100.0 * checks.held as f64 / samples.max(1) as f64,
            checks.longest_hold
        ));
    }
}

/// What the clocks did.
fn of_stamps(to: &mut Vec<String>, stamps: &Summary) {
    let Summary { samples, gap_count, missing, duplicates, backward, restarts, .. } = *stamps;
    if gap_count > 0 {
        let longest = stamps.gaps.iter().max_by_key(|gap| gap.missing);
        let longest = longest.filter(|_| stamps.rate_hz > 0.0).map_or_else(String::new, |gap| {
            let length = gap.missing as f64 / stamps.rate_hz;
            format!(", the longest of {length:.3} s, {} after the start", seconds(gap.at_s))
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

fn stretch(stretch: &Stretch) -> String {
    format!("{:.0} to {:.0} s", stretch.from_s, stretch.to_s)
}

fn seconds(seconds: f64) -> String {
    display_duration((seconds.clamp(0.0, 1e9).round() * 1e9) as u64)
}
