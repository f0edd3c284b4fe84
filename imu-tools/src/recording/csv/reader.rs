//! Reading a CSV row by row.

use super::columns::Column;
use super::layout::{Layout, is_aside};
use super::row::{self, Fault};
use crate::error::Error;
use crate::recording::input::{Input, LARGEST_PIECE};
use crate::recording::{Block, Note, ReadOptions, SampleKind, Source, Stream, TABLE};

/// So much of the start is looked at to understand the table.
const AHEAD: usize = 64 * 1024;

/// A CSV being read.
pub struct CsvReader {
    input: Input,
    layout: Layout,
    /// Lines taken so far.
    line: u64,
    /// Of them, those that can be read.
    rows: u64,
    gyroscope: String,
    accelerometer: String,
}

impl CsvReader {
    /// Starts to read: finds out what the columns are.
    ///
    /// # Errors
    /// When there is no row of numbers, or its columns cannot be told.
    pub fn open(mut input: Input, options: &ReadOptions) -> Result<Self, Error> {
        if options.topic.is_some() || options.bag_time {
            return Err(Error::usage(format!(
                "{} is no bag: --topic and --bag-time are for bags, --columns and --map are for \
                 tables",
                input.path().display()
            )));
        }
        input.fill(AHEAD)?;
        let layout = Layout::find(input.at_hand(), input.path(), options)?;
        input.consume(layout.bytes_before);
        let names = |column: fn(u8) -> Column| {
            let at = |axis| layout.columns.iter().position(|c| *c == column(axis));
            match [at(0), at(1), at(2)].map(|at| at.map(|at| at + 1)) {
                [Some(x), Some(y), Some(z)] if y == x + 1 && z == y + 1 => {
                    format!("columns {x} to {z} (x, y, z)")
                }
                [Some(x), Some(y), Some(z)] => format!("columns {x}, {y}, {z} (x, y, z)"),
                _ => String::new(),
            }
        };
        Ok(Self {
            input,
            line: layout.lines_before,
            rows: 0,
            gyroscope: names(Column::Rate),
            accelerometer: names(Column::Force),
            layout,
        })
    }

    /// Length of the next line with its end, all of it at hand; `None` at the end of the file.
    #[inline]
    fn next_line(&mut self) -> Result<Option<usize>, Error> {
        let mut seen = 0;
        loop {
            let bytes = self.input.at_hand();
            let unseen = bytes.get(seen..).unwrap_or_default();
            if let Some(end) = memchr::memchr(self.layout.line_end, unseen) {
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
                // Where damage cuts a row, its last number may be cut too, and look whole.
                return Ok((seen > 0 && !self.input.is_broken_off()).then_some(seen));
            }
        }
    }

    /// Takes the row in the next `len` bytes; `false` where there is none in them.
    #[inline]
    fn row(&self, len: usize, block: &mut Block) -> Result<bool, Fault> {
        let line = self.input.at_hand().get(..len).unwrap_or_default();
        let line = match line {
            [line @ .., b'\r', b'\n'] | [line @ .., b'\n' | b'\r'] => line,
            line => line,
        };
        if is_aside(line) {
            return Ok(false);
        }
        row::take(&self.layout, line, block).map(|()| true)
    }

    /// The error for a row that cannot be read, unless it is the last one and cut off.
    fn faulty(&mut self, len: usize, Fault { column, what }: Fault) -> Result<(), Error> {
        let path = self.input.path().display();
        let line = self.input.at_hand().get(..len).unwrap_or_default();
        if line.ends_with(&[self.layout.line_end]) {
            return Err(Error::data(format!(
                "{path}, line {}, column {column}: {what}",
                self.line
            )));
        }
        let note = format!("{path} is cut off in line {}: that row is left out", self.line);
        self.layout.notes.push(Note::Warning(note));
        Ok(())
    }
}

impl Source for CsvReader {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        block.clear();
        while block.has_room() {
            let Some(len) = self.next_line()? else { break };
            self.line += 1;
            match self.row(len, block) {
                Ok(row) => self.rows += u64::from(row),
                Err(fault) => self.faulty(len, fault)?,
            }
            self.input.consume(len);
        }
        self.layout.increments.divide(block)?;
        if block.is_empty() {
            self.layout.notes.extend(self.layout.increments.verdict());
        }
        Ok(!block.is_empty())
    }

    fn streams(&self) -> Vec<Stream> {
        let table = |name: String, used: bool| Stream {
            name,
            type_name: TABLE.into(),
            messages: self.rows,
            used,
        };
        let mut streams = vec![table(format!("{} columns", self.layout.columns.len()), true)];
        if !self.layout.not_taken.is_empty() {
            streams.push(table(self.layout.not_taken.clone(), false));
        }
        streams
    }

    fn gyroscope(&self) -> &str {
        &self.gyroscope
    }

    fn accelerometer(&self) -> &str {
        &self.accelerometer
    }

    fn take_notes(&mut self) -> Vec<Note> {
        std::mem::take(&mut self.layout.notes)
    }

    fn samples(&self) -> Option<SampleKind> {
        self.layout.samples
    }

    fn bytes_read(&self) -> u64 {
        self.input.offset()
    }

    fn bytes_total(&self) -> Option<u64> {
        self.input.len()
    }
}
