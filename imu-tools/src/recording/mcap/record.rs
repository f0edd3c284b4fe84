//! Records and the fields in them.

/// Bytes in front of a record's data: opcode and length.
pub const HEAD: usize = 9;

/// Bytes of a message's data before its payload: channel, sequence, two times.
pub const MESSAGE: usize = 22;

/// Bytes of a chunk's data before its records, at most.
pub const CHUNK: usize = 28 + 4 + LONGEST_NAME + 8;

/// Bytes of the name of a compression, at most: there are names of none, three and four.
pub const LONGEST_NAME: usize = 32;

/// Opcode and length of data of the record that starts with `bytes`.
#[inline]
pub fn head(bytes: &[u8]) -> Option<(u8, u64)> {
    let (op, rest) = bytes.split_first()?;
    Some((*op, u64::from_le_bytes(*rest.first_chunk()?)))
}

/// Fields, taken from the front.
#[derive(Clone, Copy, Debug)]
pub struct Fields<'a>(pub &'a [u8]);

impl<'a> Fields<'a> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (field, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*field)
    }

    /// A number of two bytes.
    pub fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    /// A number of four bytes.
    pub fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    /// A number of eight bytes.
    pub fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    /// A text, prefixed by its length; what is no UTF-8 in it is marked.
    pub fn text(&mut self) -> Option<String> {
        let len = self.u32()? as usize;
        let (text, rest) = self.0.split_at_checked(len)?;
        self.0 = rest;
        Some(String::from_utf8_lossy(text).into_owned())
    }
}

/// What a chunk says of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChunkHead {
    /// Length of its records when decompressed.
    pub unpacked: u64,
    /// CRC-32 of them; 0 where nobody computed it.
    pub crc: u32,
    /// Name of the compression; empty for none.
    pub compression: String,
    /// Length of its records as they are stored.
    pub stored: u64,
    /// Bytes of all this, from the start of the chunk's data.
    pub len: usize,
}

impl ChunkHead {
    /// Reads the head of a chunk's data.
    pub fn parse(data: &[u8]) -> Option<Self> {
        let mut fields = Fields(data);
        fields.u64()?;
        fields.u64()?;
        let (unpacked, crc) = (fields.u64()?, fields.u32()?);
        if Fields(fields.0).u32()? as usize > LONGEST_NAME {
            return None;
        }
        let compression = fields.text()?;
        let stored = fields.u64()?;
        Some(Self { unpacked, crc, compression, stored, len: data.len() - fields.0.len() })
    }
}

/// Appends a text, prefixed by its length.
pub fn push_text(to: &mut Vec<u8>, text: &str) {
    to.extend_from_slice(&(text.len() as u32).to_le_bytes());
    to.extend_from_slice(text.as_bytes());
}

/// Appends a record whose data `data` appends.
pub fn push_record(to: &mut Vec<u8>, op: u8, data: impl FnOnce(&mut Vec<u8>)) {
    to.push(op);
    let start = to.len();
    to.extend_from_slice(&[0; 8]);
    data(to);
    let len = (to.len() - start - 8) as u64;
    if let Some(field) = to.get_mut(start..start + 8) {
        field.copy_from_slice(&len.to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_read_back_and_cut_ones_refused() {
        let mut bytes = Vec::new();
        push_record(&mut bytes, 6, |data| {
            data.extend_from_slice(&[0; 16]);
            data.extend_from_slice(&7_u64.to_le_bytes());
            data.extend_from_slice(&8_u32.to_le_bytes());
            push_text(data, "lz4");
            data.extend_from_slice(&9_u64.to_le_bytes());
        });
        let (op, len) = head(&bytes).unwrap();
        assert_eq!((op, len as usize), (6, bytes.len() - HEAD));
        let data = &bytes[HEAD..];
        let expected = ChunkHead {
            unpacked: 7,
            crc: 8,
            compression: "lz4".into(),
            stored: 9,
            len: data.len(),
        };
        assert_eq!(ChunkHead::parse(data), Some(expected));
        for cut in 0..data.len() {
            assert_eq!(ChunkHead::parse(&data[..cut]), None);
        }
        assert_eq!(Fields(&[0xff; 4]).text(), None);
    }
}
