//! ROS 1 bags put together by hand: other programs' layouts, and wrong ones.

use std::io::Write as _;

/// A record with these header fields, in this order.
#[must_use]
pub fn record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let mut header = Vec::new();
    for (name, value) in fields {
        header.extend(((name.len() + 1 + value.len()) as u32).to_le_bytes());
        header.extend([name.as_bytes(), b"=", value].concat());
    }
    let mut record = (header.len() as u32).to_le_bytes().to_vec();
    record.extend(header);
    record.extend((data.len() as u32).to_le_bytes());
    record.extend(data);
    record
}

/// The description of a connection, whose layout has no fingerprint.
#[must_use]
pub fn connection(number: u32, topic: &str, type_name: &str) -> Vec<u8> {
    let mut data = Vec::new();
    for field in [
        format!("topic={topic}"),
        format!("type={type_name}"),
        "md5sum=*".to_owned(),
        "message_definition=...".to_owned(),
    ] {
        data.extend((field.len() as u32).to_le_bytes());
        data.extend(field.as_bytes());
    }
    let number = number.to_le_bytes();
    record(&[("topic", topic.as_bytes()), ("op", &[7]), ("conn", &number)], &data)
}

/// An Imu message at second `sec`, recorded a second later, with its header fields turned by
/// `order`; its doubles are 0, 1, 2, …
#[must_use]
pub fn message(number: u32, sec: u32, order: usize) -> Vec<u8> {
    let mut payload = vec![0; 4];
    payload.extend(sec.to_le_bytes());
    payload.extend([0; 4]);
    payload.extend(3_u32.to_le_bytes());
    payload.extend(b"imu");
    payload.extend((0..37).flat_map(|i| f64::from(i).to_le_bytes()));
    let mut time = (sec + 1).to_le_bytes().to_vec();
    time.extend([0; 4]);
    let number = number.to_le_bytes();
    let mut fields: Vec<(&str, &[u8])> = vec![("op", &[2]), ("conn", &number), ("time", &time)];
    fields.rotate_left(order % 3);
    record(&fields, &payload)
}

/// A chunk of records, not compressed.
#[must_use]
pub fn chunk(records: &[Vec<u8>]) -> Vec<u8> {
    let data = records.concat();
    let size = (data.len() as u32).to_le_bytes();
    record(&[("size", &size), ("compression", b"none"), ("op", &[5])], &data)
}

/// How the chunks of a bag are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// Not at all.
    None,
    /// By bzip2.
    Bz2,
    /// As a frame of LZ4 with a checksum, one block a chunk: what roslz4 makes of it.
    Lz4,
}

impl Packing {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::None, Self::Bz2, Self::Lz4];

    /// As the header of a chunk calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Bz2 => "bz2",
            Self::Lz4 => "lz4",
        }
    }

    /// Packs the data of a chunk.
    ///
    /// # Panics
    /// When a compressor fails, which it does not in memory.
    #[must_use]
    pub fn pack(self, data: &[u8]) -> Vec<u8> {
        use lz4_flex::frame::{BlockSize, FrameEncoder, FrameInfo};
        match self {
            Self::None => data.to_vec(),
            Self::Bz2 => {
                let level = bzip2::Compression::best();
                let mut encoder = bzip2::write::BzEncoder::new(Vec::new(), level);
                encoder.write_all(data).expect("memory");
                encoder.finish().expect("memory")
            }
            Self::Lz4 => {
                let info = FrameInfo::new().block_size(BlockSize::Max1MB).content_checksum(true);
                let mut encoder = FrameEncoder::with_frame_info(info, Vec::new());
                encoder.write_all(data).expect("memory");
                encoder.finish().expect("memory")
            }
        }
    }
}

/// A chunk of records, packed.
#[must_use]
pub fn packed_chunk(packing: Packing, records: &[Vec<u8>]) -> Vec<u8> {
    let data = records.concat();
    let size = (data.len() as u32).to_le_bytes();
    let compression = packing.name().as_bytes();
    record(&[("compression", compression), ("op", &[5]), ("size", &size)], &packing.pack(&data))
}

/// A bag with these chunks and one connection, number 0, closed as a recorder does: its list says
/// where they are, but nothing of their messages.
#[must_use]
pub fn closed_bag(connection: &[u8], chunks: &[Vec<u8>]) -> Vec<u8> {
    let count = (chunks.len() as u32).to_le_bytes();
    let index_pos = |at: u64| {
        let (at, one) = (at.to_le_bytes(), 1_u32.to_le_bytes());
        let fields: [(&str, &[u8]); 4] =
            [("chunk_count", &count), ("conn_count", &one), ("index_pos", &at), ("op", &[3])];
        [b"#ROSBAG V2.0\n".to_vec(), record(&fields, &[b' '; 4027])].concat()
    };
    let (mut bytes, mut infos) = (index_pos(0), Vec::new());
    for chunk in chunks {
        let (at, one) = ((bytes.len() as u64).to_le_bytes(), 1_u32.to_le_bytes());
        let fields: [(&str, &[u8]); 6] = [
            ("chunk_pos", &at),
            ("count", &one),
            ("end_time", &[0; 8]),
            ("op", &[6]),
            ("start_time", &[0; 8]),
            ("ver", &one),
        ];
        infos.extend(record(&fields, &[0; 8]));
        bytes.extend(chunk);
        let none = [0; 4];
        let fields: [(&str, &[u8]); 4] =
            [("conn", &none), ("count", &none), ("op", &[4]), ("ver", &one)];
        bytes.extend(record(&fields, &[]));
    }
    let start = index_pos(bytes.len() as u64);
    bytes[..start.len()].copy_from_slice(&start);
    bytes.extend(connection);
    bytes.extend(infos);
    bytes
}

/// A bag of these records that was never closed.
#[must_use]
pub fn bag(records: &[Vec<u8>]) -> Vec<u8> {
    let (zero, one) = (0_u64.to_le_bytes(), 1_u32.to_le_bytes());
    let header = record(
        &[("op", &[3]), ("index_pos", &zero), ("conn_count", &one), ("chunk_count", &one)],
        &[b' '; 4027],
    );
    [b"#ROSBAG V2.0\n".to_vec(), header, records.concat()].concat()
}
