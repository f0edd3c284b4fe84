//! The flags that say how to read a recording, shared by every subcommand that reads one.

use std::path::PathBuf;

use clap::Args;

use crate::error::Error;
use crate::recording::{self, ForceUnit, Joined, RateUnit, ReadOptions, Source, TimeUnit};

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
    /// Columns of a CSV by name: t=stamp,gx=omega.x,… (also sec and nsec, or date and t; temp)
    #[arg(long, value_name = "KEY=NAME,…", conflicts_with = "columns")]
    map: Option<String>,
    /// Unit of angular rate: rad/s, mrad/s, deg/s, mdeg/s, deg/h (of increments: deg/s of deg)
    #[arg(long, value_name = "UNIT")]
    gyro_unit: Option<RateUnit>,
    /// Unit of specific force: m/s^2, g, mg (of increments: m/s^2 of m/s)
    #[arg(long, value_name = "UNIT")]
    accel_unit: Option<ForceUnit>,
    /// Unit of time in a CSV: s, ms, us, ns
    #[arg(long, value_name = "UNIT")]
    time_unit: Option<TimeUnit>,
}

/// A recording that was opened.
pub(super) struct Opened {
    /// What reads it.
    pub(super) source: Box<dyn Source>,
    /// The names of its files, in the order in which they are read.
    pub(super) names: Vec<String>,
}

impl Reading {
    /// Opens a file, or several as one recording.
    pub(super) fn open(&self, files: &[PathBuf]) -> Result<Opened, Error> {
        Self::open_with(files, &self.options())
    }

    /// Opens for somebody who wants to know what is there: several IMUs are no error.
    pub(super) fn survey(&self, files: &[PathBuf]) -> Result<Opened, Error> {
        Self::open_with(files, &ReadOptions { survey: true, ..self.options() })
    }

    fn open_with(files: &[PathBuf], options: &ReadOptions) -> Result<Opened, Error> {
        if let Some(topic) = &options.topic
            && topic.split(',').any(|one| one.trim().is_empty())
        {
            return Err(Error::usage(format!(
                "--topic '{topic}' lacks a name: give one, such as /imu, or two, such as /gyro,/accel"
            )));
        }
        if let [file] = files {
            let name = match file.to_str() {
                Some("-") => "the pipe".to_owned(),
                _ => file.display().to_string(),
            };
            return Ok(Opened { source: recording::open(file, options)?, names: vec![name] });
        }
        let joined = Joined::open(files, options)?;
        let names = joined.names().to_vec();
        Ok(Opened { source: Box::new(joined), names })
    }

    /// The flags as the library takes them.
    pub(super) fn options(&self) -> ReadOptions {
        ReadOptions {
            topic: self.topic.clone(),
            poses: None,
            survey: false,
            bag_time: self.bag_time,
            columns: self.columns.clone(),
            map: self.map.clone(),
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
