//! A checkpoint on disk: whole or not there, checked, and with the one before it.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `IMULIVE` and a zero |
//! | 2 | version of what follows (3), little-endian |
//! | 8 | length of the payload, little-endian |
//! | … | the payload |
//! | 4 | CRC-32 (IEEE 802.3) of all bytes before, little-endian |
//!
//! It is written to `NAME.part` and flushed to the disk; then `NAME` becomes `NAME.previous` and
//! `NAME.part` becomes `NAME`. Whenever the power goes, one of them is whole. A session keeps the file that it
//! wrote last locked, before the first one an empty `NAME.part`: two sessions of one name would each lose what
//! the other keeps.

use std::fs::{self, File, TryLockError};
use std::io::{self, Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

use crate::error::Error;

const MAGIC: &[u8; 8] = b"IMULIVE\0";
const VERSION: u16 = 3;
const HEADER: usize = 18;
const CRC: usize = 4;

/// A payload that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// What was kept.
    pub payload: Vec<u8>,
    /// What there is to tell: that this is not the latest one, and why.
    pub warning: Option<String>,
}

/// Why a file is not taken.
enum Refused {
    Missing,
    Damaged(&'static str),
    Other(u16),
    Unreadable(io::Error),
}

/// `path` with something at the end of its name.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// Where the checkpoints of one session are kept.
#[derive(Debug)]
pub struct Place {
    path: PathBuf,
    /// The file that is locked, and whether it still is `NAME.part`.
    locked: File,
    is_part: bool,
}

impl Place {
    /// Takes `path` for a session, and completes what a power cut may have left undone there.
    ///
    /// # Errors
    /// When another session keeps its checkpoints there, or the folder cannot be written.
    pub fn take(path: &Path) -> Result<Self, Error> {
        let refused = refused(path);
        let (part, previous) = (beside(path, ".part"), beside(path, ".previous"));
        if let Ok(latest) = File::open(path) {
            lock(&latest, path)?;
        } else if previous.exists() && one(&part).is_ok() {
            fs::rename(&part, path).map_err(&refused)?;
        }
        let locked = open(&part).map_err(refused)?;
        lock(&locked, path)?;
        Ok(Self { path: path.to_owned(), locked, is_part: true })
    }

    /// Puts a checkpoint in the place of the one before, which is kept as `.previous`.
    ///
    /// # Errors
    /// When the disk is full or the folder cannot be written; then the one before is still there.
    pub fn write(&mut self, payload: &[u8]) -> Result<(), Error> {
        let path = self.path.clone();
        let (refused, part) = (refused(&path), beside(&path, ".part"));
        if !self.is_part {
            let next = open(&part).map_err(&refused)?;
            lock(&next, &path)?;
            (self.locked, self.is_part) = (next, true);
        }
        self.put(&part, payload).map_err(refused)
    }

    fn put(&mut self, part: &Path, payload: &[u8]) -> io::Result<()> {
        let mut header = Vec::with_capacity(HEADER);
        header.extend_from_slice(MAGIC);
        header.extend_from_slice(&VERSION.to_le_bytes());
        header.extend_from_slice(&(payload.len() as u64).to_le_bytes());
        let mut crc = crc32fast::Hasher::new();
        crc.update(&header);
        crc.update(payload);
        self.locked.set_len(0)?;
        self.locked.rewind()?;
        self.locked.write_all(&header)?;
        self.locked.write_all(payload)?;
        self.locked.write_all(&crc.finalize().to_le_bytes())?;
        self.locked.sync_all()?;
        if self.path.exists() {
            fs::rename(&self.path, beside(&self.path, ".previous"))?;
        }
        fs::rename(part, &self.path)?;
        self.is_part = false;
        sync_folder(&self.path)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let part = beside(&self.path, ".part");
        // Empty or half a checkpoint: of no use to anybody.
        if self.is_part && one(&part).is_err() {
            let _ = fs::remove_file(part);
        }
    }
}

/// What is said where the disk is full or the folder cannot be written.
fn refused(path: &Path) -> impl Fn(io::Error) -> Error {
    |source| Error::io("write the checkpoint", path, source)
}

/// A file that is written from its beginning once it is locked.
fn open(part: &Path) -> io::Result<File> {
    File::options().write(true).create(true).truncate(false).open(part)
}

/// Keeps other sessions away. Where files cannot be locked, nobody is.
fn lock(file: &File, path: &Path) -> Result<(), Error> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(Error::data(format!(
            "another imu live keeps its checkpoints in {}: name another with --checkpoint",
            path.display()
        ))),
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
    }
}

