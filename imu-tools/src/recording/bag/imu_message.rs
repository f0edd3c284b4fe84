//! The message `sensor_msgs/Imu` as ROS 1 puts it on the wire.
//!
//! A header ([`stamped`](super::stamped)) and the doubles of [`imu_body`], little-endian.

use super::stamped::{HEADER, header};
use crate::recording::imu_body;

/// Name of the type.
pub const TYPE_NAME: &str = "sensor_msgs/Imu";

/// Fingerprint of the definition, which ROS computes without comments and blanks.
pub const MD5SUM: &str = "6a62c6daae103f4ff57a132d6f95cec2";

/// Text of the definition with all that it includes: readers refuse a bag without.
pub const DEFINITION: &str = include_str!("sensor_msgs_Imu.txt");

/// What is wanted of a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImuMessage {
    /// Stamp of the header: seconds and nanoseconds.
    pub stamp: (u32, u32),
    /// Angular rate, rad/s, where given.
    pub rate: Option<[f64; 3]>,
    /// Specific force, m/s², where given.
    pub force: Option<[f64; 3]>,
}

impl ImuMessage {
    /// Reads a message; `None` when `bytes` are not one.
    #[inline]
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        let (stamp, body) = header(bytes)?;
        Some(Self::of(stamp, body.try_into().ok()?))
    }

    /// A message with this stamp and these doubles.
    #[inline]
    pub fn of(stamp: (u32, u32), body: &[u8; imu_body::LEN]) -> Self {
        // The compiler sees that it is there.
        let (rate, force) = imu_body::read(|at| {
            let bytes = body.get(at..at + 8).and_then(|b| b.try_into().ok());
            f64::from_le_bytes(bytes.unwrap_or([0; 8]))
        });
        Self { stamp, rate, force }
    }
}

/// A message in its wire form, of which only numbers change from one to the next.
#[derive(Clone, Debug)]
pub struct Template {
    bytes: Vec<u8>,
}

impl Template {
    /// A message of this frame, without orientation.
    pub fn new(frame_id: &str) -> Self {
        let mut bytes = vec![0; HEADER - 4];
        super::record::push_prefixed(&mut bytes, frame_id.as_bytes());
        imu_body::push(&mut bytes);
        Self { bytes }
    }

    /// The wire form of `message`, as number `seq` of its topic.
    pub fn fill(&mut self, seq: u32, message: &ImuMessage) -> &[u8] {
        if let Some(header) = self.bytes.first_chunk_mut::<12>() {
            header[..4].copy_from_slice(&seq.to_le_bytes());
            header[4..8].copy_from_slice(&message.stamp.0.to_le_bytes());
            header[8..].copy_from_slice(&message.stamp.1.to_le_bytes());
        }
        if let Some(body) = self.bytes.last_chunk_mut() {
            imu_body::write(body, message.rate, message.force);
        }
        &self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_read_back() {
        let mut template = Template::new("imu");
        for (rate, force) in [
            (Some([1.0, -2.0, 1e-300]), Some([0.0, -0.0, 9.81])),
            (Some([1.0, 2.0, 3.0]), None),
            (None, Some([4.0, 5.0, 6.0])),
        ] {
            let message = ImuMessage { stamp: (1_700_000_000, 999_999_999), rate, force };
            let bytes = template.fill(7, &message);
            assert_eq!(bytes.len(), 315);
            assert_eq!(ImuMessage::parse(bytes), Some(message));
            for cut in 0..bytes.len() {
                assert_eq!(ImuMessage::parse(&bytes[..cut]), None);
            }
        }
    }

    #[test]
    fn definition_is_the_whole_text() {
        assert_eq!(DEFINITION.len(), 2572);
        assert!(!DEFINITION.contains('\r'));
    }
}
