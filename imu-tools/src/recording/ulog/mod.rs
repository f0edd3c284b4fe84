//! PX4 flight logs, ULog: a reader.
//!
//! A log is a header of 16 bytes, then messages: a size (u16), a kind (one letter) and so many
//! bytes, little-endian. Formats (F) say what fields a topic has, subscriptions (A) give a topic
//! and instance a number, data (D) carries that number and the fields, packed. Source: PX4's user
//! guide, "ULog File Format".
//!
//! **Where samples come from.** For each sensor, of the topics below that hold it, the first whose
//! readings are not fewer than half of those of the richest, by the first megabyte of the log (a
//! log often has `sensor_gyro` once a second, to watch temperatures, and `sensor_combined` at full
//! rate); [`ReadOptions::topic`](super::ReadOptions) overrules that.
//!
//! | topic | what a reading is |
//! | --- | --- |
//! | `sensor_gyro_fifo`, `sensor_accel_fifo` | every sample of the chip's FIFO, in counts times `scale` |
//! | `sensor_gyro`, `sensor_accel` | as the driver publishes it, or the mean of a FIFO's batch; not calibrated |
//! | `vehicle_imu` | `delta_angle` / `delta_angle_dt`, `delta_velocity` / `delta_velocity_dt`: means, calibrated by PX4 |
//! | `sensor_combined` | means, calibrated by PX4, of the IMU that PX4 has selected |
//!
//! All are in rad/s and m/s². A drone has several IMUs: an instance is called `sensor_gyro:1`, and
//! `1` alone, as a topic, means this instance of both sensors.
//!
//! **Stamps** are `timestamp_sample` (where a topic has none, `timestamp`): microseconds since the
//! autopilot started, brought to nanoseconds. A FIFO's batch carries the stamp of its *last* sample
//! (PX4's drivers take it at the interrupt that says that the batch is complete; PX4's Flight Review
//! expands it so), so sample k of n is stamped `timestamp_sample - (n - 1 - k)·dt`. A mean carries
//! the stamp at which its interval ends (`VehicleIMU::Publish` takes that of the last gyroscope
//! sample in it).
//!
//! **Temperature** is that of the `sensor_gyro` whose device is the chosen gyroscope's, or else of
//! the chosen accelerometer's `sensor_accel`.
//!
//! **Damage.** Logs usually end where the power was cut: all whole messages are used. After bytes
//! that are no message, reading goes on at the next synchronization mark or message that is sound:
//! its size is the one that its format has, and another message follows. Data appended by a crash
//! dump is read as such. Memory does not grow with the log: a message is 64 KiB at most.

mod channel;
mod choice;
mod definitions;
mod format;
mod messages;
mod reader;
mod remarks;
mod survey;

pub use reader::UlogReader;

/// The first bytes of every log; a byte of version and the time of the start follow.
pub(super) const MAGIC: &[u8] = b"ULog\x01\x12\x35";
