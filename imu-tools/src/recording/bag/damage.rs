//! Where reading can go on after damage: the next bytes that have the form of a record.
//!
//! A record's header is a sound sign. Its fields have names, `op` among them, values of fixed
//! lengths, and must fill the header's length to the byte: that 38 bytes of noise look like a
//! message's header has a chance below 2⁻²⁰⁰. LZ4 leaves text that did not occur before as it is, so
//! that a header can stand in a compressed chunk; but another one behind it, at the distance that the
//! first says, cannot.

use memchr::memmem;

use super::op;
use super::record::{Header, prefixed};
use super::unpack::Compression;

/// Headers are found up to this length; but for a connection's they have less than 100 bytes.
const LONGEST_HEADER: usize = 1024;

/// A record that begins in the last so many bytes may not be found without those that follow.
pub const TAIL: usize = 8 * LONGEST_HEADER;

/// What is looked through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Among {
    /// Records.
    Records,
    /// Records, or the data of compressed chunks.
    Anything,
}

/// How far behind the start of a header its field `op` is looked for.
const REACH: usize = 256;

/// Where in `bytes` the first record begins that can be one.
pub fn next_record(bytes: &[u8], among: Among) -> Option<usize> {
    let is_record = |bytes: &[u8]| match plausible(bytes) {
        Some((op::MESSAGE | op::CONNECTION, len)) if among == Among::Anything => {
            bytes.get(len..).and_then(plausible).is_some()
        }
        other => other.is_some(),
    };
    let mut searched = 0;
    for op in memmem::find_iter(bytes, b"op=") {
        // The header's length and the field's stand before it.
        let Some(last) = op.checked_sub(8) else { continue };
        let first = op.saturating_sub(REACH).max(searched);
        if let Some(found) = (first..=last).find(|&at| bytes.get(at..).is_some_and(is_record)) {
            return Some(found);
        }
        searched = last + 1;
    }
    None
}

/// The kind and length of the record with which `bytes` begin, if its header is such as programs
/// write.
fn plausible(bytes: &[u8]) -> Option<(u8, usize)> {
    let length = bytes.first_chunk().map_or(0, |b| u32::from_le_bytes(*b)) as usize;
    if !(8..=LONGEST_HEADER).contains(&length) {
        return None;
    }
    let (header, rest) = prefixed(bytes)?;
    let (header, data) = (Header::parse(header)?, rest.first_chunk()?);
    let data = u64::from(u32::from_le_bytes(*data));
    let entries = |size: u64| header.count.is_some_and(|count| u64::from(count) * size == data);
    let op = header.op?;
    let whole = match op {
        op::MESSAGE => header.conn.is_some() && header.time.is_some(),
        op::CONNECTION => header.conn.is_some() && header.topic.is_some(),
        op::INDEX => header.conn.is_some() && entries(12),
        op::CHUNK_INFO => entries(8),
        op::CHUNK => {
            let name = header.compression.unwrap_or_default();
            header.size.is_some() && (name == b"none" || Compression::of(name).is_some())
        }
        _ => false,
    };
    whole.then_some((op, 8 + length + data as usize))
}

#[cfg(test)]
mod tests {
    use super::super::record::{push_header, push_prefixed};
    use super::*;

    fn message() -> Vec<u8> {
        let mut record = Vec::new();
        push_header(&mut record, &[("conn", &[0; 4]), ("op", &[2]), ("time", &[0; 8])]);
        push_prefixed(&mut record, b"payload");
        record
    }

    #[test]
    fn records_are_found_behind_anything() {
        for noise in [&b""[..], b"op=", b"op=op=op=\x02op=", &[0; 500], &[0xff; 300]] {
            let bytes = [noise, &message()].concat();
            assert_eq!(next_record(&bytes, Among::Records), Some(noise.len()));
            assert_eq!(next_record(&bytes[..bytes.len() - 8], Among::Records), None);
            // Alone it may be a piece of a compressed chunk.
            assert_eq!(next_record(&bytes, Among::Anything), None);
            let two = [bytes, message()].concat();
            assert_eq!(next_record(&two, Among::Anything), Some(noise.len()));
        }
    }

    #[test]
    fn what_only_looks_like_a_record_is_none() {
        for change in 0..42 {
            // Every byte of the header but those of the values of conn and time.
            if (13..17).contains(&change) || (34..42).contains(&change) {
                continue;
            }
            let mut bytes = message();
            bytes[change] ^= 0x40;
            assert_eq!(next_record(&bytes, Among::Records), None, "{change}");
        }
    }

    #[test]
    fn an_index_must_be_as_long_as_it_counts() {
        for (count, found) in [(2_u32, Some(0)), (3, None)] {
            let mut record = Vec::new();
            let fields: [(&str, &[u8]); 3] =
                [("conn", &[0; 4]), ("count", &count.to_le_bytes()), ("op", &[op::INDEX])];
            push_header(&mut record, &fields);
            push_prefixed(&mut record, &[0; 24]);
            assert_eq!(next_record(&record, Among::Anything), found);
        }
    }
}
