//! Streams: `imu live` and what it is made of.

mod session;
