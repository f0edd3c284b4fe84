//! What the start of a table tells: where its rows begin, how they are written, what they mean.

use std::path::Path;

use super::celsius::Celsius;
use super::columns::{Column, Columns};
use super::dialect::{Dialect, Separator, pointed};
use super::granted::Granted;
use super::increments::Increments;
use super::{beside, date, number};
use crate::error::Error;
use crate::recording::sensor::Sensor;
use crate::recording::{Note, ReadOptions, SampleKind};

/// How to read the rows of a table.
pub struct Layout {
    /// How they are written.
    pub dialect: Dialect,
    /// What ends them: LF, or CR where there is no LF.
    pub line_end: u8,
    /// What their fields mean.
    pub columns: Vec<Column>,
    /// How their time is written.
    pub time: Time,
    /// Factor to rad/s.
    pub rate: f64,
    /// Factor to m/s².
    pub force: f64,
    /// Scale of temperature.
    pub celsius: Celsius,
    /// Lines before the first row.
    pub lines_before: u64,
    /// Bytes before it.
    pub bytes_before: usize,
    /// What the header says of the samples; nothing where the user says what the columns are.
    pub samples: Option<SampleKind>,
    /// What makes means of increments.
    pub increments: Increments,
    /// Names of columns that are not taken; empty where there are none.
    pub not_taken: String,
    /// What was taken for granted.
    pub notes: Vec<Note>,
}

/// How time is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Time {
    /// A number of units of 10^this ns.
    Number(u32),
    /// A date, a time of day, or both.
    Text,
}

impl Time {
    /// Nanoseconds of a field.
    pub fn nanoseconds(self, dialect: Dialect, field: &[u8]) -> Option<i64> {
        match self {
            Self::Text => date::stamp(field),
            Self::Number(exponent) if dialect.decimal_comma => {
                number::nanoseconds(&pointed(field), exponent)
            }
            Self::Number(exponent) => number::nanoseconds(field, exponent),
        }
    }
}

/// Whether a line is no row: empty, or a comment.
pub fn is_aside(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start().first(), None | Some(b'#' | b'%'))
}

/// Fields that are a number or a date, when the first of the line is one; else 0.
fn numbers(line: &[u8]) -> usize {
    let dialect = Dialect::of(line);
    let is_number = |field: &&[u8]| dialect.value(field).is_some() || date::stamp(field).is_some();
    let mut fields = dialect.fields(line).filter(|field| !field.is_empty());
    match fields.next() {
        Some(first) if is_number(&first) => 1 + fields.filter(is_number).count(),
        _ => 0,
    }
}

/// Time and three axes.
const FEWEST: usize = 4;

/// The lines of the start of a table, and what is before the first row.
struct Start<'a> {
    /// Lines that are no rows, and not empty.
    headers: Vec<&'a [u8]>,
    /// The first row and what follows it; the last may be cut.
    rows: Vec<&'a [u8]>,
    lines_before: u64,
    bytes_before: usize,
}

impl<'a> Start<'a> {
    fn of(bytes: &'a [u8], line_end: u8) -> Option<Self> {
        let bom = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        let text = bytes.get(bom..).unwrap_or_default();
        let lines: Vec<&[u8]> =
            text.split(|&b| b == line_end).map(|line| line.trim_ascii_end()).collect();
        let row = |fewest: usize| {
            lines.iter().position(|line| !is_aside(line) && numbers(line) >= fewest)
        };
        // What begins with a number may be a line of a preamble, or a row that lacks columns.
        let first = row(FEWEST).or_else(|| row(1))?;
        let (before, rows) = lines.split_at(first);
        let ends = text.split(|&b| b == line_end).take(first).map(|line| line.len() + 1);
        Some(Self {
            headers: before.iter().copied().filter(|line| !line.is_empty()).collect(),
            rows: rows.to_vec(),
            lines_before: first as u64,
            bytes_before: bom + ends.sum::<usize>(),
        })
    }

    /// The names in the first header of this width; none where there is no such.
    fn names(&self, dialect: Dialect, width: usize) -> Vec<&'a [u8]> {
        let mut all = self.headers.iter().map(|header| names(header, dialect));
        all.find(|names| names.len() == width).unwrap_or_default()
    }
}

