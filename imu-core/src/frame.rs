//! The frame in which firmware sends what an IMU says: bit for bit, numbered, stamped, checked.
//!
//! 41 or 45 bytes, little-endian:
//!
//! | byte | field |
//! | --- | --- |
//! | 0, 1 | 0xA9, 0x56: a frame begins |
//! | 2 | what follows: bits 7 to 4 the version, 1; bit 3 increments; bit 2 temperature; bit 1 accelerometer; bit 0 gyroscope |
//! | 3, 4 | `u16`: the number of the frame, 0 after 65 535 |
//! | 5 to 12 | `u64`: the sensor's time, ns |
//! | 13 to 24 | three `f32`: gyroscope x, y, z, rad/s, or rad if these are increments; zeros without bit 0 |
//! | 25 to 36 | three `f32`: accelerometer x, y, z, m/s², or m/s if these are increments; zeros without bit 1 |
//! | 37 to 40 | with bit 2 only, `f32`: temperature, degrees Celsius |
//! | last 4 | `u32`: CRC-32 of bytes 2 to the last before it |
//!
//! The CRC is that of Ethernet and zip (ISO 3309: polynomial 0x04C11DB7 reflected, started from and
//! finished with all ones). Increments are over the time since the frame before. At 8 kHz these are
//! 328 000 bytes a second: USB, or a serial line at 4 Mbit/s.
//!
//! ```
//! use imu_core::frame::{Check, Frame, LONGEST, View, check};
//!
//! let frame = Frame {
//!     number: 7,
//!     time_ns: 875_000,
//!     gyroscope: Some([0.1, 0.0, -0.1]),
//!     accelerometer: Some([0.0, 0.0, 9.81]),
//!     ..Frame::default()
//! };
//! let mut bytes = [0; LONGEST];
//! let sent = frame.encode(&mut bytes);
//! assert_eq!(check(sent), Check::Whole(41));
//! assert_eq!(View::of(sent).map(|view| view.frame()), Some(frame));
//! ```

/// Bytes of the longest frame, one with a temperature.
pub const LONGEST: usize = 45;

/// Bytes of a frame without one.
pub const SHORTEST: usize = 41;

/// The bytes with which a frame begins.
pub const SYNC: [u8; 2] = [0xA9, 0x56];

const VERSION: u8 = 1 << 4;
const GYROSCOPE: u8 = 1;
const ACCELEROMETER: u8 = 1 << 1;
const TEMPERATURE: u8 = 1 << 2;
const INCREMENTS: u8 = 1 << 3;

/// What a frame says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// Its number, one more than that of the frame before, 0 after 65 535.
    pub number: u16,
    /// The sensor's time, nanoseconds since any start.
    pub time_ns: u64,
    /// Angular rate, rad/s, or its increment, rad.
    pub gyroscope: Option<[f32; 3]>,
    /// Specific force, m/s², or its increment, m/s.
    pub accelerometer: Option<[f32; 3]>,
    /// Degrees Celsius.
    pub celsius: Option<f32>,
    /// The two are increments since the frame before.
    pub increments: bool,
}

impl Frame {
    /// Writes the frame into `bytes`, and gives what of it is to be sent.
    pub fn encode<'a>(&self, bytes: &'a mut [u8; LONGEST]) -> &'a [u8] {
        let flag = |set: bool, flag: u8| if set { flag } else { 0 };
        let kind = VERSION
            | flag(self.gyroscope.is_some(), GYROSCOPE)
            | flag(self.accelerometer.is_some(), ACCELEROMETER)
            | flag(self.celsius.is_some(), TEMPERATURE)
            | flag(self.increments, INCREMENTS);
        let [first, second] = SYNC;
        let mut writer = Writer { rest: &mut bytes[..], crc: !0 };
        writer.put_plain(&[first, second]);
        writer.put(&[kind]);
        writer.put(&self.number.to_le_bytes());
        writer.put(&self.time_ns.to_le_bytes());
        for [x, y, z] in [self.gyroscope, self.accelerometer].map(Option::unwrap_or_default) {
            writer.put(&x.to_le_bytes());
            writer.put(&y.to_le_bytes());
            writer.put(&z.to_le_bytes());
        }
        if let Some(celsius) = self.celsius {
            writer.put(&celsius.to_le_bytes());
        }
        let crc = !writer.crc;
        writer.put_plain(&crc.to_le_bytes());
        let unused = writer.rest.len();
        bytes.get(..LONGEST.saturating_sub(unused)).unwrap_or_default()
    }
}

