//! Bytes of a file or pipe, front to back, through one small buffer.
//!
//! Plain reads, no memory map: a recording of any length costs the same memory, and a pipe is as
//! good as a file.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::inside::{Compression, Inside};
use crate::error::Error;

/// Bytes asked of the system at once: large enough to hide the calls, small enough for the
/// second-level cache, where they are parsed.
const BUFFER: usize = 256 * 1024;

/// What a file may claim at most of a piece that must be held in memory as a whole.
pub const LARGEST_PIECE: usize = 1 << 20;

/// Skips shorter than this are read, longer ones are sought where that is possible.
const WORTH_A_SEEK: u64 = 1 << 20;

/// Where the bytes come from.
enum Origin {
    File {
        file: File,
        len: u64,
    },
    Pipe(Box<dyn Read + Send>),
    /// A compressed piece, with the file around it.
    Inside(Box<Inside>),
}

/// A buffered reader that shows its buffer.
pub struct Input {
    path: PathBuf,
    from: Origin,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    /// Offset in the file of `buffer[start]`.
    offset: u64,
    /// Set when the bytes end where they should not.
    broken_off: Arc<AtomicBool>,
}

impl Input {
    /// Opens `path`, or the standard input for `-`.
    pub fn open(path: &Path) -> Result<Self, Error> {
        if path == Path::new("-") {
            return Ok(Self::pipe(Path::new("standard input"), Box::new(io::stdin())));
        }
        let refused = |source| Error::io("read", path, source);
        let file = File::open(path).map_err(refused)?;
        let about = file.metadata().map_err(refused)?;
        if about.is_dir() {
            return Err(refused(io::ErrorKind::IsADirectory.into()));
        }
        if !about.is_file() {
            return Ok(Self::pipe(path, Box::new(file)));
        }
        Ok(Self::new(path, Origin::File { file, len: about.len() }))
    }

    /// Reads a file that is open already, from its start; `path` is what errors call it.
    pub fn file(path: &Path, mut file: File) -> Result<Self, Error> {
        let len = file.seek(SeekFrom::End(0)).and_then(|len| file.rewind().map(|()| len));
        let len = len.map_err(|e| Error::io("read", path, e))?;
        Ok(Self::new(path, Origin::File { file, len }))
    }

    /// Reads from any stream; `path` is what errors call it.
    pub fn pipe(path: &Path, stream: Box<dyn Read + Send>) -> Self {
        Self::new(path, Origin::Pipe(stream))
    }

    /// Reads what is unpacked from another input; `broken_off` is set when that ends too early.
    pub fn unpacked(
        path: &Path,
        stream: Box<dyn Read + Send>,
        broken_off: Arc<AtomicBool>,
    ) -> Self {
        Self { broken_off, ..Self::pipe(path, stream) }
    }

    fn new(path: &Path, from: Origin) -> Self {
        Self {
            path: path.to_owned(),
            from,
            buffer: vec![0; BUFFER],
            start: 0,
            end: 0,
            offset: 0,
            broken_off: Arc::default(),
        }
    }

    /// The end that was reached is no end: the file was packed, and damage was found there.
    pub fn is_broken_off(&self) -> bool {
        self.broken_off.load(Ordering::Relaxed)
    }

    /// The name that errors call this by.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The bytes at hand.
    #[inline]
    pub fn at_hand(&self) -> &[u8] {
        self.buffer.get(self.start..self.end).unwrap_or_default()
    }

    /// Offset in the file of the first byte at hand.
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// Length of the file; of a pipe nobody knows it.
    pub fn len(&self) -> Option<u64> {
        match self.from {
            Origin::File { len, .. } => Some(len),
            Origin::Pipe(_) => None,
            Origin::Inside(ref inside) => inside.outer().len(),
        }
    }

    /// Offset in the file, also where [`Input::offset`] counts the bytes of a compressed piece.
    pub fn file_offset(&self) -> u64 {
        match &self.from {
            Origin::Inside(inside) => inside.outer().file_offset(),
            _ => self.offset,
        }
    }

    /// Goes into the compressed piece that is the next `len` bytes: from here on its contents are
    /// at hand, and offsets count from its start.
    pub fn enter(&mut self, len: u64, compression: Compression) {
        let empty = Self {
            path: self.path.clone(),
            from: Origin::Pipe(Box::new(io::empty())),
            buffer: Vec::new(),
            start: 0,
            end: 0,
            offset: 0,
            broken_off: Arc::default(),
        };
        let outer = std::mem::replace(self, empty);
        self.from = Origin::Inside(Box::new(Inside::new(outer, len, compression)));
    }

    /// Whether the piece that was entered could not be decompressed to its end.
    pub fn is_damaged(&self) -> bool {
        matches!(&self.from, Origin::Inside(inside) if inside.is_damaged())
    }

