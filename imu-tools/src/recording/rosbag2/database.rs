//! The tables `topics` and `messages` of a rosbag2's SQLite file.
//!
//! Messages come in the order of their numbers, which is that of recording. What comes through a
//! pipe or out of a compressed file is put into a temporary file first: a database is not read front
//! to back.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::sqlite::{Pages, Rows, columns};
use crate::error::Error;
use crate::recording::input::Input;
use crate::recording::ros2::{Recorded, Taken, holds};
use crate::recording::topics::{Connection, Topics};
use crate::recording::{Block, Note, ReadOptions, Source, Stream};

/// A database being read.
pub struct DatabaseReader {
    pages: Pages,
    rows: Rows,
    topics: Topics,
    taken: Taken,
    /// Columns of the topic, the time and the payload.
    topic: usize,
    time: usize,
    data: usize,
    /// Messages that are incomplete, and those of topics that are not described.
    lost: u64,
    unknown: u64,
    ended: bool,
    notes: Vec<Note>,
}

/// A table as the database describes it.
struct Table {
    root: u32,
    columns: Vec<String>,
}

impl Table {
    /// Place of a column.
    fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }
}

/// A file beside another: its name with something behind.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// A file that can be sought in, with the same contents.
fn seekable(mut input: Input) -> Result<Input, Error> {
    let start = input.offset();
    if input.seek(start)? {
        return Ok(input);
    }
    let path = input.path().to_owned();
    let refused = |e| Error::io("write a temporary copy of", &path, e);
    let mut copy = tempfile::tempfile().map_err(refused)?;
    while input.fill(1)? {
        let here = input.at_hand();
        copy.write_all(here).map_err(refused)?;
        let n = here.len();
        input.consume(n);
    }
    Input::file(&path, copy)
}

impl DatabaseReader {
    /// Opens a database and finds the topic.
    ///
    /// # Errors
    /// When it is none of rosbag2's, or has not exactly one topic that fits.
    pub fn open(input: Input, options: &ReadOptions) -> Result<Self, Error> {
        let path = input.path().to_owned();
        let name = path.display();
        if options.are_for_a_table() {
            return Err(Error::usage(format!(
                "{name} is a rosbag2: --columns, --map and --time-unit are for tables, --topic and \
                 --bag-time are for recordings of ROS"
            )));
        }
        let mut notes = Vec::new();
        let log = beside(&path, "-wal");
        let log = if log.is_file() { Some(Input::open(&log)?) } else { None };
        let journal = beside(&path, "-journal");
        if std::fs::metadata(&journal).is_ok_and(|about| about.len() > 0) {
            notes.push(Note::Warning(format!(
                "{} tells that the recorder was stopped while it wrote: the last messages of \
                 {name} may be wrong",
                journal.display()
            )));
        }
        let mut pages = Pages::open(seekable(input)?, log)?;
        if let Some(told) = pages.cut_off {
            let size = pages.size() as u64;
            let here = pages.len().unwrap_or(0) / size;
            notes.push(Note::Warning(format!(
                "{name} is cut off: of its {told} pages of {size} bytes {here} are there"
            )));
        }
        let (topics, messages) = tables(&mut pages)?;
        let place = |table: &Table, column: &str| {
            table.column(column).ok_or_else(|| {
                Error::data(format!(
                    "{name} is no recording of rosbag2: its table has no column {column}"
                ))
            })
        };
        let topic = place(&messages, "topic_id")?;
        let (time, data) = (place(&messages, "timestamp")?, place(&messages, "data")?);
        let (id, topic_name) = (place(&topics, "id")?, place(&topics, "name")?);
        let (kind, format) = (place(&topics, "type")?, topics.column("serialization_format"));
        let mut found = Topics::new(options);
        let mut rows = Rows::new(topics.root);
        while rows.advance(&mut pages)? {
            let number = rows.integer(id).and_then(|id| u32::try_from(id).ok());
            let topic = rows.text(topic_name, &mut pages)?;
            let type_name = rows.text(kind, &mut pages)?;
            let format = match format {
                Some(format) => rows.text(format, &mut pages)?,
                None => None,
            };
            if let (Some(number), Some(topic), Some(type_name)) = (number, topic, type_name) {
                let holds = holds(&type_name, format.as_deref().unwrap_or("cdr"));
                found.add(Connection { number, topic, type_name, holds });
            }
        }
        found.choose(&path)?;
        if !found.complete() {
            return Err(found.not_found(&path));
        }
        Ok(Self {
            pages,
            rows: Rows::new(messages.root),
            topics: found,
            taken: Taken::new(options),
            topic,
            time,
            data,
            lost: 0,
            unknown: 0,
            ended: false,
            notes,
        })
    }

