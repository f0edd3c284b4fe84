//! CDR, the wire form of a ROS 2 message, as far as a header and a row of doubles go.
//!
//! Four bytes say how the rest is put: the representation (big-endian) and two of options. Then
//! come the fields; each is aligned to its size, counted from byte 4: to 8 bytes for a double, or
//! to 4 in the second version of the format (XCDR2). A text is a length (u32, with the closing NUL)
//! and its bytes. Source: OMG DDSI-RTPS 2.5, section 10, and DDS-XTypes 1.3, section 7.4.

/// Bytes in front of the fields.
pub const ENCAPSULATION: usize = 4;

/// Bytes of a header before the text of its frame: seconds i32, nanoseconds u32, length u32.
const HEADER: usize = 12;

/// Where in a message the length of that text stands.
pub const FRAME: usize = ENCAPSULATION + 8;

/// Why a message cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Its fields are put in a way that we do not know.
    Representation([u8; 2]),
    /// It has not the length that it should have.
    Malformed,
}

/// A message that is a header and then nothing but doubles.
#[derive(Clone, Copy, Debug)]
pub struct Stamped<'a> {
    /// Stamp of the header, nanoseconds.
    pub stamp_ns: i64,
    big_endian: bool,
    doubles: &'a [u8],
}

impl<'a> Stamped<'a> {
    /// Reads the header.
    #[inline]
    pub fn parse(bytes: &'a [u8]) -> Result<Self, Refusal> {
        Self::behind(0, bytes)
    }

    /// Reads the header and passes over this many texts behind it.
    #[inline]
    pub fn behind(texts: usize, bytes: &'a [u8]) -> Result<Self, Refusal> {
        let (start, fields) =
            bytes.split_first_chunk::<ENCAPSULATION>().ok_or(Refusal::Malformed)?;
        let [first, second, ..] = *start;
        let (big_endian, alignment) = match [first, second] {
            [0, 0] => (true, 8),
            [0, 1] => (false, 8),
            [0, 6] => (true, 4),
            [0, 7] => (false, 4),
            other => return Err(Refusal::Representation(other)),
        };
        let header = fields.first_chunk::<HEADER>().ok_or(Refusal::Malformed)?;
        let number = |bytes: [u8; 4]| {
            if big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
        };
        let word = |at: usize| {
            number(header.get(at..at + 4).and_then(|b| b.try_into().ok()).unwrap_or_default())
        };
        let (sec, nanosec, frame) = (word(0).cast_signed(), word(4), word(8));
        let mut end = HEADER + frame as usize;
        for _ in 0..texts {
            let length = fields.get(end.next_multiple_of(4)..).and_then(|rest| rest.first_chunk());
            let length = number(*length.ok_or(Refusal::Malformed)?);
            end = end.next_multiple_of(4) + 4 + length as usize;
        }
        let doubles = fields.get(end.next_multiple_of(alignment)..).ok_or(Refusal::Malformed)?;
        Ok(Self { stamp_ns: nanoseconds(sec, nanosec), big_endian, doubles })
    }

    /// The doubles, if they are `N / 8` and little-endian, and nothing is behind them.
    pub fn exactly<const N: usize>(&self) -> Option<&'a [u8; N]> {
        self.doubles.try_into().ok().filter(|_| !self.big_endian)
    }

    /// The doubles, of which there must be `N / 8`; what pads the message behind them is ignored.
    #[inline]
    pub fn doubles<const N: usize>(&self) -> Result<Doubles<'a, N>, Refusal> {
        self.first(N)
    }

    /// The first `N / 8` of the doubles, which must be `len` bytes in all; what pads the message behind
    /// them is ignored.
    #[inline]
    pub fn first<const N: usize>(&self, len: usize) -> Result<Doubles<'a, N>, Refusal> {
        match (self.doubles.first_chunk::<N>(), self.doubles.len().checked_sub(len)) {
            (Some(bytes), Some(0..8)) => Ok(Doubles { bytes, big_endian: self.big_endian }),
            _ => Err(Refusal::Malformed),
        }
    }
}

/// The stamp of a header.
#[inline]
pub fn nanoseconds(sec: i32, nanosec: u32) -> i64 {
    i64::from(sec) * 1_000_000_000 + i64::from(nanosec)
}

/// A row of doubles, `N` bytes.
#[derive(Clone, Copy, Debug)]
pub struct Doubles<'a, const N: usize> {
    bytes: &'a [u8; N],
    big_endian: bool,
}

impl<const N: usize> Doubles<'_, N> {
    /// The double at byte `at`; the compiler sees that it is there.
    #[inline]
    pub fn get(&self, at: usize) -> f64 {
        let bytes = self.bytes.get(at..at + 8).and_then(|b| b.try_into().ok()).unwrap_or_default();
        if self.big_endian { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A message with this frame and two doubles.
    fn message(representation: [u8; 2], frame: &str) -> Vec<u8> {
        let big = representation[1] & 1 == 0;
        let alignment = if representation[1] < 6 { 8 } else { 4 };
        let word = |v: u32| if big { v.to_be_bytes() } else { v.to_le_bytes() };
        let mut fields = [word(5), word(6), word(frame.len() as u32 + 1)].concat();
        fields.extend([frame.as_bytes(), &[0]].concat());
        fields.resize(fields.len().next_multiple_of(alignment), 0xee);
        for v in [1.5, -2.0f64] {
            fields.extend(if big { v.to_be_bytes() } else { v.to_le_bytes() });
        }
        [&representation[..], &[0, 0], &fields].concat()
    }

    #[test]
    fn both_byte_orders_and_alignments() {
        for representation in [[0, 0], [0, 1], [0, 6], [0, 7]] {
            for frame in ["", "a", "imu", "imu_link", "base_link"] {
                let bytes = message(representation, frame);
                let stamped = Stamped::parse(&bytes).unwrap();
                assert_eq!(stamped.stamp_ns, 5_000_000_006);
                let doubles = stamped.doubles::<16>().unwrap();
                assert_eq!((doubles.get(0), doubles.get(8)), (1.5, -2.0), "{frame}");
                for cut in 0..bytes.len() {
                    let doubles = Stamped::parse(&bytes[..cut]).and_then(|s| s.doubles::<16>());
                    assert_eq!(doubles.err(), Some(Refusal::Malformed), "{frame} {cut}");
                }
            }
        }
    }

    #[test]
    fn other_representations_are_refused() {
        for representation in [[0, 2], [0, 3], [0, 8], [0, 9], [0, 10], [0, 11], [1, 0]] {
            let mut bytes = message([0, 1], "imu");
            bytes[..2].copy_from_slice(&representation);
            let refusal = Stamped::parse(&bytes).unwrap_err();
            assert_eq!(refusal, Refusal::Representation(representation));
        }
    }

    #[test]
    fn a_claim_of_gigabytes_is_malformed() {
        let mut bytes = message([0, 1], "imu");
        bytes[12..16].fill(0xff);
        assert_eq!(Stamped::parse(&bytes).unwrap_err(), Refusal::Malformed);
    }
}
