//! Reading an MCAP file front to back, in a file or a pipe.
//!
//! A chunk's checksum covers a megabyte, and all of its messages were already handed on when it
//! turns out to be wrong: they are used, with a warning that says where. A chunk of which a long
//! record is passed over unread (an image of a megabyte) is not checked, and neither are the
//! checksums of data section and summary.

mod described;
mod lost;

use super::chunk::Chunk;
use super::record::{self, ChunkHead, Fields, HEAD, MESSAGE};
use super::repeat::{self, Repeat};
use super::{MAGIC, op};
use crate::error::Error;
use crate::recording::input::{Input, LARGEST_PIECE};
use crate::recording::inside::Compression;
use crate::recording::ros2::Taken;
use crate::recording::topics::Topics;
use crate::recording::{Block, Note, ReadOptions, Source, Stream};

/// A longer record of another topic is passed over without a look at its checksum.
const WORTH_A_SEEK: u64 = LARGEST_PIECE as u64;

/// An MCAP file being read.
pub struct McapReader {
    input: Input,
    topics: Topics,
    /// Names of the types that channels refer to by number.
    schemas: Vec<(u16, String)>,
    chunk: Option<Chunk>,
    /// The list of channels was read, so that no other topic will turn up.
    listed: bool,
    /// The data section is over.
    data_ended: bool,
    ended: bool,
    repeat: Option<Repeat>,
    taken: Taken,
    /// Messages so far, of all topics, and those of channels that were never described.
    messages: u64,
    unknown: u64,
    /// Messages that the file's statistics count.
    expected: Option<u64>,
    notes: Vec<Note>,
}

/// What the next bytes hold.
enum Next {
    /// A record: its opcode and length with its head.
    Record(u8, u64),
    /// Nothing: file or chunk are over.
    End,
    /// A piece of a record: file or chunk were cut off here.
    Cut,
}

impl McapReader {
    /// Starts to read: finds the topic, as far ahead as is needed for that.
    ///
    /// # Errors
    /// When this is no MCAP file, or has not exactly one topic that fits.
    pub fn open(mut input: Input, options: &ReadOptions) -> Result<Self, Error> {
        let path = input.path().display().to_string();
        if options.are_for_a_table() {
            return Err(Error::usage(format!(
                "{path} is an MCAP file: --columns, --map and --time-unit are for tables, --topic and \
                 --bag-time are for recordings of ROS"
            )));
        }
        input.fill(MAGIC.len())?;
        if !input.at_hand().starts_with(MAGIC) {
            return Err(Error::data(format!("{path} is no MCAP file")));
        }
        input.consume(MAGIC.len());
        let mut mcap = Self {
            input,
            topics: Topics::new(options),
            schemas: Vec::new(),
            chunk: None,
            listed: false,
            data_ended: false,
            ended: false,
            repeat: None,
            taken: Taken::new(options),
            messages: 0,
            unknown: 0,
            expected: None,
            notes: Vec::new(),
        };
        mcap.listed = mcap.list()?;
        mcap.topics.choose(mcap.input.path())?;
        let mut ahead = Block::default();
        while !mcap.listed && !mcap.topics.any() && mcap.record(&mut ahead)? {
            ahead.clear();
        }
        if mcap.topics.lack(mcap.listed) {
            return Err(mcap.topics.not_found(mcap.input.path()));
        }
        Ok(mcap)
    }

    /// What comes next; nothing is consumed.
    #[inline]
    fn next(&mut self) -> Result<Next, Error> {
        if !self.input.fill(HEAD)? {
            return Ok(if self.input.at_hand().is_empty() { Next::End } else { Next::Cut });
        }
        let Some((op, len)) = record::head(self.input.at_hand()) else { return Ok(Next::Cut) };
        Ok(Next::Record(op, len.saturating_add(HEAD as u64)))
    }

    /// Data of the record at hand, of length `len` with its head: all, or the start of a long one.
    fn data(&mut self, len: u64) -> Result<&[u8], Error> {
        let len = usize::try_from(len).unwrap_or(LARGEST_PIECE).min(LARGEST_PIECE);
        self.input.fill(len)?;
        let here = self.input.at_hand();
        Ok(here.get(HEAD..len.min(here.len())).unwrap_or_default())
    }

