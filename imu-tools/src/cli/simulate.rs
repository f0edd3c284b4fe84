//! `imu simulate`: a preset or a scene file into a recording, the truth beside it.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{progress, same_target};
use crate::error::Error;
use crate::recording::{self, Block, Contents, Format, SampleKind, Sink};
use crate::scene::{
    Path as Motion, Preset, Rate, Scene, Simulator, TermsWriter, TruthWriter, display_duration,
    parse_duration,
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
    /// Samples at an instant, means over the interval before, or increments over it: instantaneous,
    /// mean or increments [default: the scene's, instantaneous]
    #[arg(long, value_name = "KIND")]
    samples: Option<SampleKind>,
    /// Write pose, velocity, true rate and force, and the bias carried, as CSV
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Write what each error adds to each sample and axis, as CSV
    #[arg(long, value_name = "FILE")]
    truth_terms: Option<PathBuf>,
}

/// Everything that is written.
struct Targets {
    sink: Box<dyn Sink>,
    truth: Option<TruthWriter>,
    terms: Option<TermsWriter>,
}

impl Simulate {
    pub(super) fn run(self) -> Result<(), Error> {
        let scene = self.scene()?;
        self.check_targets()?;
        let mut simulator = Simulator::new(&scene)?;
        let samples = simulator.samples_left();
        let format = self.format.map_or_else(|| Format::of(&self.output), Ok)?;
        let contents =
            Contents { samples: scene.samples, temperature: scene.temperature.is_some() };
        let mut targets = Targets {
            sink: recording::create_with(&self.output, format, contents)?,
            truth: self.truth.as_ref().map(|path| TruthWriter::create(path, &scene)).transpose()?,
            terms: self
                .truth_terms
                .as_ref()
                .map(|path| TermsWriter::create(path, &scene))
                .transpose()?,
        };
        let lost = targets.write(&mut simulator)?;
        targets.finish()?;
        super::say(&format!("imu: wrote {}", self.summary(&scene, samples, lost)));
        if let Some(unsaid) = unsaid(format, contents) {
            super::say(&format!("imu: {}: {unsaid}", super::target_name(&self.output)));
        }
        Ok(())
    }

    /// That no file is to be written twice, nor over the scene.
    fn check_targets(&self) -> Result<(), Error> {
        let targets = [
            (Some(&self.output), "recording"),
            (self.truth.as_ref(), "truth"),
            (self.truth_terms.as_ref(), "terms"),
        ];
        let targets: Vec<(&PathBuf, &str)> =
            targets.into_iter().filter_map(|(path, what)| Some((path?, what))).collect();
        for (i, (path, what)) in targets.iter().enumerate() {
            let same = |(other, _): &&(&PathBuf, &str)| same_target(path, other);
            if let Some((_, before)) = targets[..i].iter().find(same) {
                return Err(Error::usage(format!(
                    "the {before} and the {what} cannot both go to {}: name two files",
                    path.display()
                )));
            }
            let is_file = Preset::from_name(&self.scene).is_none();
            if is_file && same_target(path, Path::new(&self.scene)) {
                return Err(Error::usage(format!(
                    "{} is the scene itself: name another file to write",
                    path.display()
                )));
            }
        }
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
        if let Some(samples) = self.samples {
            scene.samples = samples;
        }
        if let Some(hz) = self.lowpass {
            scene.gyroscope.lowpass_hz = Some(hz);
            scene.accelerometer.lowpass_hz = Some(hz);
        }
        Ok(scene)
    }

    fn summary(&self, scene: &Scene, due: u64, lost: u64) -> String {
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
        let samples = due - lost;
        format!(
            "{samples} {} of both sensors ({} at {} Hz, seed {}{without}) to {to}{beside}",
            if samples == 1 { "sample" } else { "samples" },
            display_duration(scene.duration_ns),
            scene.rate.hz(),
            scene.seed,
        )
    }
}

/// What a recording of this format cannot say of its contents.
fn unsaid(format: Format, contents: Contents) -> Option<String> {
    let Contents { samples, temperature } = contents;
    let kind = match (format, samples) {
        (_, SampleKind::Instantaneous) | (Format::Csv | Format::Euroc, _) => None,
        (Format::Bag | Format::Mcap, _) => Some(format!(
            "this format has no place for the kind of its samples; they are {}",
            samples.meaning()
        )),
    };
    let temperature = (temperature && format != Format::Csv)
        .then(|| "the temperature is not in it; a .csv has a column for it".to_owned());
    let all: Vec<String> = kind.into_iter().chain(temperature).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

impl Targets {
    /// Plays the scene to its end; how many of its samples were lost.
    fn write(&mut self, simulator: &mut Simulator) -> Result<u64, Error> {
        let due = simulator.samples_left();
        let bar = progress::bar(due, "simulating");
        if self.terms.is_some() {
            simulator.keep_terms();
        }
        let (mut block, mut written) = (Block::default(), 0);
        loop {
            if self.truth.is_some() || self.terms.is_some() {
                let Some(truth) = simulator.advance_with_truth(&mut block) else { break };
                if let Some(writer) = &mut self.truth {
                    writer.write(truth)?;
                }
                if let Some(writer) = &mut self.terms {
                    writer.write(truth)?;
                }
            } else if !simulator.advance(&mut block) {
                break;
            }
            self.sink.write_block(&block)?;
            written += block.gyroscope.len() as u64;
            bar.set_position(due - simulator.samples_left());
        }
        Ok(due - written)
    }

    fn finish(self) -> Result<(), Error> {
        self.sink.finish()?;
        if let Some(truth) = self.truth {
            truth.finish()?;
        }
        if let Some(terms) = self.terms {
            terms.finish()?;
        }
        Ok(())
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
