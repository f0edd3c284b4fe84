//! Reading a bag front to back, in a file or a pipe.
//!
//! Records are taken as they come. What cannot be read is stepped over to the next bytes that have
//! the form of a record, and told.

mod described;
mod lost;

use super::account::Account;
use super::bytes::{Bytes, Left};
use super::damage::{Among, next_record};
use super::record::{Header, prefixed};
use super::repeat::Repeat;
use super::samples::Samples;
use super::unpack::Compression;
use super::{MAGIC, op};
use crate::error::Error;
use crate::recording::input::{Input, LARGEST_PIECE};
use crate::recording::topics::Topics;
use crate::recording::{Block, Note, ReadOptions, Source, Stream};

/// Headers have less than 100 bytes, or a little more than their topic's name.
const LARGEST_HEADER: usize = 64 * 1024;

/// A bag being read.
pub struct BagReader {
    bytes: Bytes,
    topics: Topics,
    samples: Samples,
    account: Account,
    /// The list of connections was read, so that no other topic will turn up.
    listed: bool,
    ended: bool,
    repeat: Option<Repeat>,
    /// Messages of connections that were not described.
    unknown: u64,
    notes: Vec<Note>,
    /// Warnings so far, those that were not told among them.
    warnings: u32,
}

/// A record's lengths, and what its header says of those that come often.
#[derive(Clone, Copy)]
struct Record {
    header: usize,
    data: usize,
    op: u8,
    conn: Option<u32>,
    time: (u32, u32),
}

impl Record {
    fn len(&self) -> u64 {
        (8 + self.header + self.data) as u64
    }
}

/// What the next bytes hold.
enum Next {
    Record(Record),
    /// Nothing: the chunk or the file is over.
    End,
    /// The beginning of a record, and then the chunk or the file is over.
    Piece,
    /// Something that is no record.
    Damage,
}

impl BagReader {
    /// Starts to read: finds the topic, as far ahead as is needed for that.
    ///
    /// # Errors
    /// When this is no bag, is encrypted, or has no topic that fits, or several.
    pub fn open(mut input: Input, options: &ReadOptions) -> Result<Self, Error> {
        if options.are_for_a_table() {
            return Err(Error::usage(format!(
                "{} is a bag: --columns, --map and --time-unit are for tables, --topic and --bag-time \
                 are for bags",
                input.path().display()
            )));
        }
        input.fill(MAGIC.len())?;
        if !input.at_hand().starts_with(MAGIC) {
            return Err(Error::data(format!(
                "{} is no ROS 1 bag of version 2.0",
                input.path().display()
            )));
        }
        input.consume(MAGIC.len());
        let mut bag = Self {
            bytes: Bytes::new(input),
            topics: Topics::new(options),
            samples: Samples::new(options),
            account: Account::default(),
            listed: false,
            ended: false,
            repeat: None,
            unknown: 0,
            notes: Vec::new(),
            warnings: 0,
        };
        bag.bag_header()?;
        bag.list()?;
        bag.topics.choose(bag.bytes.input().path())?;
        let mut ahead = Block::default();
        while !bag.listed && !bag.topics.any() && bag.record(&mut ahead)? {
            ahead.clear();
        }
        if bag.topics.lack(bag.listed) {
            return Err(bag.topics.not_found(bag.bytes.input().path()));
        }
        Ok(bag)
    }

    /// What comes next; nothing is consumed.
    #[inline]
    fn next(&mut self) -> Result<Next, Error> {
        if !self.bytes.fill(4)? {
            return Ok(if self.bytes.at_hand().is_empty() { Next::End } else { Next::Piece });
        }
        let header = self.bytes.at_hand().first_chunk().map_or(0, |b| u32::from_le_bytes(*b));
        let header = header as usize;
        if header > LARGEST_HEADER {
            return Ok(Next::Damage);
        }
        if !self.bytes.fill(8 + header)? {
            return Ok(Next::Piece);
        }
        let Some((bytes, rest)) = prefixed(self.bytes.at_hand()) else { return Ok(Next::Piece) };
        let Some(data) = rest.first_chunk() else { return Ok(Next::Piece) };
        let Some(Header { op: Some(op), conn, time, .. }) = Header::parse(bytes) else {
            return Ok(Next::Damage);
        };
        let data = u32::from_le_bytes(*data) as usize;
        Ok(Next::Record(Record { header, data, op, conn, time: time.unwrap_or_default() }))
    }

