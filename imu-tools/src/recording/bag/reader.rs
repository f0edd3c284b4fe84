//! Reading a bag front to back, in a file or a pipe.

use super::MAGIC;
use super::imu_message::{ImuMessage, MD5SUM, TYPE_NAME};
use super::op;
use super::record::{Header, prefixed};
use super::repeat::Repeat;
use crate::error::Error;
use crate::recording::input::{Input, LARGEST_PIECE};
use crate::recording::topics::{Connection, Holds, Role, Topics};
use crate::recording::{
    BLOCK_SAMPLES, Block, ForceUnit, Note, RateUnit, ReadOptions, Sample, Source, Stream,
};

/// A bag being read.
pub struct BagReader {
    input: Input,
    topics: Topics,
    bag_time: bool,
    /// Factors to SI units: 1 unless the user says that the bag does not keep to them.
    rate: f64,
    force: f64,
    /// Where the chunk ends in which we are.
    chunk_end: u64,
    /// Where the bag says that its index is; 0 when it was never closed.
    index_pos: u64,
    /// The list of connections was read, so that no other topic will turn up.
    listed: bool,
    ended: bool,
    repeat: Option<Repeat>,
    taken: Taken,
    unknown: u64,
    notes: Vec<Note>,
}

/// What the next bytes hold.
enum Next {
    /// A record: lengths of header and data, and what its header says.
    Record { header: usize, data: usize, op: u8, conn: Option<u32>, time: (u32, u32) },
    /// Nothing: the file is over.
    End,
    /// A piece of a record: the file was cut off here.
    Cut,
    /// Something that is no record.
    Damage,
}

