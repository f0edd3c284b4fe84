//! How a table is written: what stands between fields, in numbers and around text.

use super::number;

/// What separates fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// This byte, once.
    Byte(u8),
    /// Any number of blanks and tabs.
    Blanks,
}

/// How the lines of a table are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dialect {
    /// Between fields.
    pub separator: Separator,
    /// Numbers have a comma where others have a point.
    pub decimal_comma: bool,
}

impl Dialect {
    /// The dialect of a line.
    pub fn of(line: &[u8]) -> Self {
        let outside_quotes = |byte: u8| {
            let mut quoted = false;
            line.iter().any(|&b| {
                quoted ^= b == b'"';
                b == byte && !quoted
            })
        };
        let bytes = [b';', b'\t', b'|', b','];
        let byte = bytes.into_iter().find(|byte| outside_quotes(*byte));
        // A quote that is never closed encloses nothing.
        let byte = byte.or_else(|| bytes.into_iter().find(|byte| line.contains(byte)));
        let separator = match byte {
            Some(b',') if commas_are_decimal(line) => Separator::Blanks,
            Some(byte) => Separator::Byte(byte),
            None => Separator::Blanks,
        };
        let mut dialect = Self { separator, decimal_comma: false };
        dialect.decimal_comma = dialect.fields(line).any(is_decimal_comma);
        dialect
    }

    /// The fields of a line, without blanks and quotes around them.
    pub fn fields(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
        let mut rest = Some(line);
        std::iter::from_fn(move || {
            let mut line = rest?;
            if self.separator == Separator::Blanks {
                line = line.trim_ascii_start();
                if line.is_empty() {
                    return None;
                }
            }
            let after = line.get(closing_quote(line)..).unwrap_or_default();
            let end = match self.separator {
                Separator::Byte(byte) => memchr::memchr(byte, after),
                Separator::Blanks => memchr::memchr2(b' ', b'\t', after),
            };
            let end = end.map(|end| line.len() - after.len() + end);
            let field = line.get(..end.unwrap_or(line.len())).unwrap_or_default();
            rest = end.and_then(|end| line.get(end + 1..));
            Some(trim(field))
        })
    }

    /// The double nearest to the number in a field.
    pub fn value(self, field: &[u8]) -> Option<f64> {
        if !self.decimal_comma {
            return number::value(field);
        }
        number::value(&pointed(field))
    }
}

/// The same number with a decimal point.
pub fn pointed(field: &[u8]) -> Vec<u8> {
    field.iter().map(|&byte| if byte == b',' { b'.' } else { byte }).collect()
}

/// Where the text in quotes ends with which a field begins; 0 where there are no quotes.
fn closing_quote(line: &[u8]) -> usize {
    let blanks = line.iter().take_while(|&&b| b == b' ').count();
    match line.get(blanks..) {
        Some([b'"', text @ ..]) => memchr::memchr(b'"', text).map_or(0, |end| blanks + end + 2),
        _ => 0,
    }
}

/// Whether a field is a number like `-1,5`.
fn is_decimal_comma(field: &[u8]) -> bool {
    let Some(comma) = memchr::memchr(b',', field) else { return false };
    let inside = comma > 0 && comma + 1 < field.len();
    inside && number::value(field).is_none() && number::value(&pointed(field)).is_some()
}

/// Whether the commas of a line stand in its numbers, and blanks between them.
fn commas_are_decimal(line: &[u8]) -> bool {
    let blanks = Dialect { separator: Separator::Blanks, decimal_comma: true };
    let mut any = false;
    let all = blanks.fields(line).all(|field| {
        let decimal = is_decimal_comma(field);
        any |= decimal;
        decimal || !field.contains(&b',')
    });
    all && any && blanks.fields(line).count() >= 4
}

#[inline]
fn trim(field: &[u8]) -> &[u8] {
    let mut field = field.trim_ascii();
    if let [b'"', inner @ .., b'"'] | [b'\'', inner @ .., b'\''] = field {
        field = inner.trim_ascii();
    }
    field
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(line: &'static str) -> Vec<&'static str> {
        let line = line.as_bytes();
        Dialect::of(line).fields(line).map(|f| std::str::from_utf8(f).unwrap()).collect()
    }

    #[test]
    fn separators() {
        assert_eq!(fields("1, 2 ,,3"), ["1", "2", "", "3"]);
        assert_eq!(fields("1;2"), ["1", "2"]);
        assert_eq!(fields("1|2| 3"), ["1", "2", "3"]);
        assert_eq!(fields("1\t2\t"), ["1", "2", ""]);
        assert_eq!(fields("  1   2 "), ["1", "2"]);
        assert_eq!(fields("\"1\",'2'"), ["1", "2"]);
    }

    #[test]
    fn separators_in_quotes_separate_nothing() {
        assert_eq!(fields(r#""t; s","x, y",3"#), ["t; s", "x, y", "3"]);
        assert_eq!(fields(r#""1,5","2,5""#), ["1,5", "2,5"]);
        assert_eq!(fields(r#""open,2"#), [r#""open"#, "2"]);
    }

    #[test]
    fn decimal_commas() {
        for (line, separator, decimal_comma) in [
            ("0,005;1,5;2", Separator::Byte(b';'), true),
            ("0,005\t1,5\t2", Separator::Byte(b'\t'), true),
            ("0,005 1,5 2 3", Separator::Blanks, true),
            (r#""0,005","1,5","2""#, Separator::Byte(b','), true),
            ("0.005, 1.5, 2, 3", Separator::Byte(b','), false),
            ("1,2,3,4", Separator::Byte(b','), false),
            ("0.005;1.5;2", Separator::Byte(b';'), false),
        ] {
            assert_eq!(
                Dialect::of(line.as_bytes()),
                Dialect { separator, decimal_comma },
                "{line}"
            );
        }
        let comma = Dialect::of(b"0,5;1");
        assert_eq!(comma.value(b"-1,25e3"), Some(-1250.0));
        assert_eq!(comma.value(b"1,2,3"), None);
    }
}
