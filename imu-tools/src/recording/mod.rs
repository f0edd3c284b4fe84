//! Recordings: one format a folder, one stream of samples out of all of them.
//!
//! A [`Source`] fills [`Block`]s with the samples of both sensors, in the order of the file, in SI
//! units, stamped in integer nanoseconds. The two sensors of a block are independent: each has its
//! own samples, rate and gaps. A [`Sink`] takes blocks and writes a file.
//!
//! ```
//! use imu_tools::recording::{self, Block, ReadOptions, Sample};
//!
//! let folder = tempfile::tempdir().unwrap();
//! let path = folder.path().join("imu.bag");
//! let mut block = Block::default();
//! for i in 0..3 {
//!     let stamp_ns = i * 5_000_000;
//!     block.gyroscope.push(Sample { stamp_ns, value: [0.1, 0.0, 0.0] });
//!     block.accelerometer.push(Sample { stamp_ns, value: [0.0, 0.0, 9.81] });
//! }
//! let mut sink = recording::create(&path)?;
//! sink.write_block(&block)?;
//! sink.finish()?;
//!
//! let mut source = recording::open(&path, &ReadOptions::default())?;
//! let mut read = Block::default();
//! assert!(source.next_block(&mut read)?);
//! assert_eq!(read, block);
//! assert!(!source.next_block(&mut read)?);
//! # Ok::<(), imu_tools::error::Error>(())
//! ```

mod ahead;
mod align;
pub mod bag;
mod contents;
mod convert;
pub mod csv;
pub mod euroc;
mod folder;
mod format;
mod imu_body;
mod input;
mod inside;
mod joined;
pub mod mcap;
mod noted;
mod nothing;
pub mod numpy;
mod pose_body;
pub mod poses;
mod ros2;
pub mod rosbag2;
mod sensor;
mod shape;
pub mod timeline;
mod topics;
pub mod ulog;
mod units;
mod unpack;
mod zstandard;

use std::io::Read;
use std::path::Path;

use serde::{Deserialize, Serialize};

pub(crate) use ahead::read_ahead;
pub use contents::{Contents, SampleKind};
pub use convert::{Converted, convert};
pub use format::Format;
pub use joined::Joined;
pub use timeline::{ClockStep, Event, Gap, Summary, Timeline};
pub use units::{ForceUnit, RateUnit, TimeUnit};

use crate::error::Error;
use crate::output::Output;
pub(crate) use input::Input;
use poses::{Pose, PoseTopic};

/// One reading of one three-axis sensor.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
pub struct Sample {
    /// Nanoseconds since the epoch of the recording's clock.
    pub stamp_ns: i64,
    /// Angular rate in rad/s, or specific force in m/s², in sensor axes x, y, z. Not finite where
    /// the recording has a row or message but no number.
    pub value: [f64; 3],
}

/// A stretch of a recording: what each sensor said in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Block {
    /// Angular rate, rad/s.
    pub gyroscope: Vec<Sample>,
    /// Specific force, m/s².
    pub accelerometer: Vec<Sample>,
    /// What a thermometer in or near the sensor said, where there is one.
    pub temperature: Vec<Temperature>,
    /// Where the body was, of a topic that was asked for ([`ReadOptions::poses`]).
    pub poses: Vec<Pose>,
}

/// One reading of a thermometer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Temperature {
    /// Nanoseconds since the epoch of the recording's clock.
    pub stamp_ns: i64,
    /// Degrees Celsius.
    pub celsius: f64,
}

impl Block {
    /// Whether nothing is in it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.gyroscope.is_empty()
            && self.accelerometer.is_empty()
            && self.temperature.is_empty()
            && self.poses.is_empty()
    }

    /// The first stamp of gyroscope and accelerometer, ns, whichever is earlier.
    #[must_use]
    pub fn first_ns(&self) -> Option<i64> {
        let first = [self.gyroscope.first(), self.accelerometer.first()];
        first.into_iter().flatten().map(|sample| sample.stamp_ns).min()
    }

    /// Empties all lists and keeps their memory.
    pub fn clear(&mut self) {
        self.gyroscope.clear();
        self.accelerometer.clear();
        self.temperature.clear();
        self.poses.clear();
    }

    /// Whether one more sample of each sensor fits.
    #[inline]
    fn has_room(&self) -> bool {
        self.gyroscope.len() < BLOCK_SAMPLES
            && self.accelerometer.len() < BLOCK_SAMPLES
            && self.temperature.len() < BLOCK_SAMPLES
            && self.poses.len() < BLOCK_SAMPLES
    }
}

