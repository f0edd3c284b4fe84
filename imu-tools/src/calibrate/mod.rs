//! From samples to noise parameters.
//!
//! A recording is read on one thread and computed on another, block by block, in memory that does
//! not grow: stamps go to a grid ([`crate::recording::Timeline`]), values into a ladder of Allan
//! variances, and at the end `imu_core::allan` fits N and K to it (or another [`Estimator`] does).
//!
//! ```
//! use imu_tools::calibrate::{Options, calibrate};
//! use imu_tools::scene::{Preset, Scene, Simulator};
//!
//! let scene = Scene { duration_ns: 600_000_000_000, ..Preset::Mid.scene() };
//! let source = Box::new(Simulator::new(&scene)?);
//! let calibration = calibrate(source, "simulated", &Options::default(), |_| {})?;
//! let gyroscope = calibration.gyroscope.unwrap();
//! assert_eq!(gyroscope.stamps.samples, 120_000);
//! # Ok::<(), imu_tools::error::Error>(())
//! ```

mod advice;
pub mod batch;
pub mod block_means;
mod checks;
mod drift;
pub mod five_terms;
mod gravity;
pub mod maximum_likelihood;
mod sensor;
pub mod slope;
mod stillness;
mod usual;

pub use checks::Checks;

use imu_core::allan::{Contradiction, Octave, Parameter};

use crate::error::Error;
use crate::recording::{Block, Note, Sample, Source, Summary, read_ahead};
use sensor::Pipeline;

/// Octaves of τ that a ladder holds here: at 1 kHz the longest is 12 days.
pub const LEVELS: usize = 31;

/// What to leave out, and how to estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Start this many seconds after the first sample of each record.
    pub from_s: Option<f64>,
    /// End this many seconds after the first sample of each record.
    pub to_s: Option<f64>,
    /// The user has said what unit the accelerometer is in: gravity that contradicts it is only
    /// worth a warning.
    pub unit_is_given: bool,
    /// How N and K are estimated.
    pub estimator: Estimator,
    /// Leave nothing out: neither what was handled nor the warm-up, and read no K past a ramp.
    pub keep_all: bool,
}

/// How N and K are estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimator {
    /// By the likelihood of the octaves ([`imu_core::allan::fit_noise`]).
    #[default]
    Octaves,
    /// By exact maximum likelihood on block means ([`maximum_likelihood`]).
    MaximumLikelihood,
    /// By the classic slopes ([`slope`]), for comparison: they have no intervals.
    Slope,
}

/// What a recording says about its IMU.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The recording's name; of several, all of them.
    pub path: String,
    /// The names of the files one by one, by their first stamps.
    pub paths: Vec<String>,
    /// Length of the longer sensor's record, seconds.
    pub span_s: f64,
    /// What was taken for granted.
    pub remarks: Vec<String>,
    /// What is wrong with the recording or its result.
    pub warnings: Vec<String>,
    /// Angular rate, rad/s.
    pub gyroscope: Option<SensorNoise>,
    /// Specific force, m/s².
    pub accelerometer: Option<SensorNoise>,
}

/// Which of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorKind {
    /// Angular rate.
    Gyroscope,
    /// Specific force.
    Accelerometer,
}

impl SensorKind {
    /// `gyroscope` or `accelerometer`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gyroscope => "gyroscope",
            Self::Accelerometer => "accelerometer",
        }
    }
}

/// The noise of one sensor.
#[derive(Clone, Debug)]
pub struct SensorNoise {
    /// Which one.
    pub kind: SensorKind,
    /// Topic or columns that it was read from.
    pub topic: String,
    /// What its stamps are like.
    pub stamps: Summary,
    /// Samples that counted as missing: not finite, or absurdly far from the others.
    pub rejected: u64,
    /// Mean of each axis, in the sensor's unit.
    pub mean: [f64; 3],
    /// The same of each record ([`Source::record_number`]) that has samples: bias and attitude may differ.
    pub record_means: Vec<(usize, [f64; 3])>,
    /// x, y and z on their own.
    pub axes: [AxisNoise; 3],
    /// All axes by their joint likelihood.
    pub pooled: AxisNoise,
    /// Shortest and longest τ that decided, s.
    pub tau_used_s: Option<(f64, f64)>,
    /// Why shorter τ did not: they contradict the longer ones.
    pub contradiction: Option<Contradiction>,
    /// White noise and random walk are not all there is on these axes.
    pub misfit: [bool; 3],
    /// Stretches in which the sensor was not at rest, the first thousand; left out unless
    /// [`Options::keep_all`].
    pub disturbed: Vec<Stretch>,
    /// Seconds at the beginning in which the sensor warmed up, which decide nothing about long
    /// averaging times unless [`Options::keep_all`].
    pub warm_up_s: Option<f64>,
    /// A drift over all of the record, unit per second on each axis, where there is more of it than
    /// noise explains. K is then read from the Hadamard variance, unless [`Options::keep_all`].
    pub ramp: Option<[f64; 3]>,
    /// What the values themselves say of the sensor and its driver.
    pub checks: Checks,
    /// The variance at every τ that has one, shortest first.
    pub deviation: Vec<Deviation>,
}

/// A part of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Seconds after the first sample.
    pub from_s: f64,
    /// Seconds after the first sample.
    pub to_s: f64,
}

/// N and K of one axis, or of all together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisNoise {
    /// N: angle or velocity random walk, unit/√Hz.
    pub noise_density: Parameter,
    /// K: random walk of the bias, unit/s/√Hz.
    pub random_walk: Parameter,
}

