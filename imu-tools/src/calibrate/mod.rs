//! From samples to noise parameters.
//!
//! A recording is read on one thread, and each sensor computed on another, block by block, in memory
//! that does not grow: stamps go to a grid ([`crate::recording::Timeline`]), values into a ladder of Allan
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
mod envelope;
pub mod filter;
mod fits;
pub mod five_terms;
pub(crate) mod gravity;
mod held;
mod ladder_bytes;
mod lane;
mod limits;
pub mod live;
pub mod maximum_likelihood;
pub mod one_sample;
mod refusal;
mod sensor;
mod shifts;
pub mod slope;
mod stillness;
mod taken;
mod temperature;
mod terms;
mod usual;
pub mod verdict;
mod window;

use serde::{Deserialize, Serialize};

pub use checks::Checks;
pub use envelope::Column;
pub use temperature::TemperatureRange;

use imu_core::allan::{AllanLadder, Contradiction, Octave, Parameter, Terms};

use crate::error::Error;
use crate::recording::{Block, Note, Source, Stream, Summary};
use lane::Lane;
use sensor::Pipeline;
use temperature::Thermometer;
use window::Window;

/// Octaves of τ that a ladder holds here: at 1 kHz the longest is 12 days.
pub const LEVELS: usize = 31;

/// Windows a τ: statistically as good as full overlap.
const WINDOWS: usize = 4;

type SensorLadder = AllanLadder<f64, 3, LEVELS, WINDOWS>;

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
    /// What is fitted beside them; [`Estimator::Octaves`] only.
    pub terms: FittedTerms,
    /// Leave nothing out: neither what was handled nor the warm-up, and read no K past a ramp.
    pub keep_all: bool,
    /// Keep the signal in outline ([`SensorNoise::signal`]), for a picture of it.
    pub keep_signal: bool,
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

/// What is fitted beside N and K.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FittedTerms {
    /// What the recording asks for ([`imu_core::allan::select_terms`]).
    #[default]
    Asked,
    /// These, whether it asks for them or not.
    Given(Terms),
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
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
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

    /// The unit of its readings.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Gyroscope => "rad/s",
            Self::Accelerometer => "m/s²",
        }
    }

    /// The unit of its random walk K, a continuous-time density.
    #[must_use]
    pub const fn walk_unit(self) -> &'static str {
        match self {
            Self::Gyroscope => "rad/s²/√Hz",
            Self::Accelerometer => "m/s³/√Hz",
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
    /// The signal in outline; empty unless [`Options::keep_signal`].
    pub signal: Vec<Column>,
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

/// The noise of one axis, or of all together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisNoise {
    /// N: angle or velocity random walk, unit/√Hz.
    pub noise_density: Parameter,
    /// K: random walk of the bias, unit/s/√Hz.
    pub random_walk: Parameter,
    /// B: bias instability, unit; `None` where it was not asked for.
    pub bias_instability: Option<Parameter>,
    /// Q: quantisation of the integral, unit·s; `None` where it was not asked for.
    pub quantisation: Option<Parameter>,
    /// |R|: a ramp, unit/s; `None` where it was not asked for.
    pub rate_ramp: Option<Parameter>,
}

impl AxisNoise {
    /// White noise and a random walk, and nothing else.
    #[must_use]
    pub const fn of_two(noise_density: Parameter, random_walk: Parameter) -> Self {
        Self {
            noise_density,
            random_walk,
            bias_instability: None,
            quantisation: None,
            rate_ramp: None,
        }
    }
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
    progress: impl FnMut(Progress),
) -> Result<Calibration, Error> {
    let Examined { calibration, refusal, .. } = examine(source, path, options, progress)?;
    match refusal {
        Some(refusal) => Err(refusal),
        None => Ok(calibration),
    }
}

/// Everything that a recording shows.
#[derive(Debug)]
pub struct Examined {
    /// Its noise, for what it is worth, and what is wrong with it.
    pub calibration: Calibration,
    /// Why it is not fit to calibrate from.
    pub refusal: Option<Error>,
    /// What it holds, IMU or not.
    pub streams: Vec<Stream>,
    /// What a thermometer said.
    pub temperature: Option<TemperatureRange>,
}

