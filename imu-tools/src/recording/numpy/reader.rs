//! Reading arrays row by row.

use std::io;
use std::path::Path;

use super::arrays::{Array, Candidate, columns, members};
use super::header::Header;
use super::is_archive;
use super::scalar::Scalar;
use crate::error::Error;
use crate::recording::csv::celsius::Celsius;
use crate::recording::csv::columns::{Column, Columns};
use crate::recording::csv::granted::Granted;
use crate::recording::csv::increments::Increments;
use crate::recording::input::{Input, LARGEST_PIECE};
use crate::recording::{
    BLOCK_SAMPLES, Block, Note, ReadOptions, Sample, SampleKind, Source, Stream, Temperature,
};

/// So many rows show the unit of time.
const ROWS_AHEAD: usize = 64;

/// Arrays being read.
pub struct NumpyReader {
    name: String,
    streams: Vec<Records>,
    places: Vec<Place>,
    /// Power of ten between the time and nanoseconds.
    exponent: u32,
    rate: f64,
    force: f64,
    celsius: Celsius,
    increments: Increments,
    samples: Option<SampleKind>,
    /// Rows in all, and those that were read.
    rows: u64,
    row: u64,
    len: Option<u64>,
    gyroscope: String,
    accelerometer: String,
    ended: bool,
    notes: Vec<Note>,
}

/// Records one after the other.
struct Records {
    input: Input,
    stride: usize,
}

/// Where a column's numbers are in the records of a stream.
#[derive(Clone, Copy)]
struct Place {
    column: Column,
    stream: usize,
    at: usize,
    scalar: Scalar,
}

impl NumpyReader {
    /// Starts to read the array or archive in `input`.
    ///
    /// # Errors
    /// When it is damaged, or holds no columns of an IMU.
    pub fn open(mut input: Input, options: &ReadOptions) -> Result<Self, Error> {
        let path = input.path().to_owned();
        let name = path.display().to_string();
        if options.topic.is_some() || options.bag_time {
            return Err(Error::usage(format!(
                "{name} is no bag: --topic and --bag-time are for bags, --columns and --map are \
                 for tables and arrays"
            )));
        }
        let len = input.len();
        let arrays = if is_archive(input.at_hand()) {
            if len.is_none() {
                return Err(Error::data(format!(
                    "{name} is an .npz in a pipe or inside of compression: its list of arrays \
                     stands at its end, so it must be a file"
                )));
            }
            members(&path)?
        } else {
            let header = Header::read(&mut input, &name)?;
            vec![Array { name: String::new(), header, member: None }]
        };
        let mut candidates = Vec::new();
        for (at, array) in arrays.iter().enumerate() {
            candidates.extend(array.columns(at));
        }
        let found = columns(&candidates, &arrays, options, &name)?;
        let mut reader = Self {
            increments: Increments::of(&found, name.clone()),
            samples: (found.angles || found.velocities).then_some(SampleKind::Mean),
            name,
            streams: Vec::new(),
            places: Vec::new(),
            exponent: 0,
            rate: 1.0,
            force: 1.0,
            celsius: found.celsius,
            rows: 0,
            row: 0,
            len,
            gyroscope: String::new(),
            accelerometer: String::new(),
            ended: false,
            notes: Vec::new(),
        };
        reader.find_places(&path, Some(input), &arrays, &candidates, &found)?;
        reader.take_units(options, &found)?;
        Ok(reader)
    }

    /// Opens the streams of the columns that are of interest.
    fn find_places(
        &mut self,
        path: &Path,
        mut input: Option<Input>,
        arrays: &[Array],
        candidates: &[Candidate],
        found: &Columns,
    ) -> Result<(), Error> {
        let mut opened: Vec<(usize, u64)> = Vec::new();
        let used = candidates.iter().zip(&found.columns).filter(|(_, c)| **c != Column::Other);
        for (candidate, &column) in used {
            let name = &candidate.name;
            let scalar = candidate.scalar.clone().map_err(|kind| {
                Error::data(format!(
                    "{} holds '{kind}' where '{name}' should be: floats of 4 or 8 bytes and whole \
                     numbers are read",
                    self.name
                ))
            })?;
            if self.places.is_empty() {
                self.rows = candidate.rows;
            } else if self.rows != candidate.rows {
                return Err(Error::data(format!(
                    "{}: '{name}' has {} rows where others have {}: sensors of rates of their own \
                     need a file each",
                    self.name, candidate.rows, self.rows
                )));
            }
            match column {
                Column::Rate(0) => self.gyroscope = shown(name, &self.name),
                Column::Force(0) => self.accelerometer = shown(name, &self.name),
                _ => {}
            }
            let key = (candidate.array, candidate.before);
            let stream = match opened.iter().position(|other| *other == key) {
                Some(stream) => stream,
                None => {
                    let array = arrays.get(candidate.array);
                    let stream = self.stream(path, &mut input, array, candidate)?;
                    self.streams.push(stream);
                    opened.push(key);
                    opened.len() - 1
                }
            };
            self.places.push(Place { column, stream, at: candidate.at, scalar });
        }
        Ok(())
    }

