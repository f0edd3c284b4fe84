//! Arrays as columns: which there are, where their numbers stand, and what they mean.

use std::path::Path;

use super::archive::{self, Member};
use super::header::{Field, Header};
use super::scalar::Scalar;
use crate::error::Error;
use crate::recording::ReadOptions;
use crate::recording::csv::columns::Columns;
use crate::recording::input::Input;

/// An array and its name in the archive; a single one has none.
pub struct Array {
    /// Its name.
    pub name: String,
    /// Its type, shape and order.
    pub header: Header,
    /// Where it is in the archive.
    pub member: Option<Member>,
}

/// A column that arrays have.
pub struct Candidate {
    /// Its name.
    pub name: String,
    /// The array that it is in.
    pub array: usize,
    /// Bytes of the array's data before the first record.
    pub before: u64,
    /// Bytes of a record.
    pub stride: usize,
    /// Where in a record it stands.
    pub at: usize,
    /// Its type, or what NumPy calls it where it is none we read.
    pub scalar: Result<Scalar, String>,
    /// How many records there are.
    pub rows: u64,
}

/// The arrays of an archive with their headers.
///
/// # Errors
/// When one cannot be read.
pub fn members(path: &Path) -> Result<Vec<Array>, Error> {
    let mut arrays = Vec::new();
    for member in archive::list(path)? {
        let mut input = Input::pipe(path, Box::new(member.open(path)?));
        let name = format!("array {} of {}", member.name, path.display());
        let header = Header::read(&mut input, &name)?;
        arrays.push(Array { name: member.name.clone(), header, member: Some(member) });
    }
    Ok(arrays)
}

impl Array {
    /// The columns that it has.
    pub fn columns(&self, array: usize) -> Vec<Candidate> {
        /// More are no table of an IMU.
        const MOST: u64 = 1000;
        let header = &self.header;
        let record = header.record;
        let own = |suffix: &str| match (self.name.as_str(), suffix) {
            (name, "") => name.to_owned(),
            ("", suffix) => suffix.to_owned(),
            (name, suffix) => format!("{name}_{suffix}"),
        };
        let plain = header.fields.first().filter(|field| field.name.is_empty());
        match (header.shape.as_slice(), plain) {
            // A list of numbers, or of structures.
            ([rows], _) => {
                let of = |field: &Field| Candidate {
                    name: own(&field.name),
                    array,
                    before: 0,
                    stride: record,
                    at: field.at,
                    scalar: field.scalar.clone(),
                    rows: *rows,
                };
                header.fields.iter().map(of).collect()
            }
            ([first, second], Some(field)) => {
                // Seven rows of any length are seven columns, stored one after the other.
                let turned = matches!(first, 3..=8) && *second > 8;
                let (rows, columns) = if turned { (*second, *first) } else { (*first, *second) };
                let one_by_one = header.fortran != turned;
                let of = |column: u64| {
                    let (bytes, width) = (record as u64, columns.saturating_mul(record as u64));
                    let (before, stride, at) = if one_by_one {
                        (column.saturating_mul(rows).saturating_mul(bytes), bytes, 0)
                    } else {
                        (0, width, column.saturating_mul(bytes))
                    };
                    let suffix = match (columns, column) {
                        (3, 0) => "x".to_owned(),
                        (3, 1) => "y".to_owned(),
                        (3, 2) => "z".to_owned(),
                        (1, _) => String::new(),
                        (_, column) => (column + 1).to_string(),
                    };
                    Candidate {
                        name: own(&suffix),
                        array,
                        before,
                        stride: usize::try_from(stride).unwrap_or(usize::MAX),
                        at: usize::try_from(at).unwrap_or(usize::MAX),
                        scalar: field.scalar.clone(),
                        rows,
                    }
                };
                (0..columns.min(MOST)).map(of).collect()
            }
            _ => Vec::new(),
        }
    }
}

/// What the columns are: as the user says, by their names, or by custom.
///
/// # Errors
/// When that cannot be told.
pub fn columns(
    candidates: &[Candidate],
    arrays: &[Array],
    options: &ReadOptions,
    name: &str,
) -> Result<Columns, Error> {
    let is_object = |c: &Candidate| matches!(&c.scalar, Err(kind) if kind.ends_with('O'));
    if !candidates.is_empty() && candidates.iter().all(is_object) {
        return Err(Error::data(format!(
            "{name} holds '|O', objects of Python, which cannot be read: save it as numbers, with \
             array.astype(float)"
        )));
    }
    let names: Vec<&[u8]> = candidates.iter().map(|c| c.name.as_bytes()).collect();
    if let Some(map) = &options.map {
        return Columns::from_map(map, &names)
            .map_err(|what| Error::usage(format!("--map does not fit {name}: {what}")));
    }
    if let Some(spec) = &options.columns {
        let found =
            Columns::from_spec(spec).map_err(|e| Error::usage(format!("--columns: {e}")))?;
        if found.columns.len() > names.len() {
            return Err(Error::usage(format!(
                "--columns names {} columns where {name} has {}",
                found.columns.len(),
                names.len()
            )));
        }
        return Ok(found);
    }
    let shapes = || {
        let shape = |array: &Array| match array.name.as_str() {
            "" => format!("{:?}", array.header.shape),
            name => format!("{name} {:?}", array.header.shape),
        };
        arrays.iter().map(shape).collect::<Vec<_>>().join(", ")
    };
    match arrays {
        [array] if array.header.shape.len() == 2 => {
            let customary = Columns::customary();
            if names.len() == customary.columns.len() {
                return Ok(customary);
            }
            Err(Error::data(format!(
                "{name} has {} columns (its shape is {}): say what they are with --columns, such \
                 as t,gx,gy,gz,ax,ay,az",
                names.len(),
                shapes()
            )))
        }
        _ => Columns::from_names(&names, None).map_err(|what| {
            Error::data(format!(
                "in {name} {what}: it holds {}; name them with --map t=NAME,gx=NAME_x,…",
                shapes()
            ))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_of_any_size_have_columns() {
        let field = Field { name: String::new(), at: 0, scalar: Err("V".into()) };
        for record in [1 << 62, usize::MAX] {
            for fortran in [false, true] {
                let fields = vec![field.clone()];
                let header = Header { shape: vec![5, 7], fortran, record, fields, len: 0 };
                let array = Array { name: String::new(), header, member: None };
                let columns = array.columns(0);
                assert_eq!(columns.len(), 7);
                assert!(columns.iter().all(|column| column.stride >= record));
            }
        }
    }
}
