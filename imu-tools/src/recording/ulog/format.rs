//! Format messages: which fields a topic has, of what type, and where.
//!
//! `name:type field;type[count] field;…`, where a type is one of twelve plain ones or the name of
//! another format. Padding at the end of a message may be left out by whoever writes the log.

use std::collections::HashMap;

/// Text of formats kept, at most: a log has 50 KB.
const TEXT: usize = 4 << 20;

/// Formats within formats, at most.
const DEPTH: u32 = 8;

/// Fields looked at to find the length of a format, at most, in the formats within as often as they
/// occur: a topic has some hundred.
const FIELDS: usize = 4096;

/// Bytes of a message, at most: its size is written in 16 bits.
const LONGEST: usize = 65_535;

/// Plain types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "int8_t" => Self::I8,
            "uint8_t" | "bool" | "char" => Self::U8,
            "int16_t" => Self::I16,
            "uint16_t" => Self::U16,
            "int32_t" => Self::I32,
            "uint32_t" => Self::U32,
            "int64_t" => Self::I64,
            "uint64_t" => Self::U64,
            "float" => Self::F32,
            "double" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of it.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// A field of plain type in the messages of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Type of each element.
    pub scalar: Scalar,
    /// Where its first element stands.
    pub offset: usize,
    /// Elements; 1 for what is no array.
    pub count: usize,
}

impl Field {
    /// An element of it as a field of its own.
    pub fn element(self, i: usize) -> Option<Self> {
        let offset = self.offset + i * self.scalar.size();
        (i < self.count).then_some(Self { offset, count: 1, ..self })
    }

