//! `imu integrate`: dead reckoning of a recording, by one rule or all of them, against the truth.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use imu_core::nalgebra::Vector3;
use imu_core::sample::Bias;

use super::reading::{Opened, Reading};
use super::{progress, same_target};
use crate::error::Error;
use crate::integrate::{
    Against, Integration, Kind, KnownBias, Method, Options, Start, file_names, integrate,
};
use crate::output::Output;
use crate::recording::poses;
use crate::report;

const EXAMPLES: &str = "\
Examples:
  imu integrate drive.bag --samples instantaneous --start rest
      from rest at the start: where each rule ends
  imu integrate ellipse.csv --samples instantaneous --truth truth.csv -o out
      errors of all rules; trajectory_RULE.csv and .tum, trajectory.svg and error.svg in out
  imu integrate vicon.bag --samples mean --truth-topic /vicon/imu/imu
      poses in a topic of the recording itself, which are those of the IMU
  imu integrate V1_01_easy --samples mean --rule previous-increment --bias truth
      a folder of EuRoC, whose ground truth is found beside it, less the bias that it knows
  imu integrate log.csv --samples mean --latitude 47.4 --height 410
      on the turning Earth, east, north and up

What a sample is matters more than the rule: the driver or the datasheet says it. A register that holds
the latest conversion is instantaneous (as are simulated samples, unless the scene says otherwise); the
output of an averaging or decimating stage, and increments of angle and velocity, are means.";

/// Integrate a recording: dead reckoning by any rule, and its error against the truth.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Integrate {
    /// The recording, or - for a pipe
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// What a sample is: of the instant of its stamp, or the mean over the interval that ends there
    /// (increments too, divided by their time); it has to be said
    #[arg(long, value_enum, value_name = "KIND")]
    samples: Option<KindName>,
    /// all that fit the samples, or some of: euler, midpoint, coning-sculling, three-sample,
    /// textbook-euler, textbook-midpoint (instantaneous); previous-increment, two-increments (mean)
    #[arg(long, value_name = "RULE,...", default_value = "all")]
    rule: String,
    /// The truth: TUM's format, EuRoC's ground truth, or what imu simulate --truth writes [default:
    /// NAME.truth.csv or NAME.truth.tum beside the recording, or EuRoC's folder]
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// The truth: poses in this topic of the recording, PoseStamped, PoseWithCovarianceStamped,
    /// TransformStamped or Odometry [default: the only one, where no file lies beside the recording]
    #[arg(long, value_name = "TOPIC", conflicts_with = "truth")]
    truth_topic: Option<String>,
    /// Compare with nothing, although a truth lies beside the recording or in it
    #[arg(long, conflicts_with_all = ["truth", "truth_topic"])]
    no_truth: bool,
    /// Where the first state comes from [default: truth where there is one, else rest]
    #[arg(long, value_enum, value_name = "STATE")]
    start: Option<StartName>,
    /// How long it stands still at the start, for --start rest
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0, allow_negative_numbers = true)]
    rest: f64,
    /// m/s^2 [default: as measured at rest, else 9.81]
    #[arg(long, value_name = "G", allow_negative_numbers = true)]
    gravity: Option<f64>,
    /// On the turning Earth: degrees, north positive
    #[arg(long, value_name = "DEG", conflicts_with = "gravity", allow_negative_numbers = true)]
    latitude: Option<f64>,
    /// Metres above the ellipsoid, with --latitude
    #[arg(long, value_name = "M", requires = "latitude", allow_negative_numbers = true)]
    height: Option<f64>,
    /// What to take off: GX,GY,GZ,AX,AY,AZ in rad/s and m/s^2, or truth for what the truth knows at the
    /// start [default: at rest the mean rate, else nothing]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    bias: Option<String>,
    /// Start this many seconds after the first sample
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    from: Option<f64>,
    /// End this many seconds after the first sample
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    to: Option<f64>,
    /// Write trajectories and plots into this folder, over those there
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

