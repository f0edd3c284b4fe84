//! The shape that a topic's messages repeat: found once, then only compared.
//!
//! All records of one connection differ in their time and payload alone, as long as the frame keeps
//! its length. Comparing two stretches of bytes is several times faster than reading the fields of
//! each header anew.

use super::record::prefixed;
use crate::recording::topics::Role;

/// Headers are 38 bytes long, and a little more where a recorder adds fields.
const LONGEST: usize = 96;

/// Length and fixed bytes of a message record.
#[derive(Clone, Copy, Debug)]
pub struct Repeat {
    /// Length of the whole record.
    pub len: usize,
    /// Where its payload starts.
    payload: usize,
    /// What is wanted of it.
    pub role: Role,
    /// The bits that are fixed, and which ones are.
    words: [Word; LONGEST / 8],
    /// Where the time stands.
    time: usize,
}

#[derive(Clone, Copy, Debug, Default)]
struct Word {
    bits: u64,
    fixed: u64,
}

impl Repeat {
    /// The shape of `record`, whose header is `header` bytes long; `None` for an uncommon one.
    pub fn of(record: &[u8], header: usize, role: Role) -> Option<Self> {
        let payload = 8 + header;
        let bytes = record.first_chunk::<LONGEST>().filter(|_| payload <= LONGEST)?;
        let time = Self::time(record.get(4..4 + header)?)? + 4;
        let mut words = [Word::default(); LONGEST / 8];
        for (word, (at, bytes)) in words.iter_mut().zip((0..).step_by(8).zip(bytes.as_chunks().0)) {
            let is_fixed = |at: usize| at < payload && !(time..time + 8).contains(&at);
            let fixed = [0, 1, 2, 3, 4, 5, 6, 7].map(|k| if is_fixed(at + k) { 0xff } else { 0 });
            let fixed = u64::from_ne_bytes(fixed);
            *word = Word { bits: u64::from_ne_bytes(*bytes) & fixed, fixed };
        }
        Some(Self { len: record.len(), payload, role, words, time })
    }

    /// Where the time stands among the fields of a header.
    fn time(fields: &[u8]) -> Option<usize> {
        let mut rest = fields;
        while let Some((field, after)) = prefixed(rest) {
            rest = after;
            if field.len() == 13 && field.starts_with(b"time=") {
                return Some(fields.len() - rest.len() - 8);
            }
        }
        None
    }

    /// The time (seconds, nanoseconds) and payload of the next record, if it has this shape and
    /// `bytes` hold all of it.
    #[inline]
    pub fn next<'a>(&self, bytes: &'a [u8]) -> Option<((u32, u32), &'a [u8])> {
        let record = bytes.get(..self.len)?;
        let head = record.first_chunk::<LONGEST>()?.as_chunks().0;
        let other = self.words.iter().zip(head).fold(0, |other, (word, bytes)| {
            other | ((u64::from_ne_bytes(*bytes) ^ word.bits) & word.fixed)
        });
        let time = u64::from_le_bytes(*record.get(self.time..)?.first_chunk()?);
        let payload = record.get(self.payload..)?;
        (other == 0).then_some(((time as u32, (time >> 32) as u32), payload))
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::{push_header, push_prefixed};
    use super::*;
    use crate::recording::ReadOptions;
    use crate::recording::topics::{Connection, Holds, Topics};

    fn role() -> Role {
        let mut topics = Topics::new(&ReadOptions::default());
        let (topic, type_name) = ("/imu".into(), "sensor_msgs/Imu".into());
        topics.add(Connection { number: 0, topic, type_name, holds: Holds::Imu });
        topics.choose("a.bag".as_ref()).unwrap();
        topics.role(0).unwrap()
    }

    #[test]
    fn only_time_and_payload_may_differ() {
        for time_first in [false, true] {
            let record = |conn: u32, time: u64, payload: &[u8]| {
                let (conn, time) = (conn.to_le_bytes(), time.to_le_bytes());
                let mut fields: Vec<(&str, &[u8])> =
                    vec![("conn", &conn), ("op", &[2]), ("time", &time)];
                if time_first {
                    fields.rotate_right(1);
                }
                let mut bytes = Vec::new();
                push_header(&mut bytes, &fields);
                push_prefixed(&mut bytes, payload);
                bytes
            };
            let shape = Repeat::of(&record(0, 1, &[7; 60]), 38, role()).unwrap();
            let next = record(0, 5 << 32 | 4, &[8; 60]);
            assert_eq!(shape.next(&next), Some(((4, 5), &[8; 60][..])));
            assert_eq!(shape.next(&next[..next.len() - 1]), None);
            assert_eq!(shape.next(&record(1, 1, &[7; 60])), None);
            assert_eq!(shape.next(&record(0, 1, &[7; 61])), None);
            // All bytes of the header but those of the time are looked at.
            let time = 4 + if time_first { 9 } else { 30 };
            for at in 0..46 {
                let mut other = next.clone();
                other[at] ^= 0x10;
                assert_eq!(shape.next(&other).is_some(), (time..time + 8).contains(&at), "{at}");
            }
            assert!(Repeat::of(&record(0, 1, b"abc"), 38, role()).is_none());
        }
    }
}
