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
//! use imu_tools::integrate::{Kind, Method, Options, integrate};
//! use imu_tools::recording::{self, ReadOptions};
//! use imu_tools::scene::{Scene, Simulator};
//!
//! let scene = Scene { duration_ns: 10_000_000_000, ..Scene::default() }; // at rest, no errors
//! let source = Box::new(Simulator::new(&scene)?);
//! let options = Options::new(Kind::Instantaneous);
//! let (result, _files) = integrate(source, "simulated", None, &options, |_| {})?;
//! let midpoint = result.outcomes.iter().find(|outcome| outcome.method == Method::Midpoint).unwrap();
//! assert!(midpoint.last.position_w.abs().max() < 1e-9);
//! # Ok::<(), imu_tools::error::Error>(())
//! ```

mod align;
mod errors;
mod method;
mod motion;
mod pairs;
mod reckoner;
mod rest;
mod said;
mod thin;
mod truth;
mod written;

use std::path::PathBuf;

use imu_core::nalgebra::Vector3;
use imu_core::sample::Bias;
use imu_core::time::Step;
use imu_core::world::{Flat, RotatingEarth};
use imu_core::{State, so3};

pub use errors::{ErrorAt, Errors};
pub use method::{Kind, Method};
pub use motion::Motion;
pub use pairs::HOLE;
pub use thin::Thin;
pub use truth::Truth;
pub use written::file_names;

use crate::error::Error;
use crate::output::Output;
use crate::recording::{Note, Source, read_ahead};
use errors::ErrorSums;
use pairs::{Pairs, Row};
use reckoner::{Place, Reckoner};
use rest::Rest;
use truth::Begin;
use written::Writer;

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

/// Integrates a recording by several rules at once, and compares with the truth; `path` and the truth's name are for
/// messages, `progress` is told the bytes read. The trajectories, where a folder was named, are complete and take
/// their places when they are finished.
///
/// # Errors
/// What source and truth say; no samples of both sensors; a start that is not at rest, or of which the truth knows
/// nothing; a truth where one is needed; nothing that could be integrated.
pub fn integrate(
    source: Box<dyn Source>,
    path: &str,
    truth: Option<(String, Truth)>,
    options: &Options,
    mut progress: impl FnMut(u64),
) -> Result<(Integration, Vec<Output>), Error> {
    let (truth_name, truth) = truth.unzip();
    let mut run = Run::new(path, truth_name, truth, options)?;
    let mut source = read_ahead(source, |block, at| {
        run.pairs.take(block);
        let first = [block.gyroscope.first(), block.accelerometer.first()];
        let first = first.into_iter().flatten().map(|sample| sample.stamp_ns).min();
        run.first_ns = run.first_ns.or(first);
        progress(at.bytes);
        run.rows()
    })?;
    run.pairs.end();
    run.rows()?;
    run.check()?;
    for note in source.take_notes() {
        match note {
            Note::Info(text) => run.remarks.push(text),
            Note::Warning(text) => run.warnings.push(text),
        }
    }
    run.finish()
}

/// How far it has come.
enum Phase {
    /// No start yet.
    Waiting,
    /// What was read since the start, which may be at rest.
    Resting(Vec<Row>, Option<Begin>),
    /// The last reading.
    Moving(Row),
    /// A hole that nothing leads across.
    Stopped,
}

struct Run<'a> {
    path: &'a str,
    truth_name: Option<String>,
    truth: Option<Truth>,
    options: &'a Options,
    start: Start,
    pairs: Pairs,
    first_ns: Option<i64>,
    phase: Phase,
    begun: Option<Begun>,
    place: Place,
    lanes: Vec<Lane>,
    true_path: Thin<PathPoint>,
    steps: u64,
    span_ns: i64,
    /// Readings before the truth begins, and steps over missing samples.
    too_early: u64,
    bridged: u64,
    /// Sum of the lengths of all specific forces, m/s².
    felt: f64,
    /// Length of the mean specific force at rest, m/s².
    force_at_rest: Option<f64>,
    remarks: Vec<String>,
    warnings: Vec<String>,
}

struct Lane {
    method: Method,
    reckoner: Option<Reckoner>,
    sums: ErrorSums,
    path: Thin<PathPoint>,
    writer: Option<Writer>,
}