/// Brings the names of a folder to the disk.
#[cfg(unix)]
fn sync_folder(path: &Path) -> io::Result<()> {
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    File::open(folder.unwrap_or(Path::new(".")))?.sync_all()
}

/// Other systems open no folder.
#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

/// The latest checkpoint at `path` that is whole; `None` where there never was one.
///
/// # Errors
/// When it is of another version of this program, or none that there is is whole.
pub fn read(path: &Path) -> Result<Option<Found>, Error> {
    let (part, previous) = (beside(path, ".part"), beside(path, ".previous"));
    let why = match one(path) {
        Ok(payload) => return Ok(Some(Found { payload, warning: None })),
        Err(Refused::Other(version)) => {
            return Err(Error::data(format!(
                "the checkpoint {} is of another version of this program ({version}; this one reads \
                 {VERSION}): resume with that one, or begin anew with another --checkpoint",
                path.display()
            )));
        }
        Err(Refused::Unreadable(source)) => {
            return Err(Error::io("read the checkpoint", path, source));
        }
        // The power went between two renames: the new one is complete beside it.
        Err(Refused::Missing) => match (one(&part), previous.exists()) {
            (Ok(payload), true) => return Ok(Some(Found { payload, warning: None })),
            (_, false) => return Ok(None),
            (Err(_), true) => "is missing",
        },
        Err(Refused::Damaged(why)) => why,
    };
    match one(&previous) {
        Ok(payload) => {
            let warning = format!(
                "the checkpoint {} {why}: the one before it, {}, is taken",
                path.display(),
                previous.display()
            );
            Ok(Some(Found { payload, warning: Some(warning) }))
        }
        Err(_) => Err(Error::data(format!(
            "the checkpoint {} {why}, and there is no whole one before it: begin anew with {}",
            path.display(),
            if check_is_one(path).is_ok() { "--fresh" } else { "another --checkpoint" }
        ))),
    }
}

/// Refuses a file that is none of ours: it is not replaced.
///
/// # Errors
/// When `path` is another's file.
pub fn check_is_one(path: &Path) -> Result<(), Error> {
    let mut beginning = Vec::new();
    if let Ok(file) = File::open(path) {
        let read = file.take(MAGIC.len() as u64).read_to_end(&mut beginning);
        read.map_err(|source| Error::io("read the checkpoint", path, source))?;
    }
    let same = beginning.iter().zip(MAGIC).all(|(a, b)| a == b);
    if same {
        Ok(())
    } else {
        Err(Error::usage(format!(
            "{} is no checkpoint, and is not replaced: name another with --checkpoint",
            path.display()
        )))
    }
}

