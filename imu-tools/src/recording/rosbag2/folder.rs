//! A folder of files that follow each other.

use std::path::{Path, PathBuf};

use super::metadata::{self, Metadata};
use crate::error::Error;
use crate::recording::nothing::Nothing;
use crate::recording::poses::PoseTopic;
use crate::recording::{self, Block, Note, ReadOptions, Source, Stream, add_streams};

/// Endings of files that hold messages.
const ENDINGS: [&str; 4] = [".db3", ".mcap", ".db3.zstd", ".mcap.zstd"];

fn holds_messages(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    ENDINGS.iter().any(|ending| name.ends_with(ending))
}

/// Whether a folder is a rosbag2: it has a `metadata.yaml`, or a file of messages.
pub fn is_rosbag2(folder: &Path) -> bool {
    folder.join(metadata::NAME).is_file()
        || std::fs::read_dir(folder).is_ok_and(|mut files| {
            files.any(|file| file.is_ok_and(|file| holds_messages(&file.path())))
        })
}

/// A rosbag2 folder being read.
pub struct FolderReader {
    folder: PathBuf,
    options: ReadOptions,
    files: Vec<PathBuf>,
    /// Which of them is open.
    current: usize,
    source: Box<dyn Source>,
    /// Topics of the files before.
    streams: Vec<Stream>,
    /// Bytes of the files before, and of all.
    before: u64,
    total: u64,
    /// Messages that the metadata count.
    expected: Option<u64>,
    gyroscope: String,
    accelerometer: String,
    notes: Vec<Note>,
}

impl FolderReader {
    /// Opens the folder and its first file.
    ///
    /// # Errors
    /// When a file is missing, or none has a topic that fits.
    pub fn open(folder: &Path, options: &ReadOptions) -> Result<Self, Error> {
        let mut notes = Vec::new();
        let metadata = Metadata::read(folder)?;
        let files = match &metadata {
            Some(metadata) => named(folder, metadata)?,
            None => found(folder, &mut notes)?,
        };
        let mut total = 0;
        for file in &files {
            total += length(file, folder)?;
        }
        let mut current = 0;
        let source = loop {
            let file = files.get(current).ok_or_else(|| nothing(folder))?;
            match recording::open(file, options) {
                Ok(source) => break source,
                // A file that was opened and never written to; the next one may have the topics.
                Err(error) if current + 1 == files.len() => return Err(error),
                Err(Error::Data(what)) => notes.push(Note::Warning(what)),
                Err(error) => return Err(error),
            }
            current += 1;
        };
        let mut options = options.clone();
        let (gyroscope, accelerometer) =
            (source.gyroscope().to_owned(), source.accelerometer().to_owned());
        // The other files are asked for what was found here, so that the choice is made once.
        options.topic = match (gyroscope.as_str(), accelerometer.as_str()) {
            ("", "") => options.topic,
            (topic, "") | ("", topic) => Some(topic.to_owned()),
            (gyroscope, accelerometer) => Some(format!("{gyroscope},{accelerometer}")),
        };
        if let (Some(PoseTopic::Only), Some(of)) =
            (&options.poses, source.streams().into_iter().find(|stream| stream.used))
        {
            options.poses = Some(PoseTopic::Named(of.name));
        }
        Ok(Self {
            folder: folder.to_owned(),
            options,
            files,
            current,
            source,
            streams: Vec::new(),
            before: 0,
            total,
            expected: metadata.and_then(|metadata| metadata.message_count),
            gyroscope,
            accelerometer,
            notes,
        })
    }

    /// Goes to the next file; `false` at the end.
    fn next_file(&mut self) -> Result<bool, Error> {
        while let Some(file) = self.files.get(self.current + 1) {
            self.notes.append(&mut self.source.take_notes());
            add_streams(&mut self.streams, self.source.streams());
            if let Some(done) = self.files.get(self.current) {
                self.before += length(done, &self.folder)?;
            }
            self.current += 1;
            match recording::open(file, &self.options) {
                Ok(source) => {
                    self.source = source;
                    return Ok(true);
                }
                // The other files may be whole.
                Err(Error::Data(what) | Error::Usage(what)) => {
                    self.notes.push(Note::Warning(format!("{what}; it is left out")));
                    self.source = Box::new(Nothing);
                }
                Err(error) => return Err(error),
            }
        }
        Ok(false)
    }

