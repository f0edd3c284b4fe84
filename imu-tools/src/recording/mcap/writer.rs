//! Writing an MCAP file as ROS 2 does: one Imu topic, chunks of 768 KiB, an index and checksums.
//!
//! The same samples give the same bytes on every machine: nothing is taken from a clock, and chunks
//! are not compressed, so that no change of a compressor changes them (and the Zstandard encoder in
//! Rust, 50 MB/s, would make of two seconds for four hours of samples twenty). Nothing is patched in
//! after it was written.

use std::path::Path;

use crc32fast::Hasher;

use super::record::{HEAD, push_record, push_text};
use super::{MAGIC, op};
use crate::error::Error;
use crate::output::Output;
use crate::recording::ros2::{DEFINITION, IMU, Template};
use crate::recording::{Block, Sink, merge};

/// The topic that is written.
const TOPIC: &str = "/imu";

/// The frame that is written.
const FRAME: &str = "imu";

/// How reliable a publisher is, without which players of ROS 2 guess: keep the last ten, reliable,
/// volatile.
const QOS: &str = "- history: 1\n  depth: 10\n  reliability: 1\n  durability: 2\n  deadline:\n    \
                   sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    \
                   nsec: 854775807\n  liveliness: 1\n  liveliness_lease_duration:\n    sec: \
                   9223372036\n    nsec: 854775807\n  avoid_ros_namespace_conventions: false\n";

/// A chunk is closed when it has grown to this.
const CHUNK: usize = 768 * 1024;

/// Numbers of our only schema and channel. 0 is no schema.
const SCHEMA: u16 = 1;
const CHANNEL: u16 = 0;

/// First and last time of messages, nanoseconds.
type Span = Option<(u64, u64)>;

/// What the index says of a chunk.
#[derive(Clone, Copy, Debug)]
struct ChunkInfo {
    start: u64,
    /// Length of its record.
    len: u64,
    span: (u64, u64),
    /// Length of its records.
    records: u64,
    /// Length of the index behind it.
    index: u64,
}

/// An MCAP file being written.
pub struct McapWriter {
    output: Output,
    written: u64,
    /// Checksum of all that was written.
    sum: Hasher,
    /// Records of the chunk at hand.
    chunk: Vec<u8>,
    /// Time and offset of each of its messages.
    index: Vec<u8>,
    span: Span,
    /// Those of the whole file.
    whole: Span,
    messages: u64,
    chunks: Vec<ChunkInfo>,
    message: Template,
}

/// A stamp in the two forms in which it is written.
#[derive(Clone, Copy)]
struct Stamp {
    ns: u64,
    split: (i32, u32),
}

impl Stamp {
    fn new(stamp_ns: i64) -> Result<Self, Error> {
        let (sec, nanosec) =
            (stamp_ns.div_euclid(1_000_000_000), stamp_ns.rem_euclid(1_000_000_000));
        match (u64::try_from(stamp_ns), i32::try_from(sec)) {
            (Ok(ns), Ok(sec)) => Ok(Self { ns, split: (sec, nanosec as u32) }),
            _ => Err(Error::data(format!(
                "an MCAP file of ROS 2 cannot hold the stamp {stamp_ns} ns: its clock runs from \
                 1970 to 2038"
            ))),
        }
    }
}

/// The span with a time in it.
fn with(span: Span, ns: u64) -> Span {
    let (first, last) = span.unwrap_or((ns, ns));
    Some((first.min(ns), last.max(ns)))
}

/// Appends the schema.
fn push_schema(to: &mut Vec<u8>) {
    push_record(to, op::SCHEMA, |data| {
        data.extend_from_slice(&SCHEMA.to_le_bytes());
        push_text(data, IMU);
        push_text(data, "ros2msg");
        push_text(data, DEFINITION);
    });
}

/// Appends the channel.
fn push_channel(to: &mut Vec<u8>) {
    push_record(to, op::CHANNEL, |data| {
        data.extend_from_slice(&CHANNEL.to_le_bytes());
        data.extend_from_slice(&SCHEMA.to_le_bytes());
        push_text(data, TOPIC);
        push_text(data, "cdr");
        let mut metadata = Vec::new();
        push_text(&mut metadata, "offered_qos_profiles");
        push_text(&mut metadata, QOS);
        data.extend_from_slice(&(metadata.len() as u32).to_le_bytes());
        data.extend_from_slice(&metadata);
    });
}

