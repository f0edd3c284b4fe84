//! The [`Shape`] of a channel's messages, and where their time and readings stand in it.
//!
//! Records of one channel begin with the same eleven bytes (opcode, length, channel) as long as
//! their frame keeps its length. Where a file is damaged, those show where its messages go on.

use super::op;
use super::record::{HEAD, MESSAGE};
use crate::recording::imu_body;
use crate::recording::ros2::{ImuMessage, Recorded, cdr};
use crate::recording::shape::Shape;
use crate::recording::topics::Role;

/// Opcode, length and channel.
const SAME: usize = HEAD + 2;
/// Where the payload stands in a record.
const PAYLOAD: usize = HEAD + MESSAGE;

/// Length and first bytes of a message's record.
#[derive(Clone, Copy, Debug)]
pub struct Repeat {
    /// Length of the whole record.
    pub len: usize,
    /// What is wanted of it.
    pub role: Role,
    same: [u8; SAME],
    /// Of a message that is little-endian and not compressed, as most are.
    shape: Option<Shape>,
}

impl Repeat {
    /// The shape of a whole message record.
    pub fn of(record: &[u8], role: Role) -> Option<Self> {
        let same = *record.first_chunk()?;
        let message = cdr::Stamped::parse(record.get(PAYLOAD..)?).ok();
        let plain = message.and_then(|message| message.exactly::<{ imu_body::LEN }>());
        let frame = PAYLOAD + cdr::FRAME..PAYLOAD + cdr::FRAME + 4;
        let shape = plain
            .filter(|_| role.is_imu())
            .and_then(|_| Shape::of(record, &[0..SAME, PAYLOAD..PAYLOAD + 2, frame]));
        Some(Self { len: record.len(), role, same, shape })
    }

    /// Time of recording and message of the next record, if it has this shape and `bytes` hold all
    /// of it.
    #[inline]
    pub fn next(&self, bytes: &[u8]) -> Option<(i64, ImuMessage)> {
        let record = self.shape.as_ref()?.next(bytes)?;
        let time_ns = time_ns(record)?;
        let stamp = record.get(PAYLOAD + cdr::ENCAPSULATION..)?.first_chunk()?;
        let stamp = u64::from_le_bytes(*stamp);
        let stamp_ns = cdr::nanoseconds(stamp as i32, (stamp >> 32) as u32);
        Some((time_ns, ImuMessage::little_endian(stamp_ns, record.last_chunk()?)))
    }

    /// Where in `bytes` the next record of this shape begins, or could begin at their end.
    pub fn find(&self, bytes: &[u8]) -> Option<usize> {
        memchr::memmem::find(bytes, &self.same)
    }
}

/// Time of recording and payload of a message's whole record.
pub fn recorded(record: &[u8]) -> Option<Recorded<'_>> {
    Some(Recorded { time_ns: time_ns(record)?, payload: record.get(PAYLOAD..)? })
}

#[inline]
fn time_ns(record: &[u8]) -> Option<i64> {
    let time = u64::from_le_bytes(*record.get(SAME + 4..)?.first_chunk()?);
    Some(i64::try_from(time).unwrap_or(i64::MAX))
}

/// Where in `bytes` a chunk begins: its opcode, and lengths that agree with each other.
pub fn find_chunk(bytes: &[u8]) -> Option<usize> {
    memchr::memchr_iter(op::CHUNK, bytes).find(|&at| {
        let rest = bytes.get(at..).unwrap_or_default();
        let Some((_, len)) = super::record::head(rest) else { return false };
        let Some(head) = rest.get(HEAD..).and_then(super::record::ChunkHead::parse) else {
            return false;
        };
        ["", "zstd", "lz4"].contains(&head.compression.as_str())
            && (head.len as u64).checked_add(head.stored) == Some(len)
    })
}

#[cfg(test)]
mod tests {
    use super::super::record::{push_record, push_text};
    use super::*;
    use crate::recording::ros2::Template;

    const ROLE: Role = Role { gyroscope: true, accelerometer: true, ..Role::of(3) };

    fn message(channel: u16, time: u64, payload: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        push_record(&mut bytes, op::MESSAGE, |data| {
            data.extend_from_slice(&channel.to_le_bytes());
            data.extend_from_slice(&[7; 4]);
            data.extend_from_slice(&time.to_le_bytes());
            data.extend_from_slice(&[9; 8]);
            data.extend_from_slice(payload);
        });
        bytes
    }

    fn imu(frame: &str, k: u32) -> (ImuMessage, Vec<u8>) {
        let rate = Some([f64::from(k), -2.0, 0.5]);
        let message = ImuMessage { stamp_ns: 5_000_000_000 + i64::from(k), rate, force: None };
        (message, Template::new(frame).fill((5, k), rate, None).to_vec())
    }

    #[test]
    fn only_sequence_times_and_readings_may_differ() {
        let (_, first) = imu("imu", 1);
        let shape = Repeat::of(&message(3, 1, &first), ROLE).unwrap();
        let (read, second) = imu("imu", 2);
        let next = message(3, 1 << 40, &second);
        assert_eq!(shape.next(&next), Some((1 << 40, read)));
        assert_eq!(shape.next(&next[..next.len() - 1]), None);
        assert_eq!(shape.next(&message(4, 1, &second)), None);
        assert_eq!(shape.next(&message(3, 1, &imu("a_longer_frame", 2).1)), None);
        assert_eq!(shape.find(&[&[5; 20], &next[..]].concat()), Some(20));
        for at in (0..SAME).chain([PAYLOAD, PAYLOAD + 1]).chain(PAYLOAD + 12..PAYLOAD + 16) {
            let mut other = next.clone();
            other[at] ^= 1;
            assert_eq!(shape.next(&other), None, "{at}");
        }
    }

    #[test]
    fn what_is_not_plain_is_found_and_not_compared() {
        let (_, first) = imu("imu", 1);
        let padded = [&first[..], &[0; 4]].concat();
        for payload in [&b"abc"[..], &padded] {
            let other = message(3, 1, payload);
            let shape = Repeat::of(&other, ROLE).unwrap();
            assert_eq!((shape.next(&other), shape.find(&other)), (None, Some(0)));
        }
    }

    #[test]
    fn a_chunk_is_known_by_lengths_that_agree() {
        let mut bytes = vec![op::CHUNK; 60];
        push_record(&mut bytes, op::CHUNK, |data| {
            data.extend_from_slice(&[0; 28]);
            push_text(data, "zstd");
            data.extend_from_slice(&5_u64.to_le_bytes());
            data.extend_from_slice(b"abcde");
        });
        assert_eq!(find_chunk(&bytes), Some(60));
        bytes[61] += 1;
        assert_eq!(find_chunk(&bytes), None);
    }
}
