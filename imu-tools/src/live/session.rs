//! One calibration while it runs: what is taken, left out, kept and shown. No file, port or screen is
//! known here.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::link::Link;
use crate::calibrate::live::{Running, Snapshot};
use crate::calibrate::{Calibration, Options};
use crate::error::Error;
use crate::recording::Block;

/// A moment that the user marked.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
pub struct Mark {
    /// Seconds of the sensor's time after the first sample.
    pub at_s: f64,
}

/// Marks that are kept, at most.
const MARKS: usize = 1000;

/// What came before, when a session goes on with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Before {
    /// The same samples come once more from the beginning: those that were taken are passed over.
    ComesAgain,
    /// It is past: what comes now is new. A clock that was set back meanwhile is a restart.
    IsPast,
}

/// A calibration while it runs.
pub struct Session {
    name: String,
    running: Running,
    kept: State,
    /// Stamps of the last samples before it went on with others; `None`: not any more, or never.
    taken: [Option<i64>; 2],
    /// How many of what comes came before: gyroscope, accelerometer, temperature.
    skip: [u64; 3],
    paused: bool,
}

/// What a checkpoint holds beside the calibration.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
struct State {
    name: String,
    first_ns: Option<i64>,
    marks: Vec<Mark>,
    /// What came: gyroscope, accelerometer, temperature.
    came: [u64; 3],
    /// Times that it went on from a checkpoint.
    resumed: u32,
    /// Times that the sensor began anew.
    restarts: u64,
    /// It ended as it should: there is nothing to go on with.
    ended: bool,
    celsius: Option<f64>,
}

/// What a checkpoint holds.
#[derive(Deserialize, Serialize)]
struct Kept<'a> {
    state: State,
    #[serde(serialize_with = "as_a_whole")]
    running: &'a [u8],
}

/// Megabytes byte by byte would take a fifth of a checkpoint's time.
fn as_a_whole<S: serde::Serializer>(bytes: &&[u8], to: S) -> Result<S::Ok, S::Error> {
    to.serialize_bytes(bytes)
}

/// What there is to see at one moment.
#[derive(Debug)]
pub struct View {
    /// The noise as far as it shows.
    pub snapshot: Snapshot,
    /// The way from the sensor.
    pub link: Link,
    /// Samples taken of each sensor, gyroscope first.
    pub samples: [u64; 2],
    /// Whether the sensor is being moved; `None` as long as nobody can say.
    pub moving: Option<bool>,
    /// The last temperature, °C.
    pub celsius: Option<f64>,
    /// Moments that the user marked.
    pub marks: Vec<Mark>,
    /// Samples are passed over.
    pub paused: bool,
    /// What is not kept of all this, though it was asked for: a disk is full.
    pub lost: Vec<String>,
}

impl Session {
    /// Begins anew; `name` is what the sensor is called in messages.
    #[must_use]
    pub fn new(name: &str, options: &Options) -> Self {
        Self {
            name: name.to_owned(),
            running: Running::new(options),
            kept: State { name: name.to_owned(), ..State::default() },
            taken: [None; 2],
            skip: [0; 3],
            paused: false,
        }
    }

    /// Goes on with what [`to_bytes`](Self::to_bytes) kept.
    ///
    /// # Errors
    /// When the bytes are not such, or of another recording.
    pub fn resume(
        name: &str,
        options: &Options,
        bytes: &[u8],
        before: Before,
    ) -> Result<Self, Error> {
        let kept = kept(bytes)?;
        let of = |name: &str| Path::new(name).file_name().map(ToOwned::to_owned);
        if before == Before::ComesAgain && of(&kept.state.name) != of(name) {
            return Err(Error::usage(format!(
                "the checkpoint is of {}, not of {name}: name another with --checkpoint, or begin anew \
                 with --fresh",
                kept.state.name
            )));
        }
        let running = Running::from_bytes(kept.running, options)?;
        let state = State { resumed: kept.state.resumed + 1, ended: false, ..kept.state };
        let (skip, taken) = match before {
            Before::ComesAgain => (state.came, [None; 2]),
            Before::IsPast => ([0; 3], running.last_ns()),
        };
        let session = Self { running, kept: state, taken, skip, ..Self::new(name, options) };
        Ok(session)
    }