impl McapWriter {
    /// Starts the file that will stand at `path`.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn create(path: &Path) -> Result<Self, Error> {
        Self::write_to(Output::create(path)?)
    }

    /// Starts the file that `output` will be.
    ///
    /// # Errors
    /// When the disk is full.
    pub(crate) fn write_to(output: Output) -> Result<Self, Error> {
        let mut mcap = Self {
            output,
            written: 0,
            sum: Hasher::new(),
            chunk: Vec::with_capacity(CHUNK + 4096),
            index: Vec::with_capacity(CHUNK / 16),
            span: None,
            whole: None,
            messages: 0,
            chunks: Vec::new(),
            message: Template::new(FRAME),
        };
        let mut start = MAGIC.to_vec();
        push_record(&mut start, op::HEADER, |data| {
            push_text(data, "ros2");
            push_text(data, concat!("imu-tools ", env!("CARGO_PKG_VERSION")));
        });
        mcap.put(&start)?;
        push_schema(&mut mcap.chunk);
        push_channel(&mut mcap.chunk);
        Ok(mcap)
    }

    /// Writes bytes and takes them into the checksum.
    fn put(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.sum.update(bytes);
        self.put_summed(bytes)
    }

    /// Writes bytes of which the checksum knows.
    fn put_summed(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.written += bytes.len() as u64;
        self.output.write(bytes)
    }

    /// Appends one message.
    fn message(
        &mut self,
        stamp: Stamp,
        rate: Option<[f64; 3]>,
        force: Option<[f64; 3]>,
    ) -> Result<(), Error> {
        let time = stamp.ns.to_le_bytes();
        self.index.extend_from_slice(&time);
        self.index.extend_from_slice(&(self.chunk.len() as u64).to_le_bytes());
        let payload = self.message.fill(stamp.split, rate, force);
        let sequence = self.messages as u32;
        push_record(&mut self.chunk, op::MESSAGE, |data| {
            data.extend_from_slice(&CHANNEL.to_le_bytes());
            data.extend_from_slice(&sequence.to_le_bytes());
            data.extend_from_slice(&time);
            data.extend_from_slice(&time);
            data.extend_from_slice(payload);
        });
        self.messages += 1;
        self.span = with(self.span, stamp.ns);
        if self.chunk.len() >= CHUNK {
            self.close_chunk()?;
        }
        Ok(())
    }

    /// Writes the chunk at hand and its index.
    fn close_chunk(&mut self) -> Result<(), Error> {
        let Some(span) = self.span.take() else { return Ok(()) };
        self.whole = with(with(self.whole, span.0), span.1);
        let records = self.chunk.len() as u64;
        let mut sum = Hasher::new();
        sum.update(&self.chunk);
        let mut head = Vec::new();
        push_record(&mut head, op::CHUNK, |data| {
            data.extend_from_slice(&span.0.to_le_bytes());
            data.extend_from_slice(&span.1.to_le_bytes());
            data.extend_from_slice(&records.to_le_bytes());
            data.extend_from_slice(&sum.clone().finalize().to_le_bytes());
            push_text(data, "");
            data.extend_from_slice(&records.to_le_bytes());
        });
        let len = head.len() as u64 + records;
        if let Some(field) = head.get_mut(1..HEAD) {
            field.copy_from_slice(&(len - HEAD as u64).to_le_bytes());
        }
        let mut index = Vec::with_capacity(self.index.len() + 64);
        push_record(&mut index, op::MESSAGE_INDEX, |data| {
            data.extend_from_slice(&CHANNEL.to_le_bytes());
            data.extend_from_slice(&(self.index.len() as u32).to_le_bytes());
            data.extend_from_slice(&self.index);
        });
        self.index.clear();
        let (start, behind) = (self.written, index.len() as u64);
        self.chunks.push(ChunkInfo { start, len, span, records, index: behind });
        self.put(&head)?;
        let chunk = std::mem::take(&mut self.chunk);
        self.sum.combine(&sum);
        self.put_summed(&chunk)?;
        self.chunk = chunk;
        self.chunk.clear();
        self.put(&index)
    }

    /// Appends the end of the data and the summary.
    fn close(mut self) -> Result<(), Error> {
        if self.messages == 0 {
            // No chunk without a message: schema and channel stand by themselves.
            let records = std::mem::take(&mut self.chunk);
            self.put(&records)?;
        }
        self.close_chunk()?;
        let mut end = Vec::new();
        let sum = self.sum.clone().finalize();
        push_record(&mut end, op::DATA_END, |data| data.extend_from_slice(&sum.to_le_bytes()));
        self.put(&end)?;

        let start = self.written;
        let mut summary = Vec::new();
        let mut groups = Vec::new();
        let mut group = |summary: &mut Vec<u8>, op: u8, fill: &dyn Fn(&mut Vec<u8>)| {
            let from = summary.len() as u64;
            fill(summary);
            let len = summary.len() as u64 - from;
            if len > 0 {
                groups.push((op, start + from, len));
            }
        };
        group(&mut summary, op::SCHEMA, &push_schema);
        group(&mut summary, op::CHANNEL, &push_channel);
        group(&mut summary, op::STATISTICS, &|to| self.push_statistics(to));
        group(&mut summary, op::CHUNK_INDEX, &|to| self.push_chunk_indexes(to));
        let offsets = start + summary.len() as u64;
        for (op, from, len) in groups {
            push_record(&mut summary, op::SUMMARY_OFFSET, |data| {
                data.push(op);
                data.extend_from_slice(&from.to_le_bytes());
                data.extend_from_slice(&len.to_le_bytes());
            });
        }
        // The checksum goes from the summary's start to the footer's last field, which it is.
        summary.push(op::FOOTER);
        summary.extend_from_slice(&20_u64.to_le_bytes());
        summary.extend_from_slice(&start.to_le_bytes());
        summary.extend_from_slice(&offsets.to_le_bytes());
        let sum = crc32fast::hash(&summary);
        summary.extend_from_slice(&sum.to_le_bytes());
        summary.extend_from_slice(MAGIC);
        self.put(&summary)?;
        self.output.finish()
    }

    fn push_statistics(&self, to: &mut Vec<u8>) {
        let (first, last) = self.whole.unwrap_or_default();
        push_record(to, op::STATISTICS, |data| {
            data.extend_from_slice(&self.messages.to_le_bytes());
            data.extend_from_slice(&1_u16.to_le_bytes());
            // Channels, attachments, metadata, chunks.
            for count in [1, 0, 0, self.chunks.len() as u32] {
                data.extend_from_slice(&count.to_le_bytes());
            }
            data.extend_from_slice(&first.to_le_bytes());
            data.extend_from_slice(&last.to_le_bytes());
            data.extend_from_slice(&10_u32.to_le_bytes());
            data.extend_from_slice(&CHANNEL.to_le_bytes());
            data.extend_from_slice(&self.messages.to_le_bytes());
        });
    }

    fn push_chunk_indexes(&self, to: &mut Vec<u8>) {
        for chunk in &self.chunks {
            push_record(to, op::CHUNK_INDEX, |data| {
                for field in [chunk.span.0, chunk.span.1, chunk.start, chunk.len] {
                    data.extend_from_slice(&field.to_le_bytes());
                }
                // Where the index of each channel begins.
                data.extend_from_slice(&10_u32.to_le_bytes());
                data.extend_from_slice(&CHANNEL.to_le_bytes());
                data.extend_from_slice(&(chunk.start + chunk.len).to_le_bytes());
                data.extend_from_slice(&chunk.index.to_le_bytes());
                push_text(data, "");
                data.extend_from_slice(&chunk.records.to_le_bytes());
                data.extend_from_slice(&chunk.records.to_le_bytes());
            });
        }
    }
}

impl Sink for McapWriter {
    fn write_block(&mut self, block: &Block) -> Result<(), Error> {
        merge(block, |stamp_ns, rate, force| self.message(Stamp::new(stamp_ns)?, rate, force))
    }

    fn flush(&mut self) -> Result<(), Error> {
        self.close_chunk()?;
        self.output.sync()
    }

    fn finish(self: Box<Self>) -> Result<(), Error> {
        self.close()
    }
}