/// The payload of one file.
fn one(path: &Path) -> Result<Vec<u8>, Refused> {
    let bytes = fs::read(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => Refused::Missing,
        _ => Refused::Unreadable(error),
    })?;
    let Some((header, _)) = bytes.split_first_chunk::<HEADER>() else {
        return Err(Refused::Damaged("is cut off"));
    };
    let [a, b, c, d, e, f, g, h, v0, v1, l @ ..] = *header;
    if [a, b, c, d, e, f, g, h] != *MAGIC {
        return Err(Refused::Damaged("is none, or its beginning is damaged"));
    }
    let version = u16::from_le_bytes([v0, v1]);
    let Some((body, crc)) = bytes.split_last_chunk::<CRC>() else {
        return Err(Refused::Damaged("is cut off"));
    };
    let whole = u32::from_le_bytes(*crc) == crc32fast::hash(body);
    if version != VERSION && whole {
        return Err(Refused::Other(version));
    }
    let payload = body.get(HEADER..).unwrap_or_default();
    if payload.len() as u64 != u64::from_le_bytes(l) {
        return Err(Refused::Damaged("is cut off"));
    }
    if !whole {
        return Err(Refused::Damaged("is damaged (its checksum does not match)"));
    }
    Ok(payload.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(path: &Path, payloads: &[&[u8]]) {
        let mut place = Place::take(path).unwrap();
        payloads.iter().for_each(|payload| place.write(payload).unwrap());
    }

    fn payload(found: Option<Found>) -> (Vec<u8>, bool) {
        let found = found.unwrap();
        (found.payload, found.warning.is_some())
    }

    #[test]
    fn the_latest_is_read_and_the_one_before_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c");
        assert_eq!(read(&path).unwrap(), None);
        let mut place = Place::take(&path).unwrap();
        for text in [&b"one"[..], b"two", b""] {
            place.write(text).unwrap();
            assert_eq!(payload(read(&path).unwrap()), (text.to_vec(), false));
        }
        assert_eq!(one(&beside(&path, ".previous")).ok().unwrap(), b"two");
    }

    #[test]
    fn whatever_is_damaged_the_one_before_is_taken_and_that_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c");
        write(&path, &[b"one", b"two"]);
        let whole = fs::read(&path).unwrap();
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x40;
            fs::write(&path, &bytes).unwrap();
            assert_eq!(payload(read(&path).unwrap()), (b"one".to_vec(), true), "byte {at}");
            fs::write(&path, &whole[..at]).unwrap();
            assert_eq!(payload(read(&path).unwrap()), (b"one".to_vec(), true), "cut at {at}");
        }
        fs::remove_file(beside(&path, ".previous")).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("is cut off") && error.contains("--fresh"), "{error}");
    }

    #[test]
    fn a_power_loss_between_the_renames_loses_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c");
        write(&path, &[b"one"]);
        fs::rename(&path, beside(&path, ".previous")).unwrap();
        assert_eq!(payload(read(&path).unwrap()), (b"one".to_vec(), true));
        write(&beside(&path, ".part"), &[b"two"]);
        assert_eq!(payload(read(&path).unwrap()), (b"two".to_vec(), false));
        // Who goes on with it completes the renames before anything else is written.
        let place = Place::take(&path).unwrap();
        assert_eq!(one(&path).ok().unwrap(), b"two");
        drop(place);
        assert!(!beside(&path, ".part").exists());
    }

    #[test]
    fn a_place_is_of_one_session_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c");
        let is_taken = || {
            let error = Place::take(&path).unwrap_err().to_string();
            error.starts_with("another imu live keeps its checkpoints in")
        };
        let mut place = Place::take(&path).unwrap();
        assert!(is_taken(), "before the first checkpoint");
        for _ in 0..3 {
            place.write(b"one").unwrap();
            assert!(is_taken());
            assert_eq!(payload(read(&path).unwrap()), (b"one".to_vec(), false));
        }
        drop(place);
        Place::take(&path).unwrap();
    }

    #[test]
    fn another_version_is_refused_and_not_taken_for_damage() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c");
        write(&path, &[b"one", b"two"]);
        for version in [2, 4] {
            let mut bytes = fs::read(&path).unwrap();
            bytes[8] = version;
            let end = bytes.len() - CRC;
            let crc = crc32fast::hash(&bytes[..end]).to_le_bytes();
            bytes[end..].copy_from_slice(&crc);
            fs::write(&path, &bytes).unwrap();
            let error = read(&path).unwrap_err().to_string();
            let words = format!("another version of this program ({version}; this one reads 3)");
            assert!(error.contains(&words), "{error}");
        }
    }
}
