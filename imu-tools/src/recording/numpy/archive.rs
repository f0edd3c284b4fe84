//! `.npz`: a zip file of arrays, each read by itself so that several can be read in step.

use std::fs::File;
use std::io::{self, Read, Seek as _, SeekFrom};
use std::path::Path;

use flate2::read::DeflateDecoder;
use zip::{CompressionMethod, ZipArchive};

use crate::error::Error;

/// How a zip file begins; an empty one is only its end.
pub const MAGICS: [&[u8]; 2] = [b"PK\x03\x04", b"PK\x05\x06"];

/// What one call decompresses at most, so that damage costs no more than this.
const AT_ONCE: usize = 8 * 1024;

/// An array in the archive.
#[derive(Clone, Debug)]
pub struct Member {
    /// Its name, without `.npy`.
    pub name: String,
    start: u64,
    packed: u64,
    size: u64,
    crc: u32,
    deflated: bool,
}

/// Lists the arrays in a file.
///
/// # Errors
/// When it is no whole zip file, or an array in it cannot be read.
pub fn list(path: &Path) -> Result<Vec<Member>, Error> {
    let name = path.display();
    let file = File::open(path).map_err(|e| Error::io("read", path, e))?;
    let mut archive = ZipArchive::new(io::BufReader::new(file)).map_err(|e| {
        Error::data(format!(
            "{name} is no whole .npz ({e}): its list of arrays stands at its end, so nothing can be \
             read of one that is cut off"
        ))
    })?;
    let mut members = Vec::new();
    for at in 0..archive.len() {
        let damaged = |what: &dyn std::fmt::Display| {
            Error::data(format!("{name} is damaged: array {} cannot be read ({what})", at + 1))
        };
        let member = archive.by_index_raw(at).map_err(|e| damaged(&e))?;
        let file_name = member.name().map_err(|e| damaged(&e))?.into_owned();
        let Some(array) = file_name.strip_suffix(".npy") else { continue };
        let deflated = match member.compression() {
            CompressionMethod::Stored => false,
            CompressionMethod::Deflated => true,
            other => return Err(damaged(&format!("it is compressed by {other}"))),
        };
        if member.encrypted() {
            return Err(damaged(&"it is encrypted"));
        }
        members.push(Member {
            name: array.to_owned(),
            start: member.data_start().ok_or_else(|| damaged(&"it has no start"))?,
            packed: member.compressed_size(),
            size: member.size(),
            crc: member.crc32(),
            deflated,
        });
    }
    if members.is_empty() {
        return Err(Error::data(format!(
            "{name} is a zip file without NumPy arrays: unpack it, and name the recording in it"
        )));
    }
    Ok(members)
}

impl Member {
    /// Reads the array from its start.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn open(&self, path: &Path) -> Result<MemberReader, Error> {
        let refused = |e| Error::io("read", path, e);
        let mut file = File::open(path).map_err(refused)?;
        file.seek(SeekFrom::Start(self.start)).map_err(refused)?;
        let packed = file.take(self.packed);
        let from: Box<dyn Read + Send> =
            if self.deflated { Box::new(DeflateDecoder::new(packed)) } else { Box::new(packed) };
        Ok(MemberReader { from, left: self.size, crc: self.crc, sum: crc32fast::Hasher::new() })
    }
}

/// The bytes of an array; at their end an error of the kind `InvalidData` where its checksum is
/// wrong, and `UnexpectedEof` where it is cut off.
pub struct MemberReader {
    from: Box<dyn Read + Send>,
    left: u64,
    crc: u32,
    sum: crc32fast::Hasher,
}

impl Read for MemberReader {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let most = to.len().min(AT_ONCE).min(usize::try_from(self.left).unwrap_or(AT_ONCE));
        let to = to.get_mut(..most).unwrap_or_default();
        if to.is_empty() && self.left > 0 {
            return Ok(0);
        }
        let n = self.from.read(to)?;
        if n == 0 {
            if self.left > 0 {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            let sum = self.sum.clone().finalize();
            return if sum == self.crc { Ok(0) } else { Err(io::ErrorKind::InvalidData.into()) };
        }
        self.left = self.left.saturating_sub(n as u64);
        self.sum.update(to.get(..n).unwrap_or_default());
        Ok(n)
    }
}
