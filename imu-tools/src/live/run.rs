//! The loop of a live session: what arrives goes into the calibration, the recording and the checkpoint;
//! now and then it is shown.

use std::sync::mpsc::TryRecvError;
use std::time::{Duration, Instant};

use super::face::{Face, Key};
use super::goal::Goal;
use super::keep::Keep;
use super::link::Link;
use super::port::{self, Arrival, Port};
use super::session::{Session, View};
use super::told::{Heard, Told};
use crate::error::Error;
use crate::output::end_is_asked;
use crate::recording::{Block, Note, SampleKind};

/// Nothing left to take, the loop sleeps so long: to wake for every piece would cost as much as all else,
/// and when bytes came is noted by who reads them. Keys and signals are looked at as often, at least.
const LULL: Duration = Duration::from_millis(20);

/// Recordings are brought to the disk so often.
const FLUSH: Duration = Duration::from_secs(1);

/// The time between views is this many times what a view takes, at least.
const REST: u32 = 200;

/// The goal is looked at whenever the record has grown by this part, whatever the time on the wall.
const GROWTH: f64 = 1.02;

/// What POSIX calls the signal of Ctrl-C.
const SIGINT: i32 = 2;

/// What became of bytes.
#[derive(Debug)]
pub enum Step {
    /// Samples, and what they are.
    Samples(Block, SampleKind),
    /// The sensor was switched off and on.
    Restart,
}

/// From bytes to samples.
pub trait Decode {
    /// Takes bytes whose last one came at `arrival_ns`, and appends what became of them.
    ///
    /// # Errors
    /// When they are of no known protocol.
    fn feed(&mut self, arrival_ns: i64, bytes: &[u8], to: &mut Vec<Step>) -> Result<(), Error>;

    /// The port went away and is open again: appends what waited.
    fn reopened(&mut self, to: &mut Vec<Step>);

    /// There is nothing more: appends what waited.
    ///
    /// # Errors
    /// When what came is of no known protocol.
    fn finish(&mut self, to: &mut Vec<Step>) -> Result<(), Error>;

    /// Fills in what is known of the way.
    fn tell(&self, link: &mut Link);
}

/// Why a session ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// It reached its goal.
    Goal,
    /// There is nothing more to read.
    Input,
    /// The user ended it.
    Quit,
    /// A signal of this number did.
    Signal(i32),
}

/// A session, and all that it is connected with.
pub struct Live<'a> {
    /// The calibration.
    pub session: Session,
    /// Where it comes from.
    pub port: Port,
    /// What makes samples of bytes.
    pub decode: Option<Box<dyn Decode + 'a>>,
    /// What is kept.
    pub keep: Keep,
    /// When it is enough.
    pub goal: Goal,
    /// What is done when the user saves, beside a checkpoint; where it went, if there is a place.
    pub save: &'a mut dyn FnMut(&View) -> Result<Option<String>, Error>,
}

