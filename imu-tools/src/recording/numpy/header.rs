//! The header of an array: its type, shape and order.

use super::literal::Literal;
use super::scalar::Scalar;
use crate::error::Error;
use crate::recording::input::{Input, LARGEST_PIECE};

/// How every array begins.
pub const MAGIC: &[u8] = b"\x93NUMPY";

/// What the header of an array says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// Lengths along its axes.
    pub shape: Vec<u64>,
    /// The first index changes fastest.
    pub fortran: bool,
    /// Bytes of an element.
    pub record: usize,
    /// The numbers in an element; one without a name where elements are numbers.
    pub fields: Vec<Field>,
    /// Bytes of the header itself.
    pub len: u64,
}

/// A number in an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name, with `_x`, `_y`, `_z` where the field is three numbers.
    pub name: String,
    /// Where it begins.
    pub at: usize,
    /// Its type, or what NumPy calls it where it is none we read.
    pub scalar: Result<Scalar, String>,
}

impl Header {
    /// Reads the header at the start of `input`.
    ///
    /// # Errors
    /// When there is none, or it is damaged; `name` is what the array is called.
    pub fn read(input: &mut Input, name: &str) -> Result<Self, Error> {
        input.fill(12)?;
        let (lengths, text_at): (&[u8], usize) = match input.at_hand() {
            start if !start.starts_with(MAGIC) => {
                return Err(Error::data(format!("{name} is no NumPy array")));
            }
            [_, _, _, _, _, _, 1, _, a, b, ..] => (&[*a, *b], 10),
            [_, _, _, _, _, _, 2 | 3, _, a, b, c, d, ..] => (&[*a, *b, *c, *d], 12),
            [_, _, _, _, _, _, major, ..] => {
                return Err(Error::data(format!(
                    "{name} is a NumPy array of format {major}: formats 1 to 3 are read"
                )));
            }
            _ => return Err(Error::data(format!("{name} is cut off in its header"))),
        };
        let length = lengths.iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte));
        let end = text_at.saturating_add(length);
        if end > LARGEST_PIECE {
            return Err(Error::data(format!(
                "{name} is damaged: its header claims {length} bytes"
            )));
        }
        if !input.fill(end)? {
            return Err(Error::data(format!("{name} is cut off in its header")));
        }
        let text = input.at_hand().get(text_at..end).unwrap_or_default();
        let header = Self::of(text, end as u64)
            .map_err(|what| Error::data(format!("{name} cannot be read: {what}")))?;
        input.consume(end);
        Ok(header)
    }

    fn of(text: &[u8], len: u64) -> Result<Self, String> {
        let literal = Literal::parse(text).ok_or("its header is damaged")?;
        let get = |key: &str| literal.get(key).ok_or_else(|| format!("its header has no {key}"));
        let Literal::Bool(fortran) = *get("fortran_order")? else {
            return Err("its header's fortran_order is neither True nor False".into());
        };
        let Literal::List(shape) = get("shape")? else {
            return Err("its header's shape is no list".into());
        };
        let shape = shape.iter().map(|axis| match axis {
            Literal::Number(length) => Ok(*length),
            _ => Err("its shape is damaged".to_owned()),
        });
        let shape = shape.collect::<Result<_, _>>()?;
        let (fields, record) = match get("descr")? {
            Literal::Text(kind) => {
                let (scalar, size) = typed(kind)?;
                (vec![Field { name: String::new(), at: 0, scalar }], size)
            }
            Literal::List(fields) => structure(fields)?,
            _ => return Err("its type is damaged".into()),
        };
        Ok(Self { shape, fortran, record, fields, len })
    }
}

