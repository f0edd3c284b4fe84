//! What sensors send, one protocol a file: bytes to [`Message`]s, and back for tests and simulation.
//!
//! Each protocol is *check → view → sample* on frames that `framer` finds: `check` says whether a
//! whole frame with a right checksum begins here, a `View` names its fields in place, and a sample of
//! it is a [`Message`] in SI units. What is read of which protocol, and what it was tested against,
//! stands in docs/live-protocols.md.

mod decoder;
mod encoder;
mod fields;
mod framer;
mod imu_frame;
mod mavlink;
mod name;
mod recognise;
mod text;
mod vectornav;
mod witmotion;
mod xsens;

#[cfg(test)]
mod tests;

pub use decoder::Decoder;
pub use encoder::Encoder;
pub use framer::Tally;
pub use name::Protocol;
pub use recognise::{Candidate, candidate, candidates, recognise};

#[cfg(doc)]
use super::Message;