    /// Whether bytes of [`to_bytes`](Self::to_bytes) are of a session that ended as it should.
    ///
    /// # Errors
    /// When the bytes are not such.
    pub fn has_ended(bytes: &[u8]) -> Result<bool, Error> {
        kept(bytes).map(|kept| kept.state.ended)
    }

    /// The stamp up to which samples of all sensors were taken, ns.
    #[must_use]
    pub fn taken_until(&self) -> Option<i64> {
        self.running.last_ns().into_iter().flatten().min()
    }

    /// Samples taken of each sensor, gyroscope first.
    #[must_use]
    pub fn samples(&self) -> [u64; 2] {
        self.running.samples()
    }

    /// The whole state, for a checkpoint; `ended`: it has come to its end.
    ///
    /// # Errors
    /// When an encoder fails.
    pub fn to_bytes(&self, ended: bool) -> Result<Vec<u8>, Error> {
        let running = self.running.to_bytes()?;
        let state = State { ended, ..self.kept.clone() };
        postcard::to_stdvec(&Kept { state, running: &running })
            .map_err(|e| Error::data(format!("the session cannot be kept: {e}")))
    }

    /// Takes samples, and leaves in `block` those that were taken.
    pub fn take(&mut self, block: &mut Block) {
        self.pass_over(block);
        if self.paused {
            block.clear();
        }
        if let Some(first) = block.first_ns() {
            self.kept.first_ns.get_or_insert(first);
        }
        if let Some(last) = block.temperature.last() {
            self.kept.celsius = Some(last.celsius);
        }
        self.running.push(block);
    }

    /// Leaves out of a block what comes once the session is `span_s` long: a recording comes in large blocks.
    pub fn end_at(&self, span_s: f64, block: &mut Block) {
        let Some(first_ns) = self.kept.first_ns.or(block.first_ns()) else { return };
        let end_ns = first_ns.saturating_add((span_s * 1e9).round() as i64);
        for list in [&mut block.gyroscope, &mut block.accelerometer] {
            let end = list.iter().position(|sample| sample.stamp_ns >= end_ns);
            list.truncate(end.map_or(list.len(), |end| end + 1));
        }
        block.temperature.retain(|temperature| temperature.stamp_ns <= end_ns);
    }

    /// Leaves out what came before the session went on.
    fn pass_over(&mut self, block: &mut Block) {
        let [gyroscope, accelerometer, temperature] = &mut self.skip;
        skip(&mut block.gyroscope, gyroscope);
        skip(&mut block.accelerometer, accelerometer);
        skip(&mut block.temperature, temperature);
        let lists = [&block.gyroscope, &block.accelerometer];
        let lengths = [lists[0].len(), lists[1].len(), block.temperature.len()];
        for (came, length) in self.kept.came.iter_mut().zip(lengths) {
            *came += length as u64;
        }
        if self.taken == [None; 2] || lists.iter().all(|list| list.is_empty()) {
            return;
        }
        let back = lists.into_iter().zip(self.taken).filter_map(|(list, taken)| {
            list.first().zip(taken).map(|(sample, last)| last.saturating_sub(sample.stamp_ns))
        });
        let set_back_ns = back.max().filter(|back_ns| *back_ns >= 0);
        self.taken = [None; 2];
        if let Some(back_ns) = set_back_ns {
            // The time that it has run goes on.
            let first_ns = &mut self.kept.first_ns;
            *first_ns = first_ns.map(|first| first.saturating_sub(back_ns));
            self.restart();
        }
    }

    /// The sensor was switched off and on.
    pub fn restart(&mut self) {
        self.kept.restarts += 1;
        self.running.restart();
    }

