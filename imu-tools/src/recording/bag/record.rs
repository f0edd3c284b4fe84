//! Records and their header fields: slices of the buffer, nothing copied.

/// What a header says, of the fields that matter here; in any order in the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Header<'a> {
    /// Kind of the record.
    pub op: Option<u8>,
    /// Connection number.
    pub conn: Option<u32>,
    /// Time of recording: seconds and nanoseconds.
    pub time: Option<(u32, u32)>,
    /// A chunk's compression.
    pub compression: Option<&'a [u8]>,
    /// A connection's topic.
    pub topic: Option<&'a [u8]>,
    /// Name of a connection's message type.
    pub type_name: Option<&'a [u8]>,
    /// Fingerprint of a connection's message type.
    pub md5sum: Option<&'a [u8]>,
    /// Where the bag's list of connections and chunks starts.
    pub index_pos: Option<u64>,
    /// How many chunks the bag has.
    pub chunk_count: Option<u32>,
    /// What encrypted the bag; empty for nothing.
    pub encryptor: Option<&'a [u8]>,
    /// Bytes that a chunk unpacks to.
    pub size: Option<u32>,
    /// Entries of an index or a chunk's description.
    pub count: Option<u32>,
}

impl<'a> Header<'a> {
    /// Reads the fields of a header (or of a connection's data, which has the same form); `None`
    /// when they are malformed.
    #[inline]
    pub fn parse(mut bytes: &'a [u8]) -> Option<Self> {
        let mut header = Self::default();
        while !bytes.is_empty() {
            let (field, rest) = prefixed(bytes)?;
            bytes = rest;
            match field {
                [b'o', b'p', b'=', op] => header.op = Some(*op),
                [b'c', b'o', b'n', b'n', b'=', value @ ..] => {
                    header.conn = Some(u32::from_le_bytes(value.try_into().ok()?));
                }
                [b't', b'i', b'm', b'e', b'=', value @ ..] => {
                    let (sec, nsec) = value.split_first_chunk()?;
                    header.time =
                        Some((u32::from_le_bytes(*sec), u32::from_le_bytes(nsec.try_into().ok()?)));
                }
                _ => header.rare_field(field)?,
            }
        }
        Some(header)
    }

    /// Fields that no message has.
    #[cold]
    fn rare_field(&mut self, field: &'a [u8]) -> Option<()> {
        let equals = field.iter().position(|&b| b == b'=')?;
        let (name, value) = (field.get(..equals)?, field.get(equals + 1..)?);
        let word = |value: &[u8]| value.try_into().ok().map(u32::from_le_bytes);
        match name {
            b"op" | b"conn" | b"time" => return None,
            b"compression" => self.compression = Some(value),
            b"topic" => self.topic = Some(value),
            b"type" => self.type_name = Some(value),
            b"md5sum" => self.md5sum = Some(value),
            b"index_pos" => self.index_pos = Some(u64::from_le_bytes(value.try_into().ok()?)),
            b"chunk_count" => self.chunk_count = Some(word(value)?),
            b"encryptor" => self.encryptor = Some(value),
            b"size" => self.size = Some(word(value)?),
            b"count" => self.count = Some(word(value)?),
            _ => {}
        }
        Some(())
    }
}

/// A piece prefixed by its length (u32), and what follows it.
#[inline]
pub fn prefixed(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (len, rest) = bytes.split_first_chunk()?;
    rest.split_at_checked(u32::from_le_bytes(*len) as usize)
}

/// Appends `bytes` prefixed by their length.
pub fn push_prefixed(to: &mut Vec<u8>, bytes: &[u8]) {
    to.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
    to.extend_from_slice(bytes);
}

/// Appends fields, each prefixed by its length.
pub fn push_fields(to: &mut Vec<u8>, fields: &[(&str, &[u8])]) {
    for (name, value) in fields {
        to.extend_from_slice(&((name.len() + 1 + value.len()) as u32).to_le_bytes());
        to.extend_from_slice(name.as_bytes());
        to.push(b'=');
        to.extend_from_slice(value);
    }
}

/// Appends a header of these fields, prefixed by its length.
pub fn push_header(to: &mut Vec<u8>, fields: &[(&str, &[u8])]) {
    let start = to.len();
    to.extend_from_slice(&[0; 4]);
    push_fields(to, fields);
    let len = (to.len() - start - 4) as u32;
    if let Some(prefix) = to.get_mut(start..start + 4) {
        prefix.copy_from_slice(&len.to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_in_any_order() {
        let fields: [(&str, &[u8]); 4] = [
            ("op", &[2]),
            ("conn", &7u32.to_le_bytes()),
            ("time", &[1, 0, 0, 0, 2, 0, 0, 0]),
            ("unknown", b"a=b"),
        ];
        let expected =
            Header { op: Some(2), conn: Some(7), time: Some((1, 2)), ..Header::default() };
        for first in 0..4 {
            for second in (0..4).filter(|&i| i != first) {
                let mut order = vec![first, second];
                order.extend((0..4).filter(|i| ![first, second].contains(i)));
                let fields: Vec<_> = order.iter().map(|&i| fields[i]).collect();
                let mut bytes = Vec::new();
                push_header(&mut bytes, &fields);
                let (header, rest) = prefixed(&bytes).unwrap();
                assert!(rest.is_empty());
                assert_eq!(Header::parse(header), Some(expected));
            }
        }
    }

    #[test]
    fn malformed_headers_are_refused() {
        for bytes in [&b"\x05\0\0\0op=\x02"[..], b"\x02\0\0\0op", b"\x06\0\0\0conn=1", b"\x01\0"] {
            assert_eq!(Header::parse(bytes), None, "{bytes:?}");
        }
    }
}
