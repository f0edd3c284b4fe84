//! A ladder as bytes: to flash, to a file, over a wire, and back on any machine.
//!
//! ```
//! use imu_core::allan::AllanLadder;
//! type Ladder = AllanLadder<f32, 3, 20>;
//!
//! let mut ladder = Ladder::new();
//! (0..100).for_each(|k| ladder.push(&[k as f32; 3]));
//! let mut flash = [0_u8; Ladder::BYTES];
//! ladder.write_to(&mut flash)?;
//! // … power is lost …
//! let mut ladder = Ladder::read_from(&flash)?;
//! ladder.restart(); // no difference spans the time that was lost
//! assert_eq!(ladder.octaves(0)[0].differences, 99);
//! # Ok::<(), imu_core::Error>(())
//! ```
//!
//! # Layout
//!
//! All numbers are little-endian; S is the size of the scalar, 4 or 8 bytes (IEEE 754); arrays go in
//! the order of their indices, axis last and fastest.
//!
//! | bytes | what |
//! |---|---|
//! | 4 | `IMUL` |
//! | 1 each | version of this layout (1), S, levels, windows, order, three zeros |
//! | 4 | axes |
//! | 1 | samples that wait while the ladder learns; 255: it has learnt |
//! | 7 | missing samples before each that waits |
//! | 8 each | position, missing samples, rejected samples |
//! | S · axes each | reference, bound |
//! | 8 · levels | differences |
//! | 8 · levels | excess of white noise: an `f64`, or two `f32`, small and large part |
//! | 8 · levels · axes | squares, likewise |
//! | S · levels · order · windows · axes | sums of the last blocks (or the samples that wait) |
//! | 4 · levels · order · windows | samples in those blocks |
//! | 4 | CRC-32 of all bytes before |
//!
//! The CRC is that of Ethernet and zip (IEEE 802.3: polynomial 0x04C11DB7, reflected 0xEDB88320, all
//! ones at the start and inverted at the end). It finds every error of one burst of up to 32 bits.

use super::ladder::Ladder;
use super::learn::{LEARN, LEARNT};
use super::total::Total;
use crate::{Error, Real};

const MAGIC: [u8; 4] = *b"IMUL";
const VERSION: u8 = 1;
const HEADER: usize = 16;
const CRC: usize = 4;
/// Bytes of a [`Total`] of either scalar.
const TOTAL: usize = 8;

