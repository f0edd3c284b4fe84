//! `imu spline`: a curve through poses, its derivatives, and what an IMU on it reads.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, Subcommand};

use super::play::{Played, Targets, say_notes};
use super::progress;
use super::same_target;
use crate::error::Error;
use crate::output::Output;
use crate::recording::{Format, SampleKind};
use crate::report;
use crate::scene::{Rate, Scene, display_duration};
use crate::spline::{Fitted, FormName, Options, Route, Spacing, asked, file, sampled};

const EXAMPLES: &str = "\
Examples:
  imu spline fit poses.tum -o flight.spline --plots plots
      a curve through poses of TUM or EuRoC, and how far it is from them
  imu spline fit poses.tum -o flight.spline --within 5mm,0.1deg
      knots as far apart as that allows
  imu spline imu flight.spline --rate 1000 --samples increments -o flight.csv --truth flight.truth.csv
      what an ideal IMU along it reads; errors and noise: trajectory = \"poses.tum\" in a scene of imu simulate
  imu spline sample poses.tum --rate 100 -o flight.csv
      pose, velocity, acceleration and angular acceleration of the curve that `fit` would make";

const FORMS: &str = "\
A curve is a uniform cubic B-spline, position and attitude apart. Its form is that of the attitudes: `plain` is the
cumulative product of the literature, of order 3 in the time between knots; `symmetric` is the same seen from either
end, of order 4, at about twice the price. The same control points give two curves, so the form is a choice, and stands in
the file.";

/// A smooth curve through poses, its derivatives, and IMU data along it.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Spline {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Fit(Fit),
    Sample(Sample),
    Imu(Imu),
}

/// How a curve is made of poses; of no use where the file is a curve already.
#[derive(Args, Debug)]
struct How {
    /// Which curve of attitudes: plain or symmetric [default: plain]
    #[arg(long, value_name = "FORM")]
    form: Option<FormName>,
    /// Time between knots, such as 0.1s or 50ms: the nearest equal part of the whole is taken [default: as the poses]
    #[arg(long, value_name = "TIME", conflicts_with = "within", allow_negative_numbers = true)]
    spacing: Option<String>,
    /// Knots as far apart as they can be with no pose further than this from the curve, such as 5mm,0.1deg
    #[arg(long, value_name = "DISTANCE", allow_hyphen_values = true)]
    within: Option<String>,
    /// Smooth: half is left of what moves with so many Hz, a 65th of what moves twice as fast
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    smooth: Option<f64>,
}

impl How {
    fn options(&self) -> Result<Options, Error> {
        let spacing = match (&self.spacing, &self.within) {
            (Some(time), _) => asked::spacing(time)?,
            (None, Some(text)) => asked::within(text)?,
            (None, None) => Spacing::AsPoses,
        };
        let smoothing_s = self.smooth.map_or(Ok(0.0), asked::smoothing_s)?;
        Ok(Options { form: self.form, spacing, smoothing_s })
    }

    fn open(&self, path: &Path) -> Result<Route, Error> {
        let options = self.options()?;
        let _turning = progress::turning("fitting");
        Route::open(path, &options)
    }
}

/// Fit a curve to poses: how far it is from them, and what their jitter makes of it.
#[derive(Args, Debug)]
#[command(after_help = FORMS)]
struct Fit {
    /// Poses of TUM, EuRoC's ground truth, or imu simulate's truth; - for a pipe
    #[arg(value_name = "POSES")]
    poses: PathBuf,
    /// Where to write the curve
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    how: How,
    /// Write curve.svg and residual.svg (.png too) into this folder, over those there
    #[arg(long, value_name = "FOLDER")]
    plots: Option<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

/// Write a curve as a table: poses for TUM's readers (.tum), or with all derivatives (.csv).
///
/// Columns of the CSV: time, position, attitude (q_wb, w first), velocity, angular rate in body axes, acceleration in
/// the world's, angular acceleration in body axes.
#[derive(Args, Debug)]
#[command(after_help = FORMS)]
struct Sample {
    /// A curve of imu spline fit, or poses
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Instants a second, from the first of the curve on
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    rate: f64,
    /// Where to write: FILE.tum, FILE.csv, or - for CSV into a pipe
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    how: How,
}

/// Write what an ideal IMU along a curve reads.
///
/// The simulator with sensors that do not err; for those that do, and for a clock that does, write a scene with
/// trajectory = "poses.tum" (docs/scenes.md) and play it with imu simulate.
#[derive(Args, Debug)]
#[command(after_help = FORMS)]
struct Imu {
    /// A curve of imu spline fit, or poses
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Samples a second
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    rate: f64,
    /// Samples at an instant, means over the interval before, or increments over it: instantaneous, mean or
    /// increments
    #[arg(long, value_name = "KIND", default_value = "instantaneous")]
    samples: SampleKind,
    /// From the point whose poses these are to the IMU, in body axes, m: X,Y,Z
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    lever_arm: Option<String>,
    /// m/s^2, along the world's z axis downwards
    #[arg(long, value_name = "G", default_value_t = imu_core::trajectory::GRAVITY, allow_negative_numbers = true)]
    gravity: f64,
    /// Where to write: FILE.bag (ROS 1), FILE.mcap (ROS 2), FILE.csv, FOLDER/ (EuRoC), or - for a pipe
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Write this format whatever the name: bag, mcap, csv or euroc
    #[arg(long = "to", value_name = "FORMAT")]
    format: Option<Format>,
    /// Write pose, velocity, rate and force at each sample, as CSV
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    #[command(flatten)]
    how: How,
}

/// The pictures written into a folder.
const PICTURES: [&str; 4] = ["curve.svg", "curve.png", "residual.svg", "residual.png"];

impl Spline {
    pub(super) fn run(self) -> Result<(), Error> {
        match self.what {
            What::Fit(fit) => fit.run(),
            What::Sample(sample) => sample.run(),
            What::Imu(imu) => imu.run(),
        }
    }
}

impl Fit {
    fn run(self) -> Result<(), Error> {
        let options = self.how.options()?;
        self.check_targets()?;
        let turning = progress::turning("fitting");
        let fitted = Fitted::to(&self.poses, &options)?;
        turning.finish_and_clear();
        let mut files = vec![file::write(&self.output, &fitted.fit)?];
        if let Some(folder) = &self.plots {
            std::fs::create_dir_all(folder).map_err(|e| Error::io("make the folder", folder, e))?;
            let outline = &fitted.outline;
            let [curve, residual] =
                [report::plot::curve(outline), report::plot::curve_residual(outline)];
            let pictures = [
                curve.svg().into_bytes(),
                curve.png()?,
                residual.svg().into_bytes(),
                residual.png()?,
            ];
            for (name, bytes) in PICTURES.iter().zip(pictures) {
                let mut output = Output::create(&folder.join(name))?;
                output.write(&bytes)?;
                files.push(output);
            }
        }
        // All are complete before any takes its place.
        files.into_iter().try_for_each(Output::finish)?;
        if self.json {
            return super::print(&format!("{:#}\n", report::spline::json(&fitted)));
        }
        say_notes(&fitted.notes);
        let text = report::spline::text(&fitted);
        if self.output == Path::new("-") {
            super::say(text.trim_end());
            return Ok(());
        }
        super::print(&text)
    }

