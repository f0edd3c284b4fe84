//! The image's report: lines of text that the runner parses.

use crate::{semihosting, stack, systick};
use firmware_cases::Report;

/// Characters of one line; what does not fit is lost, and the runner says so.
const LENGTH: usize = 120;

/// Gathers a line and sends it.
pub struct Printer {
    line: [u8; LENGTH],
    used: usize,
    words: usize,
}

impl Printer {
    /// An empty line.
    pub const fn new() -> Self {
        Self { line: [0; LENGTH], used: 0, words: 0 }
    }

    fn byte(&mut self, byte: u8) {
        // One byte stays zero for the end of the text, one for the line break.
        if let Some(place) = self.line.get_mut(self.used)
            && self.used < LENGTH - 2
        {
            *place = byte;
            self.used += 1;
        }
    }

    /// Adds text to the line.
    pub fn text(&mut self, text: &str) {
        for byte in text.bytes() {
            self.byte(byte);
        }
    }

    /// Adds the last `digits` hexadecimal digits of a number.
    pub fn hex(&mut self, number: u64, digits: u32) {
        for digit in (0..digits).rev() {
            let nibble = number.wrapping_shr(4 * digit) as u8 & 15;
            self.byte(if nibble < 10 { b'0' + nibble } else { b'a' - 10 + nibble });
        }
    }

    /// Sends the line.
    pub fn line(&mut self) {
        if let Some(end) = self.line.get_mut(self.used) {
            *end = b'\n';
        }
        semihosting::write(&self.line);
        self.line = [0; LENGTH];
        self.used = 0;
    }

    /// Begins a case.
    pub fn case(&mut self, name: &str) {
        self.words = 0;
        self.text("case ");
        self.text(name);
        self.line();
    }

    /// Ends a case: sends the words that wait for a full line.
    pub fn end(&mut self) {
        if self.words > 0 {
            self.words = 0;
            self.line();
        }
    }

    fn figure(&mut self, kind: &str, value: Option<u32>, calls: u32, what: &str) {
        self.end();
        self.text(kind);
        match value {
            Some(value) => self.hex(u64::from(value), 8),
            None => self.text("overflow"),
        }
        self.text(" ");
        self.hex(u64::from(calls), 8);
        self.text(" ");
        self.text(what);
        self.line();
    }
}

impl Default for Printer {
    fn default() -> Self {
        Self::new()
    }
}

impl Report for Printer {
    fn word(&mut self, bits: u64) {
        self.text(if self.words == 0 { "words " } else { " " });
        self.hex(bits, 16);
        self.words += 1;
        if self.words == 6 {
            self.end();
        }
    }

    fn instructions(&mut self, what: &'static str, calls: u32, work: &mut dyn FnMut()) {
        let ticks = systick::ticks(work);
        self.figure("ticks ", ticks, calls, what);
    }

    fn stack(&mut self, what: &'static str, work: &mut dyn FnMut()) {
        let bytes = stack::bytes(work);
        self.figure("stack ", bytes.map(|bytes| bytes as u32), 1, what);
    }

    fn state(&mut self, what: &'static str, bytes: usize) {
        self.figure("state ", Some(bytes as u32), 1, what);
    }
}