/// Reads a recording as [`calibrate`] does, and says all that there is to say of it, even if it is
/// not fit to calibrate from.
///
/// # Errors
/// What the source says when it cannot be read.
pub fn examine(
    mut source: Box<dyn Source>,
    path: &str,
    options: &Options,
    mut progress: impl FnMut(Progress),
) -> Result<Examined, Error> {
    let mut window = Window::new(options);
    let mut temperature = Thermometer::default();
    let mut samples = 0;
    let mut record = 0;
    let (gyroscope, accelerometer) = std::thread::scope(|scope| {
        let lane = |kind| Lane::new(scope, Pipeline::new(kind, options));
        let (gyroscope, accelerometer) =
            (lane(SensorKind::Gyroscope), lane(SensorKind::Accelerometer));
        let mut block = Block::default();
        while source.next_block(&mut block)? {
            if source.record_number() != record {
                record = source.record_number();
                window = Window::new(options);
                gyroscope.next_record();
                accelerometer.next_record();
            }
            window.open(&block);
            temperature.push(&block.temperature);
            samples += block.gyroscope.len().max(block.accelerometer.len()) as u64;
            let range = window.cut(&block.gyroscope);
            gyroscope.take(&mut block.gyroscope, range);
            let range = window.cut(&block.accelerometer);
            accelerometer.take(&mut block.accelerometer, range);
            progress(Progress { bytes: source.bytes_read(), samples });
        }
        // Both are told of the end before either is waited for.
        let (gyroscope, accelerometer) = (gyroscope.close(), accelerometer.close());
        Ok::<_, Error>((gyroscope.noise()?, accelerometer.noise()?))
    })?;
    let named = |noise: Option<SensorNoise>, topic: &str| {
        noise.map(|noise| SensorNoise { topic: topic.to_owned(), ..noise })
    };
    let gyroscope = named(gyroscope, source.gyroscope());
    let accelerometer = named(accelerometer, source.accelerometer());

    let (mut remarks, mut warnings) = (Vec::new(), Vec::new());
    for note in source.take_notes() {
        match note {
            Note::Info(text) => remarks.push(text),
            Note::Warning(text) => warnings.push(text),
        }
    }
    let name = |record| source.record_name(record);
    let (calibration, refusal) = judge(path, options, gyroscope, accelerometer, &name);
    let calibration =
        Calibration { remarks, warnings: [warnings, calibration.warnings].concat(), ..calibration };
    let streams = source.streams();
    Ok(Examined { calibration, refusal, streams, temperature: temperature.range() })
}

/// Puts both sensors together, and says what is wrong with them, and why nothing can be made of them,
/// if so. `name` gives a record's name, where there are several.
fn judge(
    path: &str,
    options: &Options,
    gyroscope: Option<SensorNoise>,
    accelerometer: Option<SensorNoise>,
    name: &dyn Fn(usize) -> Option<String>,
) -> (Calibration, Option<Error>) {
    let mut warnings = Vec::new();
    let mut refusal = refusal::of_samples(path, &gyroscope, &accelerometer, options);
    for (record, mean) in accelerometer.iter().flat_map(|sensor| &sensor.record_means) {
        let name = name(*record);
        match gravity::check(*mean) {
            gravity::Verdict::Plausible => {}
            gravity::Verdict::OtherUnit(sentence) if !options.unit_is_given => {
                let name = name.as_deref().unwrap_or(path);
                refusal.get_or_insert(Error::data(format!("{name}: {sentence}")));
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
    let calibration = Calibration {
        path: path.to_owned(),
        paths: vec![path.to_owned()],
        span_s: span(&gyroscope).max(span(&accelerometer)),
        remarks: Vec::new(),
        warnings,
        gyroscope,
        accelerometer,
    };
    (calibration, refusal)
}
