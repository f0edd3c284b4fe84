//! The first bytes of something unknown, for a person: as numbers and as text.

use std::fmt::Write as _;

/// So many are shown.
const SHOWN: usize = 24;

/// The first bytes in hexadecimal, and as text with a dot for what is none.
#[must_use]
pub fn bytes(bytes: &[u8]) -> String {
    let first = bytes.get(..SHOWN).unwrap_or(bytes);
    let mut text = String::new();
    for byte in first {
        let _ = write!(text, "{byte:02x} ");
    }
    text.push('"');
    text.extend(
        first.iter().map(|b| if b.is_ascii_graphic() || *b == b' ' { *b as char } else { '.' }),
    );
    text.push('"');
    text
}

#[cfg(test)]
mod tests {
    #[test]
    fn numbers_and_text() {
        assert_eq!(super::bytes(b"$A\r"), "24 41 0d \"$A.\"");
        assert_eq!(super::bytes(&[0xff; 100]).len(), 24 * 3 + 26);
    }
}
