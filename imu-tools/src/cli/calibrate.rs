//! `imu calibrate`: a recording into the noise parameters of its IMU.

use std::path::PathBuf;

use clap::Args;

use super::progress;
use super::reading::{Opened, Reading};
use super::results::Results;
use crate::calibrate::{Options, calibrate};
use crate::error::Error;
use crate::report;

const EXAMPLES: &str = "\
Examples:
  imu calibrate still.bag
      a table: angle and velocity random walk N, random walk of the bias K, intervals, units
  imu calibrate still.bag -o out
      also out/report.html, plots (allan.svg, allan.png), imu.yaml (Kalibr's keys) and allan.csv
  imu calibrate still.bag --format vins
      the lines for VINS-Mono's configuration in the place of the table
  imu calibrate log.csv --columns t,ax,ay,az,gx,gy,gz --gyro-unit deg/s --accel-unit g --json
  imu calibrate still.bag --from 120 --to 14000
      without the time when a hand was still on the sensor
  imu calibrate night_*.bag
      several files: one recording in pieces, or several nights of one sensor
  imu simulate high --duration 1h -o - | imu calibrate -

Record the sensor at rest, warmed up, on something solid: a minute shows N, hours show K.";

/// Estimate an IMU's noise from a recording of it at rest.
///
/// Reads bags of ROS 1 and 2, PX4's logs, tables in text, arrays of NumPy and EuRoC's folders, packed
/// by gzip or Zstandard too, finds the IMU in them, and fits white noise N and random walk K to the
/// Allan variance of every axis.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Calibrate {
    /// The recording, or - for a pipe; several files are joined where one goes on where another
    /// ends, and pooled where they are of other days or sensors
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
    /// Start this many seconds after the first sample (of each record, where files are pooled)
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    from: Option<f64>,
    /// End this many seconds after the first sample (of each record, where files are pooled)
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    to: Option<f64>,
    #[command(flatten)]
    results: Results,
    #[command(flatten)]
    reading: Reading,
}

impl Calibrate {
    pub(super) fn run(self) -> Result<(), Error> {
        let options = self.options()?;
        self.results.check(&self.files)?;
        let Opened { source, names } = self.reading.open(&self.files)?;
        let bar = progress::bytes(source.bytes_total(), "reading");
        let all = names.join(", ");
        let mut calibration = calibrate(source, &all, &options, |at| bar.set_position(at.bytes))?;
        calibration.paths = names;
        bar.finish_and_clear();
        self.results.write(&calibration)?;
        if self.json {
            return super::print(&format!("{:#}\n", report::json::calibration(&calibration)));
        }
        self.results.say(&calibration)
    }

    fn options(&self) -> Result<Options, Error> {
        for (flag, value) in [("--from", self.from), ("--to", self.to)] {
            if value.is_some_and(|s| !s.is_finite() || s < 0.0) {
                return Err(Error::usage(format!(
                    "{flag} wants seconds after the first sample, 0 or more"
                )));
            }
        }
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from >= to
        {
            return Err(Error::usage(format!("--from {from} is not before --to {to}")));
        }
        Ok(Options {
            from_s: self.from,
            to_s: self.to,
            unit_is_given: self.reading.accel_unit_is_given(),
            ..self.results.options()?
        })
    }
}
