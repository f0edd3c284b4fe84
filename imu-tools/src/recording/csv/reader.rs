//! Reading a CSV row by row.

use super::columns::{Column, Columns, Separator};
use super::{number, time_unit};
use crate::error::Error;
use crate::recording::input::{Input, LARGEST_PIECE};
use crate::recording::{
    BLOCK_SAMPLES, Block, ForceUnit, Note, RateUnit, ReadOptions, Sample, Source, Stream, TimeUnit,
};

/// So much of the start is looked at to understand the table.
const AHEAD: usize = 64 * 1024;

/// A CSV being read.
pub struct CsvReader {
    input: Input,
    separator: Separator,
    columns: Vec<Column>,
    /// Power of ten between the time column and nanoseconds.
    exponent: u32,
    /// Factors to SI units.
    rate: f64,
    force: f64,
    /// Lines taken so far.
    line: u64,
    /// Of them, those that can be read.
    rows: u64,
    gyroscope: String,
    accelerometer: String,
    notes: Vec<Note>,
}

/// What three fields of a sensor hold.
#[derive(Clone, Copy)]
struct Triple {
    value: [f64; 3],
    /// Some field was not empty.
    present: bool,
}

/// Why a row cannot be read: the column (from 1) and what is wrong with it.
struct Fault {
    column: usize,
    what: String,
}

/// Whether a line is no row: empty, or a comment.
fn is_aside(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start().first(), None | Some(b'#' | b'%'))
}

/// Whether a line is a row of numbers: its first field that is not empty is one.
fn is_row(line: &[u8]) -> bool {
    let first = Separator::of(line).split(line).find(|field| !field.is_empty());
    first.is_some_and(|field| number::value(field).is_some())
}

impl CsvReader {
    /// Starts to read: finds out what the columns are.
    ///
    /// # Errors
    /// When there is no row of numbers, or its columns cannot be told.
    pub fn open(mut input: Input, options: &ReadOptions) -> Result<Self, Error> {
        let path = input.path().display().to_string();
        if options.topic.is_some() || options.bag_time {
            return Err(Error::usage(format!(
                "{path} is no bag: --topic and --bag-time are for bags, --columns is for tables"
            )));
        }
        input.fill(AHEAD)?;
        let start = input.at_hand().strip_prefix(b"\xef\xbb\xbf").unwrap_or(input.at_hand());
        let bom = input.at_hand().len() - start.len();
        let mut lines = start.split(|&b| b == b'\n').map(|line| line.trim_ascii_end());
        let mut headers = Vec::new();
        let mut aside = 0;
        let first = loop {
            match lines.next() {
                Some(line) if !is_aside(line) && is_row(line) => break line,
                Some(line) => {
                    aside += 1;
                    if !line.is_empty() {
                        headers.push(line);
                    }
                }
                None => {
                    let old = !start.contains(&b'\n') && start.contains(&b'\r');
                    let why = if old { ": its lines end in CR alone; end them in LF" } else { "" };
                    return Err(Error::data(format!("{path} holds no row of numbers{why}")));
                }
            }
        };
        let separator = Separator::of(first);
        let found = if let Some(spec) = &options.columns {
            Columns::from_spec(spec).map_err(|e| Error::usage(format!("--columns: {e}")))?
        } else if let Some(found) = from_headers(&headers, separator) {
            found.map_err(|what| {
                Error::data(format!(
                    "in the header of {path} {what}: name its columns with \
                     --columns, such as t,gx,gy,gz,ax,ay,az"
                ))
            })?
        } else {
            Columns::customary()
        };
        let here = separator.split(first).count();
        let needed = found.columns.len();
        if here < needed {
            return Err(Error::data(format!(
                "line {} of {path} has {here} columns where {needed} are needed (time, \
                 gyroscope x y z, accelerometer x y z): name them with --columns",
                aside + 1
            )));
        }
        let time_at = found.columns.iter().position(|c| *c == Column::Time).unwrap_or(0);
        let times: Vec<&[u8]> = std::iter::once(first)
            .chain(lines)
            .filter(|line| !is_aside(line))
            .filter_map(|line| separator.split(line).nth(time_at))
            .collect();
        // The last line at hand may be cut.
        let whole = times.len().saturating_sub(1).max(1);
        let of_data = || time_unit::from_data(times.get(..whole).unwrap_or_default());
        let time = found.time.unless(options.time_unit);
        let time = time.map_err(|what| unclear(&path, what, "--time-unit"))?;
        let time = time.map_or_else(|| (of_data(), true), |unit| (unit, false));
        let at_hand = times.get(..whole).unwrap_or_default();
        if let Some(rate) = time_unit::implausible_rate(at_hand, time.0) {
            return Err(Error::data(format!(
                "{path} would have {rate:.2e} samples a second with time in {}: name the unit of \
                 its time with --time-unit",
                time.0.symbol()
            )));
        }
        let names = |column: fn(u8) -> Column| {
            let at = found.columns.iter().position(|c| *c == column(0));
            at.map_or_else(String::new, |at| format!("columns from {}", at + 1))
        };
        let mut csv = Self {
            separator,
            exponent: time.0.exponent(),
            rate: 1.0,
            force: 1.0,
            line: aside,
            rows: 0,
            gyroscope: names(Column::Rate),
            accelerometer: names(Column::Force),
            notes: Vec::new(),
            columns: Vec::new(),
            input,
        };
        csv.take_units(&path, options, &found, time)?;
        csv.columns = found.columns;
        csv.input.consume(bom);
        for _ in 0..aside {
            let len = csv.next_line()?.unwrap_or(0);
            csv.input.consume(len);
        }
        Ok(csv)
    }

