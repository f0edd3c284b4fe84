//! The message `sensor_msgs/Temperature` as ROS 1 puts it on the wire.
//!
//! A header, temperature in degrees Celsius and its variance: two doubles, little-endian.

use super::stamped::header;

/// Name of the type.
pub const TYPE_NAME: &str = "sensor_msgs/Temperature";

/// Fingerprint of the definition.
pub const MD5SUM: &str = "ff71b307acdbe7c871a5a6d7ed359100";

/// What is wanted of a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TemperatureMessage {
    /// Stamp of the header: seconds and nanoseconds.
    pub stamp: (u32, u32),
    /// Degrees Celsius.
    pub celsius: f64,
}

impl TemperatureMessage {
    /// Reads a message; `None` when `bytes` are not one.
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        let (stamp, body) = header(bytes)?;
        let body: &[u8; 16] = body.try_into().ok()?;
        Some(Self { stamp, celsius: f64::from_le_bytes(*body.first_chunk()?) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_read_whole_or_not_at_all() {
        let mut bytes = vec![9, 0, 0, 0, 7, 0, 0, 0, 8, 0, 0, 0, 3, 0, 0, 0];
        bytes.extend(b"imu");
        bytes.extend(36.6_f64.to_le_bytes());
        bytes.extend(0.5_f64.to_le_bytes());
        let expected = TemperatureMessage { stamp: (7, 8), celsius: 36.6 };
        assert_eq!(TemperatureMessage::parse(&bytes), Some(expected));
        for cut in 0..bytes.len() {
            assert_eq!(TemperatureMessage::parse(&bytes[..cut]), None);
        }
    }
}
