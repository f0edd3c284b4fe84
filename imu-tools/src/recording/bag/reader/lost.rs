//! What cannot be read: where reading goes on behind it, and what is told of it.

use super::BagReader;
use crate::error::Error;
use crate::recording::Note;
use crate::recording::bag::damage::{Among, TAIL, next_record};

/// Looked through at once for the next record after damage.
const SCAN: usize = 64 * 1024;

/// Damage is told so often, at most.
const TOLD: u32 = 20;

impl BagReader {
    /// Steps over what cannot be read, to the next record; whether there is more to read.
    /// `piece`: it can be a record whose end is missing.
    #[cold]
    pub(super) fn damaged(&mut self, piece: bool) -> Result<bool, Error> {
        let (at, from) = (self.bytes.at(), self.bytes.offset());
        self.bytes.consume(1);
        if !self.search()? {
            return Ok(self.over(&at, from, piece));
        }
        let lost = self.bytes.offset() - from;
        self.warn(format!("is damaged at {at}: {lost} bytes are lost"));
        Ok(true)
    }

    /// Goes to the next record; `false`, at the end of the chunk or file, where there is none.
    pub(super) fn search(&mut self) -> Result<bool, Error> {
        let among = if self.bytes.in_chunk() { Among::Records } else { Among::Anything };
        loop {
            let more = self.bytes.fill(SCAN)?;
            let bytes = self.bytes.at_hand();
            let found = next_record(bytes, among);
            let clear = if more { bytes.len().saturating_sub(TAIL) } else { bytes.len() };
            self.bytes.consume(found.unwrap_or(clear));
            if found.is_some() || !more {
                return Ok(found.is_some());
            }
        }
    }

    /// Says that nothing more was found in the chunk or file, unless that will be said when it is
    /// left; whether there is more to read.
    pub(super) fn over(&mut self, at: &str, from: u64, piece: bool) -> bool {
        let lost = self.bytes.offset() - from;
        let in_chunk = self.bytes.in_chunk();
        if !piece || !self.bytes.cut() {
            let of = if in_chunk { "the rest of its chunk" } else { "the rest" };
            self.warn(format!("is damaged at {at}: {of}, {lost} bytes, is lost"));
        } else if !in_chunk {
            return self.end(true);
        }
        true
    }

    /// Says, once, what the bag lacks and what was strange in it. There is nothing more to read.
    #[cold]
    pub(super) fn end(&mut self, cut: bool) -> bool {
        self.ended = true;
        let unknown = self.unknown;
        let untold = self.warnings.saturating_sub(TOLD);
        self.warnings = 0;
        if untold > 0 {
            self.warn(format!("is damaged in {untold} more places"));
        }
        if let Some(closing) = self.account.closing(self.bytes.offset(), cut) {
            self.warn(closing);
        }
        for strange in self.samples.strange() {
            self.warn(strange);
        }
        if unknown > 0 {
            self.warn(format!("has {unknown} messages of topics that it does not name"));
        }
        false
    }

    pub(super) fn warn(&mut self, what: String) {
        self.warnings = self.warnings.saturating_add(1);
        if self.warnings <= TOLD {
            let path = self.bytes.input().path().display();
            self.notes.push(Note::Warning(format!("{path} {what}")));
        }
    }
}
