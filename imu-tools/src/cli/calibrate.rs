//! `imu calibrate`: a recording into the noise parameters of its IMU.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use imu_core::allan::Terms;

use super::reading::{Opened, Reading};
use super::{progress, same_target};
use crate::calibrate::{Calibration, Estimator, FittedTerms, Options, calibrate};
use crate::error::Error;
use crate::output::Output;
use crate::report::{self, formats::Form};

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
    /// Write report.html, allan.svg, allan.png, imu.yaml and allan.csv into this folder, over those there
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
    /// Start this many seconds after the first sample (of each record, where files are pooled)
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    from: Option<f64>,
    /// End this many seconds after the first sample (of each record, where files are pooled)
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    to: Option<f64>,
    /// Leave nothing out: neither handling and bumps nor the warm-up
    #[arg(long)]
    keep_all: bool,
    /// How to estimate N and K
    #[arg(long, value_enum, default_value_t = EstimatorName::Octaves)]
    estimator: EstimatorName,
    /// What to fit: auto (N and K, and of Q, B and R what the recording asks for), or the letters of all
    /// terms, nk among them: nk, nbk, qnk, nkr ... qnbkr (Q quantisation, N white noise, B bias
    /// instability, K random walk, R ramp)
    #[arg(long, value_name = "TERMS", default_value = "auto", value_parser = fitted_terms)]
    terms: FittedTerms,
    /// Form of imu.yaml, or without -o of what is printed
    #[arg(long, value_enum, value_name = "NAME", conflicts_with = "json")]
    format: Option<FormatName>,
    #[command(flatten)]
    reading: Reading,
}

/// The files written into a folder.
const RESULTS: [&str; 5] = ["imu.yaml", "allan.csv", "allan.svg", "allan.png", "report.html"];

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FormatName {
    /// Kalibr's imu.yaml
    Kalibr,
    /// What imu_utils writes
    #[value(name = "imu_utils")]
    ImuUtils,
    /// VINS-Mono and VINS-Fusion
    Vins,
    /// OpenVINS' kalibr_imu_chain.yaml
    Openvins,
    /// ORB-SLAM3's settings
    Orbslam3,
    /// Covariances of sensor_msgs/Imu
    RosCovariance,
}

impl FormatName {
    fn form(self) -> Form {
        match self {
            Self::Kalibr => Form::Kalibr,
            Self::ImuUtils => Form::ImuUtils,
            Self::Vins => Form::Vins,
            Self::Openvins => Form::OpenVins,
            Self::Orbslam3 => Form::OrbSlam3,
            Self::RosCovariance => Form::RosCovariance,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EstimatorName {
    /// Likelihood of the octaves of τ
    Octaves,
    /// Exact maximum likelihood on block means
    Ml,
    /// The classic reading of slopes -1/2 and +1/2, as kalibr_allan does: to compare
    Slope,
}

/// `auto`, or a letter for each term.
fn fitted_terms(text: &str) -> Result<FittedTerms, String> {
    if text == "auto" {
        return Ok(FittedTerms::Asked);
    }
    let has = |letter: char| text.chars().filter(|c| c.eq_ignore_ascii_case(&letter)).count() == 1;
    let [quantisation, white, bias_instability, walk, rate_ramp] =
        ['q', 'n', 'b', 'k', 'r'].map(has);
    let named = [quantisation, white, bias_instability, walk, rate_ramp];
    let letters = named.into_iter().filter(|named| *named).count();
    if !white || !walk || letters != text.chars().count() {
        return Err(
            "auto, or each of the letters q n b k r once at most, with n and k among them \
                    (nk, nbk, qnbkr, ...)"
                .into(),
        );
    }
    Ok(FittedTerms::Given(Terms { quantisation, bias_instability, rate_ramp }))
}

impl Calibrate {
    pub(super) fn run(self) -> Result<(), Error> {
        let options = self.options()?;
        self.check_output()?;
        let Opened { source, names } = self.reading.open(&self.files)?;
        let bar = progress::bytes(source.bytes_total(), "reading");
        let all = names.join(", ");
        let mut calibration = calibrate(source, &all, &options, |at| bar.set_position(at.bytes))?;
        calibration.paths = names;
        bar.finish_and_clear();
        if let Some(folder) = &self.output {
            write_into(folder, &calibration, self.format.map_or(Form::Kalibr, FormatName::form))?;
        }
        if self.json {
            return super::print(&format!("{:#}\n", report::json::calibration(&calibration)));
        }
        for remark in &calibration.remarks {
            super::say(&format!("imu: {remark}"));
        }
        for warning in &calibration.warnings {
            super::say(&format!("imu: warning: {warning}"));
        }
        match self.format.filter(|_| self.output.is_none()) {
            Some(format) => super::print(&format.form().write(&calibration)),
            None => super::print(&report::table::calibration(&calibration)),
        }
    }

    /// Two files do not go into a pipe, nor over a recording.
    fn check_output(&self) -> Result<(), Error> {
        let Some(folder) = &self.output else { return Ok(()) };
        if folder == Path::new("-") {
            return Err(Error::usage(
                "the results go into a folder, and - is none: name one, or leave -o out",
            ));
        }
        let targets = RESULTS.map(|name| folder.join(name));
        let mut files = self.files.iter().filter(|file| *file != Path::new("-"));
        match files.find(|file| targets.iter().any(|to| same_target(file, to))) {
            Some(file) => Err(Error::usage(format!(
                "{} is the recording itself: write into another folder",
                file.display()
            ))),
            None => Ok(()),
        }
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
        let two = FittedTerms::Given(Terms::default());
        if self.estimator != EstimatorName::Octaves
            && self.terms != FittedTerms::Asked
            && self.terms != two
        {
            return Err(Error::usage(
                "--terms is for --estimator octaves: the others know N and K only",
            ));
        }
        Ok(Options {
            terms: self.terms,
            from_s: self.from,
            to_s: self.to,
            unit_is_given: self.reading.accel_unit_is_given(),
            keep_all: self.keep_all,
            keep_signal: self.output.is_some(),
            estimator: match self.estimator {
                EstimatorName::Octaves => Estimator::Octaves,
                EstimatorName::Ml => Estimator::MaximumLikelihood,
                EstimatorName::Slope => Estimator::Slope,
            },
        })
    }
}

/// Writes the report, its plots, `imu.yaml` and `allan.csv`, all or none of them, into a folder that is
/// made if need be.
pub(super) fn write_into(
    folder: &Path,
    calibration: &Calibration,
    form: Form,
) -> Result<(), Error> {
    std::fs::create_dir_all(folder).map_err(|e| Error::io("make the folder", folder, e))?;
    let allan = report::plot::allan(calibration);
    let contents = [
        form.write(calibration).into_bytes(),
        report::csv::deviations(calibration).into_bytes(),
        allan.svg().into_bytes(),
        allan.png()?,
        report::html::page(calibration).into_bytes(),
    ];
    let mut written = Vec::new();
    for (name, bytes) in RESULTS.iter().zip(contents) {
        let mut output = Output::create(&folder.join(name))?;
        output.write(&bytes)?;
        written.push(output);
    }
    // All are complete before any takes its place.
    written.into_iter().try_for_each(Output::finish)
}
