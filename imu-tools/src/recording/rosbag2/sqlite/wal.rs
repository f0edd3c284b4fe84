//! The write-ahead log beside an SQLite file: pages that were committed and not yet moved into it.
//!
//! 32 bytes of header, then frames: 24 bytes (page, size of the database after a commit or 0, two
//! salts, two sums) and the page. A frame counts if its salts are those of the header, the running
//! sums are right, and a commit follows. Source: "WAL-mode File Format",
//! <https://www.sqlite.org/walformat.html>.

use std::collections::HashMap;

use super::word;
use crate::error::Error;
use crate::recording::input::Input;

/// Bytes of the file's header and of a frame's.
const HEADER: usize = 32;
const FRAME: usize = 24;

/// The first word of a log whose sums are made of big-endian words; one less for the others.
const MAGIC: u32 = 0x377f_0683;

/// A log that has pages.
pub struct Wal {
    input: Input,
    /// Where the newest state of a page begins.
    pages: HashMap<u32, u64>,
}

/// The running sums.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Sums {
    values: [u32; 2],
    big_endian: bool,
}

impl Sums {
    fn add(&mut self, bytes: &[u8]) {
        let [mut a, mut b] = self.values;
        for pair in bytes.chunks_exact(8) {
            let (first, second) = pair.split_at(4);
            let word = |bytes: &[u8]| {
                let bytes = bytes.try_into().unwrap_or_default();
                if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
            };
            a = a.wrapping_add(word(first)).wrapping_add(b);
            b = b.wrapping_add(word(second)).wrapping_add(a);
        }
        self.values = [a, b];
    }
}

impl Wal {
    /// Finds the pages of a log; `None` if it has none.
    pub fn open(mut input: Input, page_size: usize) -> Result<Option<Self>, Error> {
        input.fill(HEADER)?;
        let Some(header) = input.at_hand().first_chunk::<HEADER>().copied() else {
            return Ok(None);
        };
        let magic = word(&header, 0).unwrap_or(0);
        let mut sums = Sums { values: [0; 2], big_endian: magic & 1 == 1 };
        sums.add(header.get(..24).unwrap_or_default());
        let is_log = magic | 1 == MAGIC
            && word(&header, 8).is_some_and(|size| size as usize == page_size)
            && [word(&header, 24), word(&header, 28)] == sums.values.map(Some);
        if !is_log {
            return Ok(None);
        }
        input.consume(HEADER);
        let mut pages = HashMap::new();
        let mut pending = Vec::new();
        while input.fill(FRAME + page_size)? {
            let offset = input.offset();
            let frame = input.at_hand().get(..FRAME + page_size).unwrap_or_default();
            let (about, page) = frame.split_at_checked(FRAME).unwrap_or_default();
            sums.add(about.get(..8).unwrap_or_default());
            sums.add(page);
            let good = about.get(8..16) == header.get(16..24)
                && [word(about, 16), word(about, 20)] == sums.values.map(Some);
            let (Some(number), Some(commit)) = (word(about, 0), word(about, 4)) else { break };
            if !good {
                break;
            }
            pending.push((number, offset + FRAME as u64));
            if commit > 0 {
                pages.extend(pending.drain(..));
            }
            input.consume(FRAME + page_size);
        }
        Ok((!pages.is_empty()).then_some(Self { input, pages }))
    }

    /// The log, and where in it the newest state of a page is.
    pub fn page(&mut self, number: u32) -> Option<(&mut Input, u64)> {
        let offset = *self.pages.get(&number)?;
        Some((&mut self.input, offset))
    }

    /// The highest number of a page in it.
    pub fn highest_page(&self) -> u64 {
        self.pages.keys().copied().max().map_or(0, u64::from)
    }
}