    /// Takes one record; `false` at the end.
    #[inline]
    fn record(&mut self, block: &mut Block) -> Result<bool, Error> {
        if self.ended {
            return Ok(false);
        }
        let here = self.input.offset();
        // Where the records end in which we are: those of the chunk, or those of the file.
        let limit = match &self.chunk {
            Some(Chunk { end: Some(end), .. }) if here >= *end => return self.leave_chunk(false),
            Some(chunk) => chunk.end,
            None => self.input.len(),
        };
        let (op, len) = match self.next()? {
            Next::Record(op, len) => (op, len),
            Next::End | Next::Cut if self.is_packed() => return self.leave_chunk(false),
            Next::End if self.chunk.is_none() => return Ok(self.at_end()),
            Next::End | Next::Cut => return Ok(self.cut_off()),
        };
        if op == op::CHUNK && self.chunk.is_none() {
            return self.enter_chunk(len);
        }
        if op == 0 || limit.is_some_and(|limit| here.saturating_add(len) > limit) {
            return self.damaged();
        }
        match op {
            op::MESSAGE => return self.message(len, block),
            op::SCHEMA => self.schema(len)?,
            op::CHANNEL => self.channel(len)?,
            op::STATISTICS => self.expected = Fields(self.data(len)?).u64(),
            op::DATA_END => self.data_ended = true,
            op::FOOTER => return self.footer(len),
            _ => {}
        }
        self.pass(len)
    }

    /// The last record: the magic ends the file.
    #[cold]
    fn footer(&mut self, len: u64) -> Result<bool, Error> {
        self.data_ended = true;
        if !self.input.skip(len)?
            || !self.input.fill(MAGIC.len())?
            || !self.input.at_hand().starts_with(MAGIC)
        {
            return Ok(self.cut_off());
        }
        self.input.consume(MAGIC.len());
        self.ended = true;
        Ok(false)
    }

    /// Takes the message at hand.
    #[inline]
    fn message(&mut self, len: u64, block: &mut Block) -> Result<bool, Error> {
        if len < (HEAD + MESSAGE) as u64 {
            self.taken.malformed();
            return self.pass(len);
        }
        if !self.input.fill(HEAD + 2)? {
            return self.ended_here();
        }
        let data = self.input.at_hand().get(HEAD..).unwrap_or_default();
        let channel = u32::from(Fields(data).u16().unwrap_or_default());
        let role = self.topics.role(channel);
        if role.is_none() || len > LARGEST_PIECE as u64 {
            self.unknown += u64::from(!self.topics.knows(channel));
            if role.is_some() {
                self.taken.malformed();
            }
            self.topics.count(channel, 1);
            self.messages += 1;
            return self.pass(len);
        }
        let len = len as usize;
        if !self.input.fill(len)? {
            return self.ended_here();
        }
        let record = self.input.at_hand().get(..len).unwrap_or_default();
        if let (Some(role), Some(message)) = (role, repeat::recorded(record)) {
            self.taken.message(message, role, block);
            self.repeat = Repeat::of(record, role);
        }
        self.took(channel, 1, len);
        self.repeated(block);
        Ok(true)
    }

    /// Takes the records at hand that repeat the shape of the last message.
    fn repeated(&mut self, block: &mut Block) {
        let Some(repeat) = self.repeat else { return };
        let mut bytes = self.input.at_hand();
        if let Some(end) = self.chunk.as_ref().and_then(|chunk| chunk.end) {
            let inside = usize::try_from(end.saturating_sub(self.input.offset()));
            bytes = bytes.get(..bytes.len().min(inside.unwrap_or(usize::MAX))).unwrap_or_default();
        }
        let mut messages = 0;
        while block.has_room()
            && let Some((time_ns, message)) = repeat.next(bytes)
        {
            self.taken.imu(&message, time_ns, repeat.role, block);
            messages += 1;
            bytes = bytes.get(repeat.len..).unwrap_or_default();
        }
        self.took(repeat.role.number, messages, messages as usize * repeat.len);
    }

    /// Counts messages of a channel that were taken, and drops their `used` bytes.
    fn took(&mut self, channel: u32, messages: u64, used: usize) {
        self.topics.count(channel, messages);
        self.messages += messages;
        if let Some(chunk) = &mut self.chunk {
            chunk.add(self.input.at_hand().get(..used).unwrap_or_default());
        }
        self.input.consume(used);
    }

