//! ROS 1 bags, format 2.0: our own reader and writer.
//!
//! A bag is a line of text and then records: a header of `name=value` fields and data, both
//! prefixed by their length, little-endian. Messages (op 2) lie in chunks (op 5) together with the
//! description of their connection (op 7); an index (op 4) follows each chunk, and the bag header
//! (op 3) at the front points to the list of connections and chunks (op 6) at the end.
//!
//! Reading needs no index: records are taken as they come, in a pipe as in a file, and a bag that
//! was cut off gives all messages before the cut. Chunks may be compressed by bz2 or LZ4. After
//! damage reading goes on with the next record. Everything lost is told.

mod account;
mod bytes;
mod connection;
mod damage;
mod imu_message;
mod lz4;
mod pose_message;
mod reader;
mod record;
mod repeat;
mod samples;
mod stamped;
mod temperature_message;
mod unpack;
mod writer;

pub use reader::BagReader;
pub use writer::BagWriter;

/// The first line of every bag of this version.
const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

/// Record kinds, field `op`.
mod op {
    pub const MESSAGE: u8 = 2;
    pub const BAG_HEADER: u8 = 3;
    pub const INDEX: u8 = 4;
    pub const CHUNK: u8 = 5;
    pub const CHUNK_INFO: u8 = 6;
    pub const CONNECTION: u8 = 7;
}
