//! What `metadata.yaml` says: which files, in which order.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::error::Error;

/// The file's name.
pub const NAME: &str = "metadata.yaml";

/// Longer ones are refused: a recording of a thousand files and topics has a megabyte.
const LONGEST: u64 = 16 << 20;

#[derive(Debug, Deserialize)]
struct File {
    rosbag2_bagfile_information: Metadata,
}

/// The part of it that we need.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq)]
pub struct Metadata {
    /// `mcap` or `sqlite3`.
    #[serde(default)]
    pub storage_identifier: String,
    /// The files, relative to the folder.
    pub relative_file_paths: Vec<PathBuf>,
    /// Messages in all files.
    pub message_count: Option<u64>,
}

impl Metadata {
    /// Reads the metadata of a folder; `None` if it has none.
    ///
    /// # Errors
    /// When they cannot be read or name no file.
    pub fn read(folder: &Path) -> Result<Option<Self>, Error> {
        let path = folder.join(NAME);
        let about = match std::fs::metadata(&path) {
            Ok(about) => about,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(Error::io("read", &path, error)),
        };
        if about.len() > LONGEST {
            return Err(Error::data(format!(
                "{} is {} bytes long, which no {NAME} is: move it away, and the files of its \
                 folder are read in the order of their names",
                path.display(),
                about.len()
            )));
        }
        let text = std::fs::read_to_string(&path).map_err(|e| Error::io("read", &path, e))?;
        Self::parse(&text, &path).map(Some)
    }

    fn parse(text: &str, path: &Path) -> Result<Self, Error> {
        let file: File = serde_saphyr::from_str(text).map_err(|error| {
            let error = error.to_string();
            Error::data(format!(
                "{} is not what rosbag2 writes ({}): move it away, and the files of its folder are \
                 read in the order of their names",
                path.display(),
                error.lines().next().unwrap_or_default()
            ))
        })?;
        let metadata = file.rosbag2_bagfile_information;
        if metadata.relative_file_paths.is_empty() {
            return Err(Error::data(format!(
                "{} names no file: nothing was recorded",
                path.display()
            )));
        }
        Ok(metadata)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_needed_is_found_among_the_rest() {
        let text = "\
rosbag2_bagfile_information:
  version: 9
  storage_identifier: mcap
  duration: {nanoseconds: 5}
  message_count: 7
  topics_with_message_count:
    - topic_metadata: {name: /imu, type: sensor_msgs/msg/Imu, offered_qos_profiles: \"- a: 1\\n\"}
      message_count: 7
  compression_format: zstd
  compression_mode: FILE
  relative_file_paths:
    - a_0.mcap.zstd
    - a_1.mcap.zstd
  files: []
";
        let metadata = Metadata::parse(text, Path::new("m")).unwrap();
        assert_eq!(metadata.storage_identifier, "mcap");
        assert_eq!(metadata.message_count, Some(7));
        let files = ["a_0.mcap.zstd", "a_1.mcap.zstd"].map(PathBuf::from);
        assert_eq!(metadata.relative_file_paths, files);
    }

    #[test]
    fn what_is_no_metadata_is_one_sentence() {
        let empty = "rosbag2_bagfile_information:\n  relative_file_paths: []\n";
        for text in ["", "a: b", "[", empty, "rosbag2_bagfile_information: 7"] {
            let error = Metadata::parse(text, Path::new("m")).unwrap_err().to_string();
            assert!(error.starts_with("m ") && !error.contains('\n'), "{error}");
        }
    }
}
