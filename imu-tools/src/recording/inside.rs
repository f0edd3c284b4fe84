//! A piece of a file that is compressed, read through its decoder.
//!
//! Inside of it an [`Input`] shows the decompressed bytes as it shows those of a file. The decoder
//! holds the file's input meanwhile and gives it back behind the piece. Nothing is decompressed
//! ahead by more than the window or block that the format needs, so what a piece claims to hold
//! decides no memory. A piece that is damaged or cut off gives all that was decoded before.

use std::io::{self, Read};

use lz4_flex::frame::FrameDecoder as Lz4;
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder as Zstd};

use super::input::Input;
use super::zstandard;
use crate::error::Error;

/// What a decoder must remember at most: as much as Zstandard's ordinary levels ask for, 8 MB, and
/// a margin for unusual ones.
const LARGEST_WINDOW: u64 = 32 << 20;

/// How a piece is compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compression {
    /// Zstandard, RFC 8878.
    Zstd,
    /// LZ4 in its frame format.
    Lz4,
}

/// So many bytes of a file, from where it stands.
struct Part {
    input: Input,
    left: u64,
    /// What the system refused, which is no damage of the piece.
    refused: Option<Error>,
}

impl Read for Part {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 || to.is_empty() {
            return Ok(0);
        }
        match self.input.fill(1) {
            Ok(true) => {}
            Ok(false) => return Ok(0),
            Err(error) => {
                self.refused = Some(error);
                return Err(io::ErrorKind::Other.into());
            }
        }
        let here = self.input.at_hand();
        let n = to.len().min(here.len()).min(usize::try_from(self.left).unwrap_or(usize::MAX));
        if let (Some(to), Some(here)) = (to.get_mut(..n), here.get(..n)) {
            to.copy_from_slice(here);
        }
        self.input.consume(n);
        self.left -= n as u64;
        Ok(n)
    }
}

/// A decoder in the middle of its piece.
enum Decoder {
    Zstd { frame: Box<Zstd>, part: Part, started: bool, ended: bool },
    Lz4(Box<Lz4<Part>>),
}

/// The inside of a compressed piece.
pub struct Inside {
    decoder: Decoder,
    damaged: bool,
}

impl Inside {
    /// Enters the piece that is the next `len` bytes of `input`.
    pub fn new(input: Input, len: u64, compression: Compression) -> Self {
        let part = Part { input, left: len, refused: None };
        let decoder = match compression {
            Compression::Lz4 => Decoder::Lz4(Box::new(Lz4::new(part))),
            Compression::Zstd => {
                let mut frame = Box::new(Zstd::new());
                frame.set_max_window_size(LARGEST_WINDOW);
                Decoder::Zstd { frame, part, started: false, ended: false }
            }
        };
        Self { decoder, damaged: false }
    }

    /// The next decompressed bytes; 0 at the end of the piece, or where it is damaged.
    pub fn read(&mut self, to: &mut [u8]) -> Result<usize, Error> {
        loop {
            let read = match &mut self.decoder {
                Decoder::Lz4(_) if self.damaged => return Ok(0),
                Decoder::Lz4(decoder) => decoder.read(to),
                Decoder::Zstd { frame, part, started, ended } => {
                    if *ended || frame.can_collect() > 0 {
                        return Ok(frame.read(to).unwrap_or(0));
                    }
                    let step = if *started {
                        frame.decode_blocks(part, BlockDecodingStrategy::UptoBlocks(1))
                    } else {
                        *started = true;
                        frame.init(part).map(|()| false)
                    };
                    match step {
                        Ok(last) => {
                            *ended = last;
                            continue;
                        }
                        Err(error) => Err(io::Error::other(error)),
                    }
                }
            };
            match read {
                Ok(n) => return Ok(n),
                Err(_) => {
                    self.damaged = true;
                    if let Some(refused) = self.part().refused.take() {
                        return Err(refused);
                    }
                    if let Decoder::Zstd { frame, ended, .. } = &mut self.decoder {
                        *ended = true;
                        zstandard::end_early(frame);
                    }
                }
            }
        }
    }

    fn part(&mut self) -> &mut Part {
        match &mut self.decoder {
            Decoder::Zstd { part, .. } => part,
            Decoder::Lz4(decoder) => decoder.get_mut(),
        }
    }

    /// The file around the piece.
    pub fn outer(&self) -> &Input {
        match &self.decoder {
            Decoder::Zstd { part, .. } => &part.input,
            Decoder::Lz4(decoder) => &decoder.get_ref().input,
        }
    }

    /// Whether decoding stopped before the piece's end.
    pub fn is_damaged(&self) -> bool {
        self.damaged
    }

    /// Gives the file back, and how many bytes of the piece were not read.
    pub fn leave(self) -> (Input, u64) {
        let part = match self.decoder {
            Decoder::Zstd { part, .. } => part,
            Decoder::Lz4(decoder) => decoder.into_inner(),
        };
        (part.input, part.left)
    }
}