/// The fields of a structure and its size.
fn structure(list: &[Literal]) -> Result<(Vec<Field>, usize), String> {
    let (mut fields, mut at) = (Vec::new(), 0_usize);
    for field in list {
        let Literal::List(parts) = field else { return Err("its type is damaged".into()) };
        let (name, kind, shape) = match parts.as_slice() {
            [Literal::Text(name), Literal::Text(kind)] => (name, kind, 1),
            [Literal::Text(name), Literal::Text(kind), Literal::List(shape)] => {
                match shape.as_slice() {
                    [Literal::Number(count)] => (name, kind, *count),
                    _ => return Err(format!("its field '{name}' has more than one axis")),
                }
            }
            _ => return Err("its type has fields in fields: save a flat one".into()),
        };
        let (scalar, size) = typed(kind)?;
        let total = usize::try_from(shape).ok().and_then(|count| count.checked_mul(size));
        let end = total.and_then(|total| at.checked_add(total)).filter(|&n| n <= LARGEST_PIECE);
        let end = end.ok_or("an element of it is larger than a megabyte")?;
        let axes: &[&str] = match (parts.len(), shape) {
            (3, 3) => &["_x", "_y", "_z"],
            (2, _) => &[""],
            _ => &[],
        };
        for (index, axis) in axes.iter().enumerate() {
            fields.push(Field {
                name: format!("{name}{axis}"),
                at: at + index * size,
                scalar: scalar.clone(),
            });
        }
        at = end;
    }
    Ok((fields, at))
}

/// A type of number, or the name of what can only be passed over, and its size.
fn typed(kind: &str) -> Result<(Result<Scalar, String>, usize), String> {
    if let Some(scalar) = Scalar::named(kind) {
        return Ok((Ok(scalar), scalar.size));
    }
    // |S12 is 12 bytes, <U3 is 3 characters of 4.
    let count = || kind.get(2..).and_then(|count| count.parse::<usize>().ok());
    let size = match kind.get(1..2) {
        Some("S" | "a" | "V" | "b" | "f" | "c") => count(),
        Some("U") => count().and_then(|count| count.checked_mul(4)),
        // Python's own objects, which stand elsewhere.
        Some("O") => Some(8),
        _ => None,
    };
    let size = size.ok_or_else(|| format!("it holds '{kind}', which is no type of NumPy's"))?;
    Ok((Err(kind.to_owned()), size))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn read(version: u8, text: &str) -> Result<Header, Error> {
        let length = text.len();
        let mut bytes = [MAGIC, &[version, 0]].concat();
        match version {
            1 => bytes.extend((length as u16).to_le_bytes()),
            _ => bytes.extend((length as u32).to_le_bytes()),
        }
        bytes.extend(text.as_bytes());
        bytes.extend([0; 16]);
        let stream = Box::new(std::io::Cursor::new(bytes));
        Header::read(&mut Input::pipe(Path::new("a"), stream), "a")
    }

    #[test]
    fn all_versions() {
        for version in 1..=3 {
            let text = "{'descr': '<f8', 'fortran_order': True, 'shape': (5, 7), }\n";
            let header = read(version, text).unwrap();
            assert_eq!((header.shape, header.fortran, header.record), (vec![5, 7], true, 8));
        }
        assert!(read(4, "").unwrap_err().to_string().contains("format 4"));
    }

    #[test]
    fn structures() {
        let text = "{'descr': [('name', '<U3'), ('t', '>i8'), ('gyro', '<f4', (3,)), ('m', '<f8', \
                    (9,))], 'fortran_order': False, 'shape': (5,)}";
        let header = read(1, text).unwrap();
        assert_eq!(header.record, 12 + 8 + 12 + 72);
        let places: Vec<(&str, usize)> =
            header.fields.iter().map(|field| (field.name.as_str(), field.at)).collect();
        let gyro = [("gyro_x", 20), ("gyro_y", 24), ("gyro_z", 28)];
        assert_eq!(places, [&[("name", 0), ("t", 12)][..], &gyro].concat());
    }

    #[test]
    fn claims_and_damage() {
        for (text, part) in [
            ("{'descr': '<q', 'fortran_order': False, 'shape': ()}", "'<q'"),
            (
                "{'descr': [('a', '<f8', (999999999999,))], 'fortran_order': False, 'shape': (1,)}",
                "megabyte",
            ),
            ("{'descr': [('a', [('b', '<f8')])], 'fortran_order': False, 'shape': (1,)}", "flat"),
            ("{'descr': '<f8', 'shape': (1,)}", "fortran_order"),
            ("rubbish", "damaged"),
        ] {
            let error = read(1, text).unwrap_err();
            assert!(error.to_string().contains(part), "{error}");
        }
        let claim = [MAGIC, &[2, 0, 0xff, 0xff, 0xff, 0xff]].concat();
        let stream = Box::new(std::io::Cursor::new(claim));
        let error = Header::read(&mut Input::pipe(Path::new("a"), stream), "a").unwrap_err();
        assert!(error.to_string().contains("claims 4294967295 bytes"), "{error}");
    }
}