/// Samples of a sensor in one block, at most: a block of both fits a second-level cache.
pub const BLOCK_SAMPLES: usize = 4096;

/// Something that a reader wants to tell its user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Note {
    /// What was found and taken for granted, such as the unit of time.
    Info(String),
    /// What is wrong with the recording although it could be read.
    Warning(String),
}

/// A topic, a message of a log, or the columns of a table, whether it is an IMU's or not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stream {
    /// As the recording calls it.
    pub name: String,
    /// What its messages are, as the recording calls it.
    pub type_name: String,
    /// Messages or rows so far.
    pub messages: u64,
    /// Samples are taken from it.
    pub used: bool,
}

/// What the columns of a table are in the place of a message's type.
pub(crate) const TABLE: &str = "table";

/// A recording being read, front to back, once.
pub trait Source: Send {
    /// Clears `block` and fills it with the next samples, at most [`BLOCK_SAMPLES`] a sensor;
    /// `false`, and an empty block, at the end.
    ///
    /// # Errors
    /// When the file cannot be read or is not what it was taken for.
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error>;

    /// What the recording holds, as far as is known by now; complete once the end was reached.
    fn streams(&self) -> Vec<Stream>;

    /// Where the gyroscope's samples come from: a topic, or the names of columns; empty where there
    /// are none.
    fn gyroscope(&self) -> &str;

    /// Where the accelerometer's samples come from.
    fn accelerometer(&self) -> &str;

    /// Takes what there is to tell since the last call; complete once the end was reached.
    fn take_notes(&mut self) -> Vec<Note>;

    /// What the recording says that its samples are, where it does. Never increments: readers divide them
    /// by their time, and give means.
    fn samples(&self) -> Option<SampleKind> {
        None
    }

    /// Bytes read so far.
    fn bytes_read(&self) -> u64;

    /// Bytes in all, where that is known (not of a pipe).
    fn bytes_total(&self) -> Option<u64>;

    /// The record that the last block belongs to, counted from 0. Nothing connects one with the
    /// next: another day, or another sensor. Only several files have more than one.
    fn record_number(&self) -> usize {
        0
    }

    /// The files of a record, by name, where there are several records; complete once the end was
    /// reached.
    fn record_name(&self, _record: usize) -> Option<String> {
        None
    }
}

/// A recording being written.
pub trait Sink: Send {
    /// Writes the samples of `block`. Two samples of one instant become one row or message;
    /// within a block each sensor's stamps are expected in order.
    ///
    /// # Errors
    /// When the disk is full, or a stamp does not fit the format.
    fn write_block(&mut self, block: &Block) -> Result<(), Error>;

    /// Writes out what waits, so that all of it is on the disk and can be read, where the file grows in
    /// its place ([`grow`]).
    ///
    /// # Errors
    /// When the disk is full.
    fn flush(&mut self) -> Result<(), Error> {
        Ok(())
    }

    /// Says what the samples to come are, where the format can say so and it does not stand there yet:
    /// before the first samples.
    fn samples_are(&mut self, _samples: SampleKind) {}

    /// Completes the file and puts it in its place. A sink that is dropped instead leaves nothing.
    ///
    /// # Errors
    /// When the disk is full.
    fn finish(self: Box<Self>) -> Result<(), Error>;
}

/// How to read a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The Imu topic of a recording of ROS or of a log, or two joined by a comma, gyroscope's and
    /// accelerometer's; `imu` and `/imu` are the same. `None` takes the only one, or the pair that is
    /// named so.
    pub topic: Option<String>,
    /// Read poses, and nothing of an IMU.
    pub poses: Option<PoseTopic>,
    /// Where there are several IMUs, take the first and say so, in the place of an error: for those
    /// who want to know what a recording holds.
    pub survey: bool,
    /// Stamp samples with the time at which they were recorded, not with their header's.
    pub bag_time: bool,
    /// Columns of a table or array, such as `t,gx,gy,gz,ax,ay,az,-`. `None` finds them.
    pub columns: Option<String>,
    /// Columns of a table or array by their names, such as `t=stamp,gx=omega.x`.
    pub map: Option<String>,
    /// Unit of the angular rates. `None` finds it in a table's header, or takes rad/s.
    pub gyro_unit: Option<RateUnit>,
    /// Unit of the specific forces. `None` finds it in a table's header, or takes m/s².
    pub accel_unit: Option<ForceUnit>,
    /// Unit of a table's time. `None` finds it in the header or in the data.
    pub time_unit: Option<TimeUnit>,
}