    /// Opens the records of a column.
    fn stream(
        &self,
        path: &Path,
        input: &mut Option<Input>,
        array: Option<&Array>,
        candidate: &Candidate,
    ) -> Result<Records, Error> {
        let stride = candidate.stride;
        if stride == 0 || stride > LARGEST_PIECE {
            return Err(Error::data(format!(
                "{} has rows of {stride} bytes: those of 1 byte to a megabyte can be read",
                self.name
            )));
        }
        let mut own = match array.and_then(|array| array.member.as_ref()) {
            Some(member) => {
                let mut own = Input::pipe(path, Box::new(member.open(path)?));
                Header::read(&mut own, &self.name)?;
                own
            }
            // In a pipe, the only stream of rows is that which is already open.
            None if self.len.is_none() => {
                input.take().filter(|_| candidate.before == 0).ok_or_else(|| {
                    Error::data(format!(
                        "{} is stored column by column, which can be read from a file only, not \
                         from a pipe or inside of compression: save it row by row (order='C')",
                        self.name
                    ))
                })?
            }
            None => {
                let mut own = Input::open(path)?;
                own.skip(array.map_or(0, |array| array.header.len))?;
                own
            }
        };
        own.skip(candidate.before)?;
        Ok(Records { input: own, stride })
    }

    /// Finds the units and tells what was taken for granted.
    fn take_units(&mut self, options: &ReadOptions, found: &Columns) -> Result<(), Error> {
        let name = self.name.clone();
        let mut granted = Granted::new(found, options, &name, &name);
        let time = self.places.iter().find(|place| place.column == Column::Time).copied();
        if let Some(time) = time {
            let texts = self.times_ahead(time)?;
            let texts: Vec<&[u8]> = texts.iter().map(String::as_bytes).collect();
            let given = options.time_unit.or(time.scalar.unit);
            self.exponent = granted.time(given, &texts)?.exponent();
        }
        let (factors, notes) = granted.sensors()?;
        (self.rate, self.force, self.notes) = (factors.rate, factors.force, notes);
        self.notes.extend(self.increments.remark());
        Ok(())
    }

    /// The first times, as they would be written.
    fn times_ahead(&mut self, time: Place) -> Result<Vec<String>, Error> {
        let Some(records) = self.streams.get_mut(time.stream) else { return Ok(Vec::new()) };
        let rows = ROWS_AHEAD.min(usize::try_from(self.rows).unwrap_or(ROWS_AHEAD));
        let wanted = rows.saturating_mul(records.stride).min(LARGEST_PIECE);
        match records.input.fill(wanted) {
            Err(error) if damage(&error).is_none() => return Err(error),
            _ => {}
        }
        let at_hand = records.input.at_hand().chunks_exact(records.stride).take(rows);
        Ok(at_hand.filter_map(|record| time.scalar.text(record, time.at)).collect())
    }

