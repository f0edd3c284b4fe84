//! `imu convert`: recordings into one recording of another format.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::reading::{Opened, Reading};
use super::{play, progress};
use crate::error::Error;
use crate::output;
use crate::recording::euroc::data_file;
use crate::recording::{self, Contents, Converted, Format, convert};
use crate::scene::display_duration;

const EXAMPLES: &str = "\
Examples:
  imu convert drive.bag drive.csv
      the samples of the IMU as a table: stamps in ns, digits that read back as the same numbers
  imu convert broken.bag whole.bag
      what can be read of a bag that was cut off or damaged, in a bag that any program reads
  imu convert night_0.bag night_1.bag night.bag
      a recording in pieces as one
  imu convert log.csv imu.bag --columns t,ax,ay,az,gx,gy,gz --gyro-unit deg/s --accel-unit g
      a table of any program as a bag
  ssh robot cat drive.bag | imu convert - - | head
      from a pipe into a pipe; --to bag writes a bag into it";

/// Convert recordings into one of another format.
///
/// Reads what `imu calibrate` reads, and writes what the name of the last file says. Stamps keep
/// their nanoseconds, numbers all their digits, in SI units; what the new file cannot hold is said.
#[derive(Args, Debug)]
#[command(override_usage = "imu convert [OPTIONS] <FILE>... <NEW>", after_help = EXAMPLES)]
pub(super) struct Convert {
    /// The recordings (- for a pipe), and last the new file: .bag, .mcap, .csv, a folder/ for EuRoC, or - for a pipe
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Write this format whatever the name: bag, mcap, csv or euroc (a pipe gets csv unless you say so)
    #[arg(long = "to", value_name = "FORMAT")]
    format: Option<Format>,
    /// Write over a file that is there
    #[arg(long)]
    force: bool,
    /// Print one JSON object instead of a sentence
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

impl Convert {
    pub(super) fn run(self) -> Result<(), Error> {
        let Some((to, from)) = self.files.split_last().filter(|(_, from)| !from.is_empty()) else {
            return Err(Error::usage("name the recording, and after it the file to write"));
        };
        let to_pipe = to == Path::new("-");
        if self.json && to_pipe {
            return Err(Error::usage(
                "the recording and --json cannot both go to the standard output: name a file",
            ));
        }
        // A name that says no format is found out before anything is read.
        let format = self.format.map_or_else(|| Format::of(to), Ok)?;
        let written = match format {
            Format::Euroc => data_file(to),
            _ => to.clone(),
        };
        for file in from {
            if same_file(file, &written) {
                return Err(Error::usage(format!(
                    "{} is the recording itself: name another file to write",
                    to.display()
                )));
            }
        }
        // `imu convert night_*.bag`, the new name forgotten, must not cost a recording.
        if !self.force && written.is_file() {
            return Err(Error::usage(format!(
                "the last name is the file to write, and {} is there already: name a new one, or \
                 say --force",
                written.display()
            )));
        }
        let Opened { source, names } = self.reading.open(from)?;
        let contents =
            Contents { samples: source.samples().unwrap_or_default(), temperature: false };
        let sink = recording::create_with(to, format, contents)?;
        let bar = progress::bytes(source.bytes_total(), "converting");
        let mut converted =
            convert(source, &names.join(", "), sink, |bytes| bar.set_position(bytes))?;
        bar.finish_and_clear();
        converted.left_out.extend(play::unsaid(format, contents));
        if format == Format::Bag && (to_pipe || !to.is_file()) {
            converted.left_out.push(
                "a bag in a pipe does not say where its index is: `rosbag reindex` mends that where \
                 a program asks for it"
                    .into(),
            );
        }
        if self.json {
            return super::print(&format!("{:#}\n", summary(&converted, &names, to, format)));
        }
        for remark in &converted.remarks {
            super::say(&format!("imu: {remark}"));
        }
        for warning in &converted.warnings {
            super::say(&format!("imu: warning: {warning}"));
        }
        for sentence in &converted.left_out {
            super::say(&format!("imu: {sentence}"));
        }
        if to_pipe { Ok(()) } else { super::print(&sentence(&converted, to)) }
    }
}

/// What was written, for a person.
fn sentence(converted: &Converted, to: &Path) -> String {
    let samples = match (converted.gyroscope, converted.accelerometer) {
        (rates, forces) if rates == forces => format!("{rates} samples of both sensors"),
        (rates, 0) => format!("{rates} samples of the gyroscope"),
        (0, forces) => format!("{forces} samples of the accelerometer"),
        (rates, forces) => {
            format!("{rates} samples of the gyroscope, {forces} of the accelerometer")
        }
    };
    let span = converted.span_ns.map_or(0, |(first, last)| last.abs_diff(first));
    format!("wrote {samples} ({}) to {}\n", display_duration(span), to.display())
}

/// The same for a program.
fn summary(
    converted: &Converted,
    names: &[String],
    to: &Path,
    format: Format,
) -> serde_json::Value {
    json!({
        "from": names,
        "to": to.display().to_string(),
        "format": format.name(),
        "gyroscope": { "samples": converted.gyroscope },
        "accelerometer": { "samples": converted.accelerometer },
        "first_stamp_ns": converted.span_ns.map(|(first, _)| first),
        "last_stamp_ns": converted.span_ns.map(|(_, last)| last),
        "remarks": converted.remarks,
        "warnings": converted.warnings,
        "left_out": converted.left_out,
    })
}

/// Whether a recording and the file to write are one, through links or by two names of one file.
fn same_file(from: &Path, to: &Path) -> bool {
    if from == Path::new("-") || to == Path::new("-") {
        return false;
    }
    let (source, target) = (output::target(from), output::target(to));
    // A folder is a recording too, and the file to write may be the one that it holds.
    source == target || to.is_file() && target.starts_with(&source) || hard_linked(from, to)
}

/// Whether both names are there and lead to one regular file.
#[cfg(unix)]
fn hard_linked(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let file = |path: &Path| std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file);
    file(a).zip(file(b)).is_some_and(|(a, b)| (a.dev(), a.ino()) == (b.dev(), b.ino()))
}

/// Without inodes nobody knows.
#[cfg(not(unix))]
fn hard_linked(_: &Path, _: &Path) -> bool {
    false
}
