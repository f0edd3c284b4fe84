//! What a file says of itself: schemas and channels, on the way or in the summary at its end.

use super::{McapReader, Next};
use crate::error::Error;
use crate::recording::mcap::record::{self, Fields, HEAD};
use crate::recording::mcap::{MAGIC, op};
use crate::recording::ros2::holds;
use crate::recording::topics::Connection;

/// Schemas remembered, at most: a recording has a few dozen.
const SCHEMAS: usize = 4096;

/// Bytes of a footer's data.
const FOOTER: u64 = 20;

impl McapReader {
    /// Reads the summary at the end of the file, where one can go there and back; whether it names
    /// all channels.
    pub(super) fn list(&mut self) -> Result<bool, Error> {
        const END: usize = HEAD + FOOTER as usize + MAGIC.len();
        let back = self.input.offset();
        let Some(footer) = self.input.len().and_then(|len| len.checked_sub(END as u64)) else {
            return Ok(false);
        };
        let mut listed = false;
        if footer >= back && self.input.seek(footer)? && self.input.fill(END)? {
            let end = self.input.at_hand();
            let summary = match record::head(end) {
                Some((op::FOOTER, FOOTER)) if end.ends_with(MAGIC) => {
                    end.get(HEAD..).and_then(|data| Fields(data).u64()).unwrap_or(0)
                }
                _ => 0,
            };
            if summary >= back && self.input.seek(summary)? {
                listed = self.summary()?;
            }
        }
        self.input.seek(back)?;
        Ok(listed)
    }

    /// Reads schemas and channels of the summary; whether it has all.
    fn summary(&mut self) -> Result<bool, Error> {
        let (mut channels, mut counted) = (0, None);
        loop {
            let Next::Record(op, len) = self.next()? else { return Ok(false) };
            match op {
                op::SCHEMA => self.schema(len)?,
                op::CHANNEL => {
                    self.channel(len)?;
                    channels += 1;
                }
                op::STATISTICS => {
                    let mut fields = Fields(self.data(len)?);
                    let (messages, _schemas) = (fields.u64(), fields.u16());
                    counted = fields.u32();
                    self.expected = messages;
                }
                op::FOOTER => break,
                // No summary: the footer is wrong.
                0 | op::HEADER | op::MESSAGE | op::CHUNK | op::DATA_END => return Ok(false),
                _ => {}
            }
            if !self.input.skip(len)? {
                return Ok(false);
            }
        }
        Ok(counted.map_or(channels > 0, |counted| counted == channels))
    }

    /// Takes note of a schema; one that is cut off says nothing.
    pub(super) fn schema(&mut self, len: u64) -> Result<(), Error> {
        let mut fields = Fields(self.data(len)?);
        if let (Some(id), Some(name)) = (fields.u16(), fields.text())
            && self.schemas.len() < SCHEMAS
            && !self.schemas.iter().any(|(known, _)| *known == id)
        {
            self.schemas.push((id, name));
        }
        Ok(())
    }

    /// Takes note of a channel.
    pub(super) fn channel(&mut self, len: u64) -> Result<(), Error> {
        let mut fields = Fields(self.data(len)?);
        let (Some(id), Some(schema)) = (fields.u16(), fields.u16()) else { return Ok(()) };
        let (Some(topic), Some(encoding)) = (fields.text(), fields.text()) else { return Ok(()) };
        let known = self.schemas.iter().find(|(known, _)| *known == schema);
        let type_name = known.map(|(_, name)| name.clone()).unwrap_or_default();
        let holds = holds(&type_name, &encoding);
        let new = self.topics.add(Connection { number: id.into(), topic, type_name, holds });
        if new && !self.listed {
            self.topics.choose(self.input.path())?;
        }
        Ok(())
    }
}