    /// Marks this moment; its number, counted from 1, or `None` where there are as many as are kept.
    pub fn mark(&mut self) -> Option<usize> {
        if self.kept.marks.len() >= MARKS {
            return None;
        }
        self.kept.marks.push(Mark { at_s: self.span_s() });
        Some(self.kept.marks.len())
    }

    /// Passes over samples from now on, or takes them again; the time between is a gap.
    pub fn pause(&mut self) {
        self.paused = !self.paused;
    }

    /// Seconds of the sensor's time, gaps counted.
    #[must_use]
    pub fn span_s(&self) -> f64 {
        let last = self.running.last_ns().into_iter().flatten().max();
        last.zip(self.kept.first_ns)
            .map_or(0.0, |(last, first)| last.saturating_sub(first) as f64 * 1e-9)
    }

    /// What there is to see.
    #[must_use]
    pub fn view(&self, link: &Link) -> View {
        let mut snapshot = self.running.snapshot(&self.name);
        self.add_remarks(&mut snapshot.calibration, link);
        View {
            snapshot,
            link: link.clone(),
            samples: self.running.samples(),
            moving: self.running.is_moving(),
            celsius: self.kept.celsius,
            marks: self.kept.marks.clone(),
            paused: self.paused,
            lost: Vec::new(),
        }
    }

    /// What a reader of the report should know of the session.
    fn add_remarks(&self, calibration: &mut Calibration, link: &Link) {
        let State { marks, resumed, restarts, .. } = &self.kept;
        let times = |n: u64| if n == 1 { "once".to_owned() } else { format!("{n} times") };
        if *resumed > 0 {
            let times = times(u64::from(*resumed));
            calibration.remarks.push(format!("went on from a checkpoint {times}"));
        }
        if *restarts > 0 {
            let times = times(*restarts);
            calibration
                .remarks
                .push(format!("the sensor began anew {times}: no difference spans that"));
        }
        if link.clock.is_some_and(|clock| clock.by_arrival) {
            calibration.remarks.push(
                "the sensor sends neither time nor count: samples are as far apart as they came, and the rate \
                 is wrong if they came faster than they were measured"
                    .to_owned(),
            );
        }
        for (number, mark) in (1..).zip(marks) {
            calibration.remarks.push(format!("mark {number} at {:.1} s", mark.at_s));
        }
    }
}

fn kept(bytes: &[u8]) -> Result<Kept<'_>, Error> {
    postcard::from_bytes(bytes)
        .map_err(|e| Error::data(format!("the checkpoint holds no session: {e}")))
}

