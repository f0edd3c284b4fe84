//! MCAP files put together by hand: other programs' layouts, and wrong ones.

use std::io::Write as _;

use lz4_flex::frame::{BlockSize, FrameEncoder, FrameInfo};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};

/// The first and the last bytes of a file.
pub const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// A record with this opcode and these pieces of data.
#[must_use]
pub fn record(op: u8, data: &[&[u8]]) -> Vec<u8> {
    let data = data.concat();
    [&[op][..], &(data.len() as u64).to_le_bytes(), &data].concat()
}

/// A text prefixed by its length.
#[must_use]
pub fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

/// A schema.
#[must_use]
pub fn schema(number: u16, name: &str) -> Vec<u8> {
    record(3, &[&number.to_le_bytes(), &text(name), &text("ros2msg"), &text("...")])
}

/// A channel of CDR messages.
#[must_use]
pub fn channel(number: u16, schema: u16, topic: &str) -> Vec<u8> {
    let (number, schema) = (number.to_le_bytes(), schema.to_le_bytes());
    record(4, &[&number, &schema, &text(topic), &text("cdr"), &[0; 4]])
}

/// A message at second `sec`, recorded a second later.
#[must_use]
pub fn message(channel: u16, sec: u32, payload: &[u8]) -> Vec<u8> {
    let time = (u64::from(sec + 1) * 1_000_000_000).to_le_bytes();
    record(5, &[&channel.to_le_bytes(), &[0; 4], &time, &time, payload])
}

/// A CDR message of a header at second `sec` and these doubles.
#[must_use]
pub fn cdr(sec: u32, doubles: &[f64]) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(sec.to_le_bytes());
    bytes.extend([0; 4]);
    bytes.extend([4, 0, 0, 0, b'i', b'm', b'u', 0]);
    bytes.extend(doubles.iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

/// An Imu message at second `sec`; its doubles are 0, 1, 2, …
#[must_use]
pub fn imu(channel: u16, sec: u32) -> Vec<u8> {
    let doubles: Vec<f64> = (0..37).map(f64::from).collect();
    message(channel, sec, &cdr(sec, &doubles))
}

/// A chunk of records with its checksum; `compression` is empty, `zstd` or `lz4`.
///
/// # Panics
/// When a compressor fails.
#[must_use]
pub fn chunk(records: &[Vec<u8>], compression: &str) -> Vec<u8> {
    let records = records.concat();
    let stored = match compression {
        "zstd" => compress_to_vec(&records[..], CompressionLevel::Fastest),
        "lz4" => {
            let info = FrameInfo::new().block_size(BlockSize::Max64KB);
            let mut encoder = FrameEncoder::with_frame_info(info, Vec::new());
            encoder.write_all(&records).expect("memory");
            encoder.finish().expect("memory")
        }
        _ => records.clone(),
    };
    chunk_of(records.len() as u64, crc32fast::hash(&records), compression, &stored)
}

/// A chunk that claims this length and checksum.
#[must_use]
pub fn chunk_of(unpacked: u64, crc: u32, compression: &str, stored: &[u8]) -> Vec<u8> {
    let len = (stored.len() as u64).to_le_bytes();
    let (unpacked, crc) = (unpacked.to_le_bytes(), crc.to_le_bytes());
    record(6, &[&[0; 16], &unpacked, &crc, &text(compression), &len, stored])
}

/// A whole file of these records, without a summary.
#[must_use]
pub fn mcap(records: &[Vec<u8>]) -> Vec<u8> {
    let end = [record(0x0f, &[&[0; 4]]), record(2, &[&[0; 20]])].concat();
    let header = record(1, &[&text("ros2"), &text("hand")]);
    [MAGIC, &header, &records.concat(), &end, MAGIC].concat()
}
