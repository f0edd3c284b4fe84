//! The [`Shape`] of a topic's messages, and where their time and readings stand in it.

use super::imu_message::ImuMessage;
use super::record::prefixed;
use super::stamped::FRAME;
use crate::recording::imu_body;
use crate::recording::shape::Shape;
use crate::recording::topics::Role;

/// Length and fixed bytes of an IMU's message record.
#[derive(Clone, Copy, Debug)]
pub struct Repeat {
    /// What is wanted of it.
    pub role: Role,
    shape: Shape,
    /// Where its time and its payload stand.
    time: usize,
    payload: usize,
}

impl Repeat {
    /// The shape of `record`, whose header is `header` bytes long; `None` for an uncommon one.
    pub fn of(record: &[u8], header: usize, role: Role) -> Option<Self> {
        let payload = 8 + header;
        ImuMessage::parse(record.get(payload..)?).filter(|_| role.is_imu())?;
        let time = Self::time(record.get(4..4 + header)?)? + 4;
        let frame = payload + FRAME..payload + FRAME + 4;
        let shape = Shape::of(record, &[0..time, time + 8..payload, frame])?;
        Some(Self { role, shape, time, payload })
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

    /// Length of the whole record.
    pub fn len(&self) -> usize {
        self.shape.len()
    }

    /// The time (seconds, nanoseconds) and message of the next record, if it has this shape and
    /// `bytes` hold all of it.
    #[inline]
    pub fn next(&self, bytes: &[u8]) -> Option<((u32, u32), ImuMessage)> {
        let record = self.shape.next(bytes)?;
        let time = |at: usize| {
            let time = u64::from_le_bytes(*record.get(at..)?.first_chunk()?);
            Some((time as u32, (time >> 32) as u32))
        };
        let body = record.last_chunk::<{ imu_body::LEN }>()?;
        Some((time(self.time)?, ImuMessage::of(time(self.payload + 4)?, body)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::imu_message::Template;
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

    fn message(k: u32) -> ImuMessage {
        let rate = Some([f64::from(k), 2.0, 3.0]);
        ImuMessage { stamp: (k, 7), rate, force: (k < 9).then_some([0.0, 0.0, 9.8]) }
    }

    #[test]
    fn only_times_and_readings_may_differ() {
        for time_first in [false, true] {
            let record = |conn: u32, time: u64, frame: &str, k: u32| {
                let (conn, time) = (conn.to_le_bytes(), time.to_le_bytes());
                let mut fields: Vec<(&str, &[u8])> =
                    vec![("conn", &conn), ("op", &[2]), ("time", &time)];
                if time_first {
                    fields.rotate_right(1);
                }
                let mut bytes = Vec::new();
                push_header(&mut bytes, &fields);
                push_prefixed(&mut bytes, Template::new(frame).fill(k, &message(k)));
                bytes
            };
            let shape = Repeat::of(&record(0, 1, "imu", 1), 38, role()).unwrap();
            for k in [2, 9] {
                let next = record(0, 5 << 32 | 4, "imu", k);
                assert_eq!(shape.len(), next.len());
                assert_eq!(shape.next(&next), Some(((4, 5), message(k))));
                assert_eq!(shape.next(&next[..next.len() - 1]), None);
            }
            assert_eq!(shape.next(&record(1, 1, "imu", 1)), None);
            assert_eq!(shape.next(&record(0, 1, "imu0", 1)), None);
            // All bytes of the header but those of the time are looked at, and the frame's length.
            let time = 4 + if time_first { 9 } else { 30 };
            for at in 0..62 {
                let mut other = record(0, 1, "imu", 1);
                other[at] ^= 0x10;
                let free = (time..time + 8).contains(&at) || (46..58).contains(&at);
                assert_eq!(shape.next(&other).is_some(), free, "{at}");
            }
            assert!(Repeat::of(&record(0, 1, "imu", 1)[..300], 38, role()).is_none());
        }
    }
}
