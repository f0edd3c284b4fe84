//! The message `sensor_msgs/msg/Imu`: a header and the doubles of [`imu_body`].

use super::cdr::{ENCAPSULATION, Refusal, Stamped};
use crate::recording::imu_body;

/// Text of the definition with all that it includes.
pub const DEFINITION: &str = include_str!("sensor_msgs_msg_Imu.txt");

/// What is wanted of a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImuMessage {
    /// Stamp of the header, nanoseconds.
    pub stamp_ns: i64,
    /// Angular rate, rad/s, where given.
    pub rate: Option<[f64; 3]>,
    /// Specific force, m/s², where given.
    pub force: Option<[f64; 3]>,
}

impl ImuMessage {
    /// Reads a message.
    #[inline]
    pub fn parse(bytes: &[u8]) -> Result<Self, Refusal> {
        let stamped = Stamped::parse(bytes)?;
        let body = stamped.doubles::<{ imu_body::LEN }>()?;
        let (rate, force) = imu_body::read(|at| body.get(at));
        Ok(Self { stamp_ns: stamped.stamp_ns, rate, force })
    }

    /// A message with this stamp and these little-endian doubles.
    #[inline]
    pub fn little_endian(stamp_ns: i64, body: &[u8; imu_body::LEN]) -> Self {
        let (rate, force) = imu_body::read(|at| {
            let bytes = body.get(at..at + 8).and_then(|b| b.try_into().ok());
            f64::from_le_bytes(bytes.unwrap_or_default())
        });
        Self { stamp_ns, rate, force }
    }
}

/// A message in its wire form, of which only numbers change from one to the next.
#[derive(Clone, Debug)]
pub struct Template {
    bytes: Vec<u8>,
}

impl Template {
    /// A message of this frame, little-endian, without orientation.
    pub fn new(frame_id: &str) -> Self {
        let mut bytes = vec![0, 1, 0, 0];
        bytes.extend_from_slice(&[0; 8]);
        bytes.extend_from_slice(&(frame_id.len() as u32 + 1).to_le_bytes());
        bytes.extend_from_slice(frame_id.as_bytes());
        bytes.push(0);
        let body = (bytes.len() - ENCAPSULATION).next_multiple_of(8) + ENCAPSULATION;
        bytes.resize(body, 0);
        imu_body::push(&mut bytes);
        Self { bytes }
    }

    /// The wire form of a message with this stamp: seconds and nanoseconds.
    pub fn fill(
        &mut self,
        (sec, nanosec): (i32, u32),
        rate: Option<[f64; 3]>,
        force: Option<[f64; 3]>,
    ) -> &[u8] {
        if let Some(start) = self.bytes.first_chunk_mut::<12>() {
            start[4..8].copy_from_slice(&sec.to_le_bytes());
            start[8..].copy_from_slice(&nanosec.to_le_bytes());
        }
        if let Some(body) = self.bytes.last_chunk_mut() {
            imu_body::write(body, rate, force);
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
            let bytes = template.fill((1_700_000_000, 999_999_999), rate, force);
            // 4 of encapsulation, 12 of header, "imu" and its NUL, 37 doubles.
            assert_eq!(bytes.len(), 4 + 16 + 37 * 8);
            let stamp_ns = 1_700_000_000_999_999_999;
            assert_eq!(ImuMessage::parse(bytes), Ok(ImuMessage { stamp_ns, rate, force }));
        }
    }

    #[test]
    fn definition_is_the_whole_text() {
        let parts: Vec<&str> = DEFINITION.lines().filter_map(|l| l.strip_prefix("MSG: ")).collect();
        let all = ["std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Quaternion"];
        assert_eq!(parts, [&all[..], &["geometry_msgs/Vector3"]].concat());
        assert!(!DEFINITION.contains('\r') && DEFINITION.ends_with('\n'));
    }
}