    /// Takes the next row; `false` at the end.
    #[inline]
    fn take_row(&mut self, block: &mut Block) -> Result<bool, Error> {
        for records in &mut self.streams {
            if records.input.at_hand().len() < records.stride {
                match records.input.fill(records.stride) {
                    Ok(true) => {}
                    Ok(false) => return Ok(self.cut("is cut off")),
                    Err(error) => match damage(&error) {
                        Some(what) => return Ok(self.cut(what)),
                        None => return Err(error),
                    },
                }
            }
        }
        let (mut stamp_ns, mut celsius) = (0_i64, None);
        let (mut rate, mut force) = ([f64::NAN; 3], [f64::NAN; 3]);
        let (mut rates, mut forces) = (false, false);
        for place in &self.places {
            let records = self.streams.get(place.stream);
            let record = records.map(|records| records.input.at_hand()).unwrap_or_default();
            let value = || place.scalar.value(record, place.at).unwrap_or(f64::NAN);
            let exponent = match place.column {
                Column::Time => self.exponent,
                Column::Seconds => 9,
                Column::Nanoseconds => 0,
                Column::Rate(axis) => {
                    rates = true;
                    if let Some(to) = rate.get_mut(usize::from(axis)) {
                        *to = value() * self.rate;
                    }
                    continue;
                }
                Column::Force(axis) => {
                    forces = true;
                    if let Some(to) = force.get_mut(usize::from(axis)) {
                        *to = value() * self.force;
                    }
                    continue;
                }
                Column::Temperature => {
                    celsius = Some(value() * self.celsius.factor + self.celsius.zero);
                    continue;
                }
                Column::Date | Column::Other => continue,
            };
            let part = place.scalar.nanoseconds(record, place.at, exponent).ok_or_else(|| {
                Error::data(format!("{}, row {}: its time is no time", self.name, self.row + 1))
            })?;
            stamp_ns = stamp_ns.saturating_add(part);
        }
        if rates {
            block.gyroscope.push(Sample { stamp_ns, value: rate });
        }
        if forces {
            block.accelerometer.push(Sample { stamp_ns, value: force });
        }
        if let Some(celsius) = celsius.filter(|celsius| celsius.is_finite()) {
            block.temperature.push(Temperature { stamp_ns, celsius });
        }
        for records in &mut self.streams {
            records.input.consume(records.stride);
        }
        self.row += 1;
        Ok(true)
    }

    /// Ends before all rows were read; gives `false`.
    fn cut(&mut self, what: &str) -> bool {
        self.ended = true;
        self.notes.push(Note::Warning(format!(
            "{} {what}: of its {} rows {} could be read, and the rest is lost",
            self.name, self.rows, self.row
        )));
        false
    }

    /// Behind the last row stands the verdict of a checksum.
    fn verify(&mut self) -> Result<(), Error> {
        self.ended = true;
        for records in &mut self.streams {
            match records.input.fill(1) {
                Err(error) if damage(&error).is_some() => {
                    self.notes.push(Note::Warning(format!(
                        "{} is damaged: the checksum of an array in it is wrong, so some of what \
                         was read may be too",
                        self.name
                    )));
                }
                other => {
                    other?;
                }
            }
        }
        Ok(())
    }
}

/// What is wrong, where an error is one of the data and not of the system.
fn damage(error: &Error) -> Option<&'static str> {
    let Error::Io { source, .. } = error else { return None };
    match source.kind() {
        io::ErrorKind::UnexpectedEof => Some("is cut off"),
        io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput => Some("is damaged"),
        _ => None,
    }
}

/// What a sensor's columns are called.
fn shown(name: &str, file: &str) -> String {
    let name = name.strip_suffix("_x").unwrap_or(name);
    if name.is_empty() { file.to_owned() } else { format!("array {name}") }
}

impl Source for NumpyReader {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        block.clear();
        while block.gyroscope.len() < BLOCK_SAMPLES && block.accelerometer.len() < BLOCK_SAMPLES {
            if self.ended {
                break;
            }
            if self.row == self.rows {
                self.verify()?;
            } else if !self.take_row(block)? {
                break;
            }
        }
        self.increments.divide(block)?;
        let any = !block.gyroscope.is_empty() || !block.accelerometer.is_empty();
        if !any {
            self.notes.extend(self.increments.verdict());
        }
        Ok(any)
    }

    fn streams(&self) -> Vec<Stream> {
        let name = format!("{} columns", self.places.len());
        vec![Stream { name, type_name: "array".into(), messages: self.row, used: true }]
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

    fn samples(&self) -> Option<SampleKind> {
        self.samples
    }

    fn bytes_read(&self) -> u64 {
        match (self.len, self.streams.first()) {
            // By rows: several places of the file are read at once.
            (Some(len), _) => {
                let done = u128::from(len) * u128::from(self.row) / u128::from(self.rows.max(1));
                u64::try_from(done).unwrap_or(len)
            }
            (None, Some(records)) => records.input.offset(),
            (None, None) => 0,
        }
    }

    fn bytes_total(&self) -> Option<u64> {
        self.len
    }
}
