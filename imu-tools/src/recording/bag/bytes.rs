//! Where records are read: in the file itself, in a chunk of it, or in what a compressed chunk
//! unpacks to.
//!
//! Inside of a chunk, its end is the end of what there is to read, until the chunk is left.

use super::unpack::{Compression, Ending, Unpacker};
use crate::error::Error;
use crate::recording::input::Input;

enum Place {
    File,
    /// A chunk that is not compressed, which begins and ends at these bytes.
    Plain {
        start: u64,
        end: u64,
    },
    /// A compressed chunk that begins at this byte and says that it unpacks to so many.
    Packed {
        start: u64,
        says: u32,
        unpacker: Box<Unpacker>,
    },
}

/// How a chunk was left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Left {
    /// At its end.
    Whole,
    /// At its end, but these bytes that it claims are not part of it.
    TooLong(u64),
    /// At its end, but it unpacked to another number of bytes than it says.
    OtherSize { unpacked: u64, says: u32 },
    /// At its end, but its checksum is another one.
    WrongSum,
    /// The file ends in it.
    Cut,
    /// It could be unpacked so far.
    Damaged { unpacked: u64 },
}

/// The bytes of records.
pub struct Bytes {
    input: Input,
    place: Place,
}

impl Bytes {
    /// The records of `input`, from where it stands.
    pub fn new(input: Input) -> Self {
        Self { input, place: Place::File }
    }

    /// The file.
    pub fn input(&self) -> &Input {
        &self.input
    }

    /// The file, to go elsewhere in it: not from within a chunk.
    pub fn input_mut(&mut self) -> &mut Input {
        &mut self.input
    }

    /// Whether we are in a chunk.
    pub fn in_chunk(&self) -> bool {
        !matches!(self.place, Place::File)
    }

    /// Whether the records at hand were compressed.
    pub fn unpacked(&self) -> bool {
        matches!(self.place, Place::Packed { .. })
    }

    /// Enters a chunk whose `len` bytes come next.
    pub fn enter(&mut self, start: u64, len: u64) {
        self.place = Place::Plain { start, end: self.input.offset() + len };
    }

    /// Enters a compressed chunk whose `len` bytes come next; where its length is not known, it
    /// goes on to its own end mark. It says that it unpacks to so many bytes.
    pub fn enter_packed(&mut self, start: u64, how: Compression, len: Option<u64>, says: u32) {
        let unpacker = Box::new(Unpacker::new(how, len.unwrap_or(u64::MAX)));
        self.place = Place::Packed { start, says, unpacker };
    }

    /// Bytes that there can be at most from here on, where that is known.
    pub fn room(&self) -> Option<u64> {
        let here = self.input.offset();
        let file = self.input.len().map(|len| len.saturating_sub(here));
        match self.place {
            Place::File => file,
            Place::Plain { end, .. } => {
                let chunk = end.saturating_sub(here);
                Some(file.map_or(chunk, |file| file.min(chunk)))
            }
            Place::Packed { .. } => None,
        }
    }

    /// Whether the bytes are over before they should be: in the file, or in a chunk that has more.
    pub fn cut(&self) -> bool {
        match &self.place {
            Place::File => true,
            Place::Plain { end, .. } => self.input.offset() < *end,
            Place::Packed { unpacker, .. } => {
                !matches!(unpacker.ending(), Some(Ending::Whole | Ending::WrongSum))
            }
        }
    }

    /// The bytes at hand.
    #[inline]
    pub fn at_hand(&self) -> &[u8] {
        let bytes = match &self.place {
            Place::Packed { unpacker, .. } => return unpacker.at_hand(),
            _ => self.input.at_hand(),
        };
        match self.place {
            Place::Plain { end, .. } => {
                let inside = end.saturating_sub(self.input.offset()).min(bytes.len() as u64);
                bytes.get(..inside as usize).unwrap_or_default()
            }
            _ => bytes,
        }
    }

    /// Reads until `wanted` bytes are at hand; `false` where the chunk or the file ends before.
    #[inline]
    pub fn fill(&mut self, wanted: usize) -> Result<bool, Error> {
        match &mut self.place {
            Place::File => self.input.fill(wanted),
            Place::Plain { end, .. } => {
                let inside = end.saturating_sub(self.input.offset());
                let whole = self.input.fill(inside.min(wanted as u64) as usize)?;
                Ok(whole && wanted as u64 <= inside)
            }
            Place::Packed { unpacker, .. } => unpacker.fill(&mut self.input, wanted),
        }
    }

    /// Drops `n` bytes of those at hand.
    #[inline]
    pub fn consume(&mut self, n: usize) {
        match &mut self.place {
            Place::Packed { unpacker, .. } => unpacker.consume(n),
            _ => self.input.consume(n),
        }
    }

    /// Drops `n` bytes, read or not; `false` where the chunk or the file ends before.
    pub fn skip(&mut self, n: u64) -> Result<bool, Error> {
        match &mut self.place {
            Place::File => self.input.skip(n),
            Place::Plain { end, .. } => {
                let inside = end.saturating_sub(self.input.offset());
                Ok(self.input.skip(n.min(inside))? && n <= inside)
            }
            Place::Packed { unpacker, .. } => {
                let mut missing = n;
                while missing > 0 {
                    if !unpacker.fill(&mut self.input, 1)? {
                        return Ok(false);
                    }
                    let here = missing.min(unpacker.at_hand().len() as u64);
                    unpacker.consume(here as usize);
                    missing -= here;
                }
                Ok(true)
            }
        }
    }

    /// Where we are: a byte of the file, or of what the chunk unpacks to.
    pub fn offset(&self) -> u64 {
        match &self.place {
            Place::Packed { unpacker, .. } => unpacker.offset(),
            _ => self.input.offset(),
        }
    }

    /// The same in words.
    pub fn at(&self) -> String {
        match &self.place {
            Place::Packed { start, unpacker, .. } => {
                format!("byte {} of what the chunk at byte {start} unpacks to", unpacker.offset())
            }
            _ => format!("byte {}", self.input.offset()),
        }
    }

    /// Leaves the chunk in which we are, of which all was read that can be; where it began, and
    /// how it was left.
    pub fn leave(&mut self) -> (u64, Left) {
        match std::mem::replace(&mut self.place, Place::File) {
            Place::File => (0, Left::Whole),
            Place::Plain { start, end } => {
                let left = if self.input.offset() < end { Left::Cut } else { Left::Whole };
                (start, left)
            }
            Place::Packed { start, says, unpacker } => {
                let (left, unpacked) = (unpacker.left(), unpacker.offset());
                let endless = left > u64::from(u32::MAX);
                let how = match unpacker.ending() {
                    Some(Ending::Cut) => Left::Cut,
                    Some(Ending::WrongSum) => Left::WrongSum,
                    Some(Ending::Whole) if endless => Left::Whole,
                    Some(Ending::Whole) if left > 0 => Left::TooLong(left),
                    Some(Ending::Whole) if says > 0 && u64::from(says) != unpacked => {
                        Left::OtherSize { unpacked, says }
                    }
                    Some(Ending::Whole) => Left::Whole,
                    Some(Ending::Damaged) | None => Left::Damaged { unpacked },
                };
                (start, how)
            }
        }
    }
}
