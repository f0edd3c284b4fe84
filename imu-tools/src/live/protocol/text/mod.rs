//! Lines of numbers, as a sketch prints them: any columns, units and separators.
//!
//! What the columns are is told by the user as for a table ([`ReadOptions`]), or by a header, which may
//! come again where a device starts again; a row of seven numbers with nothing told is the order of
//! tables, time, gyroscope, accelerometer. Other rows without a header say nothing: six numbers may
//! be either sensor first. Names, units, separators and numbers are those of tables
//! ([`crate::recording::csv`]).
//!
//! There is no checksum. A line is left out as a whole where a field is no number, some are missing, or
//! there are those of two lines; a digit that became another passes. The line that is under way when
//! listening starts is left out unless it is a header. Lines that are longer than 1024 bytes with their end
//! are none. Only a header, a decimal comma in the first row, and the sentence about them allocate.

mod layout;
mod time;
mod width;

use crate::error::Error;
use crate::live::{Kind, Message};
use crate::recording::ReadOptions;
use crate::recording::csv::dialect::Dialect;

use super::framer::{Check, Wire};
use layout::Layout;
use time::Clock;

/// Bytes of the longest line, with its end.
const LONGEST: usize = 1024;

/// Numbers of the fewest columns that can be a sensor's.
const FEWEST: usize = 3;

/// Columns of a row that are known with nothing told.
const CUSTOMARY: &str = "t,gx,gy,gz,ax,ay,az";

/// Lines of numbers, and what is known of them.
pub struct Text {
    options: ReadOptions,
    layout: Option<Layout>,
    clock: Clock,
    /// The bytes at hand begin a line.
    at_line: bool,
    learnt: Option<String>,
}

/// What a line is.
enum Line<'a> {
    /// Nothing, or a comment.
    Aside,
    /// A header that tells all that is needed.
    Header(Layout),
    /// Numbers.
    Row(&'a [u8]),
    /// Anything else.
    Other,
}

impl Text {
    /// Lines of which the options may tell columns, names and units.
    ///
    /// # Errors
    /// When the columns are no columns.
    pub fn new(options: &ReadOptions) -> Result<Self, Error> {
        let told = options.columns.as_deref().map(|spec| Layout::of_spec(spec, options));
        let layout = told.transpose().map_err(|e| Error::usage(format!("--columns: {e}")))?;
        let clock = Clock::new(layout.as_ref().and_then(|layout| layout.time));
        Ok(Self { options: options.clone(), layout, clock, at_line: false, learnt: None })
    }

    /// What a line without its end is.
    fn line<'a>(&self, line: &'a [u8]) -> Line<'a> {
        let line = trim(line);
        if matches!(line.first(), None | Some(b'#' | b'%')) && self.header(line).is_none() {
            return if line.iter().any(|byte| byte.is_ascii_control() && *byte != b'\t') {
                Line::Other
            } else {
                Line::Aside
            };
        }
        let is_row = match &self.layout {
            Some(layout) => layout.row(line).is_some(),
            None => {
                let dialect = Dialect::of(line);
                let fields = || dialect.fields(line).filter(|field| !field.is_empty());
                let number = |field: &[u8]| layout::value(dialect, field).is_some();
                fields().count() >= FEWEST && fields().all(number)
            }
        };
        if is_row {
            return Line::Row(line);
        }
        self.header(line).map_or(Line::Other, Line::Header)
    }

    /// The layout that a header tells, where the user did not tell the columns.
    fn header(&self, line: &[u8]) -> Option<Layout> {
        // Numbers and damage are no names; looking at them as names allocates.
        let letters = line.iter().filter(|byte| byte.is_ascii_alphabetic()).count();
        if self.options.columns.is_some() || letters < FEWEST || std::str::from_utf8(line).is_err()
        {
            return None;
        }
        Layout::of_header(line, &self.options)
    }

    fn learn(&mut self, layout: Layout, from: &str) {
        if !self.layout.as_ref().is_some_and(|known| known.tells_as(&layout)) {
            self.learnt = Some(format!("{from}: {layout}"));
            self.clock = Clock::new(layout.time);
            self.layout = Some(layout);
        }
    }
}

impl Wire for Text {
    const LONGEST: usize = LONGEST;

