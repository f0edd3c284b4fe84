//! What those who read Zstandard share, be it around a file, in a chunk or in a single message.

use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};

/// First bytes of a frame (RFC 8878).
pub const MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Brings a decoder whose frame goes no further to give what it still keeps back for later blocks:
/// an empty last block tells it that there are none.
pub fn end_early(frame: &mut FrameDecoder) {
    /// A block header (last, raw, no bytes) and a checksum that nobody looks at.
    const LAST: [u8; 7] = [1, 0, 0, 0, 0, 0, 0];
    // Before its first block a decoder keeps nothing, and refuses this.
    let _ = frame.decode_blocks(&LAST[..], BlockDecodingStrategy::UptoBlocks(1));
}
