//! Streams: `imu live` and what it is made of.

mod protocols;
mod session;