    /// Its first element, from a message's bytes.
    #[inline]
    pub fn read(self, message: &[u8]) -> Option<f64> {
        let bytes = message.get(self.offset..)?;
        Some(match self.scalar {
            Scalar::I8 => f64::from(i8::from_le_bytes(*bytes.first_chunk()?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(*bytes.first_chunk()?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(*bytes.first_chunk()?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(*bytes.first_chunk()?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(*bytes.first_chunk()?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(*bytes.first_chunk()?)),
            Scalar::I64 => i64::from_le_bytes(*bytes.first_chunk()?) as f64,
            Scalar::U64 => u64::from_le_bytes(*bytes.first_chunk()?) as f64,
            Scalar::F32 => f64::from(f32::from_le_bytes(*bytes.first_chunk()?)),
            Scalar::F64 => f64::from_le_bytes(*bytes.first_chunk()?),
        })
    }

    /// Its first element, where it is a stamp.
    #[inline]
    pub fn read_u64(self, message: &[u8]) -> Option<u64> {
        Some(u64::from_le_bytes(*message.get(self.offset..)?.first_chunk()?))
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Member {
    type_name: String,
    count: usize,
    name: String,
}

impl Member {
    /// Reads `type name` or `type[count] name`.
    fn parse(text: &str) -> Option<Self> {
        let (type_name, name) = text.split_once(' ')?;
        let (type_name, count) = match type_name.split_once('[') {
            Some((type_name, count)) => (type_name, count.strip_suffix(']')?.parse().ok()?),
            None => (type_name, 1),
        };
        let name = name.trim();
        let good = !type_name.is_empty() && !name.is_empty();
        (good && (1..=LONGEST).contains(&count)).then(|| Self {
            type_name: type_name.to_owned(),
            count,
            name: name.to_owned(),
        })
    }

    fn is_padding(&self) -> bool {
        self.name.starts_with("_padding")
    }
}

/// What became of a format message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Defined {
    /// It is known now, or was known, the same.
    Known,
    /// Another one of this name is known.
    Contradicts,
    /// It is none, or there are too many.
    Refused,
}

/// The formats of a log, by their names.
#[derive(Clone, Debug, Default)]
pub struct Formats {
    by_name: HashMap<String, Vec<Member>>,
    text: usize,
}

impl Formats {
    /// Takes a format message.
    pub fn define(&mut self, text: &[u8]) -> Defined {
        let Some((name, members)) = parse(text) else { return Defined::Refused };
        if let Some(known) = self.by_name.get(name) {
            return if *known == members { Defined::Known } else { Defined::Contradicts };
        }
        self.text += text.len();
        if self.text > TEXT {
            return Defined::Refused;
        }
        self.by_name.insert(name.to_owned(), members);
        Defined::Known
    }

    /// Whether there is a format of this name.
    pub fn knows(&self, name: &str) -> bool {
        self.by_name.contains_key(name)
    }

    /// Length of a message without the padding at its end, and with it; `None` where its format, or
    /// one within, is not known, or no message can hold it.
    pub fn lengths(&self, name: &str) -> Option<(usize, usize)> {
        let mut left = FIELDS;
        Some((self.trimmed(name, 0, &mut left)?, self.length(name, 0, &mut left)?))
    }

    /// A field of plain type of a message.
    pub fn field(&self, format: &str, field: &str) -> Option<Field> {
        let (mut offset, mut left) = (0, FIELDS);
        for member in self.by_name.get(format)? {
            if member.name == field {
                let scalar = Scalar::parse(&member.type_name)?;
                return Some(Field { scalar, offset, count: member.count });
            }
            offset += self.member_length(member, 0, &mut left)?;
            if offset > LONGEST {
                return None;
            }
        }
        None
    }

    fn member_length(&self, member: &Member, depth: u32, left: &mut usize) -> Option<usize> {
        *left = left.checked_sub(1)?;
        let one = match Scalar::parse(&member.type_name) {
            Some(scalar) => scalar.size(),
            None => self.length(&member.type_name, depth + 1, left)?,
        };
        Some(one * member.count)
    }

    fn length(&self, name: &str, depth: u32, left: &mut usize) -> Option<usize> {
        let members = self.by_name.get(name).filter(|_| depth < DEPTH)?;
        let mut length = 0;
        for member in members {
            length += self.member_length(member, depth, left)?;
            if length > LONGEST {
                return None;
            }
        }
        Some(length)
    }

    /// The length up to the last byte that is no padding at the end, also of formats within.
    fn trimmed(&self, name: &str, depth: u32, left: &mut usize) -> Option<usize> {
        let members = self.by_name.get(name).filter(|_| depth < DEPTH)?;
        let last = members.iter().rposition(|member| !member.is_padding())?;
        let (before, last) = (members.get(..last)?, members.get(last)?);
        let mut length = 0;
        for member in before {
            length += self.member_length(member, depth, left)?;
        }
        let whole = self.member_length(last, depth, left)?;
        let tail = match Scalar::parse(&last.type_name) {
            Some(_) => 0,
            None => {
                let inner = self.length(&last.type_name, depth + 1, left)?;
                inner - self.trimmed(&last.type_name, depth + 1, left)?
            }
        };
        Some(length + whole - tail)
    }
}

/// Splits the text of a format.
fn parse(text: &[u8]) -> Option<(&str, Vec<Member>)> {
    let text = std::str::from_utf8(text).ok()?.trim_end_matches('\0');
    let (name, fields) = text.split_once(':')?;
    let fields = fields.split(';').filter(|field| !field.trim().is_empty());
    let members: Option<Vec<_>> = fields.map(|field| Member::parse(field.trim())).collect();
    let members = members.filter(|members| !members.is_empty())?;
    (!name.is_empty() && Scalar::parse(name).is_none()).then_some((name, members))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formats(texts: &[&str]) -> Formats {
        let mut formats = Formats::default();
        for text in texts {
            assert_eq!(formats.define(text.as_bytes()), Defined::Known, "{text}");
        }
        formats
    }

    #[test]
    fn fields_stand_where_the_ones_before_them_end() {
        let formats = formats(&[
            "outer:uint64_t timestamp;inner[2] pair;float[3] x;uint8_t[3] _padding0;",
            "inner:bool flag;double value;uint8_t[7] _padding0;",
        ]);
        let x = formats.field("outer", "x").unwrap();
        assert_eq!(x, Field { scalar: Scalar::F32, offset: 8 + 32, count: 3 });
        assert_eq!(x.element(2).unwrap().offset, 48);
        assert_eq!(x.element(3), None);
        assert_eq!(formats.lengths("outer"), Some((52, 55)));
        assert_eq!(formats.lengths("inner"), Some((9, 16)));
        assert_eq!(formats.field("outer", "pair"), None);
        assert_eq!(formats.field("outer", "y"), None);
    }

    #[test]
    fn padding_within_the_last_field_may_be_left_out_too() {
        let formats = formats(&["a:float x;b[2] b;", "b:int16_t v;uint8_t[2] _padding0"]);
        assert_eq!(formats.lengths("a"), Some((10, 12)));
    }

    #[test]
    fn what_is_no_format_is_refused() {
        let mut formats = Formats::default();
        for text in [
            "",
            "a",
            "a:",
            ":float x",
            "a:float",
            "a:float[ x",
            "a:float[-1] x",
            "a:float[70000] x",
            "a:float[0] x",
            "float:float x",
        ] {
            assert_eq!(formats.define(text.as_bytes()), Defined::Refused, "{text}");
        }
        assert_eq!(formats.define(&[b'a', b':', 0xff]), Defined::Refused);
    }

    #[test]
    fn the_first_of_two_definitions_holds() {
        let mut formats = formats(&["a:float x"]);
        assert_eq!(formats.define(b"a:float x;"), Defined::Known);
        assert_eq!(formats.define(b"a:double x"), Defined::Contradicts);
        assert_eq!(formats.lengths("a"), Some((4, 4)));
    }

    #[test]
    fn circles_and_giants_have_no_length() {
        let formats = formats(&[
            "a:b[2] b",
            "b:a[4] a",
            "c:d[65535] d",
            "d:e[65535] e",
            "e:double[65535] x",
            "f:missing m;float x",
        ]);
        for name in ["a", "b", "c", "d", "e", "f", "nothing"] {
            assert_eq!(formats.lengths(name), None, "{name}");
        }
        assert_eq!(formats.field("f", "x"), None);
    }

    #[test]
    fn formats_within_formats_are_not_counted_without_end() {
        // 4^6 fields, and with what is above them more than are looked at.
        let texts: Vec<String> = (0..6)
            .map(|i| format!("f{i}:{}", format!("f{} a;", i + 1).repeat(4)))
            .chain(["f6:char a".to_owned()])
            .collect();
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let formats = formats(&texts);
        assert_eq!(formats.lengths("f0"), None);
        assert_eq!(formats.lengths("f2"), Some((256, 256)));
    }

    #[test]
    fn numbers_of_every_type_are_read() {
        let read = |scalar, bytes: &[u8]| Field { scalar, offset: 1, count: 1 }.read(bytes);
        assert_eq!(read(Scalar::I8, &[0, 0xff]), Some(-1.0));
        assert_eq!(read(Scalar::U8, &[0, 0xff]), Some(255.0));
        assert_eq!(read(Scalar::I16, &[0, 0xfe, 0xff]), Some(-2.0));
        assert_eq!(read(Scalar::U16, &[0, 1, 2]), Some(513.0));
        assert_eq!(read(Scalar::I32, &[0, 0xff, 0xff, 0xff, 0xff]), Some(-1.0));
        assert_eq!(read(Scalar::U32, &[0, 1, 0, 0, 1]), Some(16_777_217.0));
        assert_eq!(read(Scalar::F32, &[0, 0, 0, 0x80, 0x3f]), Some(1.0));
        assert_eq!(read(Scalar::I64, &[0; 9]), Some(0.0));
        assert_eq!(read(Scalar::U64, &[0; 9]), Some(0.0));
        assert_eq!(read(Scalar::F64, &[0; 9]), Some(0.0));
        assert_eq!(read(Scalar::F64, &[0; 8]), None);
    }
}