impl<T: Real, const AXES: usize, const LEVELS: usize, const WINDOWS: usize, const ORDER: usize>
    Ladder<T, AXES, LEVELS, WINDOWS, ORDER>
{
    /// How many bytes [`write_to`](Self::write_to) writes, the same on every machine.
    pub const BYTES: usize = {
        let scalar = size_of::<T>();
        let blocks = LEVELS * ORDER * WINDOWS;
        let waiting = 1 + LEARN;
        let counters = 3 * 8;
        let totals = LEVELS * (8 + TOTAL + TOTAL * AXES);
        let history = blocks * (scalar * AXES + 4);
        HEADER + waiting + counters + 2 * scalar * AXES + totals + history + CRC
    };

    /// What the bytes of this type of ladder begin with.
    const PREFIX: [u8; HEADER] = {
        let ([m0, m1, m2, m3], [a0, a1, a2, a3]) = (MAGIC, (AXES as u32).to_le_bytes());
        let (scalar, levels) = (size_of::<T>() as u8, LEVELS as u8);
        let (windows, order) = (WINDOWS as u8, ORDER as u8);
        [m0, m1, m2, m3, VERSION, scalar, levels, windows, order, 0, 0, 0, a0, a1, a2, a3]
    };

    /// Writes the whole state to the beginning of `bytes`. Returns how many bytes it took:
    /// [`BYTES`](Self::BYTES).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a buffer that is shorter than that.
    pub fn write_to(&self, bytes: &mut [u8]) -> Result<usize, Error> {
        let too_short = Error::OutOfRange("length of the buffer");
        let (body, rest) = bytes.split_at_mut_checked(Self::BYTES - CRC).ok_or(too_short)?;
        let crc = rest.first_chunk_mut::<CRC>().ok_or(too_short)?;

        let mut out = Writer(body);
        out.put(&Self::PREFIX);
        out.put(&[self.held]);
        out.put(&self.gaps);
        for counter in [self.position, self.missing, self.rejected] {
            out.put(&counter.to_le_bytes());
        }
        self.reference.iter().chain(&self.bound).for_each(|&x| out.put_real(x));
        self.differences.iter().for_each(|n| out.put(&n.to_le_bytes()));
        for total in self.excess.iter().chain(self.squares.iter().flatten()) {
            out.put(&total.to_bytes());
        }
        self.history.iter().flatten().flatten().flatten().for_each(|&x| out.put_real(x));
        self.counts.iter().flatten().flatten().for_each(|n| out.put(&n.to_le_bytes()));
        *crc = crc32(body).to_le_bytes();
        Ok(Self::BYTES)
    }

    /// The ladder that [`write_to`](Self::write_to) wrote: it goes on as if nothing had happened.
    ///
    /// # Errors
    /// [`Error::Corrupt`] for anything else than the [`BYTES`](Self::BYTES) bytes of a ladder of
    /// this type, whole and unchanged.
    pub fn read_from(bytes: &[u8]) -> Result<Self, Error> {
        match bytes.first_chunk::<HEADER>() {
            None => return Err(Error::Corrupt("too short")),
            Some(header) if header.first_chunk() != Some(&MAGIC) => {
                return Err(Error::Corrupt("no ladder"));
            }
            Some(header) if *header != Self::PREFIX => {
                return Err(Error::Corrupt("a ladder of another type or version"));
            }
            Some(_) if bytes.len() != Self::BYTES => return Err(Error::Corrupt("wrong length")),
            Some(_) => {}
        }
        let (body, crc) = bytes.split_last_chunk::<CRC>().ok_or(Error::Corrupt("too short"))?;
        if u32::from_le_bytes(*crc) != crc32(body) {
            return Err(Error::Corrupt("checksum does not match"));
        }
        let ladder = Self::parse(Reader(body)).ok_or(Error::Corrupt("too short"))?;
        ladder.check()?;
        Ok(ladder)
    }

    /// Reads the fields; `None` if there are too few bytes.
    fn parse(mut bytes: Reader<'_>) -> Option<Self> {
        let mut ladder = Self::new();
        bytes.take::<HEADER>()?;
        [ladder.held] = bytes.take()?;
        ladder.gaps = bytes.take()?;
        for counter in [&mut ladder.position, &mut ladder.missing, &mut ladder.rejected] {
            *counter = u64::from_le_bytes(bytes.take()?);
        }
        for x in ladder.reference.iter_mut().chain(&mut ladder.bound) {
            *x = bytes.take_real()?;
        }
        for n in &mut ladder.differences {
            *n = u64::from_le_bytes(bytes.take()?);
        }
        for total in ladder.excess.iter_mut().chain(ladder.squares.iter_mut().flatten()) {
            *total = T::Total::from_bytes(bytes.take()?);
        }
        for x in ladder.history.iter_mut().flatten().flatten().flatten() {
            *x = bytes.take_real()?;
        }
        for n in ladder.counts.iter_mut().flatten().flatten() {
            *n = u32::from_le_bytes(bytes.take()?);
        }
        Some(ladder)
    }

    /// Whether a ladder can have come to this state: whatever bytes were forged, what is counted and
    /// summed from here on neither overflows nor becomes a NaN.
    fn check(&self) -> Result<(), Error> {
        let waits = usize::from(self.held) < Self::WAIT;
        if !waits && self.held != LEARNT {
            return Err(Error::Corrupt("more samples wait than can"));
        }
        if !self.reference.iter().all(|r| r.is_finite()) {
            return Err(Error::Corrupt("reference is not finite"));
        }
        if !self.bound.iter().all(|&b| b > T::ZERO && b <= T::LIMIT) {
            return Err(Error::Corrupt("bound is out of range"));
        }
        let mut totals = self.excess.iter().chain(self.squares.iter().flatten());
        if !totals.all(|total| total.value() >= 0.0) {
            return Err(Error::Corrupt("a total of squares is negative or not a number"));
        }
        for (level, (history, counts)) in self.history.iter().zip(&self.counts).enumerate() {
            let full = 1_u32 << (level & 31);
            if !counts.iter().flatten().all(|&n| n <= if waits { 0 } else { full }) {
                return Err(Error::Corrupt("a block holds more samples than it can"));
            }
            // Sums of 2ᴸ values within the limit: exact, for a power of two rounds nothing.
            let most = T::LIMIT * T::from_u32(full);
            if !history.iter().flatten().flatten().all(|x| x.abs() <= most) {
                return Err(Error::Corrupt("a block's sum is out of range"));
            }
        }
        Ok(())
    }
}

/// What is left of the room to write to.
struct Writer<'a>(&'a mut [u8]);

impl Writer<'_> {
    /// Writes `bytes`, of which there are as many as room was made for.
    fn put(&mut self, bytes: &[u8]) {
        if let Some((now, rest)) = core::mem::take(&mut self.0).split_at_mut_checked(bytes.len()) {
            now.copy_from_slice(bytes);
            self.0 = rest;
        }
    }

    fn put_real<T: Real>(&mut self, x: T) {
        let bits = x.bits().to_le_bytes();
        self.put(bits.get(..size_of::<T>()).unwrap_or_default());
    }
}

/// What is left to read.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (now, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*now)
    }

    fn take_real<T: Real>(&mut self) -> Option<T> {
        let (now, rest) = self.0.split_at_checked(size_of::<T>())?;
        self.0 = rest;
        Some(T::from_bits(now.iter().rev().fold(0, |bits, &byte| bits << 8 | u64::from(byte))))
    }
}

/// CRC-32 of IEEE 802.3, four bits at a time.
fn crc32(bytes: &[u8]) -> u32 {
    const POLYNOMIAL: u32 = 0xedb8_8320;
    /// What four bits shifted out bring in.
    const NIBBLES: [u32; 16] = {
        let mut table = [0; 16];
        let mut nibble = 0;
        while nibble < 16 {
            let mut crc = nibble as u32;
            let mut bit = 0;
            while bit < 4 {
                crc = if crc & 1 == 1 { crc >> 1 ^ POLYNOMIAL } else { crc >> 1 };
                bit += 1;
            }
            table[nibble] = crc;
            nibble += 1;
        }
        table
    };
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        let crc = crc ^ u32::from(byte);
        let crc = crc >> 4 ^ NIBBLES[crc as usize & 15];
        crc >> 4 ^ NIBBLES[crc as usize & 15]
    })
}

#[cfg(test)]
#[path = "bytes_tests.rs"]
mod tests;
