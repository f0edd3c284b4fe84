//! An IMU while it streams: bytes of a port to messages ([`protocol`]), messages to samples on the
//! sensor's own clock ([`clock`]).
//!
//! Data flows one way: port → protocol → clock → [`crate::recording`]'s samples → calibration →
//! screen.

pub mod clock;
mod message;
pub mod protocol;

pub use message::{Count, Kind, Message, Ticks};
