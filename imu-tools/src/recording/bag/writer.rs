//! Writing a bag: one Imu topic, chunks of 768 KiB, an index as other readers want it.
//!
//! The same samples give the same bytes on every machine: nothing is taken from a clock, and fields
//! stand in the order of their names.

use std::path::Path;

use super::imu_message::{DEFINITION, ImuMessage, MD5SUM, TYPE_NAME, Template};
use super::record::{push_fields, push_header, push_prefixed};
use super::{MAGIC, op};
use crate::error::Error;
use crate::output::Output;
use crate::recording::{Block, Sink, merge};

/// The topic that is written.
const TOPIC: &str = "/imu";

/// The frame that is written.
const FRAME: &str = "imu";

/// A chunk is closed when it has grown to this.
const CHUNK: usize = 768 * 1024;

/// Header and data of the bag header record fill this, so that it can be rewritten in place.
const BAG_HEADER: usize = 4096;

/// Our only connection.
const CONN: [u8; 4] = [0; 4];

/// Time in the form of a bag: seconds and nanoseconds, little-endian.
type Time = [u8; 8];

/// What the index says of a chunk.
#[derive(Clone, Copy, Debug)]
struct ChunkInfo {
    offset: u64,
    first: Time,
    last: Time,
    messages: u32,
}

/// A bag being written.
pub struct BagWriter {
    output: Output,
    written: u64,
    /// Records of the chunk at hand.
    chunk: Vec<u8>,
    /// Time and offset of each of its messages.
    index: Vec<u8>,
    span: Option<(i64, i64)>,
    chunks: Vec<ChunkInfo>,
    /// A message record without its payload; time stands at its end but for the payload's length.
    record: Vec<u8>,
    message: Template,
    seq: u32,
}

/// Splits a stamp; a bag's clock runs from 1970 to 2106.
fn split(stamp_ns: i64) -> Result<(u32, u32), Error> {
    let (sec, nsec) = (stamp_ns.div_euclid(1_000_000_000), stamp_ns.rem_euclid(1_000_000_000));
    u32::try_from(sec).map(|sec| (sec, nsec as u32)).map_err(|_| {
        Error::data(format!(
            "a bag cannot hold the stamp {stamp_ns} ns: its clock runs from 1970 to 2106"
        ))
    })
}

fn wire((sec, nsec): (u32, u32)) -> Time {
    (u64::from(sec) | u64::from(nsec) << 32).to_le_bytes()
}

