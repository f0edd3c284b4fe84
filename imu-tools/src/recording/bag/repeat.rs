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
    bytes: [u8; LONGEST],
    /// Where the time stands.
    time: usize,
}

impl Repeat {
    /// The shape of `record`, whose header is `header` bytes long; `None` for an uncommon one.
    pub fn of(record: &[u8], header: usize, role: Role) -> Option<Self> {
        let payload = 8 + header;
        let mut bytes = [0; LONGEST];
        bytes.get_mut(..payload)?.copy_from_slice(record.get(..payload)?);
        let mut fields = record.get(4..4 + header)?;
        while let Some((field, rest)) = prefixed(fields) {
            fields = rest;
            if field.len() == 13 && field.starts_with(b"time=") {
                let time = 4 + header - rest.len() - 8;
                return Some(Self { len: record.len(), payload, role, bytes, time });
            }
        }
        None
    }

    /// The time (seconds, nanoseconds) and payload of the next record, if it has this shape and
    /// `bytes` hold all of it.
    #[inline]
    pub fn next<'a>(&self, bytes: &'a [u8]) -> Option<((u32, u32), &'a [u8])> {
        let (head, payload) = bytes.get(..self.len)?.split_at_checked(self.payload)?;
        let shape = self.bytes.get(..self.payload)?;
        let (before, rest) = head.split_at_checked(self.time)?;
        let (same_before, same_rest) = shape.split_at_checked(self.time)?;
        let (time, after) = rest.split_first_chunk::<8>()?;
        let (_, same_after) = same_rest.split_first_chunk::<8>()?;
        let time = u64::from_le_bytes(*time);
        (before == same_before && after == same_after)
            .then_some(((time as u32, (time >> 32) as u32), payload))
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
            let shape = Repeat::of(&record(0, 1, b"abc"), 38, role()).unwrap();
            let next = record(0, 5 << 32 | 4, b"def");
            assert_eq!(shape.next(&next), Some(((4, 5), &b"def"[..])));
            assert_eq!(shape.next(&next[..next.len() - 1]), None);
            assert_eq!(shape.next(&record(1, 1, b"abc")), None);
            assert_eq!(shape.next(&record(0, 1, b"ab1")[..]).unwrap().1, b"ab1");
            assert_eq!(shape.next(&record(0, 1, b"abcd")), None);
        }
    }
}