    /// Compares the number of messages with what the metadata say, once, at the end.
    fn count(&mut self) {
        let found: u64 = self.streams().iter().map(|stream| stream.messages).sum();
        if let Some(expected) = self.expected.take().filter(|expected| *expected > found) {
            self.notes.push(Note::Warning(format!(
                "{} should hold {expected} messages, of which {found} were found",
                self.folder.display()
            )));
        }
    }
}

/// The files that the metadata name.
fn named(folder: &Path, metadata: &Metadata) -> Result<Vec<PathBuf>, Error> {
    match metadata.storage_identifier.as_str() {
        "mcap" | "sqlite3" | "" => {}
        other => {
            return Err(Error::data(format!(
                "{} is stored as {other}, of which nothing is known: `ros2 bag convert` makes mcap \
                 of it",
                folder.display()
            )));
        }
    }
    // Old versions name the folder as well.
    let place = |file: &PathBuf| match (folder.join(file), file.file_name()) {
        (path, Some(name)) if !path.exists() => folder.join(name),
        (path, _) => path,
    };
    Ok(metadata.relative_file_paths.iter().map(place).collect())
}

/// The files of a folder without metadata, in the order of their names and numbers.
fn found(folder: &Path, notes: &mut Vec<Note>) -> Result<Vec<PathBuf>, Error> {
    let refused = |error| Error::io("read", folder, error);
    let mut files = Vec::new();
    for file in std::fs::read_dir(folder).map_err(refused)? {
        let path = file.map_err(refused)?.path();
        if holds_messages(&path) {
            files.push(path);
        }
    }
    files.sort_by_key(|path| order(path));
    if files.is_empty() {
        return Err(nothing(folder));
    }
    notes.push(Note::Warning(format!(
        "{} has no {}: its {} files are read in the order of their names",
        folder.display(),
        metadata::NAME,
        files.len()
    )));
    Ok(files)
}

/// A name by which `a_10.db3` comes behind `a_9.db3`: the recorder numbers its files.
fn order(path: &Path) -> (String, u64, String) {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = name.split('.').next().unwrap_or_default();
    let digits = stem.len() - stem.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    let (start, number) = stem.split_at(stem.len() - digits);
    (start.to_owned(), number.parse().unwrap_or(0), name)
}

fn nothing(folder: &Path) -> Error {
    Error::data(format!("{} holds no .db3 and no .mcap file", folder.display()))
}

/// Length of a file that must be there.
fn length(file: &Path, folder: &Path) -> Result<u64, Error> {
    match std::fs::metadata(file) {
        Ok(about) => Ok(about.len()),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Err(Error::data(format!(
            "{} is missing, which {} names: copy it there, or name the other files one by one",
            file.display(),
            folder.join(metadata::NAME).display()
        ))),
        Err(error) => Err(Error::io("read", file, error)),
    }
}

impl Source for FolderReader {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        loop {
            match self.source.next_block(block) {
                Ok(true) => return Ok(true),
                Ok(false) => {}
                Err(Error::Data(what)) if self.files.len() > 1 => {
                    self.notes.push(Note::Warning(what));
                }
                Err(error) => return Err(error),
            }
            if !self.next_file()? {
                block.clear();
                self.count();
                return Ok(false);
            }
        }
    }

    fn streams(&self) -> Vec<Stream> {
        let mut streams = self.streams.clone();
        add_streams(&mut streams, self.source.streams());
        streams
    }

    fn gyroscope(&self) -> &str {
        &self.gyroscope
    }

    fn accelerometer(&self) -> &str {
        &self.accelerometer
    }

    fn take_notes(&mut self) -> Vec<Note> {
        let mut notes = std::mem::take(&mut self.notes);
        notes.append(&mut self.source.take_notes());
        notes
    }

    fn bytes_read(&self) -> u64 {
        self.before + self.source.bytes_read()
    }

    fn bytes_total(&self) -> Option<u64> {
        Some(self.total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbered_files_come_in_the_order_of_their_numbers() {
        let mut names = ["a_10.db3", "a_9.db3", "b.mcap", "a_0.db3.zstd"].map(PathBuf::from);
        names.sort_by_key(|path| order(path));
        assert_eq!(names, ["a_0.db3.zstd", "a_9.db3", "a_10.db3", "b.mcap"].map(PathBuf::from));
    }
}
