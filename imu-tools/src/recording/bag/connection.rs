//! What a bag says of a connection: its topic, and what its messages are to us.

use super::record::Header;
use super::{imu_message, temperature_message};
use crate::recording::pose_body::PoseMessage;
use crate::recording::topics::{Connection, Holds};

/// The connection of this number by the header and data of its record; `None` where they do not
/// tell its topic and type.
pub fn described(number: u32, header: &[u8], data: &[u8]) -> Option<Connection> {
    let (fields, described) = (Header::parse(header)?, Header::parse(data)?);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let type_name = described.type_name?;
    Some(Connection {
        number,
        topic: text(fields.topic.or(described.topic)?),
        type_name: text(type_name),
        holds: holds(type_name, described.md5sum.unwrap_or_default()),
    })
}

/// What the messages of a type are to us: its name and fingerprint must be the ones that we know.
fn holds(type_name: &[u8], md5sum: &[u8]) -> Holds {
    let known = |ours: &str| [ours.as_bytes(), b"*", b""].contains(&md5sum);
    if type_name == temperature_message::TYPE_NAME.as_bytes() && known(temperature_message::MD5SUM)
    {
        Holds::Temperature
    } else if type_name != imu_message::TYPE_NAME.as_bytes() {
        let mut poses = PoseMessage::ALL.into_iter();
        let pose = poses.find(|pose| type_name == pose.type_name().as_bytes());
        pose.filter(|pose| known(pose.md5sum())).map_or(Holds::Other, Holds::Pose)
    } else if known(imu_message::MD5SUM) {
        Holds::Imu
    } else {
        Holds::Unreadable(format!(
            "holds an unknown layout of {} (md5sum {}, where {} is expected)",
            imu_message::TYPE_NAME,
            String::from_utf8_lossy(md5sum),
            imu_message::MD5SUM
        ))
    }
}