/// Fills bytes from the front, and keeps their CRC.
struct Writer<'a> {
    rest: &'a mut [u8],
    crc: u32,
}

impl Writer<'_> {
    fn put<const N: usize>(&mut self, bytes: &[u8; N]) {
        self.crc = bytes.iter().fold(self.crc, |crc, byte| crc_step(crc, *byte));
        self.put_plain(bytes);
    }

    fn put_plain<const N: usize>(&mut self, bytes: &[u8; N]) {
        let rest = core::mem::take(&mut self.rest);
        if let Some((place, rest)) = rest.split_first_chunk_mut() {
            *place = *bytes;
            self.rest = rest;
        }
    }
}

/// What is at the start of some bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// Perhaps a frame: more bytes are needed to tell.
    Short,
    /// A frame of so many bytes.
    Whole(usize),
    /// No frame begins with the first byte.
    Not,
    /// A frame with a wrong CRC, or what looks like the start of one. Look for the next from the second
    /// byte on.
    Damaged,
}

/// Looks at the start of `bytes`, of which there may be more than a frame's.
#[must_use]
pub fn check(bytes: &[u8]) -> Check {
    let kind = match bytes {
        [] | [0xA9] | [0xA9, 0x56] => return Check::Short,
        [0xA9, 0x56, kind, ..] if kind & 0xF0 == VERSION => *kind,
        _ => return Check::Not,
    };
    let length = if kind & TEMPERATURE == 0 { SHORTEST } else { LONGEST };
    let Some(frame) = bytes.get(..length) else { return Check::Short };
    let Some((said, sum)) = frame.split_last_chunk() else { return Check::Short };
    let crc = said.iter().skip(SYNC.len()).fold(!0, |crc, byte| crc_step(crc, *byte));
    if !crc == u32::from_le_bytes(*sum) { Check::Whole(length) } else { Check::Damaged }
}

/// A checked frame, read in place.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    kind: u8,
    fields: &'a [u8; SHORTEST - 7],
    celsius: Option<&'a [u8; 4]>,
}

impl<'a> View<'a> {
    /// Of the frame at the start of `bytes`; `None` where [`check`] finds none.
    #[must_use]
    pub fn of(bytes: &'a [u8]) -> Option<Self> {
        let Check::Whole(_) = check(bytes) else { return None };
        let ([_, _, kind], rest) = bytes.split_first_chunk()?;
        let (fields, rest) = rest.split_first_chunk()?;
        let celsius = if kind & TEMPERATURE == 0 { None } else { rest.first_chunk() };
        Some(Self { kind: *kind, fields, celsius })
    }

    /// The frame's number.
    #[must_use]
    pub fn number(&self) -> u16 {
        let [low, high, ..] = *self.fields;
        u16::from_le_bytes([low, high])
    }

    /// The sensor's time, ns.
    #[must_use]
    pub fn time_ns(&self) -> u64 {
        let [_, _, a, b, c, d, e, f, g, h, ..] = *self.fields;
        u64::from_le_bytes([a, b, c, d, e, f, g, h])
    }

    /// Angular rate, rad/s, or its increment, rad.
    #[must_use]
    pub fn gyroscope(&self) -> Option<[f32; 3]> {
        (self.kind & GYROSCOPE != 0).then(|| self.vector::<10>())
    }

    /// Specific force, m/s², or its increment, m/s.
    #[must_use]
    pub fn accelerometer(&self) -> Option<[f32; 3]> {
        (self.kind & ACCELEROMETER != 0).then(|| self.vector::<22>())
    }

    /// Degrees Celsius.
    #[must_use]
    pub fn celsius(&self) -> Option<f32> {
        self.celsius.map(|bytes| f32::from_le_bytes(*bytes))
    }

