//! Messages on their way into a block, and what was strange about them.

use std::path::Path;

use ruzstd::decoding::FrameDecoder;

use super::cdr::{Refusal, Stamped};
use super::{IMU, ImuMessage, TEMPERATURE};
use crate::recording::input::LARGEST_PIECE;
use crate::recording::pose_body::{self, PoseMessage};
use crate::recording::topics::{Holds, Role};
use crate::recording::{
    Block, ForceUnit, Note, RateUnit, ReadOptions, Sample, Temperature, zstandard,
};

/// What the messages of a type are to us, by its name and that of their wire form.
pub fn holds(type_name: &str, encoding: &str) -> Holds {
    match (type_name, encoding) {
        (IMU, "cdr") => Holds::Imu,
        (TEMPERATURE, "cdr") => Holds::Temperature,
        (IMU | "sensor_msgs/Imu", encoding) => Holds::Unreadable(format!(
            "holds an IMU whose messages are encoded as {encoding:?}, where \"cdr\" is expected: \
             record or convert it with ROS 2"
        )),
        (other, "cdr") => PoseMessage::named(other).map_or(Holds::Other, Holds::Pose),
        _ => Holds::Other,
    }
}

/// A message as the recording holds it.
#[derive(Clone, Copy, Debug)]
pub struct Recorded<'a> {
    /// When it was recorded.
    pub time_ns: i64,
    /// What it says.
    pub payload: &'a [u8],
}

/// Takes messages, and counts what it took.
pub struct Taken {
    /// Samples are stamped with the time of recording.
    by_recorder: bool,
    /// Factors to SI units: 1 unless the user says that the recording does not keep to them.
    rate: f64,
    force: f64,
    messages: u64,
    /// Messages whose stamp is 0.
    unstamped: u64,
    /// Messages that cannot be read.
    malformed: u64,
    /// Messages in a representation that we do not know, and which one.
    unknown: u64,
    representation: [u8; 2],
    zstd: FrameDecoder,
    unpacked: Vec<u8>,
}

impl Taken {
    /// Nothing yet.
    pub fn new(options: &ReadOptions) -> Self {
        let mut zstd = FrameDecoder::new();
        zstd.set_max_window_size(LARGEST_PIECE as u64);
        Self {
            by_recorder: options.bag_time,
            rate: options.gyro_unit.map_or(1.0, RateUnit::to_rad_s),
            force: options.accel_unit.map_or(1.0, ForceUnit::to_m_s2),
            messages: 0,
            unstamped: 0,
            malformed: 0,
            unknown: 0,
            representation: [0; 2],
            zstd,
            unpacked: Vec::new(),
        }
    }

    /// Takes one message.
    #[inline]
    pub fn message(&mut self, message: Recorded<'_>, role: Role, to: &mut Block) {
        // As in rosbag2's compression mode "message".
        if message.payload.starts_with(&zstandard::MAGIC) {
            return self.packed(message, role, to);
        }
        self.plain(message, role, to);
    }

    /// A message that cannot be read, whatever it holds.
    pub fn malformed(&mut self) {
        self.malformed += 1;
    }

    /// Takes a message that is compressed by itself.
    fn packed(&mut self, message: Recorded<'_>, role: Role, to: &mut Block) {
        /// What a message that we read may hold at most: a few hundred bytes and the names of its frames.
        const LARGEST_MESSAGE: usize = 64 * 1024;
        let mut unpacked = std::mem::take(&mut self.unpacked);
        unpacked.resize(LARGEST_MESSAGE, 0);
        match self.zstd.decode_all(message.payload, &mut unpacked) {
            Ok(len) => {
                let payload = unpacked.get(..len).unwrap_or_default();
                self.plain(Recorded { payload, ..message }, role, to);
            }
            Err(_) => self.malformed += 1,
        }
        self.unpacked = unpacked;
    }