/// The Allan deviations at one averaging time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Averaging time, s.
    pub tau_s: f64,
    /// x, y, z.
    pub octaves: [Octave; 3],
    /// Equivalent degrees of freedom of each, under the noise that was fitted.
    pub edf: [f64; 3],
}

/// How far a calibration has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Bytes read of the recording.
    pub bytes: u64,
    /// Samples taken of the sensor that has more.
    pub samples: u64,
}

/// Calibrates the recording that `source` reads; `path` names it in messages, and `progress` is
/// told now and then.
///
/// # Errors
/// What the source says when it cannot be read; too few samples; gravity in another unit.
pub fn calibrate(
    source: Box<dyn Source>,
    path: &str,
    options: &Options,
    mut progress: impl FnMut(Progress),
) -> Result<Calibration, Error> {
    let mut window = Window::new(options);
    let mut gyroscope = Pipeline::new(SensorKind::Gyroscope, options);
    let mut accelerometer = Pipeline::new(SensorKind::Accelerometer, options);
    let mut samples = 0;
    let mut record = 0;
    let mut source = read_ahead(source, |block, at| {
        if at.record != record {
            record = at.record;
            window = Window::new(options);
            gyroscope.next_record();
            accelerometer.next_record();
        }
        window.open(block);
        gyroscope.push(window.cut(&block.gyroscope));
        accelerometer.push(window.cut(&block.accelerometer));
        samples += block.gyroscope.len().max(block.accelerometer.len()) as u64;
        progress(Progress { bytes: at.bytes, samples });
        Ok(())
    })?;

    let (mut remarks, mut warnings) = (Vec::new(), Vec::new());
    for note in source.take_notes() {
        match note {
            Note::Info(text) => remarks.push(text),
            Note::Warning(text) => warnings.push(text),
        }
    }
    let gyroscope = gyroscope.finish(source.gyroscope());
    let accelerometer = accelerometer.finish(source.accelerometer());
    let most = [&gyroscope, &accelerometer]
        .iter()
        .filter_map(|sensor| sensor.as_ref().map(|s| s.stamps.samples - s.rejected))
        .max()
        .unwrap_or(0);
    if most < FEWEST_SAMPLES {
        return Err(too_few(path, most, options));
    }
    for sensor in [&gyroscope, &accelerometer].into_iter().flatten() {
        if sensor.stamps.rate_hz <= 0.0 && sensor.stamps.samples > 1 {
            return Err(Error::data(format!(
                "{path}: the stamps of the {} never increase, so it has no rate: name the right column \
                 of time with --columns, or try --bag-time for a bag",
                sensor.kind.name()
            )));
        }
        if sensor.rejected * 10 > sensor.stamps.samples {
            return Err(Error::data(format!(
                "{path}: {} of {} samples of the {} are not finite or far beyond what its first ones \
                 show; leave out its beginning with --from, or mend the recording",
                sensor.rejected,
                sensor.stamps.samples,
                sensor.kind.name()
            )));
        }
    }
    for (record, mean) in accelerometer.iter().flat_map(|sensor| &sensor.record_means) {
        let name = source.record_name(*record);
        match gravity::check(*mean) {
            gravity::Verdict::Plausible => {}
            gravity::Verdict::OtherUnit(sentence) if !options.unit_is_given => {
                let name = name.as_deref().unwrap_or(path);
                return Err(Error::data(format!("{name}: {sentence}")));
            }
            gravity::Verdict::OtherUnit(sentence) | gravity::Verdict::Odd(sentence) => {
                warnings.push(match name {
                    Some(name) => format!("{name}: {sentence}"),
                    None => sentence,
                });
            }
        }
    }
    for sensor in [&gyroscope, &accelerometer].into_iter().flatten() {
        warnings.extend(advice::warnings(sensor, options.keep_all));
    }
    let span = |sensor: &Option<SensorNoise>| sensor.as_ref().map_or(0.0, |s| s.stamps.span_s);
    Ok(Calibration {
        path: path.to_owned(),
        paths: vec![path.to_owned()],
        span_s: span(&gyroscope).max(span(&accelerometer)),
        remarks,
        warnings,
        gyroscope,
        accelerometer,
    })
}

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

/// The part of each record between --from and --to.
struct Window {
    from_ns: i64,
    to_ns: i64,
    first: Option<i64>,
}

impl Window {
    fn new(options: &Options) -> Self {
        let ns = |s: f64| (s * 1e9) as i64; // saturates
        Self {
            from_ns: options.from_s.map_or(i64::MIN, ns),
            to_ns: options.to_s.map_or(i64::MAX, ns),
            first: None,
        }
    }

    /// Notes where the recording begins.
    fn open(&mut self, block: &Block) {
        if self.first.is_none() {
            let first = [block.gyroscope.first(), block.accelerometer.first()];
            self.first = first.into_iter().flatten().map(|sample| sample.stamp_ns).min();
        }
    }

    /// The samples of a block that lie within.
    fn cut<'a>(&self, samples: &'a [Sample]) -> &'a [Sample] {
        let Some(first) = self.first else { return samples };
        if self.from_ns == i64::MIN && self.to_ns == i64::MAX {
            return samples;
        }
        let within = |sample: &Sample| {
            let at = sample.stamp_ns.saturating_sub(first);
            at >= self.from_ns && at <= self.to_ns
        };
        let start = samples.iter().position(within).unwrap_or(samples.len());
        let end = samples.iter().rposition(within).map_or(start, |last| last + 1);
        samples.get(start..end).unwrap_or_default()
    }
}
