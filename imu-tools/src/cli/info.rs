//! `imu info`: what a recording holds, and what is wrong with it.

use std::path::PathBuf;

use clap::Args;

use super::progress;
use super::reading::{Opened, Reading};
use crate::calibrate::{Options, examine};
use crate::error::Error;
use crate::report;

const EXAMPLES: &str = "\
Examples:
  imu info still.bag
      topics with types and counts; rate, jitter, gaps and clock of both sensors; ranges, steps,
      saturation, repeated samples; gravity; where it was handled; what is wrong with it
  imu info log.mcap --topic /imu/data --json";

/// Say what a recording holds and what is wrong with it.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Info {
    /// The recording, or several that belong together, or - for a pipe
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

impl Info {
    pub(super) fn run(self) -> Result<(), Error> {
        let Opened { source, names } = self.reading.survey(&self.files)?;
        let bar = progress::bytes(source.bytes_total(), "reading");
        let options =
            Options { unit_is_given: self.reading.accel_unit_is_given(), ..Options::default() };
        let mut examined =
            examine(source, &names.join(", "), &options, |at| bar.set_position(at.bytes))?;
        examined.calibration.paths = names;
        bar.finish_and_clear();
        if self.json {
            return super::print(&format!("{:#}\n", report::info::json(&examined)));
        }
        super::print(&report::info::text(&examined))
    }
}
