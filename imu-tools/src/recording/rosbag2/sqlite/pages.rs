//! The pages of a database: how long they are, and the newest state of each.

use std::path::Path;

use super::wal::Wal;
use super::{HEADER, MAGIC, half, word};
use crate::error::Error;
use crate::recording::input::Input;

/// The pages of a database.
pub struct Pages {
    input: Input,
    wal: Option<Wal>,
    size: usize,
    /// Bytes of a page that hold data.
    pub usable: usize,
    /// Pages that the file and its log can have at most.
    pub count: u64,
    /// Pages read so far.
    pub read: u64,
    /// Pages that are missing or are not what they should be.
    pub lost: u64,
    /// Pages that the file should have, if it has fewer.
    pub cut_off: Option<u64>,
}

impl Pages {
    /// Reads the header of a file that can be sought in.
    ///
    /// # Errors
    /// When it is no SQLite file, or one whose texts are UTF-16.
    pub fn open(mut input: Input, wal: Option<Input>) -> Result<Self, Error> {
        let name = input.path().display().to_string();
        let whole = input.fill(HEADER)?;
        let header = input.at_hand();
        if !whole || !header.starts_with(MAGIC) {
            return Err(Error::data(format!(
                "{name} is no SQLite file, or is cut off at its start"
            )));
        }
        let size = match half(header, 16) {
            Some(1) => 65_536,
            size => size.unwrap_or(0),
        };
        let usable = size.saturating_sub(usize::from(header.get(20).copied().unwrap_or(0)));
        if !size.is_power_of_two() || size < 512 || usable < 480 {
            return Err(Error::data(format!(
                "{name} is damaged: its header says that its pages are {size} bytes long"
            )));
        }
        if word(header, 56).is_some_and(|encoding| encoding > 1) {
            return Err(Error::data(format!(
                "{name} holds texts in UTF-16, and is no recording of rosbag2"
            )));
        }
        let len = input.len().unwrap_or(0);
        // The count holds if the last writer knew of it.
        let known = word(header, 24) == word(header, 92);
        let told = word(header, 28).filter(|_| known).map(u64::from);
        let wal = wal.map(|log| Wal::open(log, size)).transpose()?.flatten();
        let cut_off = told.filter(|told| *told > len / size as u64 && wal.is_none());
        let count = len.div_ceil(size as u64).max(wal.as_ref().map_or(0, Wal::highest_page));
        Ok(Self { input, wal, size, usable, count, read: 0, lost: 0, cut_off })
    }

    /// The name that errors call the file by.
    pub fn path(&self) -> &Path {
        self.input.path()
    }

    /// Length of the file.
    pub fn len(&self) -> Option<u64> {
        self.input.len()
    }

    /// Length of a page.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Page `number`, the first is 1; `None` where the file does not have it.
    pub fn page(&mut self, number: u32) -> Result<Option<&[u8]>, Error> {
        let Some(before) = number.checked_sub(1) else { return Ok(None) };
        self.read += 1;
        let (input, offset) = match self.wal.as_mut().and_then(|wal| wal.page(number)) {
            Some(there) => there,
            None => (&mut self.input, u64::from(before) * self.size as u64),
        };
        // Pages of a recording follow each other, so the next one is at hand most of the time.
        let ahead = offset.checked_sub(input.offset()).and_then(|n| usize::try_from(n).ok());
        match ahead.filter(|n| *n <= input.at_hand().len()) {
            Some(n) => input.consume(n),
            None if input.seek(offset)? => {}
            None => return Ok(None),
        }
        input.fill(self.size)?;
        Ok(input.at_hand().get(..self.size))
    }
}