impl Live<'_> {
    /// Runs until an end; the last view, and why it ended, or what went wrong: the port, or something that
    /// could not be written. Whatever ends it, checkpoint and recordings are complete. What the user ended
    /// has ended so, whatever the port would have come to; what was wrong with it is in the view.
    pub fn run(mut self, face: &mut dyn Face) -> (View, Result<Ended, Error>) {
        let mut link = Link { name: self.port.name.clone(), ..Link::default() };
        let mut told = Told::default();
        let followed = self.follow(face, &mut link, &mut told);
        let is_stopped = matches!(followed, Ok(Ended::Quit | Ended::Signal(_)));
        if is_stopped {
            self.empty(face, &mut link);
        }
        let mut steps = Vec::new();
        let last = self.decode.as_mut().map_or(Ok(()), |decode| decode.finish(&mut steps));
        self.proceed(steps);
        let amiss = last.as_ref().err().filter(|_| is_stopped).map(ToString::to_string);
        let ended =
            followed.and_then(|ended| if is_stopped { Ok(ended) } else { last.map(|()| ended) });
        if let Some(decode) = &self.decode {
            decode.tell(&mut link);
        }
        told.tell(&link, face);
        link.amiss = amiss.or(link.amiss);
        let over = matches!(ended, Ok(Ended::Goal | Ended::Input | Ended::Quit));
        let kept = self.keep.checkpoint(&self.session, over);
        let closed = self.keep.close();
        let ended = ended.and_then(|ended| kept.and(closed).map(|()| ended));
        (self.session.view(&link), ended)
    }

    /// Takes what waits of a sensor: it came before the end. A recording is not read to its own.
    fn empty(&mut self, face: &mut dyn Face, link: &mut Link) {
        if self.decode.is_none() {
            return;
        }
        // What comes meanwhile is not waited for.
        for _ in 0..port::AHEAD {
            let Ok(arrival) = self.port.arrivals.try_recv() else { break };
            if !self.arrive(arrival, face, link).is_ok_and(|goes_on| goes_on) {
                break;
            }
        }
    }

    fn follow(
        &mut self,
        face: &mut dyn Face,
        link: &mut Link,
        told: &mut Told,
    ) -> Result<Ended, Error> {
        let (mut shown, mut flushed, mut kept) = (Instant::now(), Instant::now(), Instant::now());
        let (mut between, mut look_at_s) = (face.every(), 0.0);
        let mut lost = 0;
        let mut heard = Heard::default();
        loop {
            match self.port.arrivals.try_recv() {
                Ok(arrival) => {
                    heard.note(&arrival, link, face);
                    if !self.arrive(arrival, face, link)? {
                        return Ok(Ended::Input);
                    }
                }
                Err(TryRecvError::Empty) => std::thread::sleep(LULL),
                Err(TryRecvError::Disconnected) => {
                    return Err(Error::data(format!("{} is not read any more", link.name)));
                }
            }
            if let Some(signal) = end_is_asked() {
                return Ok(Ended::Signal(signal));
            }
            if self.decode.is_some() {
                heard.look(link, face);
            }
            if flushed.elapsed() >= FLUSH {
                self.keep.flush();
                flushed = Instant::now();
            }
            for error in
                self.keep.lost.iter().skip(std::mem::replace(&mut lost, self.keep.lost.len()))
            {
                face.say(&format!("warning: {error}; the session goes on without it"));
            }
            if let Some((_, every)) = &self.keep.checkpoint
                && kept.elapsed() >= *every
            {
                let before = self.keep.unwritten.take();
                if let Err(why) = self.keep.checkpoint(&self.session, false)
                    && before != self.keep.unwritten
                {
                    face.say(&format!("warning: {why}; it is tried again"));
                }
                kept = Instant::now();
            }
            if !self.goal.is_none() && self.session.span_s() >= look_at_s {
                look_at_s = (GROWTH * self.session.span_s()).max(10.0);
                look_at_s = self.goal.span_s.map_or(look_at_s, |goal| {
                    if self.session.span_s() < goal { look_at_s.min(goal) } else { look_at_s }
                });
                let calibration = self.session.view(link).snapshot.calibration;
                if self.goal.is_reached(self.session.span_s(), &calibration) {
                    return Ok(Ended::Goal);
                }
            }
            if let Some(key) = face.key() {
                match key {
                    Key::Quit => return Ok(Ended::Quit),
                    Key::Interrupt => return Ok(Ended::Signal(SIGINT)),
                    Key::Save => self.save(face, link),
                    Key::Pause => self.session.pause(),
                    Key::Mark => self.mark(face),
                }
                between = Duration::ZERO;
            }
            if shown.elapsed() >= between {
                let start = Instant::now();
                let view = self.view(link);
                told.tell(link, face);
                face.show(&view)?;
                shown = Instant::now();
                between = face.every().max(start.elapsed() * REST);
            }
        }
    }

    fn view(&self, link: &mut Link) -> View {
        if let Some(decode) = &self.decode {
            decode.tell(link);
        }
        View { lost: self.keep.troubles(), ..self.session.view(link) }
    }

    /// Takes what arrived; `false` at the end.
    fn arrive(
        &mut self,
        arrival: Arrival,
        face: &mut dyn Face,
        link: &mut Link,
    ) -> Result<bool, Error> {
        match arrival {
            Arrival::Bytes { arrival_ns, bytes } => {
                self.keep.raw(|raw| raw.write(&bytes));
                let mut steps = Vec::new();
                if let Some(decode) = &mut self.decode {
                    decode.feed(arrival_ns, &bytes, &mut steps)?;
                }
                self.proceed(steps);
            }
            Arrival::Samples(block, samples) => self.take(block, samples),
            Arrival::Note(Note::Info(sentence)) => face.say(&sentence),
            Arrival::Note(Note::Warning(sentence)) => face.say(&format!("warning: {sentence}")),
            Arrival::Gone(why) => {
                face.say(&format!("{}: {why}; waiting for it to come back", link.name));
                link.gone = Some(why);
            }
            Arrival::Back => {
                face.say(&format!("{} is back", link.name));
                link.gone = None;
                let mut steps = Vec::new();
                if let Some(decode) = &mut self.decode {
                    decode.reopened(&mut steps);
                }
                self.proceed(steps);
            }
            Arrival::End => return Ok(false),
            Arrival::Failed(error) => return Err(error),
        }
        Ok(true)
    }

    fn proceed(&mut self, steps: Vec<Step>) {
        for step in steps {
            match step {
                Step::Samples(block, samples) => self.take(block, samples),
                Step::Restart => self.session.restart(),
            }
        }
    }

    fn take(&mut self, mut block: Block, samples: SampleKind) {
        if let Some(span_s) = self.goal.span_s {
            self.session.end_at(span_s, &mut block);
        }
        self.session.take(&mut block);
        if !block.is_empty() {
            self.keep.record(|record| {
                record.samples_are(samples);
                record.write_block(&block)
            });
        }
    }

    /// Says of each what became of it: the session goes on, and what failed can be saved later.
    fn save(&mut self, face: &mut dyn Face, link: &mut Link) {
        let kept = self.keep.checkpoint(&self.session, false);
        self.keep.flush();
        let view = self.view(link);
        let kept = match kept {
            Ok(true) => Some("the checkpoint is saved".to_owned()),
            Ok(false) => None,
            Err(error) => Some(format!("the checkpoint is not saved: {error}")),
        };
        let results = match (self.save)(&view) {
            Ok(place) => place.map(|place| format!("the results are in {place}")),
            Err(error) => Some(format!("the results are not saved: {error}")),
        };
        let said: Vec<String> = kept.into_iter().chain(results).collect();
        face.say(&match said.as_slice() {
            [] => {
                "nothing to save: neither --checkpoint nor -o was given, or no sample came".into()
            }
            said => said.join("; "),
        });
    }

    fn mark(&mut self, face: &mut dyn Face) {
        let at_s = self.session.span_s();
        face.say(&match self.session.mark() {
            Some(number) => format!("mark {number} at {at_s:.1} s"),
            None => "not marked: there are as many marks as are kept".to_owned(),
        });
    }
}

#[cfg(all(test, target_os = "linux"))]
#[path = "run_tests.rs"]
mod tests;