    /// Sets the factors and tells what was taken for granted.
    fn take_units(
        &mut self,
        path: &str,
        options: &ReadOptions,
        found: &Columns,
        (time, guessed): (TimeUnit, bool),
    ) -> Result<(), Error> {
        let mut told = Vec::new();
        if guessed {
            told.push(format!("time as {}", time.symbol()));
        }
        let rate = found.rate.unless(options.gyro_unit);
        let rate = rate.map_err(|what| unclear(path, what, "--gyro-unit"))?;
        let force = found.force.unless(options.accel_unit);
        let force = force.map_err(|what| unclear(path, what, "--accel-unit"))?;
        if found.has(Column::Rate(0)) {
            if rate.is_none() {
                told.push("angular rate as rad/s (--gyro-unit)".into());
            }
        } else {
            self.notes.push(Note::Warning(format!("{path} has no columns of a gyroscope")));
        }
        if found.has(Column::Force(0)) {
            if force.is_none() {
                told.push("specific force as m/s^2 (--accel-unit)".into());
            }
        } else {
            self.notes.push(Note::Warning(format!("{path} has no columns of an accelerometer")));
        }
        if !told.is_empty() {
            self.notes.push(Note::Info(format!("{path} is read with {}", told.join(", "))));
        }
        self.rate = rate.unwrap_or(RateUnit::RadPerS).to_rad_s();
        self.force = force.unwrap_or(ForceUnit::MPerS2).to_m_s2();
        Ok(())
    }

    /// Length of the next line with its end, all of it at hand; `None` at the end of the file.
    #[inline]
    fn next_line(&mut self) -> Result<Option<usize>, Error> {
        let mut seen = 0;
        loop {
            let bytes = self.input.at_hand();
            let unseen = bytes.get(seen..).unwrap_or_default();
            if let Some(end) = memchr::memchr(b'\n', unseen) {
                return Ok(Some(seen + end + 1));
            }
            seen = bytes.len();
            if seen >= LARGEST_PIECE {
                return Err(Error::data(format!(
                    "line {} of {} is longer than a megabyte: this is no table of numbers",
                    self.line + 1,
                    self.input.path().display()
                )));
            }
            if !self.input.fill(seen + 1)? {
                return Ok((seen > 0).then_some(seen));
            }
        }
    }