impl ReadOptions {
    /// Whether columns or a unit of time are told, which a recording that describes itself has not
    /// to be told.
    fn are_for_a_table(&self) -> bool {
        self.columns.is_some() || self.map.is_some() || self.time_unit.is_some()
    }
}

/// Opens the recording at `path` (`-` is a pipe), a file or a folder, whatever its format: what it
/// holds decides, not its name.
///
/// # Errors
/// When there is no such file, its format is unknown, or it holds no IMU.
pub fn open(path: &Path, options: &ReadOptions) -> Result<Box<dyn Source>, Error> {
    if path.is_dir() { folder::open(path, options) } else { open_file(path, options) }
}

fn open_file(path: &Path, options: &ReadOptions) -> Result<Box<dyn Source>, Error> {
    read_inside(Input::open(path)?, options)
}

/// Reads a recording from any stream, front to back; errors call it `path`.
///
/// # Errors
/// As [`open`].
pub fn read_from(
    path: &Path,
    stream: Box<dyn Read + Send>,
    options: &ReadOptions,
) -> Result<Box<dyn Source>, Error> {
    read_inside(Input::pipe(path, stream), options)
}

/// Reads what is inside of compression and of UTF-16.
fn read_inside(input: Input, options: &ReadOptions) -> Result<Box<dyn Source>, Error> {
    let (input, layers) = unpack::unpack(input)?;
    layers.around(recognise(input, options))
}

/// The reader of the format that the first bytes show.
fn recognise(mut input: Input, options: &ReadOptions) -> Result<Box<dyn Source>, Error> {
    input.fill(512)?;
    let path = input.path();
    let start = input.at_hand();
    let start = start.get(..512).unwrap_or(start);
    if start.is_empty() {
        return Err(Error::data(format!("{} is empty", path.display())));
    }
    // What it holds decides; the name tells only what a damaged beginning should have been.
    let named = |ending: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    let holds = |magic: &[u8]| start.starts_with(magic);
    let magics = [b"#ROSBAG", mcap::MAGIC, ulog::MAGIC, rosbag2::MAGIC];
    let text = is_text(start);
    let other = text || magics.into_iter().any(holds) || numpy::is_numpy(start);
    if holds(b"#ROSBAG") || (named("bag") && !other) {
        return Ok(Box::new(bag::BagReader::open(input, options)?));
    }
    if holds(mcap::MAGIC) || (named("mcap") && !other) {
        return Ok(Box::new(mcap::McapReader::open(input, options)?));
    }
    if holds(rosbag2::MAGIC) || (named("db3") && !other) {
        return Ok(Box::new(rosbag2::DatabaseReader::open(input, options)?));
    }
    if let Some(wanted) = &options.poses {
        return poses::without_topics(path, wanted);
    }
    if holds(ulog::MAGIC) || (named("ulg") && !other) {
        return Ok(Box::new(ulog::UlogReader::open(input, options)?));
    }
    if numpy::is_numpy(start) {
        return Ok(Box::new(numpy::NumpyReader::open(input, options)?));
    }
    if start.contains(&0) {
        return Err(Error::data(format!(
            "{} is neither a ROS 1 bag, an MCAP file, a PX4 ULog, a database of rosbag2, \
             an array of NumPy nor a table of numbers in text",
            path.display()
        )));
    }
    let name = path.display().to_string();
    let names =
        [("bag", "ROS 1 bag"), ("mcap", "MCAP file"), ("ulg", "ULog"), ("db3", "rosbag2 database")];
    let misnamed = names.into_iter().find(|(ending, _)| named(ending)).map(|(_, what)| what);
    if options.columns.is_none() && options.map.is_none() && poses::Table::are_in(&mut input)? {
        return Err(poses::Table::of(input)?.no_samples());
    }
    let table = csv::CsvReader::open(input, options);
    let Some(what) = misnamed else { return Ok(Box::new(table?)) };
    let table = table.map_err(|error| match error {
        Error::Data(why) => {
            Error::data(format!("{why} (it is text, and no {what} as it is named)"))
        }
        other => other,
    })?;
    let told = format!("{name} is text, and no {what} as it is named: it is read as a table");
    Ok(Box::new(noted::Noted::new(Box::new(table), vec![Note::Info(told)])))
}

