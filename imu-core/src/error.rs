//! The one error type of the crate: small, `Copy`, and only ever returned by constructors.

use core::fmt;

/// Why a constructor refused its arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// The named argument is a NaN or an infinity.
    NonFinite(&'static str),
    /// The named argument lies outside its documented range.
    OutOfRange(&'static str),
    /// The bytes are not what [`write_to`](crate::allan::Ladder::write_to) writes: the reason.
    Corrupt(&'static str),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinite(what) => write!(f, "{what} is not finite"),
            Self::OutOfRange(what) => write!(f, "{what} is out of range"),
            Self::Corrupt(why) => write!(f, "stored ladder cannot be read: {why}"),
        }
    }
}

impl core::error::Error for Error {}