    fn check(&self, bytes: &[u8]) -> Check {
        // More may be at hand, or not: that must make no difference.
        let longest = bytes.get(..LONGEST);
        let Some(end) = memchr::memchr(b'\n', longest.unwrap_or(bytes)) else {
            return longest.map_or(Check::Short, |longest| Check::Not(longest.len()));
        };
        match self.line(bytes.get(..end).unwrap_or_default()) {
            Line::Header(_) => Check::Whole(end + 1),
            Line::Row(_) | Line::Aside if self.at_line => Check::Whole(end + 1),
            _ => Check::Not(end + 1),
        }
    }

    fn take(&mut self, frame: &[u8], each: &mut dyn FnMut(Message)) {
        self.at_line = true;
        let row = match self.line(frame) {
            Line::Aside | Line::Other => return,
            Line::Header(layout) => return self.learn(layout, "a header told the columns"),
            Line::Row(row) => row,
        };
        if self.layout.is_none() {
            let seven = Dialect::of(row).fields(row).count() == CUSTOMARY.split(',').count();
            let customary = seven.then(|| Layout::of_spec(CUSTOMARY, &self.options).ok());
            match customary.flatten() {
                Some(layout) => self.learn(layout, "nothing told the columns, as in tables"),
                None => return,
            }
        }
        let Some(layout) = &mut self.layout else { return };
        if !layout.see(row) {
            return;
        }
        let kind = if layout.increments { Kind::Increments { over_s: None } } else { Kind::Rates };
        let Some(row) = layout.row(row) else { return };
        let ticks = row.time.and_then(|time| self.clock.ticks(time));
        if row.rate.is_some() || row.force.is_some() {
            each(Message {
                gyroscope: row.rate,
                accelerometer: row.force,
                kind,
                ticks,
                celsius: row.celsius,
                ..Message::default()
            });
        }
    }

    fn broken(&mut self, refused: &[u8], _each: &mut dyn FnMut(Message)) {
        self.at_line = refused.last() == Some(&b'\n');
    }

    fn learnt(&self) -> Option<&str> {
        self.learnt.as_deref()
    }
}

/// A line without blanks at its ends, and without the NULs that programs in C may send there.
fn trim(mut line: &[u8]) -> &[u8] {
    let is_blank = |byte: &u8| byte.is_ascii_whitespace() || *byte == 0;
    while let [first, rest @ ..] = line
        && is_blank(first)
    {
        line = rest;
    }
    while let [rest @ .., last] = line
        && is_blank(last)
    {
        line = rest;
    }
    line
}

/// A number as it was written, with a point where it has a comma.
#[derive(Clone, Copy)]
struct Pointed {
    bytes: [u8; Self::LONGEST],
    length: usize,
}

impl Pointed {
    /// Longer ones are none.
    const LONGEST: usize = 48;
    const EMPTY: Self = Self { bytes: [0; Self::LONGEST], length: 0 };

    fn of(written: &[u8]) -> Option<Self> {
        let mut pointed = Self { length: written.len(), ..Self::EMPTY };
        for (to, from) in pointed.bytes.get_mut(..written.len())?.iter_mut().zip(written) {
            *to = if *from == b',' { b'.' } else { *from };
        }
        Some(pointed)
    }

    fn get(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

/// Appends the header of the rows that [`encode`] writes of messages of this kind.
pub fn encode_header(kind: Kind, bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(match kind {
        Kind::Rates => {
            b"time [ns],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],\
              accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2],temperature [degC]\n"
        }
        Kind::Increments { .. } => {
            b"time [ns],delta_angle_x [rad],delta_angle_y [rad],delta_angle_z [rad],\
              delta_velocity_x [m/s],delta_velocity_y [m/s],delta_velocity_z [m/s],temperature [degC]\n"
                as &[u8]
        }
    });
}

/// Appends the row of a message, every number to its last bit.
pub fn encode(message: &Message, bytes: &mut Vec<u8>) {
    let nanoseconds = message.ticks.map_or(0, |ticks| ticks.in_units_of(1_000_000_000));
    bytes.extend_from_slice(nanoseconds.to_string().as_bytes());
    let both = [message.gyroscope, message.accelerometer];
    for value in both.into_iter().flat_map(|values| match values {
        Some(values) => values.map(Some),
        None => [None; 3],
    }) {
        push(value, bytes);
    }
    push(message.celsius, bytes);
    bytes.push(b'\n');
}

fn push(value: Option<f64>, bytes: &mut Vec<u8>) {
    bytes.push(b',');
    if let Some(value) = value {
        bytes.extend_from_slice(zmij::Buffer::new().format(value).as_bytes());
    }
}

#[cfg(test)]
mod tests;