impl<'a> Run<'a> {
    fn new(
        path: &'a str,
        truth_name: Option<String>,
        truth: Option<Truth>,
        options: &'a Options,
    ) -> Result<Self, Error> {
        let usual = if truth.is_some() { Start::Truth } else { Start::Rest };
        let start = options.start.unwrap_or(usual);
        let asks = if start == Start::Truth { "--start truth" } else { "--bias truth" };
        let needs_truth = start == Start::Truth || options.bias == Some(KnownBias::Truth);
        if needs_truth && truth.is_none() {
            return Err(Error::usage(format!(
                "{asks} wants a truth, and there is none beside {path}: name it with --truth FILE"
            )));
        }
        let writer = |method| {
            options.folder.as_ref().map(|folder| Writer::create(folder, method)).transpose()
        };
        let lane = |method: &Method| -> Result<Lane, Error> {
            let (sums, path) = (ErrorSums::default(), Thin::default());
            Ok(Lane { method: *method, reckoner: None, sums, path, writer: writer(*method)? })
        };
        Ok(Self {
            path,
            truth_name,
            truth,
            options,
            start,
            pairs: Pairs::default(),
            first_ns: None,
            phase: Phase::Waiting,
            begun: None,
            place: Place::Flat(Flat::default()),
            lanes: options.methods.iter().map(lane).collect::<Result<_, _>>()?,
            true_path: Thin::default(),
            steps: 0,
            span_ns: 0,
            too_early: 0,
            bridged: 0,
            felt: 0.0,
            force_at_rest: None,
            remarks: Vec::new(),
            warnings: Vec::new(),
        })
    }

    /// Takes all readings that are complete by now.
    fn rows(&mut self) -> Result<(), Error> {
        while let Some(row) = self.pairs.next() {
            let ns = |s: f64| (s * 1e9) as i64; // saturates
            let at = row.stamp_ns.saturating_sub(self.first_ns.unwrap_or(row.stamp_ns));
            let early = self.options.from_s.is_some_and(|from| at < ns(from));
            let late = self.options.to_s.is_some_and(|to| at > ns(to));
            if !early && !late {
                self.row(row)?;
            }
        }
        Ok(())
    }

    fn row(&mut self, row: Row) -> Result<(), Error> {
        match &mut self.phase {
            Phase::Waiting => self.wait(row),
            Phase::Resting(rows, _) => {
                let since = rows.first().map_or(row.stamp_ns, |first| first.stamp_ns);
                rows.push(row);
                let long = row.stamp_ns.saturating_sub(since) as f64 * 1e-9 >= self.options.rest_s;
                if long { self.rise() } else { Ok(()) }
            }
            Phase::Moving(last) => {
                let last = *last;
                self.step(&last, row)
            }
            Phase::Stopped => Ok(()),
        }
    }

    /// Begins here, if that can be.
    fn wait(&mut self, row: Row) -> Result<(), Error> {
        let begin = self.begin(row.stamp_ns)?;
        if self.truth.is_some() && begin.is_none() {
            self.too_early += 1;
            return Ok(());
        }
        match begin.filter(|_| self.start == Start::Truth) {
            Some(begin) => {
                let bias = self.bias(Some(&begin));
                let (gravity, from) =
                    self.options.gravity.map_or((USUAL_GRAVITY, GravityFrom::Usual), |gravity| {
                        (gravity, GravityFrom::Given)
                    });
                self.set_out(row, begin.motion, bias, (gravity, from), begin.differenced)
            }
            None => {
                self.phase = Phase::Resting(vec![row], begin);
                Ok(())
            }
        }
    }

    /// What the truth says of this instant.
    fn begin(&mut self, stamp_ns: i64) -> Result<Option<Begin>, Error> {
        let Some(truth) = &mut self.truth else { return Ok(None) };
        truth.skip_until(stamp_ns)?;
        truth.begin(stamp_ns)
    }

    /// The bias that was told; zero where none was.
    fn bias(&self, begin: Option<&Begin>) -> Bias<f64> {
        let none = Bias::default();
        match self.options.bias {
            None => none,
            Some(KnownBias::Given(bias)) => bias,
            Some(KnownBias::Truth) => begin.and_then(|begin| begin.bias).unwrap_or(none),
        }
    }