/// The pictures written into a folder.
const PICTURES: [&str; 4] = ["trajectory.svg", "trajectory.png", "error.svg", "error.png"];

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum KindName {
    /// Rate and force at the instant of the stamp
    Instantaneous,
    /// Means over the interval that ends at the stamp, or increments
    Mean,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum StartName {
    /// The state that the truth tells
    Truth,
    /// Level, still, the mean rate taken for the bias; position and heading of the truth, if there is one
    Rest,
}

impl Integrate {
    pub(super) fn run(self) -> Result<(), Error> {
        let options = self.options()?;
        let file = match (&self.truth, &self.truth_topic) {
            (Some(file), _) => Some(file.clone()),
            (None, None) if !self.no_truth => poses::beside(&self.file),
            _ => None,
        };
        self.check_output(&options, file.as_deref())?;
        let Opened { source, names } = self.reading.open(std::slice::from_ref(&self.file))?;
        let against = match (&file, &self.truth_topic) {
            (Some(file), _) => Against::file(file)?,
            (None, topic) if !self.no_truth => {
                Against::topic(&self.file, topic.as_deref(), &self.reading.options())?
            }
            _ => Against::Nothing,
        };
        if let Some(folder) = &options.folder {
            std::fs::create_dir_all(folder).map_err(|e| Error::io("make the folder", folder, e))?;
        }
        let bar = progress::bytes(source.bytes_total(), "integrating");
        let (integration, files) =
            integrate(source, &names.join(", "), against, &options, |at| bar.set_position(at))?;
        bar.finish_and_clear();
        if let Some(folder) = &options.folder {
            write_into(folder, &integration, files)?;
        }
        if self.json {
            return super::print(&format!("{:#}\n", report::integration::json(&integration)));
        }
        for remark in &integration.remarks {
            super::say(&format!("imu: {remark}"));
        }
        for warning in &integration.warnings {
            super::say(&format!("imu: warning: {warning}"));
        }
        super::print(&report::integration::text(&integration))
    }

    fn options(&self) -> Result<Options, Error> {
        let kind = match self.samples {
            Some(KindName::Instantaneous) => Kind::Instantaneous,
            Some(KindName::Mean) => Kind::Mean,
            None => {
                return Err(Error::usage(
                    "say what a sample is, which matters more than the rule: --samples instantaneous (rate and \
                     force at the stamp, as the registers of most chips) or --samples mean (averages over the \
                     interval that ends at the stamp, or increments); the driver or the datasheet tells",
                ));
            }
        };
        for (flag, value) in [("--from", self.from), ("--to", self.to), ("--rest", Some(self.rest))]
        {
            if value.is_some_and(|s| !s.is_finite() || s < 0.0) {
                return Err(Error::usage(format!("{flag} wants seconds, 0 or more")));
            }
        }
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from >= to
        {
            return Err(Error::usage(format!("--from {from} is not before --to {to}")));
        }
        if self.gravity.is_some_and(|g| !(0.0..=1e3).contains(&g)) {
            return Err(Error::usage("--gravity wants m/s^2 from 0 to 1000, such as 9.81"));
        }
        if self.latitude.is_some_and(|degrees| !(-90.0..=90.0).contains(&degrees)) {
            return Err(Error::usage("--latitude wants degrees from -90 to 90"));
        }
        if self.height.is_some_and(|metres| !(-1e5..=1e5).contains(&metres)) {
            return Err(Error::usage("--height wants metres within 100 km"));
        }
        Ok(Options {
            methods: methods(&self.rule, kind)?,
            start: self.start.map(|start| match start {
                StartName::Truth => Start::Truth,
                StartName::Rest => Start::Rest,
            }),
            rest_s: self.rest,
            gravity: self.gravity,
            place: self.latitude.map(|degrees| (degrees.to_radians(), self.height.unwrap_or(0.0))),
            bias: self.bias.as_deref().map(bias).transpose()?,
            from_s: self.from,
            to_s: self.to,
            unit_is_given: self.reading.accel_unit_is_given(),
            folder: self.output.clone(),
            ..Options::new(kind)
        })
    }

    /// Several files do not go into a pipe, nor over what is read.
    fn check_output(&self, options: &Options, truth: Option<&Path>) -> Result<(), Error> {
        let Some(folder) = &options.folder else { return Ok(()) };
        if folder == Path::new("-") {
            return Err(Error::usage(
                "trajectories and plots go into a folder, and - is none: name one, or leave -o out",
            ));
        }
        let trajectories = options.methods.iter().flat_map(|method| file_names(*method));
        let targets: Vec<PathBuf> =
            trajectories.chain(PICTURES.map(str::to_owned)).map(|name| folder.join(name)).collect();
        let mut read = [Some(self.file.as_path()), truth].into_iter().flatten();
        match read.find(|file| targets.iter().any(|to| same_target(file, to))) {
            Some(file) => Err(Error::usage(format!(
                "{} is read, and would be written over: write into another folder",
                file.display()
            ))),
            None => Ok(()),
        }
    }
}

/// The rules by their names: `all`, or some that take such samples.
fn methods(names: &str, kind: Kind) -> Result<Vec<Method>, Error> {
    if names == "all" {
        return Ok(kind.methods().collect());
    }
    let mut methods = Vec::new();
    for name in names.split(',').map(str::trim) {
        let method: Method = name
            .parse()
            .map_err(|known| Error::usage(format!("there is no rule '{name}': {known}")))?;
        if method.kind() != kind {
            let fitting: Vec<&str> = kind.methods().map(Method::name).collect();
            return Err(Error::usage(format!(
                "the rule {method} takes {} samples, and these are said to be {kind}: take {}, or all",
                method.kind(),
                fitting.join(", ")
            )));
        }
        if !methods.contains(&method) {
            methods.push(method);
        }
    }
    Ok(methods)
}

/// Six numbers, or the word.
fn bias(text: &str) -> Result<KnownBias, Error> {
    if text == "truth" {
        return Ok(KnownBias::Truth);
    }
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let bias = numbers.and_then(|numbers| {
        let [gx, gy, gz, ax, ay, az] = *numbers.as_slice() else { return None };
        Bias::new(Vector3::new(gx, gy, gz), Vector3::new(ax, ay, az)).ok()
    });
    bias.map(KnownBias::Given).ok_or_else(|| {
        Error::usage(format!(
            "--bias '{text}' is neither truth nor six numbers GX,GY,GZ,AX,AY,AZ in rad/s and m/s^2"
        ))
    })
}

/// Writes the plots, and puts them and the trajectories in their places.
fn write_into(
    folder: &Path,
    integration: &Integration,
    mut files: Vec<Output>,
) -> Result<(), Error> {
    let (trajectory, errors) =
        (report::plot::trajectory(integration), report::plot::errors(integration));
    let mut contents = vec![trajectory.svg().into_bytes(), trajectory.png()?];
    if !errors.is_empty() {
        contents.extend([errors.svg().into_bytes(), errors.png()?]);
    }
    for (name, bytes) in PICTURES.iter().zip(contents) {
        let mut output = Output::create(&folder.join(name))?;
        output.write(&bytes)?;
        files.push(output);
    }
    // All are complete before any takes its place.
    files.into_iter().try_for_each(Output::finish)
}