    /// Passes over a record.
    fn pass(&mut self, len: u64) -> Result<bool, Error> {
        if self.skip(len)? { Ok(true) } else { self.ended_here() }
    }

    /// Drops `n` bytes; `false` when file or chunk end before.
    fn skip(&mut self, n: u64) -> Result<bool, Error> {
        let Some(chunk) = self.chunk.as_mut().filter(|chunk| chunk.is_checked()) else {
            return self.input.skip(n);
        };
        if n >= WORTH_A_SEEK && chunk.end.is_some() {
            chunk.do_not_check();
            return self.input.skip(n);
        }
        let mut left = n;
        while left > 0 {
            if !self.input.fill(1)? {
                return Ok(false);
            }
            let here = self.input.at_hand();
            let n = here.len().min(usize::try_from(left).unwrap_or(usize::MAX));
            chunk.add(here.get(..n).unwrap_or_default());
            self.input.consume(n);
            left -= n as u64;
        }
        Ok(true)
    }

    /// Whether we are in a compressed chunk.
    fn is_packed(&self) -> bool {
        self.chunk.as_ref().is_some_and(|chunk| chunk.end.is_none())
    }

    /// Goes into the chunk at hand.
    fn enter_chunk(&mut self, len: u64) -> Result<bool, Error> {
        let start = self.input.offset();
        let wanted = len.min((HEAD + record::CHUNK) as u64);
        let whole = self.input.fill(wanted as usize)?;
        let data = self.input.at_hand().get(HEAD..).unwrap_or_default();
        let head = match ChunkHead::parse(data) {
            Some(head) if head.stored <= len.saturating_sub((HEAD + head.len) as u64) => head,
            None if !whole => return Ok(self.cut_off()),
            _ => return self.damaged(),
        };
        let compression = match head.compression.as_str() {
            "" => None,
            "zstd" => Some(Compression::Zstd),
            "lz4" => Some(Compression::Lz4),
            other => {
                return Err(Error::data(format!(
                    "{} is compressed with {other}, which is not known: `mcap compress` of the \
                     MCAP tools makes zstd or lz4 of it",
                    self.input.path().display()
                )));
            }
        };
        self.input.consume(HEAD + head.len);
        let end = compression.is_none().then(|| self.input.offset().saturating_add(head.stored));
        self.chunk = Some(Chunk::new(&head, start, start.saturating_add(len), end));
        if let Some(compression) = compression {
            self.input.enter(head.stored, compression);
        }
        Ok(true)
    }

    /// Leaves the chunk, all of whose records were read, or all that could be; `cut` if the last
    /// one was not whole.
    fn leave_chunk(&mut self, cut: bool) -> Result<bool, Error> {
        let Some(chunk) = self.chunk.take() else { return Ok(true) };
        if chunk.end.is_none() {
            let (decoded, rest) = (self.input.offset(), self.input.at_hand().len() as u64);
            let damaged = self.input.is_damaged();
            if !self.input.leave()? {
                self.ended = true;
                self.warn(format!(
                    "ends in the middle of a chunk, of whose {} bytes {decoded} could be \
                     decompressed: what comes before is used",
                    chunk.unpacked
                ));
                return Ok(false);
            }
            if damaged || cut || rest > 0 || decoded != chunk.unpacked {
                self.warn(format!(
                    "is damaged in the chunk at byte {}, of whose {} bytes {decoded} could be \
                     decompressed: what was whole in it is used",
                    chunk.start, chunk.unpacked
                ));
                return self.behind(chunk.next);
            }
        }
        let (start, next) = (chunk.start, chunk.next);
        if !chunk.checks_out() {
            self.warn(format!(
                "is damaged in the chunk at byte {start}, whose checksum is wrong: its samples are \
                 used, and some may be false"
            ));
        }
        self.behind(next)
    }

    /// Goes behind what may pad a chunk.
    fn behind(&mut self, next: u64) -> Result<bool, Error> {
        let padding = next.saturating_sub(self.input.offset());
        if self.input.skip(padding)? { Ok(true) } else { Ok(self.cut_off()) }
    }
}

impl Source for McapReader {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        block.clear();
        while block.has_room() {
            if !self.record(block)? {
                if !self.topics.complete() {
                    return Err(self.topics.not_found(self.input.path()));
                }
                self.warn_of_messages();
                break;
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
        self.input.file_offset()
    }

    fn bytes_total(&self) -> Option<u64> {
        self.input.len()
    }
}
