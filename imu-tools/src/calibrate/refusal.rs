//! Recordings that are not fit to calibrate from, and why.

use super::{Options, SensorNoise};
use crate::error::Error;

/// Fewer good samples than this are no recording: not even N has an interval worth the name.
const FEWEST_SAMPLES: u64 = 32;

fn too_few(path: &str, samples: u64, options: &Options) -> Error {
    let cut = options.from_s.is_some() || options.to_s.is_some();
    let within = if cut { " between --from and --to" } else { "" };
    Error::data(format!(
        "{path} has only {samples} usable samples{within}: record the sensor at rest for at least \
         a minute (for the random walk of the bias: hours)"
    ))
}

/// What most of the samples are that were rejected, and what to do about it.
fn of_rejected(sensor: &SensorNoise) -> String {
    let checks = &sensor.checks;
    let zeros = 100.0 * checks.zeros;
    if 2 * checks.not_finite > sensor.rejected {
        "are not finite (empty fields, NaN or infinite on an axis): take such rows out of the recording".into()
    } else if zeros > 5.0 {
        format!(
            "are far from the others, {zeros:.0} % of the first ones being 0 on all axes, as a driver \
             writes that has no new reading: take such rows out of the recording"
        )
    } else {
        "are far beyond what its first ones show; if those are not of rest, leave them out with \
         --from, else mend the recording"
            .into()
    }
}

/// Why samples or stamps of a recording are not fit, if they are not.
pub(super) fn of_samples(
    path: &str,
    gyroscope: &Option<SensorNoise>,
    accelerometer: &Option<SensorNoise>,
    options: &Options,
) -> Option<Error> {
    let sensors = || [gyroscope, accelerometer].into_iter().flatten();
    let most = sensors().map(|s| s.stamps.samples - s.rejected).max().unwrap_or(0);
    if most < FEWEST_SAMPLES {
        return Some(too_few(path, most, options));
    }
    sensors().find_map(|sensor| {
        let name = sensor.kind.name();
        if sensor.stamps.rate_hz <= 0.0 && sensor.stamps.samples > 1 {
            return Some(Error::data(format!(
                "{path}: the stamps of the {name} never increase, so it has no rate: name the right \
                 column of time with --columns, or try --bag-time for a bag"
            )));
        }
        if sensor.rejected * 10 > sensor.stamps.samples {
            return Some(Error::data(format!(
                "{path}: {} of {} samples of the {name} {}",
                sensor.rejected,
                sensor.stamps.samples,
                of_rejected(sensor)
            )));
        }
        None
    })
}
