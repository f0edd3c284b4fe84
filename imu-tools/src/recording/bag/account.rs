//! What a bag says of itself in its first record, against what was found in it.

use super::record::Header;

/// A bag's own account of its parts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Account {
    /// Where the bag says that its index is; 0 when it was never closed, or written through a pipe.
    pub index_pos: u64,
    /// How many chunks it says that it has.
    chunk_count: Option<u32>,
    /// Chunks found.
    pub chunks: u32,
    /// Descriptions of chunks found.
    pub infos: u32,
    /// Indexes of chunks found.
    pub indexes: u32,
}

impl Account {
    /// What the bag header says.
    pub fn of(header: &Header<'_>) -> Self {
        Self {
            index_pos: header.index_pos.unwrap_or(0),
            chunk_count: header.chunk_count,
            ..Self::default()
        }
    }

    /// What is wrong with a bag that ends after `size` bytes (`cut`: in the middle of a record), in
    /// words that follow its name.
    pub fn closing(&self, size: u64, cut: bool) -> Option<String> {
        let Self { index_pos, chunks, infos, .. } = *self;
        let said = self.chunk_count.unwrap_or(chunks);
        let lost = index_pos.saturating_sub(size);
        Some(if index_pos == 0 && cut {
            "was not closed and is cut off in the middle of a record: what comes before is used"
                .into()
        } else if index_pos == 0 && infos > 0 && infos == chunks {
            "was written through a pipe, so that its first record does not say where its index is, which \
             costs no message"
                .into()
        } else if index_pos == 0 {
            "was not closed: what was recorded last may be missing".into()
        } else if lost > 0 && (infos == 0 || infos < said) {
            format!("is cut off: its last {lost} bytes of data, or more, are lost")
        } else if lost > 0 {
            "does not have its index where it says, which costs no message".into()
        } else if cut || (0 < infos && infos < said) {
            "is cut off in its index, which costs no message".into()
        } else if infos < said {
            "lacks the index of its chunks, which costs no message".into()
        } else if chunks != said {
            format!("has {chunks} chunks where it says that it has {said}")
        } else if chunks > 0 && self.indexes == 0 {
            "lacks the indexes of its messages, which costs none of them".into()
        } else {
            return None;
        })
    }
}
