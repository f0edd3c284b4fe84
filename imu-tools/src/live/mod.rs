//! An IMU while it streams: bytes of a port to messages ([`protocol`]), messages to samples on the
//! sensor's own clock ([`clock`]), samples into a calibration that can be kept and gone on with
//! ([`session`], [`checkpoint`]).
//!
//! Data flows one way: port → protocol → clock → [`crate::recording`]'s samples → calibration →
//! screen.

pub mod checkpoint;
pub mod clock;
pub mod face;
pub mod goal;
pub mod intake;
pub mod keep;
pub mod link;
mod message;
pub mod port;
pub mod protocol;
pub mod rates;
pub mod run;
pub mod screen;
pub mod session;
mod shown;
pub mod simulated;
mod stretch;
mod told;

pub use message::{Count, Kind, Message, Ticks};