/// The error for a file without a row: its numbers may begin with a date that nobody understands.
fn no_rows(bytes: &[u8], line_end: u8, path: &Path) -> Error {
    let name = path.display();
    for (at, line) in bytes.split(|&b| b == line_end).enumerate() {
        let field = Dialect::of(line).fields(line).next().unwrap_or_default();
        if date::is_unknown(field) {
            return Error::data(format!(
                "line {} of {name} begins with '{}', a date that can be read in two ways or none: \
                 write 2024-12-31 13:00:00.5, 2024/12/31 13:00:00.5, 31.12.2024 13:00:00.5, the \
                 same with a T between, or a number",
                at + 1,
                String::from_utf8_lossy(field)
            ));
        }
    }
    Error::data(format!("{name} holds no row of numbers"))
}

/// Refuses a table of several IMUs, unless somebody said which columns are meant; a survey takes the
/// first of them and has something to tell.
fn several(names: &[&[u8]], path: &Path, options: &ReadOptions) -> Result<Option<Note>, Error> {
    if options.map.is_some() || options.columns.is_some() {
        return Ok(None);
    }
    let Some(listed) = beside::several_imus(names, sensor_by_name(path)) else { return Ok(None) };
    let several = format!("{} has columns of several IMUs: {listed}", path.display());
    if options.survey {
        let taken = format!("{several}; the first are read, --map t=NAME,gx=NAME,… reads others");
        return Ok(Some(Note::Warning(taken)));
    }
    Err(Error::usage(format!(
        "{several}; choose with --map t=NAME,gx=NAME,… or --columns t,gx,gy,gz,ax,ay,az,-,…"
    )))
}

