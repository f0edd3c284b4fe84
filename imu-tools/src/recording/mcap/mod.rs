//! MCAP, the recordings of ROS 2: our own reader and writer.
//!
//! A file is eight bytes of magic and then records: an opcode, a length (u64) and data,
//! little-endian. Messages (opcode 5) name a channel (4), which names a topic and its schema (3);
//! they lie in chunks (6), which may be compressed, or outside of them. Behind the data stands a
//! summary: schemas, channels, statistics (0x0b), indexes; the footer (2) says where it begins.
//! Source: the MCAP format specification, version 0, <https://mcap.dev/spec>.
//!
//! Reading needs neither index nor summary: records are taken as they come, in a pipe as in a file,
//! and a file that was cut off gives all messages before the cut. Only if the topics can be learned
//! from the summary at the end without reading the file are they read there.
//!
//! Why not the `mcap` crate, whose reader also works on any stream of bytes: it holds each record in
//! memory as a whole, so that neither the images between our messages can be passed over nor a
//! length of gigabytes be survived; it ends at the first damage, where much of a file may follow;
//! and its decompressors are C libraries. The part of the format that we need is small.

mod chunk;
mod reader;
mod record;
mod repeat;
mod writer;

pub use reader::McapReader;
pub use writer::McapWriter;

/// The first and the last eight bytes of a file.
pub(super) const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Kinds of records.
mod op {
    pub const HEADER: u8 = 0x01;
    pub const FOOTER: u8 = 0x02;
    pub const SCHEMA: u8 = 0x03;
    pub const CHANNEL: u8 = 0x04;
    pub const MESSAGE: u8 = 0x05;
    pub const CHUNK: u8 = 0x06;
    pub const MESSAGE_INDEX: u8 = 0x07;
    pub const CHUNK_INDEX: u8 = 0x08;
    pub const STATISTICS: u8 = 0x0b;
    pub const SUMMARY_OFFSET: u8 = 0x0e;
    pub const DATA_END: u8 = 0x0f;
}