    /// Takes the row in the next `len` bytes.
    #[inline]
    fn row(&self, len: usize, block: &mut Block) -> Result<(), Fault> {
        let line = self.input.at_hand().get(..len).unwrap_or_default();
        let line = match line {
            [line @ .., b'\r', b'\n'] | [line @ .., b'\n'] => line,
            line => line,
        };
        if is_aside(line) {
            return Ok(());
        }
        let mut stamp_ns = 0;
        let empty = Triple { value: [f64::NAN; 3], present: false };
        let (mut rate, mut force) = (empty, empty);
        let mut fields = self.separator.split(line);
        for (at, &column) in self.columns.iter().enumerate() {
            let Some(field) = fields.next() else {
                let needed = self.columns.len();
                return Err(Fault {
                    column: at + 1,
                    what: format!("the row has {at} columns where {needed} are needed"),
                });
            };
            let no_number = |what: &str| Fault {
                column: at + 1,
                what: format!("'{}' is no {what}", String::from_utf8_lossy(excerpt(field))),
            };
            let (triple, axis, unit) = match column {
                Column::Other => continue,
                Column::Time => {
                    stamp_ns = number::nanoseconds(field, self.exponent)
                        .ok_or_else(|| no_number("time"))?;
                    continue;
                }
                Column::Rate(axis) => (&mut rate, axis, self.rate),
                Column::Force(axis) => (&mut force, axis, self.force),
            };
            if field.is_empty() {
                continue;
            }
            triple.present = true;
            let value = number::value(field).ok_or_else(|| no_number("number"))?;
            if let Some(place) = triple.value.get_mut(usize::from(axis)) {
                *place = value * unit;
            }
        }
        if rate.present {
            block.gyroscope.push(Sample { stamp_ns, value: rate.value });
        }
        if force.present {
            block.accelerometer.push(Sample { stamp_ns, value: force.value });
        }
        Ok(())
    }

    /// The error for a row that cannot be read, unless it is the last one and cut off.
    fn faulty(&mut self, len: usize, Fault { column, what }: Fault) -> Result<(), Error> {
        let path = self.input.path().display();
        let line = self.input.at_hand().get(..len).unwrap_or_default();
        if line.ends_with(b"\n") {
            return Err(Error::data(format!(
                "{path}, line {}, column {column}: {what}",
                self.line
            )));
        }
        let note = format!("{path} is cut off in line {}: that row is left out", self.line);
        self.notes.push(Note::Warning(note));
        Ok(())
    }
}

/// The error for a unit in the header that cannot be used.
fn unclear(path: &str, what: &str, flag: &str) -> Error {
    Error::data(format!("in the header of {path}, {what}; say which it is with {flag}"))
}

/// The columns that one of the header lines names, the nearest to the data first; `None` without
/// a header.
fn from_headers(headers: &[&[u8]], separator: Separator) -> Option<Result<Columns, String>> {
    let mut first = None;
    for header in headers.iter().rev() {
        // Names may be separated in another way than numbers: by a comma and a blank, say.
        let own = Separator::of(header);
        let separator = if own == Separator::Blanks { own } else { separator };
        let comment = header.trim_ascii_start();
        let names = match comment {
            [b'#' | b'%', names @ ..] => names,
            names => names,
        };
        match Columns::from_names(separator.split(names)) {
            Ok(found) => return Some(Ok(found)),
            Err(what) => first = first.or(Some((names.len() < comment.len(), what))),
        }
    }
    // A comment of one sentence is no header.
    let (comment, what) = first?;
    (!comment).then_some(Err(what))
}

/// The start of a field, to be shown.
fn excerpt(field: &[u8]) -> &[u8] {
    field.get(..40).unwrap_or(field)
}

impl Source for CsvReader {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        block.clear();
        while block.gyroscope.len() < BLOCK_SAMPLES && block.accelerometer.len() < BLOCK_SAMPLES {
            let Some(len) = self.next_line()? else { break };
            self.line += 1;
            match self.row(len, block) {
                Ok(()) => self.rows += 1,
                Err(fault) => self.faulty(len, fault)?,
            }
            self.input.consume(len);
        }
        Ok(!block.gyroscope.is_empty() || !block.accelerometer.is_empty())
    }

    fn streams(&self) -> Vec<Stream> {
        let name = format!("{} columns", self.columns.len());
        vec![Stream { name, type_name: "table".into(), messages: self.rows, used: true }]
    }

    fn gyroscope(&self) -> &str {
        &self.gyroscope
    }

    fn accelerometer(&self) -> &str {
        &self.accelerometer
    }

    fn take_notes(&mut self) -> Vec<Note> {
        std::mem::take(&mut self.notes)
    }

    fn bytes_read(&self) -> u64 {
        self.input.offset()
    }

    fn bytes_total(&self) -> Option<u64> {
        self.input.len()
    }
}
