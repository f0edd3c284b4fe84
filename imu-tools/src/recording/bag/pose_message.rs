//! Messages that tell a pose as ROS 1 puts them on the wire: a header, for some of them a text (length u32
//! and bytes), and the doubles of [`pose_body`], little-endian.

use super::record::prefixed;
use super::samples::nanoseconds;
use super::stamped::header;
use crate::recording::pose_body::{self, PoseMessage};
use crate::recording::poses::Pose;

/// The pose of a message, stamped as its header is; `None` when `bytes` are not one of this type.
pub fn parse(message: PoseMessage, bytes: &[u8]) -> Option<Pose> {
    let (stamp, mut rest) = header(bytes)?;
    for _ in 0..message.texts() {
        rest = prefixed(rest)?.1;
    }
    let body = rest.first_chunk::<{ pose_body::LEN }>().filter(|_| rest.len() == message.len())?;
    let double = |at: usize| {
        let bytes = body.get(at..at + 8).and_then(|b| b.try_into().ok());
        f64::from_le_bytes(bytes.unwrap_or_default())
    };
    Some(pose_body::read(nanoseconds(stamp), double))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::bag::record::push_prefixed;

    #[test]
    fn messages_are_read_whole_or_not_at_all() {
        for message in PoseMessage::ALL {
            let mut bytes = vec![9, 0, 0, 0, 7, 0, 0, 0, 8, 0, 0, 0];
            for text in ["map", "base_link"].into_iter().take(1 + message.texts()) {
                push_prefixed(&mut bytes, text.as_bytes());
            }
            let doubles = message.len() / 8;
            bytes.extend((1..=doubles as u32).flat_map(|k| f64::from(k).to_le_bytes()));
            let pose = parse(message, &bytes).unwrap();
            assert_eq!(pose.stamp_ns, 7_000_000_008);
            assert_eq!((pose.position, pose.orientation), ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0, 7.0]));
            for cut in 0..bytes.len() {
                assert_eq!(parse(message, &bytes[..cut]), None);
            }
            assert_eq!(parse(message, &[&bytes[..], &[0]].concat()), None);
        }
    }
}
