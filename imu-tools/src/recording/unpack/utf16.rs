//! UTF-16 with a byte order mark, as spreadsheets save "Unicode text", into UTF-8.

use super::{Stop, Unpack, cut_off};
use crate::recording::input::Input;

/// Text being turned into UTF-8, without its byte order mark.
pub struct Utf16 {
    input: Input,
    unit: fn([u8; 2]) -> u16,
    begun: bool,
    /// Of a character for which there was no room.
    left: Vec<u8>,
}

impl Utf16 {
    /// Starts at the byte order mark, whose order is that of `unit`.
    pub fn new(input: Input, unit: fn([u8; 2]) -> u16) -> Self {
        Self { input, unit, begun: false, left: Vec::new() }
    }

    /// The next character; `None` at the end.
    fn next(&mut self) -> Result<Option<char>, Stop> {
        if self.input.at_hand().len() < 4 {
            self.input.fill(4)?;
        }
        let at_hand = self.input.at_hand();
        let mut units = at_hand.as_chunks::<2>().0.iter().map(|unit| (self.unit)(*unit));
        let Some(first) = units.next() else {
            let cut = !at_hand.is_empty();
            return if cut { Err(Stop::Damage(cut_off(&self.input))) } else { Ok(None) };
        };
        let character = match char::decode_utf16([first, units.next().unwrap_or(0)]).next() {
            Some(Ok(character)) => character,
            _ => char::REPLACEMENT_CHARACTER,
        };
        self.input.consume(2 * character.len_utf16());
        Ok(Some(character))
    }
}

impl Unpack for Utf16 {
    fn read(&mut self, to: &mut [u8]) -> Result<usize, Stop> {
        if !self.begun {
            self.begun = true;
            self.input.consume(2);
        }
        if self.left.is_empty() {
            let mut written = 0;
            while let Some(place) = to.get_mut(written..written + 4) {
                // A pipe that dribbles must not hold back what is already there.
                if written > 0 && self.input.at_hand().len() < 4 {
                    break;
                }
                let Some(character) = self.next()? else { break };
                written += character.encode_utf8(place).len();
            }
            if written > 0 || to.len() >= 4 {
                return Ok(written);
            }
            if let Some(character) = self.next()? {
                self.left.extend(character.encode_utf8(&mut [0; 4]).bytes());
            }
        }
        let n = to.len().min(self.left.len());
        for (place, byte) in to.iter_mut().zip(self.left.drain(..n)) {
            *place = byte;
        }
        Ok(n)
    }

    fn input(&self) -> &Input {
        &self.input
    }
}
