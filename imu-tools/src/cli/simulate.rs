//! `imu simulate`: a preset or a scene file into a recording, the truth beside it.

use std::path::{Path, PathBuf};

use clap::Args;

use super::play::{Played, Targets};
use crate::error::Error;
use crate::recording::{Format, SampleKind};
use crate::scene::{
    Instead, Path as Motion, Preset, Rate, Scene, display_duration, parse_duration,
};

const EXAMPLES: &str = "\
Examples:
  imu simulate low -o still.bag
      four hours at 200 Hz at rest, the lowest of three noise levels
  imu simulate mid --moving --duration 60s --seed 7 -o ellipse.csv --truth truth.csv
      a minute on the classic ellipse, and what was true at each sample
  imu simulate high --lowpass 42 --duration 10min -o - | imu calibrate -
      into a pipe, as CSV
  imu simulate scene.toml -o imu.csv --samples increments --truth-terms terms.csv
      increments of angle and velocity, and what each error adds to them
  imu simulate low --duration 1h --rate 1000 -o pty:vectornav:/tmp/imu
      as a sensor would send it: imu live /tmp/imu reads it
  imu simulate flight.toml -o flight.bag --truth flight.truth.csv
      along your own trajectory, if the scene has a line trajectory = \"poses.tum\" (TUM or EuRoC)
  imu simulate scene.toml -o imu.bag
      your own errors, for each sensor and axis, of the clock and the link (docs/scenes.md):
          rate_hz = 400
          duration = \"1h\"
          [gyroscope]                       # rad/s
          noise_density = 0.001             # N, rad/s/√Hz, for all axes
          random_walk = [1e-5, 1e-5, 0]     # K, rad/s²/√Hz, for x, y, z
          constant_bias = 0.01
          lowpass_hz = 92
          [accelerometer]                   # m/s²
          noise_density = 0.002";

/// Simulate an IMU with known noise.
///
/// Presets (N and K of gyroscope and accelerometer, continuous time, SI):
/// low 0.01, 1e-5 and 0.01, 1e-4; mid 0.015, 5e-5 and 0.019, 5e-4; high 0.03, 1e-4 and 0.03, 1e-3.
/// Same scene and seed, same bytes on every machine: the first stamp is a constant, 1600000000 s,
/// unless the scene says otherwise. A file that is there is written over.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Simulate {
    /// low, mid or high, or a TOML scene file
    #[arg(value_name = "SCENE", default_value = "mid")]
    scene: String,
    /// Where to write: FILE.bag (ROS 1), FILE.mcap (ROS 2), FILE.csv, FOLDER/ (EuRoC), - for a pipe, or
    /// pty:PROTOCOL[:LINK], a terminal that speaks as a sensor does, in real time (docs/live-protocols.md)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Write this format whatever the name: bag, mcap, csv or euroc (a pipe gets csv unless you say so)
    #[arg(long = "to", value_name = "FORMAT")]
    format: Option<Format>,
    /// Move on the classic ellipse instead of standing still
    #[arg(long)]
    moving: bool,
    /// How long: 4h, 1h30m, 90s [default: the scene's, 4h, all of a trajectory]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    duration: Option<String>,
    /// Samples a second [default: the scene's, 200]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    rate: Option<f64>,
    /// Seed of the random numbers [default: the scene's, 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Limit the bandwidth of both sensors by a one-pole low-pass at this frequency
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    lowpass: Option<f64>,
    /// Samples at an instant, means over the interval before, or increments over it: instantaneous,
    /// mean or increments [default: the scene's, instantaneous]
    #[arg(long, value_name = "KIND")]
    samples: Option<SampleKind>,
    /// With pty: so many times as fast as real time; max or 0: as fast as it is read
    #[arg(long, value_name = "N", default_value = "1", value_parser = super::live::speed)]
    speed: f64,
    /// Write pose, velocity, true rate and force, and the bias carried, as CSV
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Write what each error adds to each sample and axis, as CSV
    #[arg(long, value_name = "FILE")]
    truth_terms: Option<PathBuf>,
}

impl Simulate {
    pub(super) fn run(self) -> Result<(), Error> {
        let scene = self.scene()?;
        let targets = Targets {
            output: &self.output,
            format: self.format,
            truth: self.truth.as_deref(),
            terms: self.truth_terms.as_deref(),
            speed: self.speed,
        };
        let is_file = Preset::from_name(&self.scene).is_none();
        let route = match &scene.motion {
            Motion::Along(route) => route.file(),
            Motion::Rest | Motion::Ellipse => None,
        };
        let scene_file = is_file.then_some((Path::new(&self.scene), "the scene itself"));
        let poses = route.map(|poses| (poses, "the trajectory of the scene"));
        targets.check(scene_file.into_iter().chain(poses))?;
        let played = targets.play(&scene)?;
        super::say(&format!("imu: wrote {}", self.summary(&scene, &played)));
        Ok(())
    }

    /// The scene asked for, with the flags over it.
    fn scene(&self) -> Result<Scene, Error> {
        let instead = Instead {
            rate: self.rate.map(Rate::from_hz).transpose()?,
            samples: self.samples,
            duration_ns: self.duration.as_deref().map(parse_duration).transpose()?,
        };
        let mut scene = match Preset::from_name(&self.scene) {
            Some(preset) => preset.scene().with(&instead),
            None => read(Path::new(&self.scene), &instead)?,
        };
        if self.moving {
            if let Motion::Along(_) = scene.motion {
                return Err(Error::usage(
                    "the scene has a trajectory of its own: leave --moving out",
                ));
            }
            scene.motion = Motion::Ellipse;
        }
        if let Some(seed) = self.seed {
            scene.seed = seed;
        }
        if let Some(hz) = self.lowpass {
            scene.gyroscope.lowpass_hz = Some(hz);
            scene.accelerometer.lowpass_hz = Some(hz);
        }
        Ok(scene)
    }

    fn summary(&self, scene: &Scene, &Played { samples, lost }: &Played) -> String {
        let to = super::target_name(&self.output);
        let beside = [(&self.truth, "truth"), (&self.truth_terms, "terms")];
        let beside: String = beside
            .into_iter()
            .filter_map(|(path, what)| {
                Some(format!(", and the {what} to {}", path.as_ref()?.display()))
            })
            .collect();
        let without = match lost {
            0 => String::new(),
            lost => format!(", {lost} more were lost"),
        };
        format!(
            "{samples} {} of both sensors ({} at {} Hz, seed {}{without}) to {to}{beside}",
            if samples == 1 { "sample" } else { "samples" },
            display_duration(scene.duration_ns),
            scene.rate.hz(),
            scene.seed,
        )
    }
}

/// Reads a scene file; a word that is neither a file nor a preset is a mistake on the command line.
fn read(path: &Path, instead: &Instead) -> Result<Scene, Error> {
    let is_word = path.extension().is_none() && path.components().count() == 1;
    if is_word && !path.exists() {
        return Err(Error::usage(format!(
            "there is no preset '{}': take low, mid or high, or name a scene file such as \
             scene.toml",
            path.display()
        )));
    }
    let bytes = std::fs::read(path).map_err(|e| Error::io("read", path, e))?;
    let text = String::from_utf8(bytes).map_err(|_| {
        Error::data(format!("{} is no scene file: it is not text in UTF-8", path.display()))
    })?;
    Scene::from_toml_with(&text, &path.display().to_string(), instead)
}