    #[inline]
    fn plain(&mut self, Recorded { time_ns, payload }: Recorded<'_>, role: Role, to: &mut Block) {
        if role.temperature {
            return self.temperature(time_ns, payload, to);
        }
        if let Some(message) = role.pose {
            return self.pose(message, time_ns, payload, to);
        }
        match ImuMessage::parse(payload) {
            Ok(message) => self.imu(&message, time_ns, role, to),
            Err(refusal) => self.refused(refusal),
        }
    }

    /// Takes an IMU's message, recorded at `time_ns`.
    #[inline]
    pub fn imu(&mut self, message: &ImuMessage, time_ns: i64, role: Role, to: &mut Block) {
        let stamp_ns = self.stamp(message.stamp_ns, time_ns);
        if let Some(value) = message.rate
            && role.gyroscope
        {
            to.gyroscope.push(Sample { stamp_ns, value: scaled(value, self.rate) });
        }
        if let Some(value) = message.force
            && role.accelerometer
        {
            to.accelerometer.push(Sample { stamp_ns, value: scaled(value, self.force) });
        }
    }

    fn temperature(&mut self, time_ns: i64, payload: &[u8], to: &mut Block) {
        // The temperature and its variance.
        let parsed = Stamped::parse(payload).and_then(|s| Ok((s.stamp_ns, s.doubles::<16>()?)));
        match parsed {
            Ok((stamp_ns, doubles)) => {
                let stamp_ns = self.stamp(stamp_ns, time_ns);
                to.temperature.push(Temperature { stamp_ns, celsius: doubles.get(0) });
            }
            Err(refusal) => self.refused(refusal),
        }
    }

    fn pose(&mut self, message: PoseMessage, time_ns: i64, payload: &[u8], to: &mut Block) {
        let parsed = Stamped::behind(message.texts(), payload)
            .and_then(|s| Ok((s.stamp_ns, s.first::<{ pose_body::LEN }>(message.len())?)));
        match parsed {
            Ok((stamp_ns, doubles)) => {
                let stamp_ns = self.stamp(stamp_ns, time_ns);
                to.poses.push(pose_body::read(stamp_ns, |at| doubles.get(at)));
            }
            Err(refusal) => self.refused(refusal),
        }
    }

    /// The stamp that is wanted.
    #[inline]
    fn stamp(&mut self, header: i64, recorder: i64) -> i64 {
        self.messages += 1;
        self.unstamped += u64::from(header == 0);
        if self.by_recorder { recorder } else { header }
    }

    #[cold]
    fn refused(&mut self, refusal: Refusal) {
        match refusal {
            Refusal::Malformed => self.malformed += 1,
            Refusal::Representation(which) => {
                self.unknown += 1;
                self.representation = which;
            }
        }
    }

    /// What was strange about the messages since the last call, to be told at the end.
    pub fn take_notes(&mut self, path: &Path) -> Vec<Note> {
        let path = path.display();
        let mut notes = Vec::new();
        if self.malformed > 0 {
            notes.push(format!(
                "{path} has {} messages that are not of the type that their topic says: they are left out",
                self.malformed
            ));
        }
        if self.unknown > 0 {
            let [first, second] = self.representation;
            notes.push(format!(
                "{path} has {} messages in the CDR representation {first:02x} {second:02x}, of \
                 which only the plain ones (00 00, 00 01, 00 06, 00 07) are read: they are left out",
                self.unknown
            ));
        }
        if self.messages > 1 && self.unstamped == self.messages && !self.by_recorder {
            notes.push(format!("{path} has no stamps in its messages: read it with --bag-time"));
        }
        (self.messages, self.unstamped, self.malformed, self.unknown) = (0, 0, 0, 0);
        notes.into_iter().map(Note::Warning).collect()
    }
}

/// Brings a value to SI units; a factor of 1 changes no bit.
#[inline]
fn scaled(value: [f64; 3], factor: f64) -> [f64; 3] {
    value.map(|v| v * factor)
}