    /// Begins where the resting began, level.
    fn rise(&mut self) -> Result<(), Error> {
        let Phase::Resting(rows, begin) = std::mem::replace(&mut self.phase, Phase::Stopped) else {
            return Ok(());
        };
        let Some(first) = rows.first().copied() else { return Ok(()) };
        let told = self.bias(begin.as_ref());
        let rest = Rest::of(&rows).map_err(|why| self.not_at_rest(&rows, &why))?;
        let force = rest.force - told.specific_force();
        let heading = begin.map_or(0.0, |begin| rest::heading(&begin.motion.attitude_wb));
        let attitude_wb = rest::level(&force, heading);
        let measured = (motion::length(&force), GravityFrom::Rest);
        self.force_at_rest = Some(measured.0);
        let gravity = self.options.gravity.map_or(measured, |g| (g, GravityFrom::Given));
        let bias = if self.options.bias.is_some() {
            told
        } else {
            let turning = match self.options.place {
                None => Vector3::zeros(),
                Some(place) => so3::rotate(&so3::inverse(&attitude_wb), &earth(place)?.rate()),
            };
            Bias::new(rest.rate - turning, Vector3::zeros()).map_err(|e| self.impossible(e))?
        };
        let position_w = begin.map_or(Vector3::zeros(), |begin| begin.motion.position_w);
        let motion = Motion { attitude_wb, velocity_w: Some(Vector3::zeros()), position_w };
        self.set_out(first, motion, bias, gravity, false)?;
        rows.into_iter().skip(1).try_for_each(|row| self.row(row))
    }

    fn not_at_rest(&self, rows: &[Row], why: &str) -> Error {
        let ends = rows.last().zip(rows.first());
        let span = ends.map_or(0, |(last, first)| last.stamp_ns.saturating_sub(first.stamp_ns));
        let mend = if self.truth.is_some() {
            "start from the truth (--start truth), or from a time at which it rests (--from)"
        } else {
            "name a truth to start from (--truth FILE), or start from a time at which it rests (--from)"
        };
        Error::data(format!(
            "the first {:.3} s of {} are not at rest ({why}): {mend}",
            span as f64 * 1e-9,
            self.path
        ))
    }

    /// The first step can be taken.
    fn set_out(
        &mut self,
        row: Row,
        motion: Motion,
        bias: Bias<f64>,
        gravity: (f64, GravityFrom),
        differenced: bool,
    ) -> Result<(), Error> {
        let gravity = match self.options.place {
            None => {
                let down = Vector3::new(0.0, 0.0, -gravity.0);
                self.place = Place::Flat(Flat::new(down).map_err(|e| self.impossible(e))?);
                gravity
            }
            Some(place) => {
                let earth = earth(place)?;
                self.place = Place::Earth(earth);
                (-earth.gravity().z, GravityFrom::Place)
            }
        };
        self.begun = Some(Begun {
            from: self.start,
            stamp_ns: row.stamp_ns,
            motion,
            bias,
            gravity: gravity.0,
            gravity_from: gravity.1,
            differenced,
        });
        if self.truth.is_some() {
            self.true_path.push(PathPoint { t_s: 0.0, position_w: motion.position_w.into() });
        }
        self.place_at(row, &motion)
    }

    /// Puts all rules into this state.
    fn place_at(&mut self, row: Row, motion: &Motion) -> Result<(), Error> {
        let velocity_w = motion.velocity_w.unwrap_or_else(Vector3::zeros);
        let state = State::new(motion.attitude_wb, velocity_w, motion.position_w)
            .map_err(|e| self.impossible(e))?;
        let (bias, t_s) = (self.taken_off(), self.seconds(row.stamp_ns));
        for lane in &mut self.lanes {
            lane.reckoner = Some(Reckoner::new(lane.method, state, &row.reading.minus(&bias)));
            lane.keep(row.stamp_ns, t_s, &state)?;
        }
        self.phase = Phase::Moving(row);
        Ok(())
    }

    fn taken_off(&self) -> Bias<f64> {
        self.begun.map_or_else(Bias::default, |begun| begun.bias)
    }

    /// From the start, s.
    fn seconds(&self, stamp_ns: i64) -> f64 {
        let start = self.begun.map_or(stamp_ns, |begun| begun.stamp_ns);
        stamp_ns.saturating_sub(start) as f64 * 1e-9
    }