    /// Whether the two are increments.
    #[must_use]
    pub fn increments(&self) -> bool {
        self.kind & INCREMENTS != 0
    }

    /// All of it.
    #[must_use]
    pub fn frame(&self) -> Frame {
        Frame {
            number: self.number(),
            time_ns: self.time_ns(),
            gyroscope: self.gyroscope(),
            accelerometer: self.accelerometer(),
            celsius: self.celsius(),
            increments: self.increments(),
        }
    }

    /// Three singles from a place on.
    fn vector<const AT: usize>(&self) -> [f32; 3] {
        let single = |axis: usize| {
            let four = self.fields.get(AT + 4 * axis..).and_then(|rest| rest.first_chunk());
            f32::from_le_bytes(four.copied().unwrap_or_default())
        };
        [single(0), single(1), single(2)]
    }
}

/// One byte more in a CRC-32, four bits at a time: a table of 64 bytes, not of 1024.
fn crc_step(crc: u32, byte: u8) -> u32 {
    const TABLE: [u32; 16] = {
        let mut table = [0; 16];
        let mut at = 0;
        while at < 16 {
            let mut entry = at as u32;
            let mut bit = 0;
            while bit < 4 {
                entry = if entry & 1 == 0 { entry >> 1 } else { (entry >> 1) ^ 0xEDB8_8320 };
                bit += 1;
            }
            table[at] = entry;
            at += 1;
        }
        table
    };
    let half = |crc: u32| (crc >> 4) ^ TABLE[(crc & 15) as usize];
    half(half(crc ^ u32::from(byte)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn full() -> Frame {
        Frame {
            number: 0xBEEF,
            time_ns: 0x0123_4567_89AB_CDEF,
            gyroscope: Some([1.5, -0.0, f32::MIN_POSITIVE]),
            accelerometer: Some([9.81, -2.0e-7, 3.0]),
            celsius: Some(-12.5),
            increments: true,
        }
    }

    #[test]
    fn the_crc_is_that_of_the_catalogue() {
        let crc = !b"123456789".iter().fold(!0, |crc, byte| crc_step(crc, *byte));
        assert_eq!(crc, 0xCBF4_3926);
    }

    #[test]
    fn the_bytes_are_those_of_the_table() {
        let mut bytes = [0; LONGEST];
        let sent = full().encode(&mut bytes);
        assert_eq!(sent.len(), LONGEST);
        assert_eq!(sent[..5], [0xA9, 0x56, 0x1F, 0xEF, 0xBE]);
        assert_eq!(sent[5..13], 0x0123_4567_89AB_CDEF_u64.to_le_bytes());
        assert_eq!(sent[13..17], 1.5_f32.to_le_bytes());
        assert_eq!(sent[25..29], 9.81_f32.to_le_bytes());
        assert_eq!(sent[37..41], (-12.5_f32).to_le_bytes());
    }

    #[test]
    fn every_kind_comes_back() {
        for kind in 0..16 {
            let has = |bit: u8| kind & bit != 0;
            let mut frame = full();
            frame.gyroscope = frame.gyroscope.filter(|_| has(GYROSCOPE));
            frame.accelerometer = frame.accelerometer.filter(|_| has(ACCELEROMETER));
            frame.celsius = frame.celsius.filter(|_| has(TEMPERATURE));
            frame.increments = has(INCREMENTS);
            let mut bytes = [0; LONGEST];
            let sent = frame.encode(&mut bytes);
            assert_eq!(check(sent), Check::Whole(if has(TEMPERATURE) { 45 } else { 41 }));
            assert_eq!(View::of(sent).unwrap().frame(), frame);
            for cut in 0..sent.len() {
                assert_eq!(check(&sent[..cut]), Check::Short, "{cut} bytes");
            }
        }
    }

    /// A CRC finds every change of up to 32 bits in a row.
    #[test]
    fn every_changed_byte_is_found() {
        let mut bytes = [0; LONGEST];
        full().encode(&mut bytes);
        for at in 0..LONGEST {
            for change in 1..=255 {
                bytes[at] ^= change;
                assert!(!matches!(check(&bytes), Check::Whole(_)), "byte {at} changed by {change}");
                bytes[at] ^= change;
            }
        }
    }
}
