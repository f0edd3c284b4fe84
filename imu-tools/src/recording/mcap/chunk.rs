//! The chunk that is being read, and whether its contents are what was written.

use crc32fast::Hasher;

use super::record::ChunkHead;

/// A chunk between its head and its end.
pub struct Chunk {
    /// Offset of its record in the file.
    pub start: u64,
    /// Offset of the next record in the file.
    pub next: u64,
    /// Where its records end, as the input counts, if they are not compressed.
    pub end: Option<u64>,
    /// Length of its decompressed records, as it says.
    pub unpacked: u64,
    /// What the checksum must be, and that of the records so far; `None` if it is not checked.
    sum: Option<(u32, Hasher)>,
}

impl Chunk {
    /// A chunk whose record starts at `start`, the next one at `next`.
    pub fn new(head: &ChunkHead, start: u64, next: u64, end: Option<u64>) -> Self {
        let sum = (head.crc != 0).then(|| (head.crc, Hasher::new()));
        Self { start, next, end, unpacked: head.unpacked, sum }
    }

    /// Takes these bytes of its records into the checksum.
    #[inline]
    pub fn add(&mut self, bytes: &[u8]) {
        if let Some((_, hasher)) = &mut self.sum {
            hasher.update(bytes);
        }
    }

    /// Gives the check up: bytes were passed over, or it is known to be damaged.
    pub fn do_not_check(&mut self) {
        self.sum = None;
    }

    /// Whether it is checked.
    pub fn is_checked(&self) -> bool {
        self.sum.is_some()
    }

    /// Whether its records are as they were written, as far as can be known.
    pub fn checks_out(self) -> bool {
        self.sum.is_none_or(|(sum, hasher)| hasher.finalize() == sum)
    }
}