    fn step(&mut self, last: &Row, row: Row) -> Result<(), Error> {
        let ns = row.stamp_ns.saturating_sub(last.stamp_ns);
        let period = self.pairs.period_ns().unwrap_or(ns);
        let step = Step::between(last.stamp_ns, row.stamp_ns).ok();
        let Some(dt) = step.filter(|_| ns <= period.saturating_mul(HOLE)) else {
            return self.cross(last, row);
        };
        self.bridged += u64::from(ns > period.saturating_add(period / 2));
        let (bias, place) = (self.taken_off(), self.place);
        let (before_s, t_s) = (self.seconds(last.stamp_ns), self.seconds(row.stamp_ns));
        let mut before = Vec::with_capacity(self.lanes.len());
        for lane in &mut self.lanes {
            let Some(reckoner) = &mut lane.reckoner else { continue };
            before.push(Motion::from(reckoner.state()));
            let moved = reckoner.advance(&row.reading, &bias, &dt, &place);
            moved.map_err(|error| impossible(self.path, error))?;
            let state = *reckoner.state();
            lane.keep(row.stamp_ns, t_s, &state)?;
        }
        self.phase = Phase::Moving(row);
        self.felt += motion::length(&row.reading.specific_force());
        (self.steps, self.span_ns) = (self.steps + 1, self.span_ns.saturating_add(ns));
        let Some(truth) = &mut self.truth else { return Ok(()) };
        while let Some(known) = truth.next_until(row.stamp_ns)? {
            let part = (known.stamp_ns - last.stamp_ns) as f64 / ns as f64;
            let at_s = before_s + part * dt.seconds();
            let position_w = known.motion.position_w.into();
            self.true_path.push(PathPoint { t_s: at_s, position_w });
            for (lane, before) in self.lanes.iter_mut().zip(&before) {
                let Some(reckoner) = &lane.reckoner else { continue };
                let now = Motion::from(reckoner.state());
                let exact = known.stamp_ns == row.stamp_ns;
                let found = if exact { now } else { before.towards(&now, dt.seconds(), part) };
                lane.sums.push(at_s, &found, &known.motion);
            }
        }
        Ok(())
    }

    /// Across a hole only the truth leads.
    fn cross(&mut self, last: &Row, row: Row) -> Result<(), Error> {
        let at_s = self.seconds(last.stamp_ns);
        let long_s = row.stamp_ns.saturating_sub(last.stamp_ns) as f64 * 1e-9;
        let begin = self.begin(row.stamp_ns)?;
        self.warnings.push(said::hole(at_s, long_s, begin.is_some(), self.truth.is_some()));
        let Some(begin) = begin else {
            self.phase = Phase::Stopped;
            return Ok(());
        };
        if let (Some(KnownBias::Truth), Some(bias), Some(begun)) =
            (self.options.bias, begin.bias, &mut self.begun)
        {
            begun.bias = bias;
        }
        self.place_at(row, &begin.motion)
    }

    /// That something was integrated.
    fn check(&mut self) -> Result<(), Error> {
        if let Phase::Resting(..) = &self.phase {
            return Err(Error::data(format!(
                "{} ends before the {} s at rest are over that a start takes: ask for less with --rest, or name a \
                 truth to start from (--truth FILE)",
                self.path, self.options.rest_s
            )));
        }
        if self.steps > 0 {
            return Ok(());
        }
        Err(Error::data(said::nothing(self)))
    }

    fn finish(mut self) -> Result<(Integration, Vec<Output>), Error> {
        self.remark();
        let Some(begun) = self.begun else { return Err(Error::data(said::nothing(&self))) };
        let (mut outcomes, mut files) = (Vec::new(), Vec::new());
        for lane in self.lanes {
            if let Some(writer) = lane.writer {
                files.extend(writer.complete()?);
            }
            outcomes.push(Outcome {
                method: lane.method,
                last: lane.reckoner.map_or(begun.motion, |reckoner| reckoner.state().into()),
                errors: lane.sums.errors(),
                path: lane.path,
                error_curve: lane.sums.curve,
            });
        }
        let integration = Integration {
            path: self.path.to_owned(),
            truth: self.truth_name,
            kind: self.options.kind,
            steps: self.steps,
            span_s: self.span_ns as f64 * 1e-9,
            begun,
            remarks: self.remarks,
            warnings: self.warnings,
            outcomes,
            true_path: self.true_path,
        };
        Ok((integration, files))
    }

    fn impossible(&self, error: imu_core::Error) -> Error {
        impossible(self.path, error)
    }
}

/// What the core refuses although it was looked at before.
fn impossible(path: &str, error: imu_core::Error) -> Error {
    Error::data(format!("{path} cannot be integrated: {error}; look at it with imu info"))
}

fn earth((latitude, height): (f64, f64)) -> Result<RotatingEarth<f64>, Error> {
    RotatingEarth::new(latitude, height).map_err(|_| {
        Error::usage("--latitude wants degrees from -90 to 90, --height metres within 100 km")
    })
}

impl Lane {
    fn keep(&mut self, stamp_ns: i64, t_s: f64, state: &State<f64>) -> Result<(), Error> {
        self.path.push(PathPoint { t_s, position_w: state.position_w().into() });
        match &mut self.writer {
            Some(writer) => writer.write(stamp_ns, state),
            None => Ok(()),
        }
    }
}
