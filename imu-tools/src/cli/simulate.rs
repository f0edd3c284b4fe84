//! `imu simulate`: a preset or a scene file into a recording, the truth beside it.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{progress, same_target};
use crate::error::Error;
use crate::recording::{Block, Format, Sink};
use crate::scene::{
    Path as Motion, Preset, Rate, Scene, Simulator, TruthWriter, display_duration, parse_duration,
};

const EXAMPLES: &str = "\
Examples:
  imu simulate low -o still.bag
      four hours at 200 Hz at rest, the lowest of three noise levels
  imu simulate mid --moving --duration 60s --seed 7 -o ellipse.csv --truth truth.csv
      a minute on the classic ellipse, and what was true at each sample
  imu simulate high --lowpass 42 --duration 10min -o - | imu calibrate -
      into a pipe, as CSV
  imu simulate scene.toml -o imu.bag
      your own terms, for each sensor and axis:
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
    /// Where to write: FILE.bag (ROS 1), FILE.mcap (ROS 2), FILE.csv, FOLDER/ (EuRoC), or - for a pipe
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Write this format whatever the name: bag, mcap, csv or euroc (a pipe gets csv unless you say so)
    #[arg(long = "to", value_name = "FORMAT")]
    format: Option<Format>,
    /// Move on the classic ellipse instead of standing still
    #[arg(long)]
    moving: bool,
    /// How long: 4h, 1h30m, 90s [default: the scene's, 4h]
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
    /// Write pose, velocity, true rate and force, and the bias carried, as CSV
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
}

impl Simulate {
    pub(super) fn run(self) -> Result<(), Error> {
        let scene = self.scene()?;
        if self.truth.as_deref().is_some_and(|truth| same_target(truth, &self.output)) {
            return Err(Error::usage(format!(
                "the recording and the truth cannot both go to {}: name two files",
                self.output.display()
            )));
        }
        let is_file = Preset::from_name(&self.scene).is_none();
        let is_scene = |path: &Path| is_file && same_target(path, Path::new(&self.scene));
        let targets = [Some(self.output.as_path()), self.truth.as_deref()];
        if let Some(target) = targets.into_iter().flatten().find(|path| is_scene(path)) {
            return Err(Error::usage(format!(
                "{} is the scene itself: name another file to write",
                target.display()
            )));
        }
        let mut simulator = Simulator::new(&scene)?;
        let samples = simulator.samples_left();
        let mut sink = super::create(&self.output, self.format)?;
        let mut truth = self.truth.as_deref().map(TruthWriter::create).transpose()?;
        write(&mut simulator, sink.as_mut(), truth.as_mut())?;
        sink.finish()?;
        if let Some(truth) = truth {
            truth.finish()?;
        }
        super::say(&format!("imu: wrote {}", self.summary(&scene, samples)));
        Ok(())
    }

    /// The scene asked for, with the flags over it.
    fn scene(&self) -> Result<Scene, Error> {
        let mut scene = match Preset::from_name(&self.scene) {
            Some(preset) => preset.scene(),
            None => read(Path::new(&self.scene))?,
        };
        if self.moving {
            scene.motion = Motion::Ellipse;
        }
        if let Some(text) = &self.duration {
            scene.duration_ns = parse_duration(text)?;
        }
        if let Some(hz) = self.rate {
            scene.rate = Rate::from_hz(hz)?;
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

    fn summary(&self, scene: &Scene, samples: u64) -> String {
        let to = super::target_name(&self.output);
        let truth = match &self.truth {
            Some(path) => format!(", and the truth to {}", path.display()),
            None => String::new(),
        };
        format!(
            "{samples} {} of both sensors ({} at {} Hz, seed {}) to {to}{truth}",
            if samples == 1 { "sample" } else { "samples" },
            display_duration(scene.duration_ns),
            scene.rate.hz(),
            scene.seed,
        )
    }
}

fn write(
    simulator: &mut Simulator,
    sink: &mut dyn Sink,
    mut truth: Option<&mut TruthWriter>,
) -> Result<(), Error> {
    let bar = progress::bar(simulator.samples_left(), "simulating");
    let mut block = Block::default();
    loop {
        if let Some(writer) = &mut truth {
            let Some(truth) = simulator.advance_with_truth(&mut block) else { return Ok(()) };
            writer.write(truth)?;
        } else if !simulator.advance(&mut block) {
            return Ok(());
        }
        sink.write_block(&block)?;
        bar.inc(block.gyroscope.len() as u64);
    }
}

/// Reads a scene file; a word that is neither a file nor a preset is a mistake on the command line.
fn read(path: &Path) -> Result<Scene, Error> {
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
    Scene::from_toml(&text, &path.display().to_string())
}