/// Whether these first bytes are text: there are no control characters but those of lines.
fn is_text(start: &[u8]) -> bool {
    !start.iter().any(|b| b.is_ascii_control() && !matches!(b, b'\t' | b'\n' | b'\r' | 0x0c))
}

/// The bytes of a file or of the pipe `-`, with what they are packed in taken off.
pub(crate) fn unpacked(path: &Path) -> Result<Input, Error> {
    Ok(unpack::unpack(Input::open(path)?)?.0)
}

/// Starts a recording at `path`, in the format that its name says; `-` is a CSV on a pipe.
///
/// # Errors
/// When the name has another ending, or the folder cannot be written.
pub fn create(path: &Path) -> Result<Box<dyn Sink>, Error> {
    create_as(path, Format::of(path)?)
}

/// Starts a recording at `path` (`-` is a pipe) in this format, whatever its name.
///
/// # Errors
/// When the folder cannot be written.
pub fn create_as(path: &Path, format: Format) -> Result<Box<dyn Sink>, Error> {
    create_with(path, format, Contents::default())
}

/// The same, of a recording that holds `contents`: a CSV and EuRoC's folders say which samples they are,
/// and a CSV has a column for the temperature. Bags and MCAP files have no place for either.
///
/// # Errors
/// When the folder cannot be written.
pub fn create_with(
    path: &Path,
    format: Format,
    contents: Contents,
) -> Result<Box<dyn Sink>, Error> {
    Ok(match format {
        Format::Bag => Box::new(bag::BagWriter::create(path)?),
        Format::Mcap => Box::new(mcap::McapWriter::create(path)?),
        Format::Csv => Box::new(csv::CsvWriter::create_with(path, contents)?),
        Format::Euroc => Box::new(euroc::EurocWriter::create_with(path, contents.samples)?),
    })
}

/// Starts a recording that stands at `path` from the beginning and grows there: whatever ends the program,
/// it can be read up to the last [`Sink::flush`]. Its name says its format: a bag, an MCAP file or a CSV,
/// which has a column for the temperature.
///
/// # Errors
/// When there is a file of that name already, the folder cannot be written, or the format is not one file.
pub fn grow(path: &Path) -> Result<Box<dyn Sink>, Error> {
    let format = Format::of(path)?;
    if path == Path::new("-") || format == Format::Euroc {
        return Err(Error::usage(format!(
            "a recording that grows is one file: {} is none; end its name with .bag, .mcap or .csv",
            path.display()
        )));
    }
    let output = Output::growing(path)?;
    let contents = Contents { samples: SampleKind::Instantaneous, temperature: true };
    Ok(match format {
        Format::Bag => Box::new(bag::BagWriter::write_to(output)?),
        Format::Mcap => Box::new(mcap::McapWriter::write_to(output)?),
        Format::Csv | Format::Euroc => Box::new(csv::CsvWriter::write_to(output, contents)),
    })
}

/// Adds the streams of a file to those of the files before it.
fn add_streams(all: &mut Vec<Stream>, more: Vec<Stream>) {
    for stream in more {
        let same = |s: &&mut Stream| s.name == stream.name && s.type_name == stream.type_name;
        match all.iter_mut().find(same) {
            Some(before) => {
                before.messages += stream.messages;
                before.used |= stream.used;
            }
            None => all.push(stream),
        }
    }
}

/// Walks both sensors of a block by time; samples of one instant come together.
pub(crate) fn merge(
    block: &Block,
    mut row: impl FnMut(i64, Option<[f64; 3]>, Option<[f64; 3]>) -> Result<(), Error>,
) -> Result<(), Error> {
    let (mut gyroscope, mut accelerometer) = (block.gyroscope.iter(), block.accelerometer.iter());
    let (mut g, mut a) = (gyroscope.next(), accelerometer.next());
    loop {
        match (g, a) {
            (None, None) => return Ok(()),
            (Some(rate), Some(force)) if rate.stamp_ns == force.stamp_ns => {
                row(rate.stamp_ns, Some(rate.value), Some(force.value))?;
                (g, a) = (gyroscope.next(), accelerometer.next());
            }
            (Some(rate), other) if other.is_none_or(|force| rate.stamp_ns < force.stamp_ns) => {
                row(rate.stamp_ns, Some(rate.value), None)?;
                g = gyroscope.next();
            }
            (_, Some(force)) => {
                row(force.stamp_ns, None, Some(force.value))?;
                a = accelerometer.next();
            }
            (Some(_), None) => return Ok(()),
        }
    }
}