    /// All fields of the header of the record at hand.
    fn header(&self, record: &Record) -> Option<Header<'_>> {
        Header::parse(self.bytes.at_hand().get(4..4 + record.header)?)
    }

    /// Whether the record at hand holds as many entries of `size` bytes as it says.
    fn counted(&self, record: &Record, size: u64) -> bool {
        let count = self.header(record).and_then(|header| header.count);
        count.is_none_or(|count| u64::from(count) * size == record.data as u64)
    }

    /// Takes one record; `false` at the end.
    #[inline]
    fn record(&mut self, block: &mut Block) -> Result<bool, Error> {
        if self.ended {
            return Ok(false);
        }
        match self.next()? {
            Next::Record(record) => self.take(&record, block),
            Next::End if self.bytes.in_chunk() => self.leave_chunk(),
            Next::End => Ok(self.end(false)),
            Next::Piece => self.damaged(true),
            Next::Damage => self.damaged(false),
        }
    }

    #[inline]
    fn take(&mut self, record: &Record, block: &mut Block) -> Result<bool, Error> {
        let len = record.len();
        if record.op != op::CHUNK && self.bytes.room().is_some_and(|room| len > room) {
            return self.damaged(true);
        }
        match (record.op, record.conn) {
            (op::MESSAGE, Some(conn)) => {
                if let Some(role) = self.topics.role(conn) {
                    // No message that we know is so large.
                    if len > LARGEST_PIECE as u64 {
                        return self.damaged(false);
                    }
                    if !self.bytes.fill(len as usize)? {
                        return self.damaged(true);
                    }
                    let bytes = self.bytes.at_hand().get(..len as usize).unwrap_or_default();
                    let payload = bytes.get(8 + record.header..).unwrap_or_default();
                    if self.samples.message(payload, record.time, role, block) {
                        self.repeat = Repeat::of(bytes, record.header, role);
                    } else if next_record(payload, Among::Records).is_some() {
                        return self.damaged(false); // its length is wrong
                    } else {
                        self.samples.count_malformed();
                    }
                    self.bytes.consume(len as usize);
                    self.topics.count(conn, 1);
                    return Ok(true);
                }
                self.topics.count(conn, 1);
                self.unknown += u64::from(!self.topics.knows(conn));
            }
            (op::CHUNK, _) => return self.enter_chunk(record),
            (op::CONNECTION, _) if record.data > LARGEST_PIECE => return self.damaged(false),
            (op::INDEX, _) if !self.counted(record, 12) => return self.damaged(false),
            (op::CHUNK_INFO, _) if !self.counted(record, 8) => return self.damaged(false),
            (op::CONNECTION, _) => {
                if self.connection(record)? && !self.listed {
                    self.topics.choose(self.bytes.input().path())?;
                }
            }
            (op::INDEX, _) => self.account.indexes = self.account.indexes.saturating_add(1),
            (op::CHUNK_INFO, _) => self.account.infos = self.account.infos.saturating_add(1),
            (op::BAG_HEADER, _) => {}
            _ => return self.damaged(false),
        }
        self.step_over(record)
    }

    /// Takes the records at hand that repeat the shape of the last message.
    fn repeated(&mut self, block: &mut Block) {
        let Some(repeat) = self.repeat else { return };
        let mut bytes = self.bytes.at_hand();
        let mut messages = 0;
        while block.has_room()
            && let Some((time, message)) = repeat.next(bytes)
        {
            self.samples.imu(&message, time, repeat.role, block);
            messages += 1;
            bytes = bytes.get(repeat.len()..).unwrap_or_default();
        }
        self.topics.count(repeat.role.number, messages);
        self.bytes.consume(messages as usize * repeat.len());
    }

    /// Enters a chunk: its records come next.
    fn enter_chunk(&mut self, record: &Record) -> Result<bool, Error> {
        if self.bytes.unpacked() {
            return self.damaged(false); // there are no chunks in chunks
        }
        let start = self.bytes.offset();
        let fields = self.header(record).unwrap_or_default();
        let size = fields.size.unwrap_or(0);
        let name = fields.compression.unwrap_or(b"none");
        let (plain, compression) = (name == b"none", Compression::of(name));
        if !plain && compression.is_none() {
            let name = String::from_utf8_lossy(name).into_owned();
            self.warn(format!(
                "has a chunk at byte {start} whose compression ({name}) is none that is known"
            ));
            return self.damaged(false);
        }
        if self.bytes.in_chunk() {
            self.warn(format!(
                "has a chunk at byte {start}, before the end of the one that precedes it: one of \
                 them is damaged"
            ));
            self.bytes.leave();
        }
        self.account.chunks = self.account.chunks.saturating_add(1);
        self.bytes.consume(8 + record.header);
        let len = record.data as u64;
        match compression {
            None => self.bytes.enter(start, len),
            Some(how) if len > 0 => self.bytes.enter_packed(start, how, Some(len), size),
            // What a recorder was writing when it died: it fills in the length when it is done.
            Some(how) => {
                self.bytes.fill(4)?;
                if how.begins(self.bytes.at_hand()) {
                    self.bytes.enter_packed(start, how, None, size);
                }
            }
        }
        Ok(true)
    }

    /// Leaves a chunk of which all was read that can be.
    fn leave_chunk(&mut self) -> Result<bool, Error> {
        let (start, left) = self.bytes.leave();
        let chunk = format!("has a chunk at byte {start}");
        match left {
            Left::Whole => {}
            Left::Cut => return Ok(self.end(true)),
            Left::TooLong(more) => {
                self.warn(format!("{chunk} that ends {more} bytes before it should"));
            }
            Left::OtherSize { unpacked, says } => {
                self.warn(format!("{chunk} that unpacks to {unpacked} bytes where it says {says}"));
            }
            Left::WrongSum => self.warn(format!(
                "{chunk} whose checksum is wrong: values in it may be wrong, and are used"
            )),
            Left::Damaged { unpacked } => {
                self.warn(format!(
                    "{chunk} that is damaged: {unpacked} bytes could be unpacked, its rest is lost"
                ));
                self.search()?;
            }
        }
        Ok(true)
    }

    /// Steps over a record; whether there is more to read.
    fn step_over(&mut self, record: &Record) -> Result<bool, Error> {
        let (at, from) = (self.bytes.at(), self.bytes.offset());
        if self.bytes.skip(record.len())? {
            return Ok(true);
        }
        Ok(self.over(&at, from, true))
    }
}

impl Source for BagReader {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        block.clear();
        loop {
            self.repeated(block);
            if !block.has_room() {
                break;
            }
            if !self.record(block)? {
                if !self.topics.complete() {
                    return Err(self.topics.not_found(self.bytes.input().path()));
                }
                break;
            }
        }
        self.samples.scale(block);
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
        let mut notes = self.topics.take_notes();
        notes.append(&mut self.notes);
        notes
    }

    fn bytes_read(&self) -> u64 {
        self.bytes.input().offset()
    }

    fn bytes_total(&self) -> Option<u64> {
        self.bytes.input().len()
    }
}