    /// Goes back to the file, behind the piece; `false` when the file ends before.
    pub fn leave(&mut self) -> Result<bool, Error> {
        match std::mem::replace(&mut self.from, Origin::Pipe(Box::new(io::empty()))) {
            Origin::Inside(inside) => {
                let (outer, left) = inside.leave();
                *self = outer;
                self.skip(left)
            }
            other => {
                self.from = other;
                Ok(true)
            }
        }
    }

    /// Reads until `wanted` bytes are at hand; `false` when the file ends before.
    ///
    /// `wanted` is at most [`LARGEST_PIECE`]; more is never there.
    pub fn fill(&mut self, wanted: usize) -> Result<bool, Error> {
        if wanted > LARGEST_PIECE {
            return Ok(false);
        }
        while self.end - self.start < wanted {
            if self.start > 0 {
                self.buffer.copy_within(self.start..self.end, 0);
                self.end -= self.start;
                self.start = 0;
            }
            if self.buffer.len() < wanted {
                self.buffer.resize(wanted.next_power_of_two().max(BUFFER), 0);
            }
            let free = self.buffer.get_mut(self.end..).unwrap_or_default();
            let read = match &mut self.from {
                Origin::File { file, .. } => file.read(free),
                Origin::Pipe(stream) => stream.read(free),
                Origin::Inside(inside) => Ok(inside.read(free)?),
            };
            match read {
                Ok(0) => return Ok(false),
                Ok(n) => self.end += n,
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => return Err(Error::io("read", &self.path, e)),
            }
        }
        Ok(true)
    }

    /// Drops `n` bytes of those at hand (at most all).
    #[inline]
    pub fn consume(&mut self, n: usize) {
        let n = n.min(self.end - self.start);
        self.start += n;
        self.offset += n as u64;
    }

    /// Drops `n` bytes, read or not; `false` when the file ends before.
    pub fn skip(&mut self, n: u64) -> Result<bool, Error> {
        let mut left = n;
        loop {
            let here = (self.end - self.start) as u64;
            if left <= here {
                self.consume(left as usize);
                return Ok(true);
            }
            self.consume(here as usize);
            left -= here;
            if left >= WORTH_A_SEEK
                && let Origin::File { file, len } = &mut self.from
            {
                let to = self.offset.saturating_add(left).min(*len);
                file.seek(SeekFrom::Start(to)).map_err(|e| Error::io("read", &self.path, e))?;
                left -= (to - self.offset).min(left);
                self.offset = to;
            }
            if left > 0 && !self.fill(1)? {
                return Ok(false);
            }
        }
    }

    /// Goes to `offset`; `false`, and nothing happens, in a pipe or beyond the file's end.
    pub fn seek(&mut self, offset: u64) -> Result<bool, Error> {
        let Origin::File { file, len } = &mut self.from else { return Ok(false) };
        if offset > *len {
            return Ok(false);
        }
        file.seek(SeekFrom::Start(offset)).map_err(|e| Error::io("read", &self.path, e))?;
        (self.start, self.end, self.offset) = (0, 0, offset);
        Ok(true)
    }
}

impl Read for Input {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        self.fill(1).map_err(io::Error::other)?;
        let count = self.at_hand().read(to)?;
        self.consume(count);
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stream that gives one byte a call, the worst that a pipe may do.
    struct Drip(io::Cursor<Vec<u8>>);

    impl Read for Drip {
        fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
            let n = to.len().min(1);
            self.0.read(&mut to[..n])
        }
    }

    #[test]
    fn a_dripping_pipe_is_as_good_as_a_file() {
        let bytes: Vec<u8> = (0..100).collect();
        let mut input = Input::pipe(Path::new("-"), Box::new(Drip(io::Cursor::new(bytes))));
        assert!(input.fill(10).unwrap());
        assert_eq!(input.at_hand()[..10], [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
        assert!(input.skip(50).unwrap());
        assert!(input.fill(2).unwrap());
        assert_eq!((input.at_hand()[0], input.offset()), (50, 50));
        assert!(!input.skip(51).unwrap());
    }

    #[test]
    fn a_claim_of_gigabytes_costs_no_memory() {
        let mut input = Input::pipe(Path::new("-"), Box::new(io::repeat(0)));
        assert!(!input.fill(usize::MAX).unwrap());
        assert_eq!(input.buffer.len(), BUFFER);
    }

    #[test]
    fn long_skips_in_a_file_arrive_where_reading_would() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let bytes: Vec<u8> = (0..5_000_000u32).map(|i| (i % 251) as u8).collect();
        std::fs::write(&path, &bytes).unwrap();
        let mut input = Input::open(&path).unwrap();
        assert!(input.fill(1).unwrap());
        assert!(input.skip(3_000_001).unwrap());
        assert!(input.fill(1).unwrap());
        assert_eq!(input.at_hand()[0], bytes[3_000_001]);
        assert!(!input.skip(1 << 40).unwrap());
        assert!(input.seek(7).unwrap() && input.fill(1).unwrap());
        assert_eq!(input.at_hand()[0], 7);
    }
}