impl BagWriter {
    /// Starts the bag that will stand at `path`.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn create(path: &Path) -> Result<Self, Error> {
        Self::write_to(Output::create(path)?)
    }

    /// Starts the bag that `output` will be.
    ///
    /// # Errors
    /// When the disk is full.
    pub(crate) fn write_to(output: Output) -> Result<Self, Error> {
        let mut record = Vec::new();
        push_header(&mut record, &[("conn", &CONN), ("op", &[op::MESSAGE]), ("time", &[0; 8])]);
        let mut bag = Self {
            output,
            written: 0,
            chunk: Vec::with_capacity(CHUNK + 4096),
            index: Vec::with_capacity(CHUNK / 24),
            span: None,
            chunks: Vec::new(),
            record,
            message: Template::new(FRAME),
            seq: 0,
        };
        let mut start = MAGIC.to_vec();
        start.extend_from_slice(&bag.bag_header(0));
        bag.put(&start)?;
        bag.connection();
        Ok(bag)
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.written += bytes.len() as u64;
        self.output.write(bytes)
    }

    /// The bag header record, always of the same length.
    fn bag_header(&self, index_pos: u64) -> Vec<u8> {
        let mut record = Vec::with_capacity(BAG_HEADER + 8);
        push_header(
            &mut record,
            &[
                ("chunk_count", &(self.chunks.len() as u32).to_le_bytes()),
                ("conn_count", &1u32.to_le_bytes()),
                ("index_pos", &index_pos.to_le_bytes()),
                ("op", &[op::BAG_HEADER]),
            ],
        );
        let padding = (BAG_HEADER + 4).saturating_sub(record.len());
        push_prefixed(&mut record, &vec![b' '; padding]);
        record
    }

    /// Appends the description of our connection to the chunk.
    fn connection(&mut self) {
        push_header(
            &mut self.chunk,
            &[("conn", &CONN), ("op", &[op::CONNECTION]), ("topic", TOPIC.as_bytes())],
        );
        let mut data = Vec::new();
        push_fields(
            &mut data,
            &[
                ("md5sum", MD5SUM.as_bytes()),
                ("message_definition", DEFINITION.as_bytes()),
                ("topic", TOPIC.as_bytes()),
                ("type", TYPE_NAME.as_bytes()),
            ],
        );
        push_prefixed(&mut self.chunk, &data);
    }

    /// Appends one message.
    fn message(&mut self, stamp_ns: i64, message: &ImuMessage) -> Result<(), Error> {
        let time = wire(message.stamp);
        self.index.extend_from_slice(&time);
        self.index.extend_from_slice(&(self.chunk.len() as u32).to_le_bytes());
        if let Some(field) = self.record.last_chunk_mut() {
            *field = time;
        }
        self.chunk.extend_from_slice(&self.record);
        push_prefixed(&mut self.chunk, self.message.fill(self.seq, message));
        self.seq = self.seq.wrapping_add(1);
        let (first, last) = self.span.unwrap_or((stamp_ns, stamp_ns));
        self.span = Some((first.min(stamp_ns), last.max(stamp_ns)));
        if self.chunk.len() >= CHUNK {
            self.close_chunk()?;
        }
        Ok(())
    }

    /// Writes the chunk at hand and its index.
    fn close_chunk(&mut self) -> Result<(), Error> {
        let Some((first, last)) = self.span.take() else { return Ok(()) };
        let (first, last) = (wire(split(first)?), wire(split(last)?));
        let messages = (self.index.len() / 12) as u32;
        self.chunks.push(ChunkInfo { offset: self.written, first, last, messages });
        let mut header = Vec::new();
        let size = self.chunk.len() as u32;
        push_header(
            &mut header,
            &[("compression", b"none"), ("op", &[op::CHUNK]), ("size", &size.to_le_bytes())],
        );
        header.extend_from_slice(&size.to_le_bytes());
        self.put(&header)?;
        let chunk = std::mem::take(&mut self.chunk);
        self.put(&chunk)?;
        self.chunk = chunk;
        self.chunk.clear();

        let mut index = Vec::with_capacity(self.index.len() + 64);
        push_header(
            &mut index,
            &[
                ("conn", &CONN),
                ("count", &messages.to_le_bytes()),
                ("op", &[op::INDEX]),
                ("ver", &1u32.to_le_bytes()),
            ],
        );
        push_prefixed(&mut index, &self.index);
        self.index.clear();
        self.put(&index)
    }

    /// Appends the list of connections and chunks and completes the bag header.
    fn close(mut self) -> Result<(), Error> {
        // An empty recording is a bag with one chunk that holds a connection and no message.
        if self.chunks.is_empty() && self.span.is_none() {
            self.chunk.clear();
        }
        self.close_chunk()?;
        let index_pos = self.written;
        self.chunk.clear();
        self.connection();
        for info in &self.chunks {
            push_header(
                &mut self.chunk,
                &[
                    ("chunk_pos", &info.offset.to_le_bytes()),
                    ("count", &1u32.to_le_bytes()),
                    ("end_time", &info.last),
                    ("op", &[op::CHUNK_INFO]),
                    ("start_time", &info.first),
                    ("ver", &1u32.to_le_bytes()),
                ],
            );
            let mut count = CONN.to_vec();
            count.extend_from_slice(&info.messages.to_le_bytes());
            push_prefixed(&mut self.chunk, &count);
        }
        let list = std::mem::take(&mut self.chunk);
        self.put(&list)?;
        let header = self.bag_header(index_pos);
        self.output.patch(MAGIC.len() as u64, &header)?;
        self.output.finish()
    }
}

impl Sink for BagWriter {
    fn write_block(&mut self, block: &Block) -> Result<(), Error> {
        merge(block, |stamp_ns, rate, force| {
            let message = ImuMessage { stamp: split(stamp_ns)?, rate, force };
            self.message(stamp_ns, &message)
        })
    }

    fn flush(&mut self) -> Result<(), Error> {
        self.close_chunk()?;
        self.output.sync()
    }

    fn finish(self: Box<Self>) -> Result<(), Error> {
        self.close()
    }
}
