//! What is kept of a session on disk: the checkpoint, the samples, the bytes. What cannot be kept is given up or
//! tried again, and told; the measurement goes on.

use std::time::Duration;

use super::checkpoint::Place;
use super::session::Session;
use crate::error::Error;
use crate::output::Output;
use crate::recording::Sink;

/// What is kept of a session.
#[derive(Default)]
pub struct Keep {
    /// The checkpoint's place, and the time between checkpoints.
    pub checkpoint: Option<(Place, Duration)>,
    /// The samples.
    pub record: Option<Box<dyn Sink>>,
    /// The bytes.
    pub raw: Option<Output>,
    /// What could not be kept: the session goes on without it.
    pub lost: Vec<Error>,
    /// Why the latest checkpoint could not be written, if so: it is tried again.
    pub unwritten: Option<String>,
}

impl Keep {
    /// Writes a checkpoint, if there is to be one, and remembers whether it could; whether there is one.
    pub(super) fn checkpoint(&mut self, session: &Session, ended: bool) -> Result<bool, Error> {
        let written = match &mut self.checkpoint {
            // There is nothing to go on with.
            Some(_) if session.samples() == [0, 0] => Ok(false),
            Some((place, _)) => {
                session.to_bytes(ended).and_then(|bytes| place.write(&bytes)).map(|()| true)
            }
            None => Ok(false),
        };
        self.unwritten = written.as_ref().err().map(ToString::to_string);
        written
    }

    /// All that is not kept now, in words.
    pub(super) fn troubles(&self) -> Vec<String> {
        let lost = self.lost.iter().map(|error| format!("recorded no longer: {error}"));
        lost.chain(self.unwritten.iter().map(|why| format!("no checkpoint: {why}"))).collect()
    }

    /// Writes to the recording, if there is one; one that cannot be written is given up, and stays as it is.
    pub(super) fn record(&mut self, write: impl FnOnce(&mut dyn Sink) -> Result<(), Error>) {
        if let Some(record) = &mut self.record
            && let Err(error) = write(record.as_mut())
        {
            self.record = None;
            self.lost.push(error);
        }
    }

    /// The same of the bytes.
    pub(super) fn raw(&mut self, write: impl FnOnce(&mut Output) -> Result<(), Error>) {
        if let Some(raw) = &mut self.raw
            && let Err(error) = write(raw)
        {
            self.raw = None;
            self.lost.push(error);
        }
    }

    pub(super) fn flush(&mut self) {
        self.record(|record| record.flush());
        self.raw(Output::sync);
    }

    /// Completes the files; the first thing that was not kept.
    pub(super) fn close(self) -> Result<(), Error> {
        let record = self.record.map_or(Ok(()), Sink::finish);
        let raw = self.raw.map_or(Ok(()), Output::finish);
        let lost = self.lost.into_iter().next().map_or(Ok(()), Err);
        lost.and(record).and(raw)
    }
}
