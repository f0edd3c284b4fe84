//! Recordings that are folders: what is in one decides what it is.

use std::path::Path;

use super::{ReadOptions, Source, euroc, poses, rosbag2};
use crate::error::Error;

/// Opens the recording in a folder.
///
/// # Errors
/// When there is none, or more than one.
pub fn open(folder: &Path, options: &ReadOptions) -> Result<Box<dyn Source>, Error> {
    if options.poses.is_none()
        && let Some(source) = euroc::open(folder, options)?
    {
        return Ok(source);
    }
    if rosbag2::is_rosbag2(folder) {
        return Ok(Box::new(rosbag2::FolderReader::open(folder, options)?));
    }
    if let Some(wanted) = &options.poses {
        return poses::without_topics(folder, wanted);
    }
    Err(Error::data(format!(
        "{} is a folder without a recording: name a file in it, or a folder with metadata.yaml, \
         .db3 or .mcap files, or mav0/imu0/data.csv",
        folder.display()
    )))
}