impl Layout {
    /// Finds it out from the first bytes of the file.
    ///
    /// # Errors
    /// When there is no row of numbers, or its columns cannot be told.
    pub fn find(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Self, Error> {
        let name = path.display();
        let line_end =
            if bytes.contains(&b'\n') || !bytes.contains(&b'\r') { b'\n' } else { b'\r' };
        let Some(start) = Start::of(bytes, line_end) else {
            return Err(no_rows(bytes, line_end, path));
        };
        let first = start.rows.first().copied().unwrap_or_default();
        let mut dialect = Dialect::of(first);
        // A first row of whole numbers does not show its decimal point.
        if !dialect.decimal_comma && dialect.separator != Separator::Byte(b',') {
            let rows = start.rows.iter().take(100);
            dialect.decimal_comma = rows.map(|row| Dialect::of(row)).any(|d| d.decimal_comma);
        }
        let mut found = columns(&start, dialect, path, options)?;
        let fields: Vec<&[u8]> = dialect.fields(first).collect();
        if fields.len() < found.columns.len() {
            return Err(Error::data(format!(
                "line {} of {name} has {} columns where {} are needed (time, gyroscope x y z, \
                 accelerometer x y z): name them with --columns or --map",
                start.lines_before + 1,
                fields.len(),
                found.columns.len()
            )));
        }
        let names = start.names(dialect, fields.len());
        let several = several(&names, path, options)?;
        let time_at = found.columns.iter().position(|c| *c == Column::Time);
        let is_text = |at: usize| {
            let field = fields.get(at).copied().unwrap_or_default();
            dialect.value(field).is_none() && date::stamp(field).is_some()
        };
        let mut layout = Self {
            dialect,
            line_end,
            columns: Vec::new(),
            time: Time::Text,
            rate: 1.0,
            force: 1.0,
            celsius: found.celsius,
            lines_before: start.lines_before,
            bytes_before: start.bytes_before,
            samples: match options.columns {
                Some(_) => None,
                None => beside::samples(&names, &found.columns),
            },
            increments: Increments::of(&found, name.to_string()),
            not_taken: beside::not_taken(&names, &found.columns, &fields),
            notes: several.into_iter().collect(),
        };
        let name = name.to_string();
        let header = format!("the header of {name}");
        let mut granted = Granted::new(&found, options, &name, &header);
        if let Some(time_at) = time_at.filter(|at| !is_text(*at)) {
            let times = layout.times(&start, time_at);
            let times: Vec<&[u8]> = times.iter().map(Vec::as_slice).collect();
            layout.time = Time::Number(granted.time(options.time_unit, &times)?.exponent());
        }
        let (factors, notes) = granted.sensors()?;
        (layout.rate, layout.force) = (factors.rate, factors.force);
        layout.notes.extend(notes);
        layout.notes.extend(layout.increments.remark());
        if layout.time != Time::Text {
            // A day beside a number is no part of it.
            for column in found.columns.iter_mut().filter(|c| **c == Column::Date) {
                *column = Column::Other;
            }
        }
        layout.columns = found.columns;
        Ok(layout)
    }

    /// The first times, with a decimal point.
    fn times(&self, start: &Start<'_>, time_at: usize) -> Vec<Vec<u8>> {
        // The last line at hand is empty, or may be cut.
        let rows = start.rows.get(..start.rows.len().saturating_sub(1).max(1)).unwrap_or_default();
        let rows = rows.iter().filter(|line| !is_aside(line));
        rows.filter_map(|line| self.dialect.fields(line).nth(time_at))
            .map(|field| if self.dialect.decimal_comma { pointed(field) } else { field.to_vec() })
            .collect()
    }
}

/// What the columns are: as the user says, as a header says, or as is the custom.
fn columns(
    start: &Start<'_>,
    dialect: Dialect,
    path: &Path,
    options: &ReadOptions,
) -> Result<Columns, Error> {
    let first = start.rows.first().copied().unwrap_or_default();
    let width = dialect.fields(first).count();
    if let Some(map) = &options.map {
        return mapped(start, dialect, width, map).map_err(|what| {
            Error::usage(format!("--map does not fit {}: {what}", path.display()))
        });
    }
    if let Some(spec) = &options.columns {
        return Columns::from_spec(spec).map_err(|e| Error::usage(format!("--columns: {e}")));
    }
    if let Some(found) = from_headers(start, dialect, sensor_by_name(path)) {
        return found.map_err(|what| {
            Error::data(format!(
                "in the header of {} {what}: name its columns with --map t=NAME,gx=NAME,… or \
                 --columns t,gx,gy,gz,ax,ay,az",
                path.display()
            ))
        });
    }
    let frame = dialect.fields(first).nth(2);
    let is_echo = width == 40 && frame.is_some_and(|frame| number::value(frame).is_none());
    Ok(if is_echo { Columns::of_ros2_echo() } else { Columns::customary() })
}

/// The names in a header line.
fn names(header: &[u8], dialect: Dialect) -> Vec<&[u8]> {
    let header = header.trim_ascii_start();
    let header = header.strip_prefix(b"\xef\xbb\xbf").unwrap_or(header);
    // Names may be separated in another way than numbers: by a comma and a blank, say.
    let own = Dialect::of(header).separator;
    let separator = if own == Separator::Blanks { own } else { dialect.separator };
    let header = match header {
        [b'#' | b'%', names @ ..] => names,
        names => names,
    };
    Dialect { separator, ..dialect }.fields(header).collect()
}

/// The columns that the user's map picks from the header with the most names.
fn mapped(start: &Start<'_>, dialect: Dialect, width: usize, map: &str) -> Result<Columns, String> {
    let mut failed = None;
    for (at, header) in start.headers.iter().enumerate().rev() {
        let names = names(header, dialect);
        match Columns::from_map(map, &names) {
            Ok(mut found) => {
                hear_units(&mut found, start, at, dialect);
                return Ok(found);
            }
            // The error that helps is that of the line as long as the rows.
            Err(what) if failed.is_none() || names.len() == width => failed = Some(what),
            Err(_) => {}
        }
    }
    Err(failed.unwrap_or_else(|| "it has no header with names; use --columns".into()))
}

/// Takes in the rows of units between header `at` and the data.
fn hear_units(found: &mut Columns, start: &Start<'_>, at: usize, dialect: Dialect) {
    for units in start.headers.iter().skip(at + 1) {
        found.hear_units(&names(units, dialect));
    }
}

/// The columns that one of the header lines names, the nearest to the data first; `None` without
/// a header.
fn from_headers(
    start: &Start<'_>,
    dialect: Dialect,
    hint: Option<Sensor>,
) -> Option<Result<Columns, String>> {
    let mut first = None;
    for (at, header) in start.headers.iter().enumerate().rev() {
        let names = names(header, dialect);
        match Columns::from_names(&names, hint) {
            Ok(mut found) => {
                hear_units(&mut found, start, at, dialect);
                return Some(Ok(found));
            }
            // A comment of one sentence is no header, and neither is a line of a preamble.
            Err(_) if is_aside(header) || names.len() < FEWEST => {}
            Err(what) => first = first.or(Some(what)),
        }
    }
    first.map(Err)
}

/// The sensor that a file is of by its name, such as `Gyroscope.csv`.
fn sensor_by_name(path: &Path) -> Option<Sensor> {
    let name = path.file_name()?.to_string_lossy().to_lowercase();
    match (name.contains("gyr"), name.contains("acc")) {
        (true, false) => Some(Sensor::Gyroscope),
        (false, true) => Some(Sensor::Accelerometer),
        _ => None,
    }
}
