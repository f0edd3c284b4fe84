//! The one error type of this crate: a sentence for a person, and whose fault it is.
//!
//! Every message is one clear sentence: what went wrong, where, and how to mend it. `main` prints
//! it and leaves with [`Error::exit_code`].

use std::io;
use std::path::{Path, PathBuf};

/// What went wrong.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The command line asks for something that does not exist or cannot be: exit code 2.
    #[error("{0}")]
    Usage(String),
    /// The data cannot be read as asked: exit code 1.
    #[error("{0}")]
    Data(String),
    /// The operating system refused: exit code 1.
    #[error("cannot {action} {}: {}", name(path), reason(source))]
    Io {
        /// What was being done, as a verb: "read", "write".
        action: &'static str,
        /// The file it was done to; `-` for a pipe.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
}

impl Error {
    /// A mistake on the command line.
    pub fn usage(sentence: impl Into<String>) -> Self {
        Self::Usage(sentence.into())
    }

    /// Data that cannot be read as asked.
    pub fn data(sentence: impl Into<String>) -> Self {
        Self::Data(sentence.into())
    }

    /// A refusal of the operating system: `action` is a verb, such as "read".
    pub fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }

    /// 2 for a mistake on the command line, 1 for everything else.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Data(_) | Self::Io { .. } => 1,
        }
    }
}

/// A path as a person knows it: `-` is only ever written to.
fn name(path: &Path) -> String {
    match path.to_str() {
        Some("-") => "the standard output".into(),
        _ => path.display().to_string(),
    }
}

/// The common refusals with the way out; the system's own words for the others.
fn reason(source: &io::Error) -> String {
    use io::ErrorKind::{
        AlreadyExists, IsADirectory, NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem,
        StorageFull,
    };
    match source.kind() {
        NotFound => "there is no such file or folder".into(),
        PermissionDenied => "permission denied; choose another folder or mend its rights".into(),
        StorageFull => "the disk is full; free some space or choose another folder".into(),
        AlreadyExists => "there is a file of that name; choose another".into(),
        IsADirectory => "it is a folder; name a file in it".into(),
        NotADirectory => "a part of its path is a file, not a folder".into(),
        ReadOnlyFilesystem => "the disk is read-only; choose another folder".into(),
        _ => source.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usage_exits_with_2_and_the_rest_with_1() {
        assert_eq!(Error::usage("x").exit_code(), 2);
        assert_eq!(Error::data("x").exit_code(), 1);
        let full = Error::io("write", Path::new("a.bag"), io::ErrorKind::StorageFull.into());
        assert_eq!(full.exit_code(), 1);
        assert_eq!(
            full.to_string(),
            "cannot write a.bag: the disk is full; free some space or choose another folder"
        );
        let full = Error::io("write", Path::new("-"), io::ErrorKind::StorageFull.into());
        assert!(full.to_string().starts_with("cannot write the standard output: "), "{full}");
    }
}
