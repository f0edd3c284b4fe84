//! Files written whole or not at all.
//!
//! An [`Output`] is a temporary file in the folder of its target, renamed to it by
//! [`Output::finish`]. Dropped before that, it leaves nothing behind. `-` is the standard output,
//! and a path that exists but is no regular file (`/dev/null`, a named pipe) is written in place.
//! A program that is interrupted removes what it has not finished ([`clean_up_on_signals`]); one that
//! is killed outright leaves its temporary file, `.imu-XXXXXX.part`: delete it.
//!
//! ```
//! use imu_tools::output::Output;
//! let folder = tempfile::tempdir().unwrap();
//! let path = folder.path().join("note.txt");
//! let mut file = Output::create(&path).unwrap();
//! file.write(b"hello").unwrap();
//! assert!(!path.exists());
//! file.finish().unwrap();
//! assert_eq!(std::fs::read(&path).unwrap(), b"hello");
//! ```

mod unfinished;

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use crate::error::Error;
pub(crate) use unfinished::Unfinished;
pub use unfinished::{clean_up_on_signals, end_is_asked, heed_signals};

/// A file in the making. It keeps no buffer: write large pieces.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
    to: To,
}

#[derive(Debug)]
enum To {
    Whole { file: NamedTempFile, unfinished: Unfinished },
    InPlace(File),
    Growing(File),
    Stdout(io::Stdout),
}

impl Output {
    /// Starts the file that will stand at `path`.
    ///
    /// # Errors
    /// When the folder does not exist or cannot be written.
    pub fn create(path: &Path) -> Result<Self, Error> {
        let refused = |source| Error::io("write", path, source);
        if path == Path::new("-") {
            return Ok(Self { path: path.to_owned(), to: To::Stdout(io::stdout()) });
        }
        // A link is followed, so that the file behind it is replaced and not the link.
        let path = target(path);
        let to = match fs::metadata(&path) {
            Ok(there) if there.is_dir() => {
                return Err(refused(io::ErrorKind::IsADirectory.into()));
            }
            Err(_) if path.is_symlink() => {
                return Err(refused(io::Error::other(
                    "it is a link that leads nowhere; name the file itself",
                )));
            }
            Ok(there) if !there.is_file() => {
                To::InPlace(File::options().write(true).open(&path).map_err(refused)?)
            }
            _ => {
                let mut builder = Builder::new();
                builder.prefix(".imu-").suffix(".part");
                #[cfg(unix)]
                {
                    use std::os::unix::fs::PermissionsExt as _;
                    // What any new file gets: the umask takes its part away.
                    builder.permissions(fs::Permissions::from_mode(0o666));
                }
                let made = Unfinished::create(|| {
                    let file = builder.tempfile_in(folder(&path))?;
                    let at = file.path().to_owned();
                    Ok((file, at))
                });
                let (file, unfinished) = made.map_err(|e| refused(bare(e)))?;
                To::Whole { file, unfinished }
            }
        };
        Ok(Self { path, to })
    }

    /// Starts a file that stands at `path` from the beginning and grows there, so that what was written
    /// outlives the program whatever ends it: a recording of days.
    ///
    /// # Errors
    /// When there is a file of that name already, or the folder cannot be written.
    pub fn growing(path: &Path) -> Result<Self, Error> {
        let made = File::options().write(true).create_new(true).open(path);
        let file = made.map_err(|source| Error::io("write", path, source))?;
        Ok(Self { path: path.to_owned(), to: To::Growing(file) })
    }

    /// Brings what was written to the disk itself, where this is a file that grows.
    ///
    /// # Errors
    /// As [`Output::write`].
    pub fn sync(&mut self) -> Result<(), Error> {
        let To::Growing(file) = &mut self.to else { return Ok(()) };
        file.sync_data().map_err(|source| Error::io("write", &self.path, source))
    }

