//! One integration under way: from rows of samples to states, holes, errors and files.

use imu_core::State;
use imu_core::nalgebra::Vector3;
use imu_core::sample::Bias;
use imu_core::time::Step;
use imu_core::world::Flat;

use super::against::Against;
use super::errors::ErrorSums;
use super::pairs::{HOLE, Pairs, Row};
use super::reckoner::{Place, Reckoner};
use super::thin::Thin;
use super::truth::{Begin, Truth};
use super::written::Writer;
use super::{
    Begun, Integration, KnownBias, Method, Motion, Options, Outcome, PathPoint, Start, motion, said,
};
use crate::error::Error;
use crate::output::Output;
use crate::recording::{Block, Note};

/// How far it has come.
pub(super) enum Phase {
    /// No start yet.
    Waiting,
    /// What was read since the start, which may be at rest.
    Resting(Vec<Row>, Option<Begin>),
    /// The last reading.
    Moving(Row),
    /// A hole that nothing leads across.
    Stopped,
}

/// One integration under way.
pub(super) struct Run<'a> {
    pub(super) path: &'a str,
    pub(super) truth_name: Option<String>,
    pub(super) truth: Option<Truth>,
    /// Topics of poses of which none was chosen.
    pub(super) unchosen: Option<String>,
    pub(super) options: &'a Options,
    pub(super) start: Start,
    pub(super) pairs: Pairs,
    pub(super) first_ns: Option<i64>,
    pub(super) phase: Phase,
    pub(super) begun: Option<Begun>,
    pub(super) place: Place,
    pub(super) lanes: Vec<Lane>,
    pub(super) true_path: Thin<PathPoint>,
    pub(super) steps: u64,
    pub(super) span_ns: i64,
    /// Readings before the truth begins, and steps over missing samples.
    pub(super) too_early: u64,
    pub(super) bridged: u64,
    /// Sum of the lengths of all specific forces, m/s².
    pub(super) felt: f64,
    /// Length of the mean specific force at rest, m/s².
    pub(super) force_at_rest: Option<f64>,
    pub(super) remarks: Vec<String>,
    pub(super) warnings: Vec<String>,
}

pub(super) struct Lane {
    method: Method,
    reckoner: Option<Reckoner>,
    pub(super) sums: ErrorSums,
    path: Thin<PathPoint>,
    writer: Option<Writer>,
}

impl<'a> Run<'a> {
    pub(super) fn new(
        path: &'a str,
        against: Against,
        options: &'a Options,
    ) -> Result<Self, Error> {
        let (truth_name, truth, remarks, unchosen) = match against {
            Against::Truth { name, truth, told } => (Some(name), Some(*truth), told, None),
            Against::Unchosen(list) => (None, None, Vec::new(), Some(list)),
            Against::Nothing => (None, None, Vec::new(), None),
        };
        let usual = if truth.is_some() { Start::Truth } else { Start::Rest };
        let start = options.start.unwrap_or(usual);
        let asks = if start == Start::Truth { "--start truth" } else { "--bias truth" };
        let needs_truth = start == Start::Truth || options.bias == Some(KnownBias::Truth);
        if needs_truth && truth.is_none() {
            return Err(Error::usage(match unchosen {
                None => format!(
                    "{asks} wants a truth, and there is none beside {path}: name it with --truth FILE"
                ),
                Some(list) => format!(
                    "{asks} wants a truth, and {path} has several topics of poses: {list}; choose one with \
                     --truth-topic TOPIC"
                ),
            }));
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
            unchosen,
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
            remarks,
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

    pub(super) fn row(&mut self, row: Row) -> Result<(), Error> {
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

    /// Puts all rules into this state.
    pub(super) fn place_at(&mut self, row: Row, motion: &Motion) -> Result<(), Error> {
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

    /// Takes a block of samples of both sensors.
    pub(super) fn take(&mut self, block: &Block) -> Result<(), Error> {
        self.pairs.take(block);
        let first = [block.gyroscope.first(), block.accelerometer.first()];
        let first = first.into_iter().flatten().map(|sample| sample.stamp_ns).min();
        self.first_ns = self.first_ns.or(first);
        self.rows()
    }

    /// The results, where there are any, and the files; `notes` are those of the source.
    pub(super) fn finish(
        mut self,
        mut notes: Vec<Note>,
    ) -> Result<(Integration, Vec<Output>), Error> {
        self.pairs.end();
        self.rows()?;
        self.check()?;
        if let Some(truth) = &mut self.truth {
            // Both readings of one recording find the same damage.
            let others = truth.finish()?.into_iter().filter(|note| !notes.contains(note));
            notes.extend(others.collect::<Vec<_>>());
        }
        for note in notes {
            match note {
                Note::Info(text) => self.remarks.push(text),
                Note::Warning(text) => self.warnings.push(text),
            }
        }
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

    pub(super) fn impossible(&self, error: imu_core::Error) -> Error {
        impossible(self.path, error)
    }
}

/// What the core refuses although it was looked at before.
fn impossible(path: &str, error: imu_core::Error) -> Error {
    Error::data(format!("{path} cannot be integrated: {error}; look at it with imu info"))
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
