//! Dead reckoning of a recording: rules side by side, from one start, against the truth where there is one.
//!
//! Samples of both sensors come in step (`pairs`), one rule each integrates them in `f64` (`reckoner`, the rules are
//! [`imu_core::integrate`]'s), the truth is read beside them (`truth`), and errors are summed as they come (`errors`,
//! `align`): memory does not grow with the recording. It begins in the state that the truth tells, or level where the
//! sensor stood still (`rest`).
//!
//! A few missing samples are bridged by the rule. A hole of more than [`HOLE`] periods, or longer than an
//! [`imu_core::time::Step`], cannot be: behind it everything begins anew in the state that the truth tells, or ends.
//!
//! ```
//! use imu_tools::integrate::{Against, Kind, Method, Options, integrate};
//! use imu_tools::recording::{self, ReadOptions};
//! use imu_tools::scene::{Scene, Simulator};
//!
//! let scene = Scene { duration_ns: 10_000_000_000, ..Scene::default() }; // at rest, no errors
//! let source = Box::new(Simulator::new(&scene)?);
//! let options = Options::new(Kind::Instantaneous);
//! let (result, _files) = integrate(source, "simulated", Against::Nothing, &options, |_| {})?;
//! let midpoint = result.outcomes.iter().find(|outcome| outcome.method == Method::Midpoint).unwrap();
//! assert!(midpoint.last.position_w.abs().max() < 1e-9);
//! # Ok::<(), imu_tools::error::Error>(())
//! ```

mod against;
mod align;
mod errors;
mod method;
mod motion;
mod pairs;
mod reckoner;
mod rest;
mod run;
mod said;
mod start;
mod thin;
mod truth;
mod written;

use std::path::PathBuf;

use imu_core::sample::Bias;

pub use against::Against;
pub use errors::{ErrorAt, Errors};
pub use method::{Kind, Method};
pub use motion::Motion;
pub use pairs::HOLE;
pub use thin::Thin;
pub use truth::Truth;
pub use written::file_names;

use crate::error::Error;
use crate::output::Output;
use crate::recording::{Source, read_ahead};
use run::Run;

/// Gravity where nothing else is known, m/s²: that of scenes and of most published trajectories.
pub const USUAL_GRAVITY: f64 = 9.81;

/// What to integrate, from where, in which world.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// What a sample is.
    pub kind: Kind,
    /// The rules, each of which takes such samples.
    pub methods: Vec<Method>,
    /// None: from the truth where there is one, else from rest.
    pub start: Option<Start>,
    /// How long it stands still at the beginning, for a start from rest, s.
    pub rest_s: f64,
    /// m/s²; none: as measured at rest, else [`USUAL_GRAVITY`].
    pub gravity: Option<f64>,
    /// On the turning Earth, with its gravity: latitude, rad, and height, m.
    pub place: Option<(f64, f64)>,
    /// What the sensors read too much; none: nothing known.
    pub bias: Option<KnownBias>,
    /// From here on, seconds after the first sample.
    pub from_s: Option<f64>,
    /// Up to here, seconds after the first sample.
    pub to_s: Option<f64>,
    /// The unit of specific force was said, and is not questioned.
    pub unit_is_given: bool,
    /// Where to write the trajectories.
    pub folder: Option<PathBuf>,
}

impl Options {
    /// All rules that take such samples, from the truth or from rest, in a world of the usual gravity.
    #[must_use]
    pub fn new(kind: Kind) -> Self {
        Self {
            kind,
            methods: kind.methods().collect(),
            start: None,
            rest_s: 1.0,
            gravity: None,
            place: None,
            bias: None,
            from_s: None,
            to_s: None,
            unit_is_given: false,
            folder: None,
        }
    }
}

/// Where the first state comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// The truth.
    Truth,
    /// Level and without motion; position and heading of the truth where there is one, else zero.
    Rest,
}

/// Where a bias comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KnownBias {
    /// This one.
    Given(Bias<f64>),
    /// What the truth says at the start.
    Truth,
}

/// Where gravity comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GravityFrom {
    /// It was given.
    Given,
    /// The mean specific force at rest.
    Rest,
    /// The normal gravity of the place.
    Place,
    /// Nothing else was known.
    Usual,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Integration {
    /// The recording.
    pub path: String,
    /// The truth.
    pub truth: Option<String>,
    /// What its samples were said to be.
    pub kind: Kind,
    /// Steps integrated.
    pub steps: u64,
    /// Seconds integrated.
    pub span_s: f64,
    /// How it began.
    pub begun: Begun,
    /// A line each: what was taken for granted.
    pub remarks: Vec<String>,
    /// A line each: what is wrong with the recording.
    pub warnings: Vec<String>,
    /// Each rule's.
    pub outcomes: Vec<Outcome>,
    /// The true positions at which errors were taken, thinned.
    pub true_path: Thin<PathPoint>,
}

/// How it began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Begun {
    /// Where the first state came from.
    pub from: Start,
    /// Its stamp, ns.
    pub stamp_ns: i64,
    /// The first state.
    pub motion: Motion,
    /// What is taken off the samples.
    pub bias: Bias<f64>,
    /// m/s².
    pub gravity: f64,
    /// Where that comes from.
    pub gravity_from: GravityFrom,
    /// The velocity comes from differences of the truth's poses.
    pub differenced: bool,
}

/// What one rule found.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The rule.
    pub method: Method,
    /// The last state.
    pub last: Motion,
    /// None where there is no truth.
    pub errors: Option<Errors>,
    /// Where it went, thinned.
    pub path: Thin<PathPoint>,
    /// How its errors grew, thinned.
    pub error_curve: Thin<ErrorAt>,
}

/// A point of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Seconds from the start.
    pub t_s: f64,
    /// m.
    pub position_w: [f64; 3],
}

/// Integrates a recording by several rules at once, and compares with the truth; `path` is for messages,
/// `progress` is told the bytes read. The trajectories, where a folder was named, are complete and take
/// their places when they are finished.
///
/// # Errors
/// What source and truth say; samples of another kind than the recording says that they are; no samples of both
/// sensors; a start that is not at rest, or of which the truth knows nothing; a truth where one is needed; nothing that
/// could be integrated.
pub fn integrate(
    source: Box<dyn Source>,
    path: &str,
    against: Against,
    options: &Options,
    mut progress: impl FnMut(u64),
) -> Result<(Integration, Vec<Output>), Error> {
    if let Some(why) = source.samples().and_then(|told| said::other_kind(path, options.kind, told))
    {
        return Err(Error::usage(why));
    }
    let mut run = Run::new(path, against, options)?;
    let mut source = read_ahead(source, |block, at| {
        progress(at.bytes);
        run.take(block)
    })?;
    run.finish(source.take_notes())
}
