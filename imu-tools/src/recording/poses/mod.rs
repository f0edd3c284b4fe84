//! Trajectories: poses over time, out of a table (`table`) or of a topic of a recording of ROS (`topic`).

mod table;
mod topic;

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::{Input, Note, ReadOptions};
use crate::error::Error;

pub(super) use table::Table;
pub use topic::InRecording;
use topic::Topic;
pub(super) use topic::without_topics;

/// Where a body is and how it is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Nanoseconds since the epoch of the recording's clock.
    pub stamp_ns: i64,
    /// Metres, in the world's axes.
    pub position: [f64; 3],
    /// The rotation from body to world as a quaternion x, y, z, w.
    pub orientation: [f64; 4],
    /// Metres a second, in the world's axes, where the table has it.
    pub velocity: Option<[f64; 3]>,
    /// What gyroscope (rad/s) and accelerometer (m/s²) read too much, where the table has it.
    pub bias: Option<([f64; 3], [f64; 3])>,
}

impl Pose {
    /// Of its quaternion.
    pub(crate) fn length(&self) -> f64 {
        self.orientation.iter().map(|q| q * q).sum::<f64>().sqrt()
    }

    /// What may be wrong with a row of which the orientation is no rotation; the end of a sentence.
    #[must_use]
    pub fn hint(&self) -> &'static str {
        let ([x, y, z], [qx, ..]) = (self.position, self.orientation);
        let length = [x, y, z, qx].iter().map(|q| q * q).sum::<f64>().sqrt();
        if (length - 1.0).abs() < 1e-3 {
            ", but that of columns 2 to 5 is: position and rotation are swapped, and TUM's order is timestamp tx ty tz \
             qx qy qz qw"
        } else {
            ": TUM's order is timestamp tx ty tz qx qy qz qw"
        }
    }
}

/// Which of a recording's topics of poses is wanted: `geometry_msgs/PoseStamped`,
/// `PoseWithCovarianceStamped`, `TransformStamped` or `nav_msgs/Odometry`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PoseTopic {
    /// The only one, if there is exactly one.
    Only,
    /// This one; `pose` and `/pose` are the same.
    Named(String),
}

/// A trajectory being read, front to back.
pub struct Poses(Origin);

enum Origin {
    Table(Box<Table>),
    Topic(Topic),
}

impl Poses {
    /// Opens the trajectory at `path`, a table of TUM, EuRoC or `imu simulate`; `-` is a pipe.
    ///
    /// # Errors
    /// When there is no such file, or it holds no poses.
    pub fn open(path: &Path) -> Result<Self, Error> {
        Self::of(super::unpacked(path)?)
    }

    /// The same of what is unpacked.
    pub(crate) fn of(input: Input) -> Result<Self, Error> {
        Ok(Self(Origin::Table(Box::new(Table::of(input)?))))
    }

    /// Opens the poses in a recording, which is read once more for them; of `options` only the stamps that are
    /// wanted matter.
    ///
    /// # Errors
    /// When the topic that is named is not there or holds no poses, or the file cannot be read.
    pub fn in_recording(
        path: &Path,
        topic: &PoseTopic,
        options: &ReadOptions,
    ) -> Result<InRecording, Error> {
        topic::find(path, topic, options.bag_time)
    }

    /// The next pose; `None` at the end, which a row that is cut off is as well.
    ///
    /// # Errors
    /// When the file cannot be read, or a row is none.
    pub fn next_pose(&mut self) -> Result<Option<Pose>, Error> {
        match &mut self.0 {
            Origin::Table(table) => table.next_pose(),
            Origin::Topic(topic) => topic.next_pose(),
        }
    }

    /// The line of the last pose, from 1; none of a topic.
    #[must_use]
    pub fn line(&self) -> Option<u64> {
        match &self.0 {
            Origin::Table(table) => Some(table.line()),
            Origin::Topic(_) => None,
        }
    }

    /// Reads what is left of a recording, and takes what there is to tell of it; of a table, whether its last row is cut
    /// off.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn finish(&mut self) -> Result<Vec<Note>, Error> {
        match &mut self.0 {
            Origin::Table(table) => Ok(Vec::from_iter(table.note())),
            Origin::Topic(topic) => topic.finish(),
        }
    }
}

/// The first line of TUM's format.
pub(crate) const TUM_HEADER: &str = "# timestamp tx ty tz qx qy qz qw\n";

/// Appends a line of TUM's format: seconds with nine decimals, x y z, qx qy qz qw.
pub(crate) fn push_tum(text: &mut Vec<u8>, stamp_ns: i64, position: [f64; 3], xyzw: [f64; 4]) {
    let (sign, size) = (if stamp_ns < 0 { "-" } else { "" }, stamp_ns.unsigned_abs());
    // Writing to memory cannot fail.
    let _ = write!(text, "{sign}{}.{:09}", size / 1_000_000_000, size % 1_000_000_000);
    let mut digits = zmij::Buffer::new();
    for number in position.iter().chain(&xyzw) {
        text.push(b' ');
        text.extend_from_slice(digits.format(*number).as_bytes());
    }
    text.push(b'\n');
}

/// The truth that stands beside a recording: `NAME.truth.csv` or `NAME.truth.tum` beside `NAME.bag` and the like, EuRoC's
/// and TUM-VI's folders of ground truth beside the IMU's.
#[must_use]
pub fn beside(recording: &Path) -> Option<PathBuf> {
    const FOLDERS: [&str; 2] = ["state_groundtruth_estimate0", "mocap0"];
    let named = ["truth.csv", "truth.tum"].map(|ending| recording.with_extension(ending));
    let is_euroc = recording.is_dir() || recording.file_name().is_some_and(|n| n == "data.csv");
    let inside = [recording.join("mav0"), recording.to_owned()];
    let around = recording.ancestors().skip(1).take(2).map(Path::to_owned);
    let folders = inside.into_iter().chain(around).filter(|_| is_euroc);
    let truths = folders.flat_map(|at| FOLDERS.map(|folder| at.join(folder).join("data.csv")));
    named.into_iter().chain(truths).find(|path| path.is_file() && path != recording)
}