    /// Takes one message; `false` at the end.
    fn message(&mut self, block: &mut Block) -> Result<bool, Error> {
        if !self.rows.advance(&mut self.pages)? {
            return Ok(false);
        }
        let number = self.rows.integer(self.topic).and_then(|id| u32::try_from(id).ok());
        let (Some(number), Some(time_ns)) = (number, self.rows.integer(self.time)) else {
            self.lost += 1;
            return Ok(true);
        };
        self.topics.count(number, 1);
        match self.topics.role(number) {
            Some(role) => match self.rows.bytes(self.data, &mut self.pages)? {
                Some(payload) => self.taken.message(Recorded { time_ns, payload }, role, block),
                None => self.lost += 1,
            },
            None => self.unknown += u64::from(!self.topics.knows(number)),
        }
        Ok(true)
    }

    /// Says what was lost.
    fn warn(&mut self) {
        let path = self.pages.path().to_owned();
        let name = path.display();
        let lost = self.lost + self.rows.lost;
        if self.pages.lost > 0 {
            self.notes.push(Note::Warning(format!(
                "{name} is damaged: {} of its pages cannot be read, and the messages in them are \
                 lost",
                self.pages.lost
            )));
        }
        if lost > 0 {
            self.notes.push(Note::Warning(format!("{name} is damaged: {lost} messages are lost")));
        }
        if self.unknown > 0 {
            let unknown = self.unknown;
            self.notes.push(Note::Warning(format!(
                "{name} has {unknown} messages of topics that it does not name"
            )));
        }
        self.notes.append(&mut self.taken.take_notes(&path));
    }
}

/// The tables of topics and of messages.
fn tables(pages: &mut Pages) -> Result<(Table, Table), Error> {
    let (mut topics, mut messages) = (None, None);
    let mut rows = Rows::of_schema();
    // Columns of the table of tables: type, name, table, root page, command.
    while rows.advance(pages)? {
        if rows.text(0, pages)?.as_deref() != Some("table") {
            continue;
        }
        let Some(name) = rows.text(1, pages)? else { continue };
        let root = rows.integer(3).and_then(|root| u32::try_from(root).ok());
        let sql = rows.text(4, pages)?;
        let table = root.zip(sql).map(|(root, sql)| Table { root, columns: columns(&sql) });
        match name.as_str() {
            "topics" => topics = table,
            "messages" => messages = table,
            _ => {}
        }
    }
    topics.zip(messages).ok_or_else(|| {
        let path = pages.path().display();
        Error::data(if pages.lost > 0 {
            format!("{path} is damaged in its first page, without which nothing is found")
        } else {
            format!(
                "{path} is a database of SQLite and no recording of rosbag2: it has no tables \
                 topics and messages"
            )
        })
    })
}

impl Source for DatabaseReader {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        block.clear();
        while !self.ended && block.has_room() {
            if !self.message(block)? {
                self.ended = true;
                self.warn();
            }
        }
        Ok(!block.is_empty())
    }

    fn streams(&self) -> Vec<Stream> {
        self.topics.streams()
    }

    fn gyroscope(&self) -> &str {
        &self.topics.gyroscope
    }

    fn accelerometer(&self) -> &str {
        &self.topics.accelerometer
    }

    fn take_notes(&mut self) -> Vec<Note> {
        let mut notes = std::mem::take(&mut self.notes);
        notes.append(&mut self.topics.take_notes());
        notes
    }

    fn bytes_read(&self) -> u64 {
        let read = self.pages.read.saturating_mul(self.pages.size() as u64);
        read.min(self.pages.len().unwrap_or(u64::MAX))
    }

    fn bytes_total(&self) -> Option<u64> {
        self.pages.len()
    }
}