impl BagReader {
    /// Starts to read: finds the topic, as far ahead as is needed for that.
    ///
    /// # Errors
    /// When this is no bag, is compressed, or has not exactly one topic that fits.
    pub fn open(mut input: Input, options: &ReadOptions) -> Result<Self, Error> {
        if options.columns.is_some() || options.time_unit.is_some() {
            return Err(Error::usage(format!(
                "{} is a bag: --columns and --time-unit are for tables, --topic and --bag-time \
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
            input,
            topics: Topics::new(options),
            bag_time: options.bag_time,
            rate: options.gyro_unit.map_or(1.0, RateUnit::to_rad_s),
            force: options.accel_unit.map_or(1.0, ForceUnit::to_m_s2),
            chunk_end: 0,
            index_pos: 0,
            listed: false,
            ended: false,
            repeat: None,
            taken: Taken::default(),
            unknown: 0,
            notes: Vec::new(),
        };
        bag.bag_header()?;
        bag.list()?;
        bag.topics.choose(bag.input.path())?;
        let mut ahead = Block::default();
        while !bag.listed && !bag.topics.any() && bag.record(&mut ahead)? {}
        if !bag.topics.any() || (bag.listed && !bag.topics.complete()) {
            return Err(bag.topics.not_found(bag.input.path()));
        }
        Ok(bag)
    }

    /// Takes where the index is from the first record; leaves anything else to the main loop.
    fn bag_header(&mut self) -> Result<(), Error> {
        if let Next::Record { header, data, op: op::BAG_HEADER, .. } = self.next()? {
            let fields = self.header(header).unwrap_or_default();
            self.index_pos = fields.index_pos.unwrap_or(0);
            self.ended = !self.input.skip((8 + header + data) as u64)?;
            self.cut_off_if(self.ended);
        }
        Ok(())
    }

    /// Reads all connections from the end of the file, where one can go there and back.
    fn list(&mut self) -> Result<(), Error> {
        let back = self.input.offset();
        if self.index_pos < back || !self.input.seek(self.index_pos)? {
            return Ok(());
        }
        let mut found = false;
        self.listed = loop {
            match self.next()? {
                Next::Record { header, data, op: op::CONNECTION, conn, .. } => {
                    self.connection(header, data, conn)?;
                    found = true;
                    if !self.input.skip((8 + header + data) as u64)? {
                        break false;
                    }
                }
                Next::Record { op: op::CHUNK_INFO, .. } => break true,
                Next::End => break found,
                _ => break false,
            }
        };
        self.input.seek(back)?;
        Ok(())
    }

    /// What comes next; nothing is consumed.
    #[inline]
    fn next(&mut self) -> Result<Next, Error> {
        if !self.input.fill(4)? {
            return Ok(if self.input.at_hand().is_empty() { Next::End } else { Next::Cut });
        }
        let header = self.input.at_hand().first_chunk().map_or(0, |b| u32::from_le_bytes(*b));
        let header = header as usize;
        if header > LARGEST_PIECE - 8 {
            return Ok(Next::Damage);
        }
        if !self.input.fill(8 + header)? {
            return Ok(Next::Cut);
        }
        let Some((bytes, rest)) = prefixed(self.input.at_hand()) else { return Ok(Next::Cut) };
        let Some(data) = rest.first_chunk() else { return Ok(Next::Cut) };
        let Some(Header { op: Some(op), conn, time, .. }) = Header::parse(bytes) else {
            return Ok(Next::Damage);
        };
        let data = u32::from_le_bytes(*data) as usize;
        Ok(Next::Record { header, data, op, conn, time: time.unwrap_or_default() })
    }

    /// All fields of the header at hand.
    fn header(&self, len: usize) -> Option<Header<'_>> {
        Header::parse(self.input.at_hand().get(4..4 + len)?)
    }

    /// Takes one record; `false` at the end.
    #[inline]
    fn record(&mut self, block: &mut Block) -> Result<bool, Error> {
        if self.ended {
            return Ok(false);
        }
        let (header, data, op, conn, time) = match self.next()? {
            Next::Record { header, data, op, conn, time } => (header, data, op, conn, time),
            Next::Damage => return self.damaged(),
            Next::End => return Ok(self.at_end()),
            Next::Cut => return Ok(self.cut_off_if(true)),
        };
        let len = (8 + header + data) as u64;
        let here = self.input.offset();
        if here < self.chunk_end && here + len > self.chunk_end {
            return self.damaged();
        }
        match (op, conn) {
            (op::MESSAGE, Some(conn)) => {
                self.topics.count(conn);
                if let Some(role) = self.topics.role(conn) {
                    if len > LARGEST_PIECE as u64 {
                        self.taken.malformed += 1;
                    } else if self.input.fill(len as usize)? {
                        let record = self.input.at_hand().get(..len as usize).unwrap_or_default();
                        let payload = record.get(8 + header..).unwrap_or_default();
                        self.taken.message(payload, time, self.bag_time, role, block);
                        self.repeat = Repeat::of(record, header, role);
                        self.input.consume(len as usize);
                        return Ok(true);
                    } else {
                        return Ok(self.cut_off_if(true));
                    }
                } else if !self.topics.knows(conn) {
                    self.unknown += 1;
                }
            }
            (op::CHUNK, _) => {
                self.chunk(header)?;
                self.input.consume(8 + header);
                self.chunk_end = here + len;
                return Ok(true);
            }
            (op::CONNECTION, conn) => {
                self.connection(header, data, conn)?;
                if !self.listed {
                    self.topics.choose(self.input.path())?;
                }
            }
            (op::BAG_HEADER | op::INDEX | op::CHUNK_INFO, _) => {}
            _ => return self.damaged(),
        }
        let whole = self.input.skip(len)?;
        Ok(self.cut_off_if(!whole))
    }

    /// Takes the records at hand that repeat the shape of the last message.
    fn repeated(&mut self, block: &mut Block) {
        let Some(repeat) = self.repeat else { return };
        let mut bytes = self.input.at_hand();
        let here = self.input.offset();
        if here < self.chunk_end {
            let inside = bytes.len().min((self.chunk_end - here) as usize);
            bytes = bytes.get(..inside).unwrap_or_default();
        }
        let mut used = 0;
        while has_room(block)
            && let Some((time, payload)) = repeat.next(bytes)
        {
            self.taken.message(payload, time, self.bag_time, repeat.role, block);
            self.topics.count(repeat.role.number);
            used += repeat.len;
            bytes = bytes.get(repeat.len..).unwrap_or_default();
        }
        self.input.consume(used);
    }

    /// Enters a chunk: its records come next.
    fn chunk(&mut self, header: usize) -> Result<(), Error> {
        let compression = self.header(header).and_then(|h| h.compression).unwrap_or(b"none");
        if compression == b"none" {
            return Ok(());
        }
        let path = self.input.path().display();
        Err(Error::data(format!(
            "{path} is compressed ({}), which is not supported yet: decompress it with \
             `rosbag decompress` and read the result",
            String::from_utf8_lossy(compression)
        )))
    }

    /// Takes note of a connection; a description that is too large or cut off says nothing.
    fn connection(&mut self, header: usize, data: usize, conn: Option<u32>) -> Result<(), Error> {
        let Some(conn) = conn else { return Ok(()) };
        if !self.input.fill(8 + header + data)? {
            return Ok(());
        }
        let bytes = self.input.at_hand();
        let fields = bytes.get(4..4 + header).and_then(Header::parse);
        let described = bytes.get(8 + header..8 + header + data).and_then(Header::parse);
        if let (Some(fields), Some(described)) = (fields, described) {
            let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
            let (Some(topic), Some(type_name)) =
                (fields.topic.or(described.topic), described.type_name)
            else {
                return Ok(());
            };
            self.topics.add(Connection {
                number: conn,
                topic: text(topic),
                type_name: text(type_name),
                holds: holds(type_name, described.md5sum.unwrap_or_default()),
            });
        }
        Ok(())
    }

    /// Steps over what cannot be read: to the end of its chunk, or, outside of one, to the end.
    #[cold]
    fn damaged(&mut self) -> Result<bool, Error> {
        let here = self.input.offset();
        if here < self.chunk_end {
            let lost = self.chunk_end - here;
            self.warn(format!("is damaged at byte {here}: {lost} bytes are lost"));
            let whole = self.input.skip(lost)?;
            return Ok(self.cut_off_if(!whole));
        }
        self.warn(format!("is damaged at byte {here}: the rest is lost"));
        self.ended = true;
        Ok(false)
    }

    /// Says what is lost of a bag that was cut off; whether there is more to read.
    fn cut_off_if(&mut self, cut: bool) -> bool {
        if cut {
            self.ended = true;
            let size = self.input.offset() + self.input.at_hand().len() as u64;
            let lost = self.index_pos.saturating_sub(size);
            self.warn(if self.index_pos == 0 {
                "was not closed and ends in the middle of a record: what comes before is used"
                    .into()
            } else if lost > 0 {
                format!("is cut off: its last {lost} bytes of data, or more, are lost")
            } else {
                "is cut off in its index: no message is lost".into()
            });
        }
        !cut
    }

    /// Says what is lost of a bag that ends with a whole record.
    #[cold]
    fn at_end(&mut self) -> bool {
        self.ended = true;
        let size = self.input.offset();
        if self.index_pos == 0 {
            self.warn("was not closed: what was recorded last may be missing".into());
        } else if size < self.index_pos {
            let lost = self.index_pos - size;
            self.warn(format!("is cut off: its last {lost} bytes of data, or more, are lost"));
        }
        false
    }

    fn warn(&mut self, what: String) {
        /// Damage is told so often, at most.
        const TOLD: usize = 20;
        if self.notes.len() < TOLD {
            self.notes.push(Note::Warning(format!("{} {what}", self.input.path().display())));
        }
    }

    /// Says, once, what was strange about the messages.
    fn warn_of_messages(&mut self) {
        let Taken { messages, unstamped, malformed } = std::mem::take(&mut self.taken);
        let unknown = std::mem::take(&mut self.unknown);
        if malformed > 0 {
            self.warn(format!("has {malformed} messages that are no {TYPE_NAME}"));
        }
        if unknown > 0 {
            self.warn(format!("has {unknown} messages of topics that it does not name"));
        }
        if messages > 1 && unstamped == messages && !self.bag_time {
            self.warn("has no stamps in its messages: read it with --bag-time".into());
        }
    }
}

/// What the messages of a type are to us: its name and fingerprint must be the ones that we know.
fn holds(type_name: &[u8], md5sum: &[u8]) -> Holds {
    if type_name != TYPE_NAME.as_bytes() {
        Holds::Other
    } else if [MD5SUM.as_bytes(), b"*", b""].contains(&md5sum) {
        Holds::Imu
    } else {
        Holds::Unreadable(format!(
            "holds an unknown layout of {TYPE_NAME} (md5sum {}, where {MD5SUM} is expected)",
            String::from_utf8_lossy(md5sum)
        ))
    }
}

/// What was taken so far.
#[derive(Clone, Copy, Debug, Default)]
struct Taken {
    messages: u64,
    /// Messages whose stamp is 0.
    unstamped: u64,
    /// Messages that cannot be read.
    malformed: u64,
}

impl Taken {
    /// Takes one message, recorded at `time`.
    #[inline]
    fn message(
        &mut self,
        payload: &[u8],
        time: (u32, u32),
        bag_time: bool,
        role: Role,
        to: &mut Block,
    ) {
        let Some(message) = ImuMessage::parse(payload) else {
            self.malformed += 1;
            return;
        };
        self.messages += 1;
        self.unstamped += u64::from(message.stamp == (0, 0));
        let (sec, nsec) = if bag_time { time } else { message.stamp };
        let stamp_ns = i64::from(sec) * 1_000_000_000 + i64::from(nsec);
        if let Some(value) = message.rate
            && role.gyroscope
        {
            to.gyroscope.push(Sample { stamp_ns, value });
        }
        if let Some(value) = message.force
            && role.accelerometer
        {
            to.accelerometer.push(Sample { stamp_ns, value });
        }
    }
}

/// Brings values to SI units.
fn scale(samples: &mut [Sample], factor: f64) {
    if factor != 1.0 {
        for value in samples.iter_mut().flat_map(|sample| &mut sample.value) {
            *value *= factor;
        }
    }
}

/// Whether another message fits.
#[inline]
fn has_room(block: &Block) -> bool {
    block.gyroscope.len() < BLOCK_SAMPLES && block.accelerometer.len() < BLOCK_SAMPLES
}

impl Source for BagReader {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        block.clear();
        loop {
            self.repeated(block);
            if !has_room(block) {
                break;
            }
            if !self.record(block)? {
                if !self.topics.complete() {
                    return Err(self.topics.not_found(self.input.path()));
                }
                self.warn_of_messages();
                break;
            }
        }
        scale(&mut block.gyroscope, self.rate);
        scale(&mut block.accelerometer, self.force);
        Ok(!block.gyroscope.is_empty() || !block.accelerometer.is_empty())
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
        self.input.offset()
    }

    fn bytes_total(&self) -> Option<u64> {
        self.input.len()
    }
}
