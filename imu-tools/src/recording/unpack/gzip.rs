//! Gzip: members one after the other, each with a checksum (RFC 1952).

use flate2::{Decompress, FlushDecompress, Status};

use super::{Stop, Unpack, cut_off, damaged_near};
use crate::recording::input::Input;

/// Logarithm of the largest window that deflate has.
const WINDOW: u8 = 15;

/// A gzip file being unpacked.
pub struct Gzip {
    input: Input,
    inflate: Decompress,
    /// We are in a member, not between two.
    inside: bool,
    broken: Option<&'static str>,
}

impl Gzip {
    /// Starts at a member.
    pub fn new(input: Input) -> Self {
        Self { input, inflate: Decompress::new_gzip(WINDOW), inside: true, broken: None }
    }

    /// Goes to the next member; `false` at the end.
    fn next_member(&mut self) -> Result<bool, Stop> {
        self.input.fill(2)?;
        if self.input.at_hand().starts_with(&[0x1f, 0x8b]) {
            self.inflate = Decompress::new_gzip(WINDOW);
            self.inside = true;
            return Ok(true);
        }
        // Padding is no damage.
        while self.input.fill(1)? {
            let zeros = self.input.at_hand().iter().take_while(|&&byte| byte == 0).count();
            self.input.consume(zeros);
            if !self.input.at_hand().is_empty() {
                let (path, at) = (self.input.path().display().to_string(), self.input.offset());
                let mut left = 0_u64;
                while self.input.fill(1)? {
                    left += self.input.at_hand().len() as u64;
                    self.input.consume(usize::MAX);
                }
                return Err(Stop::Damage(format!(
                    "{path} is damaged: the last {left} bytes, from byte {at}, are not compressed \
                     data and are left out"
                )));
            }
        }
        Ok(false)
    }

    fn stop(&self, why: &str) -> Stop {
        Stop::Damage(damaged_near(&self.input, self.input.offset(), &why))
    }
}

impl Unpack for Gzip {
    fn read(&mut self, to: &mut [u8]) -> Result<usize, Stop> {
        if let Some(why) = self.broken {
            return Err(self.stop(why));
        }
        loop {
            if !self.inside && !self.next_member()? {
                return Ok(0);
            }
            let more = self.input.fill(1)?;
            let (read, written) = (self.inflate.total_in(), self.inflate.total_out());
            let status = self.inflate.decompress(self.input.at_hand(), to, FlushDecompress::None);
            let read = self.inflate.total_in() - read;
            let written = (self.inflate.total_out() - written) as usize;
            self.input.consume(read as usize);
            match status {
                Ok(Status::StreamEnd) => self.inside = false,
                Ok(_) if read > 0 || written > 0 => {}
                Ok(_) if !more => return Err(Stop::Damage(cut_off(&self.input))),
                Ok(_) => self.broken = Some("it does not go on"),
                Err(error) => {
                    self.broken = Some(match error.message() {
                        Some(what) if what.contains("check") => "its checksum is wrong",
                        _ => "it is no deflate stream",
                    });
                }
            }
            if written > 0 {
                return Ok(written);
            }
            if let Some(why) = self.broken {
                return Err(self.stop(why));
            }
        }
    }

    fn input(&self) -> &Input {
        &self.input
    }
}
