//! rosbag2 folders: `metadata.yaml` and the files that it names, in the order of the recording.
//!
//! The files are MCAP files, which [`mcap`](super::mcap) reads, or databases of SQLite (`.db3`),
//! and either may be compressed by Zstandard as a whole or message by message. A folder whose
//! `metadata.yaml` is missing, because the recorder was killed, is read in the order of its names.
//! A single `.db3` file is read as well.
//!
//! SQLite is read by a scanner of our own (`sqlite`): the crates for it are C, or whole database
//! engines that are not finished, and refuse a damaged file, of which we take what is there.

mod database;
mod folder;
mod metadata;
mod sqlite;

pub use database::DatabaseReader;
pub use folder::FolderReader;
pub(super) use folder::is_rosbag2;
pub(super) use sqlite::MAGIC;