    /// That nothing is written twice, nor over the poses.
    fn check_targets(&self) -> Result<(), Error> {
        let pictures = self.plots.iter().flat_map(|to| PICTURES.map(|name| to.join(name)));
        if self.json && self.output == Path::new("-") {
            return Err(Error::usage(
                "the curve and --json cannot both go to the standard output: name a file",
            ));
        }
        if let Some(folder) = self.plots.as_deref().filter(|folder| *folder == Path::new("-")) {
            return Err(Error::usage(format!(
                "plots go into a folder, and {} is none: name one",
                folder.display()
            )));
        }
        if let Some(twice) = pictures.clone().find(|picture| same_target(picture, &self.output)) {
            return Err(Error::usage(format!(
                "the curve and a picture cannot both go to {}: name another file",
                twice.display()
            )));
        }
        pictures
            .chain([self.output.clone()])
            .try_for_each(|target| refuse_overwriting(&self.poses, &target))
    }
}

impl Sample {
    fn run(self) -> Result<(), Error> {
        let (rate, table) = (Rate::from_hz(self.rate)?, sampled::Table::of(&self.output)?);
        refuse_overwriting(&self.file, &self.output)?;
        let route = self.how.open(&self.file)?;
        say_notes(route.notes());
        let count = sampled::write(&route, rate, &self.output, table)?;
        let instants = if count == 1 { "instant" } else { "instants" };
        super::say(&format!(
            "imu: wrote {count} {instants} to {}",
            super::target_name(&self.output)
        ));
        Ok(())
    }
}

impl Imu {
    fn run(self) -> Result<(), Error> {
        let rate = Rate::from_hz(self.rate)?;
        let arm = self.lever_arm.as_deref().map_or(Ok([0.0; 3]), lever_arm)?;
        let targets = Targets {
            output: &self.output,
            format: self.format,
            truth: self.truth.as_deref(),
            terms: None,
            speed: 1.0,
        };
        targets.check(
            (self.file != Path::new("-")).then_some((self.file.as_path(), "the trajectory itself")),
        )?;
        let route = Arc::new(self.how.open(&self.file)?);
        if route.span_ns().0 < 0 {
            return Err(Error::data(format!(
                "{} begins {} s before 1970, from where recordings count: add seconds to its stamps",
                self.file.display(),
                route.span_ns().0.unsigned_abs() as f64 / 1e9
            )));
        }
        let mut scene = Scene { gravity: self.gravity, ..Scene::along(route, rate, self.samples) };
        if scene.duration_ns == 0 {
            return Err(Error::usage(format!(
                "no whole interval of {} Hz fits into the curve: take a higher --rate",
                self.rate
            )));
        }
        scene.gyroscope.lever_arm_m = arm;
        scene.accelerometer.lever_arm_m = arm;
        let Played { samples, .. } = targets.play(&scene)?;
        super::say(&format!(
            "imu: wrote {samples} samples of both sensors ({} at {} Hz: {}) to {}",
            display_duration(scene.duration_ns),
            rate.hz(),
            scene.samples.meaning(),
            super::target_name(&self.output),
        ));
        Ok(())
    }
}

fn refuse_overwriting(read: &Path, written: &Path) -> Result<(), Error> {
    if read != Path::new("-") && same_target(read, written) {
        return Err(Error::usage(format!(
            "{} is read, and would be written over: name another file to write",
            read.display()
        )));
    }
    Ok(())
}

/// Three numbers.
fn lever_arm(text: &str) -> Result<[f64; 3], Error> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
        Error::usage(format!("--lever-arm '{text}' is no X,Y,Z in metres, such as 0.1,0,-0.05"))
    })
}
