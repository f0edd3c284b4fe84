//! Zstandard: frames one after the other (RFC 8878), windows of up to 128 MiB.

use std::io::{self, Read};

use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};

use super::{Stop, Unpack, cut_off, damaged_near};
use crate::error::Error;
use crate::recording::input::Input;
use crate::recording::zstandard;

/// Blocks are decoded until there is so much to hand on.
const AT_ONCE: usize = 128 * 1024;

/// A Zstandard file being unpacked.
pub struct Zstd {
    input: Input,
    decoder: FrameDecoder,
    inside: bool,
    broken: Option<String>,
}

/// An [`Input`] as a decoder reads it.
struct Feed<'a> {
    input: &'a mut Input,
    refused: Option<Error>,
    ended: bool,
}

impl Read for Feed<'_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        match self.input.fill(1) {
            Ok(more) => {
                self.ended |= !more;
                let n = self.input.at_hand().read(to)?;
                self.input.consume(n);
                Ok(n)
            }
            Err(error) => {
                self.refused = Some(error);
                Err(io::ErrorKind::Other.into())
            }
        }
    }
}

impl Zstd {
    /// Starts at a frame.
    pub fn new(input: Input) -> Self {
        Self { input, decoder: FrameDecoder::new(), inside: false, broken: None }
    }

    /// Goes to the next frame; `false` at the end.
    fn next_frame(&mut self) -> Result<bool, Stop> {
        while self.input.fill(1)? {
            let at = self.input.offset();
            let mut feed = Feed { input: &mut self.input, refused: None, ended: false };
            let started = self.decoder.reset(&mut feed);
            let (refused, ended) = (feed.refused, feed.ended);
            if let Some(error) = refused {
                return Err(error.into());
            }
            match started {
                Ok(()) => {
                    self.inside = true;
                    return Ok(true);
                }
                Err(FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame {
                    length,
                    ..
                })) => {
                    if !self.input.skip(u64::from(length))? {
                        return Err(Stop::Damage(cut_off(&self.input)));
                    }
                }
                Err(_) if ended => return Err(Stop::Damage(cut_off(&self.input))),
                Err(error) => return Err(Stop::Damage(damaged_near(&self.input, at, &error))),
            }
        }
        Ok(false)
    }

    /// Decodes some blocks.
    fn blocks(&mut self) -> Result<(), Stop> {
        let at = self.input.offset();
        let mut feed = Feed { input: &mut self.input, refused: None, ended: false };
        let decoded =
            self.decoder.decode_blocks(&mut feed, BlockDecodingStrategy::UptoBytes(AT_ONCE));
        let (refused, ended) = (feed.refused, feed.ended);
        if let Some(error) = refused {
            return Err(error.into());
        }
        if let Err(error) = decoded {
            let what =
                if ended { cut_off(&self.input) } else { damaged_near(&self.input, at, &error) };
            zstandard::end_early(&mut self.decoder);
            self.broken = Some(what);
        }
        Ok(())
    }
}

impl Unpack for Zstd {
    fn read(&mut self, to: &mut [u8]) -> Result<usize, Stop> {
        loop {
            if !self.inside && !self.next_frame()? {
                return Ok(0);
            }
            if self.decoder.can_collect() == 0
                && !self.decoder.is_finished()
                && self.broken.is_none()
            {
                self.blocks()?;
            }
            let n = self.decoder.read(to).unwrap_or(0);
            if n > 0 || to.is_empty() {
                return Ok(n);
            }
            if let Some(what) = &self.broken {
                return Err(Stop::Damage(what.clone()));
            }
            if self.decoder.is_finished() {
                self.inside = false;
                let told = self.decoder.get_checksum_from_data();
                if told.is_some() && told != self.decoder.get_calculated_checksum() {
                    return Err(Stop::Damage(format!(
                        "{} is damaged before byte {} of its compressed data (the checksum is \
                         wrong): what follows is lost",
                        self.input.path().display(),
                        self.input.offset()
                    )));
                }
            }
        }
    }

    fn input(&self) -> &Input {
        &self.input
    }
}