    /// Appends all of `bytes`.
    ///
    /// # Errors
    /// When the disk is full or the pipe's reader has gone.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), Error> {
        match &mut self.to {
            To::Whole { file, .. } => file.as_file_mut().write_all(bytes),
            To::InPlace(file) | To::Growing(file) => file.write_all(bytes),
            To::Stdout(stdout) => stdout.write_all(bytes),
        }
        .map_err(|source| Error::io("write", &self.path, source))
    }

    /// Overwrites `bytes` at `offset`, for headers that are known only at the end; `false` where
    /// the target is a pipe and cannot.
    ///
    /// # Errors
    /// As [`Output::write`].
    pub fn patch(&mut self, offset: u64, bytes: &[u8]) -> Result<bool, Error> {
        use std::io::Seek as _;
        let file = match &mut self.to {
            To::Whole { file, .. } => file.as_file_mut(),
            To::Growing(file) => file,
            To::InPlace(_) | To::Stdout(_) => return Ok(false),
        };
        let end = file.stream_position();
        end.and_then(|end| {
            file.seek(io::SeekFrom::Start(offset))?;
            file.write_all(bytes)?;
            file.seek(io::SeekFrom::Start(end))
        })
        .map(|_| true)
        .map_err(|source| Error::io("write", &self.path, source))
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// As [`Output::write`]; then nothing is left behind.
    pub fn finish(self) -> Result<(), Error> {
        match self.to {
            To::Whole { file, unfinished } => {
                unfinished.settle(|| file.persist(&self.path).map(drop).map_err(|e| e.error))
            }
            To::InPlace(mut file) => file.flush(),
            To::Growing(file) => file.sync_all(),
            To::Stdout(mut stdout) => stdout.flush(),
        }
        .map_err(|source| Error::io("write", &self.path, source))
    }
}

/// Where a path leads: through all links, also to a file that does not exist yet.
pub(crate) fn target(path: &Path) -> PathBuf {
    /// So many links in a row are a loop.
    const LINKS: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        if fs::metadata(&path).is_ok() {
            // What is no file (a pipe behind /dev/stdout) may have no other name.
            return fs::canonicalize(&path).unwrap_or(path);
        }
        let Ok(link) = fs::read_link(&path) else { break };
        path = folder(&path).join(link);
    }
    match (fs::canonicalize(folder(&path)), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path,
    }
}

/// The folder that a file stands in.
fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// The system's error without the temporary name that `tempfile` adds to it.
fn bare(error: io::Error) -> io::Error {
    error.kind().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn dropped_output_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "old").unwrap();
        let mut output = Output::create(&path).unwrap();
        output.write(b"new").unwrap();
        drop(output);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(files(folder.path()), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_nothing_yet_is_followed() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("link");
        std::os::unix::fs::symlink("a", &link).unwrap();
        let mut output = Output::create(&link).unwrap();
        output.write(b"new").unwrap();
        output.finish().unwrap();
        assert_eq!(fs::read_link(&link).unwrap(), Path::new("a"));
        assert_eq!(fs::read(folder.path().join("a")).unwrap(), b"new");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_itself_is_refused_and_kept() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("link");
        std::os::unix::fs::symlink("link", &link).unwrap();
        let error = Output::create(&link).unwrap_err();
        assert!(error.to_string().contains("a link that leads nowhere"), "{error}");
        assert_eq!(fs::read_link(&link).unwrap(), Path::new("link"));
    }

    #[test]
    fn patches_go_back_and_writing_goes_on_at_the_end() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let mut output = Output::create(&path).unwrap();
        output.write(b"????1").unwrap();
        assert!(output.patch(0, b"size").unwrap());
        output.write(b"2").unwrap();
        output.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"size12");
    }

    #[test]
    fn a_growing_file_is_there_at_once_and_never_in_the_place_of_another() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let mut output = Output::growing(&path).unwrap();
        output.write(b"???t").unwrap();
        output.sync().unwrap();
        assert!(output.patch(0, b"cut").unwrap());
        drop(output);
        assert_eq!(fs::read(&path).unwrap(), b"cutt");
        assert!(Output::growing(&path).is_err());
    }

    #[test]
    fn missing_folder_is_one_sentence() {
        let error = Output::create(Path::new("/no-such-folder/a.bag")).unwrap_err();
        assert_eq!(
            error.to_string(),
            "cannot write /no-such-folder/a.bag: there is no such file or folder"
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn full_disk_is_one_sentence() {
        let mut output = Output::create(Path::new("/dev/full")).unwrap();
        let error = output.write(b"x").unwrap_err();
        assert!(error.to_string().contains("the disk is full"), "{error}");
    }
}