/// Leaves out as many as are to be skipped, which are fewer then.
fn skip<T>(list: &mut Vec<T>, skip: &mut u64) {
    let many = usize::try_from(*skip).unwrap_or(usize::MAX).min(list.len());
    list.drain(..many);
    *skip -= many as u64;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Sample;

    fn block(range: std::ops::Range<i64>) -> Block {
        let sample = |i: i64| Sample { stamp_ns: i * 1_000_000, value: [(i * i % 101) as f64; 3] };
        Block { gyroscope: range.map(sample).collect(), ..Block::default() }
    }

    fn told(session: &Session) -> String {
        format!("{:?}", session.view(&Link::default()).snapshot.calibration.gyroscope)
    }

    #[test]
    fn what_comes_again_is_taken_once() {
        let options = Options::default();
        let mut whole = Session::new("it", &options);
        whole.take(&mut block(0..9000));
        let mut first = Session::new("it", &options);
        first.take(&mut block(0..5003));
        let bytes = first.to_bytes(false).unwrap();
        assert!(!Session::has_ended(&bytes).unwrap());
        let mut second = Session::resume("it", &options, &bytes, Before::ComesAgain).unwrap();
        for from in [0, 4000, 8000] {
            second.take(&mut block(from..9000.min(from + 4000)));
        }
        assert_eq!(told(&second), told(&whole));
        assert_eq!(second.running.samples(), [9000, 0]);
    }

    /// A checkpoint of days must not be misread by a program that was built since: where this fails for a
    /// good reason, raise the version of `checkpoint.rs`, and delete the file; the next run writes it.
    #[test]
    fn a_checkpoint_that_was_kept_long_ago_is_read() {
        use crate::live::checkpoint::{self, Place};
        let options = Options::default();
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/src/live/checkpoint.kept"));
        if !path.exists() {
            let mut session = Session::new("it", &options);
            session.take(&mut block(0..500));
            session.mark();
            Place::take(path).unwrap().write(&session.to_bytes(false).unwrap()).unwrap();
            panic!("{} is new: look that it is in the next commit", path.display());
        }
        let found = checkpoint::read(path).unwrap().unwrap();
        assert_eq!(found.warning, None);
        let mut whole = Session::new("it", &options);
        whole.take(&mut block(0..9000));
        let resume = Session::resume("it", &options, &found.payload, Before::ComesAgain);
        let mut resumed = resume.unwrap();
        resumed.take(&mut block(0..9000));
        assert_eq!(told(&resumed), told(&whole));
        assert!((resumed.kept.marks[0].at_s - 0.499).abs() < 1e-9);
    }

    #[test]
    fn a_clock_that_is_set_back_in_a_recording_is_gone_on_with_at_the_next_sample() {
        let options = Options::default();
        let all = || {
            let mut all = block(0..4000);
            all.gyroscope.extend(block(2000..6000).gyroscope);
            all
        };
        let mut whole = Session::new("b/it.bag", &options);
        whole.take(&mut all());
        let mut first = Session::new("a/it.bag", &options);
        let mut part = all();
        part.gyroscope.truncate(5000);
        first.take(&mut part);
        let bytes = first.to_bytes(false).unwrap();
        let resume = |name| Session::resume(name, &options, &bytes, Before::ComesAgain);
        let mut second = resume("b/it.bag").unwrap();
        second.take(&mut all());
        assert_eq!(told(&second), told(&whole));
        let error = resume("a/other.bag").err().unwrap();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().starts_with("the checkpoint is of a/it.bag, not of"), "{error}");
    }

    #[test]
    fn the_time_between_is_a_gap_and_a_clock_set_back_a_restart() {
        let options = Options::default();
        let mut first = Session::new("it", &options);
        first.take(&mut block(0..5000));
        let bytes = first.to_bytes(false).unwrap();
        for (from, missing, records) in [(6000, 1000, 1), (100, 0, 2)] {
            let mut second = Session::resume("it", &options, &bytes, Before::IsPast).unwrap();
            second.take(&mut block(from..from + 5000));
            let noise = second.view(&Link::default()).snapshot.calibration.gyroscope.unwrap();
            assert_eq!((noise.stamps.missing, noise.record_means.len()), (missing, records));
            assert_eq!(noise.stamps.samples, 10_000);
            // A clock that was set back does not take back the time that it ran.
            let span_s = if from == 100 { 9.998 } else { 10.999 };
            assert!((second.span_s() - span_s).abs() < 1e-9, "{}", second.span_s());
        }
    }

    #[test]
    fn a_session_ends_at_the_first_sample_that_makes_it_long_enough() {
        let mut session = Session::new("it", &Options::default());
        for from in [0, 4000] {
            let mut block = block(from..from + 4000);
            session.end_at(4.9995, &mut block);
            session.take(&mut block);
        }
        assert_eq!(session.samples(), [5001, 0]);
        assert!((session.span_s() - 5.0).abs() < 1e-9, "{}", session.span_s());
    }

    #[test]
    fn a_pause_is_a_gap_and_marks_are_told() {
        let mut session = Session::new("it", &Options::default());
        session.take(&mut block(0..5000));
        assert_eq!(session.mark(), Some(1));
        session.pause();
        let mut passed = block(5000..6000);
        session.take(&mut passed);
        assert!(passed.is_empty(), "what is passed over is not recorded either");
        session.pause();
        session.take(&mut block(6000..8000));
        let calibration = session.view(&Link::default()).snapshot.calibration;
        assert_eq!(calibration.gyroscope.unwrap().stamps.missing, 1000);
        assert_eq!(calibration.remarks, ["mark 1 at 5.0 s"]);
    }
}
