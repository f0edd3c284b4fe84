//! Messages of ROS 2, whatever they are stored in: an MCAP file or the tables of a rosbag2.
//!
//! `cdr` is the wire form, `imu_message` the message `sensor_msgs/msg/Imu`, `taken` what becomes of
//! messages on their way into a [`Block`](super::Block).

pub mod cdr;
mod imu_message;
mod taken;

pub use imu_message::{DEFINITION, ImuMessage, Template};
pub use taken::{Recorded, Taken, holds};

/// Name of the IMU's type.
pub const IMU: &str = "sensor_msgs/msg/Imu";

/// Name of a thermometer's type.
pub const TEMPERATURE: &str = "sensor_msgs/msg/Temperature";
