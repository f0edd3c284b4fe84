//! The flags that say how to read a recording, shared by every subcommand that reads one.

use clap::Args;

use crate::recording::{ForceUnit, RateUnit, ReadOptions, TimeUnit};

/// How to read a recording, where it does not say so itself.
#[derive(Args, Debug)]
#[command(next_help_heading = "Reading")]
pub(super) struct Reading {
    /// The topic where there are several (imu and /imu are the same), or GYRO,ACCEL
    #[arg(long, value_name = "TOPIC")]
    topic: Option<String>,
    /// Use the time at which the bag recorded a message, not the one in its header
    #[arg(long)]
    bag_time: bool,
    /// Columns of a CSV: t, gx, gy, gz, ax, ay, az and - for one to pass over
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    columns: Option<String>,
    /// Unit of angular rate: rad/s, mrad/s, deg/s, mdeg/s, deg/h
    #[arg(long, value_name = "UNIT")]
    gyro_unit: Option<RateUnit>,
    /// Unit of specific force: m/s^2, g, mg
    #[arg(long, value_name = "UNIT")]
    accel_unit: Option<ForceUnit>,
    /// Unit of time in a CSV: s, ms, us, ns
    #[arg(long, value_name = "UNIT")]
    time_unit: Option<TimeUnit>,
}

impl Reading {
    /// The flags as the library takes them.
    pub(super) fn options(&self) -> ReadOptions {
        ReadOptions {
            topic: self.topic.clone(),
            survey: false,
            bag_time: self.bag_time,
            columns: self.columns.clone(),
            gyro_unit: self.gyro_unit,
            accel_unit: self.accel_unit,
            time_unit: self.time_unit,
        }
    }

    /// Whether the unit of specific force was said, and is not to be guessed.
    pub(super) fn accel_unit_is_given(&self) -> bool {
        self.accel_unit.is_some()
    }
}
