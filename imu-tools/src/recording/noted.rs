//! A reader with something more to tell.

use super::{Block, Note, SampleKind, Source, Stream};
use crate::error::Error;

/// Tells `notes` with those of `source`.
pub struct Noted {
    source: Box<dyn Source>,
    notes: Vec<Note>,
}

impl Noted {
    /// Around a reader.
    pub fn new(source: Box<dyn Source>, notes: Vec<Note>) -> Self {
        Self { source, notes }
    }
}

impl Source for Noted {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        self.source.next_block(block)
    }

    fn streams(&self) -> Vec<Stream> {
        self.source.streams()
    }

    fn gyroscope(&self) -> &str {
        self.source.gyroscope()
    }

    fn accelerometer(&self) -> &str {
        self.source.accelerometer()
    }

    fn take_notes(&mut self) -> Vec<Note> {
        let mut notes = std::mem::take(&mut self.notes);
        notes.extend(self.source.take_notes());
        notes
    }

    fn samples(&self) -> Option<SampleKind> {
        self.source.samples()
    }

    fn bytes_read(&self) -> u64 {
        self.source.bytes_read()
    }

    fn bytes_total(&self) -> Option<u64> {
        self.source.bytes_total()
    }
}
