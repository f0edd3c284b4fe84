//! A compressed chunk as a stream: packed bytes in, records out, through one small window.
//!
//! What a chunk says of its size decides nothing: the window grows with what was really unpacked.
//! Of a damaged chunk all that comes before the damage is given. A bz2 block is only known to be
//! good when its end was reached, so that much is held back until then.

use bzip2::{Decompress, Status};

use super::lz4::{self, HISTORY, Lz4, Step};
use crate::error::Error;
use crate::recording::input::{Input, LARGEST_PIECE};

/// A block of bz2 unpacks to this at most, but for long runs of one byte.
const LARGEST_BLOCK: usize = 900_000;

/// Unpacked by bz2 at once.
const PORTION: usize = 64 * 1024;

/// The packed bytes of a chunk: the file from here on, but no more than `left`.
pub struct Packed<'a> {
    /// The file.
    pub input: &'a mut Input,
    /// Bytes of the chunk that were not read yet.
    pub left: &'a mut u64,
}

impl Packed<'_> {
    /// The bytes at hand, at least one unless the chunk or the file is over.
    fn at_hand(&mut self) -> Result<&[u8], Error> {
        if *self.left > 0 && self.input.at_hand().is_empty() {
            self.input.fill(1)?;
        }
        let bytes = self.input.at_hand();
        let here = (bytes.len() as u64).min(*self.left) as usize;
        Ok(bytes.get(..here).unwrap_or_default())
    }

    fn consume(&mut self, n: usize) {
        self.input.consume(n);
        *self.left -= (n as u64).min(*self.left);
    }

    /// Appends the next `wanted` bytes to `to`; `false`, and as many as there are, where the chunk
    /// or the file ends before.
    pub fn append(&mut self, wanted: usize, to: &mut Vec<u8>) -> Result<bool, Error> {
        let mut missing = wanted;
        while missing > 0 {
            let bytes = self.at_hand()?;
            let bytes = bytes.get(..missing).unwrap_or(bytes);
            let n = bytes.len();
            if n == 0 {
                return Ok(false);
            }
            to.extend_from_slice(bytes);
            self.consume(n);
            missing -= n;
        }
        Ok(true)
    }
}

/// How a chunk is compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compression {
    /// bzip2.
    Bz2,
    /// A frame of LZ4.
    Lz4,
}

impl Compression {
    /// The compression of that name in a chunk's header.
    pub fn of(name: &[u8]) -> Option<Self> {
        match name {
            b"bz2" => Some(Self::Bz2),
            b"lz4" => Some(Self::Lz4),
            _ => None,
        }
    }

    /// Whether `bytes` can be the first of a compressed chunk.
    pub fn begins(self, bytes: &[u8]) -> bool {
        match self {
            Self::Bz2 => bytes.starts_with(b"BZh"),
            Self::Lz4 => bytes.starts_with(&lz4::MAGIC),
        }
    }
}

enum Codec {
    Bz2(Decompress),
    Lz4(Lz4),
}

/// How unpacking ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// All of it was unpacked.
    Whole,
    /// All of it was unpacked, but its checksum is another one.
    WrongSum,
    /// The file ended in it.
    Cut,
    /// It is damaged behind what was unpacked.
    Damaged,
}

/// A compressed chunk being read.
pub struct Unpacker {
    codec: Codec,
    /// Packed bytes that the chunk still claims.
    left: u64,
    /// Unpacked: what was consumed and is still referred to, what is at hand, what is held back.
    window: Vec<u8>,
    start: usize,
    held: usize,
    /// Consumed before `window[start]`.
    offset: u64,
    ending: Option<Ending>,
}

impl Unpacker {
    /// Starts on a chunk of `len` packed bytes.
    pub fn new(compression: Compression, len: u64) -> Self {
        let codec = match compression {
            Compression::Bz2 => Codec::Bz2(Decompress::new(false)),
            Compression::Lz4 => Codec::Lz4(Lz4::default()),
        };
        Self { codec, left: len, window: Vec::new(), start: 0, held: 0, offset: 0, ending: None }
    }

    /// The unpacked bytes at hand.
    #[inline]
    pub fn at_hand(&self) -> &[u8] {
        self.window.get(self.start..self.window.len() - self.held).unwrap_or_default()
    }

    /// Drops `n` of them.
    pub fn consume(&mut self, n: usize) {
        let n = n.min(self.at_hand().len());
        self.start += n;
        self.offset += n as u64;
    }

    /// Unpacked bytes consumed so far.
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// Packed bytes that the chunk claims beyond those that were read.
    pub fn left(&self) -> u64 {
        self.left
    }

    /// How unpacking ended, when it has.
    pub fn ending(&self) -> Option<Ending> {
        self.ending
    }

    /// Unpacks until `wanted` bytes are at hand; `false` when the chunk ends before.
    pub fn fill(&mut self, input: &mut Input, wanted: usize) -> Result<bool, Error> {
        if wanted > LARGEST_PIECE {
            return Ok(false);
        }
        while self.at_hand().len() < wanted {
            if self.ending.is_some() {
                return Ok(false);
            }
            self.forget();
            let Self { codec, left, window, held, .. } = self;
            let mut packed = Packed { input, left };
            let step = match codec {
                Codec::Lz4(lz4) => lz4.step(&mut packed, window)?,
                Codec::Bz2(bz2) => step_bz2(bz2, &mut packed, window, held)?,
            };
            self.ending = match step {
                Step::More => None,
                Step::End => Some(Ending::Whole),
                Step::WrongSum => Some(Ending::WrongSum),
                Step::Short if self.left > 0 => Some(Ending::Cut),
                Step::Short | Step::Damaged => Some(Ending::Damaged),
            };
        }
        Ok(true)
    }

    /// Makes room: drops what was consumed and is referred to no more.
    fn forget(&mut self) {
        let old = self.start.saturating_sub(HISTORY);
        if old >= self.window.len() / 2 {
            self.window.drain(..old);
            self.start -= old;
        }
    }
}

/// Unpacks a portion. `held` bytes at the window's end belong to a block whose sum was not seen.
fn step_bz2(
    bz2: &mut Decompress,
    packed: &mut Packed<'_>,
    window: &mut Vec<u8>,
    held: &mut usize,
) -> Result<Step, Error> {
    let (start, read, made) = (window.len(), bz2.total_in(), bz2.total_out());
    window.resize(start + PORTION, 0);
    let bytes = packed.at_hand()?;
    let over = bytes.is_empty();
    let status = bz2.decompress(bytes, window.get_mut(start..).unwrap_or_default());
    let (read, made) = ((bz2.total_in() - read) as usize, (bz2.total_out() - made) as usize);
    window.truncate(start + made);
    packed.consume(read);
    *held = (*held + made).min(LARGEST_BLOCK);
    Ok(match status {
        Ok(Status::StreamEnd) => {
            *held = 0;
            Step::End
        }
        Ok(_) if read > 0 || made > 0 => Step::More,
        // Without progress: it wants bytes that are not there, or memory.
        Ok(_) if over => {
            *held = 0;
            Step::Short
        }
        _ => {
            window.truncate(window.len() - *held);
            *held = 0;
            Step::Damaged
        }
    })
}
