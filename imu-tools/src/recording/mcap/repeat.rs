//! The shape that a channel's messages repeat: found once, then only compared.
//!
//! Records of one channel begin with the same eleven bytes (opcode, length, channel) as long as
//! their frame keeps its length. Comparing those is faster than reading each head anew, and, where a
//! file is damaged, they show where its messages go on.

use super::op;
use super::record::{HEAD, MESSAGE};
use crate::recording::topics::Role;

/// Opcode, length and channel.
const SAME: usize = HEAD + 2;

/// Length and first bytes of a message's record.
#[derive(Clone, Copy, Debug)]
pub struct Repeat {
    /// Length of the whole record.
    pub len: usize,
    /// What is wanted of it.
    pub role: Role,
    same: [u8; SAME],
}

impl Repeat {
    /// The shape of a whole message record.
    pub fn of(record: &[u8], role: Role) -> Option<Self> {
        Some(Self { len: record.len(), role, same: *record.first_chunk()? })
    }

    /// Time of recording and payload of the next record, if it has this shape and `bytes` hold all
    /// of it.
    #[inline]
    pub fn next<'a>(&self, bytes: &'a [u8]) -> Option<(u64, &'a [u8])> {
        let (same, rest) = bytes.get(..self.len)?.split_first_chunk::<SAME>()?;
        if *same != self.same {
            return None;
        }
        let (fields, payload) = rest.split_first_chunk::<{ MESSAGE - 2 }>()?;
        let time = fields.get(4..12)?.first_chunk()?;
        Some((u64::from_le_bytes(*time), payload))
    }

    /// Where in `bytes` the next record of this shape begins, or could begin at their end.
    pub fn find(&self, bytes: &[u8]) -> Option<usize> {
        memchr::memmem::find(bytes, &self.same)
    }
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

    const ROLE: Role = Role { number: 3, gyroscope: true, accelerometer: true, temperature: false };

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

    #[test]
    fn only_sequence_times_and_payload_may_differ() {
        let shape = Repeat::of(&message(3, 1, b"abc"), ROLE).unwrap();
        let next = message(3, 1 << 40, b"def");
        assert_eq!(shape.next(&next), Some((1 << 40, &b"def"[..])));
        assert_eq!(shape.next(&next[..next.len() - 1]), None);
        assert_eq!(shape.next(&message(4, 1, b"abc")), None);
        assert_eq!(shape.next(&message(3, 1, b"abcd")), None);
        assert_eq!(shape.find(&[&[5; 20], &next[..]].concat()), Some(20));
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
