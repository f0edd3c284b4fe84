//! What cannot be read: where it ends or goes on, and what is told of it.

use super::McapReader;
use crate::error::Error;
use crate::recording::Note;
use crate::recording::mcap::record::{self, HEAD};
use crate::recording::mcap::repeat::find_chunk;

impl McapReader {
    /// The record at hand goes beyond the end of the file, or of what a chunk holds.
    pub(super) fn ended_here(&mut self) -> Result<bool, Error> {
        if self.is_packed() { self.leave_chunk(true) } else { Ok(self.cut_off()) }
    }

    /// Looks for the place where messages or chunks go on behind what cannot be read.
    #[cold]
    pub(super) fn damaged(&mut self) -> Result<bool, Error> {
        /// More than the head of a chunk or message.
        const TAIL: usize = HEAD + record::CHUNK;
        let (start, at) = (self.input.file_offset(), self.input.offset());
        let limit = self.chunk.as_ref().and_then(|chunk| chunk.end);
        let cut = self.chunk.is_none() && self.input.len().is_some();
        if let Some(chunk) = &mut self.chunk {
            chunk.do_not_check();
        }
        let mut step = 1;
        let found = loop {
            if !self.input.skip(step as u64)? {
                break false;
            }
            let more = self.input.fill(TAIL + 1)?;
            let mut here = self.input.at_hand();
            if let Some(limit) = limit {
                let inside = usize::try_from(limit.saturating_sub(self.input.offset()));
                here = here.get(..here.len().min(inside.unwrap_or(usize::MAX))).unwrap_or_default();
            }
            let message = self.repeat.and_then(|repeat| repeat.find(here));
            let chunk = self.chunk.is_none().then(|| find_chunk(here)).flatten();
            if let Some(at) = message.into_iter().chain(chunk).min() {
                self.input.skip(at as u64)?;
                break true;
            }
            if !more || limit.is_some_and(|l| self.input.offset() + here.len() as u64 >= l) {
                self.input.skip(here.len() as u64)?;
                break false;
            }
            step = here.len() - TAIL;
        };
        let lost = self.input.offset() - at;
        if !found && cut && !self.data_ended {
            self.warn(format!(
                "is damaged or cut off at byte {start}: {lost} bytes are lost, and what comes \
                 before is used"
            ));
        } else if self.data_ended {
            self.warn(format!("is damaged behind its data, at byte {start}: no message is lost"));
        } else {
            self.warn(format!("is damaged at byte {start}: {lost} bytes are lost"));
        }
        if !found && self.chunk.is_none() {
            self.ended = true;
        }
        Ok(!self.ended)
    }

    /// Says that the file was cut off; there is no more to read.
    #[cold]
    pub(super) fn cut_off(&mut self) -> bool {
        self.ended = true;
        self.warn(if self.data_ended {
            "is cut off behind its data: no message is lost".into()
        } else {
            "ends in the middle of a record: what comes before is used".into()
        });
        false
    }

    /// The file ends with a whole record that is no footer.
    #[cold]
    pub(super) fn at_end(&mut self) -> bool {
        self.ended = true;
        self.warn(if self.data_ended {
            "is cut off behind its data: no message is lost".into()
        } else {
            "was not closed: what was recorded last may be missing".into()
        });
        false
    }

    pub(super) fn warn(&mut self, what: String) {
        /// Damage is told so often, at most.
        const TOLD: usize = 20;
        if self.notes.len() < TOLD {
            self.notes.push(Note::Warning(format!("{} {what}", self.input.path().display())));
        }
    }

    /// Says, once, at the end, what was strange about the messages.
    pub(super) fn warn_of_messages(&mut self) {
        let mut notes = self.taken.take_notes(self.input.path());
        self.notes.append(&mut notes);
        if self.unknown > 0 {
            self.warn(format!("has {} messages of channels that it does not name", self.unknown));
        }
        if let Some(expected) = self.expected.filter(|expected| *expected > self.messages) {
            let found = self.messages;
            self.warn(format!("says that it has {expected} messages, of which {found} were found"));
        }
        (self.unknown, self.expected) = (0, None);
    }
}
