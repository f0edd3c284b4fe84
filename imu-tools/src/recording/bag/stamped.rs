//! The header of a message as ROS 1 puts it on the wire: seq u32, stamp (seconds u32, nanoseconds u32),
//! frame_id (length u32 and text), little-endian.

use super::record::prefixed;

/// Bytes of the header before the text of its frame.
pub const HEADER: usize = 16;

/// Where in it the length of that text stands.
pub const FRAME: usize = 12;

/// Stamp of the header (seconds and nanoseconds) and what stands behind it; `None` where `bytes` hold none.
#[inline]
pub fn header(bytes: &[u8]) -> Option<((u32, u32), &[u8])> {
    let header = bytes.first_chunk::<HEADER>()?;
    let word = |at: usize| header.get(at..at + 4).and_then(|b| b.try_into().ok());
    let stamp = (u32::from_le_bytes(word(4)?), u32::from_le_bytes(word(8)?));
    Some((stamp, prefixed(bytes.get(FRAME..)?)?.1))
}
