//! What a bag says of itself: its first record, and its connections, on the way or in the list at its
//! end.

use super::{BagReader, LARGEST_HEADER, Next, Record};
use crate::error::Error;
use crate::recording::bag::account::Account;
use crate::recording::bag::damage::{Among, next_record};
use crate::recording::bag::{connection, op};

impl BagReader {
    /// Takes what the first record says of the bag; leaves anything else to the main loop.
    pub(super) fn bag_header(&mut self) -> Result<(), Error> {
        let Next::Record(record @ Record { op: op::BAG_HEADER, .. }) = self.next()? else {
            return Ok(());
        };
        let header = self.header(&record).unwrap_or_default();
        let encryptor = header.encryptor.unwrap_or_default();
        if !encryptor.is_empty() && encryptor != b"rosbag/NoEncryptor" {
            return Err(Error::data(format!(
                "{} is encrypted by {}: decrypt it with the key that it was recorded with, and \
                 read the result",
                self.bytes.input().path().display(),
                String::from_utf8_lossy(encryptor)
            )));
        }
        self.account = Account::of(&header);
        // Blanks fill it up; where there is a record in them, its length is wrong.
        let (start, len) = (8 + record.header, 8 + record.header + record.data);
        let whole = self.bytes.fill(len)?;
        let bytes = self.bytes.at_hand();
        let blanks = bytes.get(..len).unwrap_or(bytes).get(start..).unwrap_or_default();
        if record.data > LARGEST_HEADER || next_record(blanks, Among::Records).is_some() {
            self.damaged(!whole)?;
        } else {
            self.step_over(&record)?;
        }
        Ok(())
    }

    /// Reads all connections from the end of the file, where one can go there and back.
    pub(super) fn list(&mut self) -> Result<(), Error> {
        let back = self.bytes.offset();
        let index_pos = self.account.index_pos;
        if self.ended || index_pos < back || !self.bytes.input_mut().seek(index_pos)? {
            return Ok(());
        }
        let mut found = false;
        self.listed = loop {
            match self.next()? {
                Next::Record(record @ Record { op: op::CONNECTION, .. }) => {
                    self.connection(&record)?;
                    found = true;
                    if !self.bytes.skip(record.len())? {
                        break false;
                    }
                }
                Next::Record(Record { op: op::CHUNK_INFO, .. }) => break true,
                Next::End => break found,
                _ => break false,
            }
        };
        self.bytes.input_mut().seek(back)?;
        Ok(())
    }

    /// Takes note of a connection; whether it is new. A description that is too large or cut off
    /// says nothing.
    pub(super) fn connection(&mut self, record: &Record) -> Result<bool, Error> {
        let Some(number) = record.conn else { return Ok(false) };
        let start = 8 + record.header;
        if !self.bytes.fill(start + record.data)? {
            return Ok(false);
        }
        let bytes = self.bytes.at_hand();
        let header = bytes.get(4..4 + record.header).unwrap_or_default();
        let data = bytes.get(start..start + record.data).unwrap_or_default();
        let Some(connection) = connection::described(number, header, data) else {
            return Ok(false);
        };
        let known = self.topics.knows(number);
        let added = self.topics.add(connection);
        if known && added {
            let at = self.bytes.at();
            self.warn(format!(
                "has a damaged description of connection {number}: its messages before {at} are lost"
            ));
        }
        Ok(added)
    }
}
