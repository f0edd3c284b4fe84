//! Playing a scene into files: shared by every subcommand that simulates.

use std::path::Path;

use super::{progress, same_target};
use crate::error::Error;
use crate::live::simulated::Terminal;
use crate::recording::{self, Block, Contents, Format, Note, SampleKind, Sink, Source as _};
use crate::scene::{Scene, Simulator, TermsWriter, TruthWriter};

/// Where a scene goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Targets<'a> {
    pub(super) output: &'a Path,
    pub(super) format: Option<Format>,
    pub(super) truth: Option<&'a Path>,
    pub(super) terms: Option<&'a Path>,
    /// How many times as fast as real time a simulated terminal is; 0 as fast as it is read.
    pub(super) speed: f64,
}

/// What was written.
pub(super) struct Played {
    /// Samples of each sensor.
    pub(super) samples: u64,
    /// Those that were due besides.
    pub(super) lost: u64,
}

impl Targets<'_> {
    /// That no file is to be written twice, nor over what is read, each of which is called so.
    pub(super) fn check<'r>(
        &self,
        read: impl IntoIterator<Item = (&'r Path, &'r str)>,
    ) -> Result<(), Error> {
        let read: Vec<_> = read.into_iter().collect();
        let targets =
            [(Some(self.output), "recording"), (self.truth, "truth"), (self.terms, "terms")];
        let targets: Vec<(&Path, &str)> =
            targets.into_iter().filter_map(|(path, what)| Some((path?, what))).collect();
        for (i, (path, what)) in targets.iter().enumerate() {
            let same = |(other, _): &&(&Path, &str)| same_target(path, other);
            if let Some((_, before)) = targets[..i].iter().find(same) {
                return Err(Error::usage(format!(
                    "the {before} and the {what} cannot both go to {}: name two files",
                    path.display()
                )));
            }
            let is_read = |(file, _): &&(&Path, &str)| same_target(path, file) || holds(path, file);
            if let Some((_, what)) = read.iter().find(is_read) {
                return Err(Error::usage(format!(
                    "{} is {what}, or holds it: name another file to write",
                    path.display()
                )));
            }
        }
        if let Some(truth) =
            self.truth.filter(|truth| truth.extension().is_some_and(|e| e == "tum"))
        {
            return Err(Error::usage(format!(
                "truth is written as CSV, and {} would be TUM's: name it .csv",
                truth.display()
            )));
        }
        Ok(())
    }

    /// Plays a scene to its end, and tells what there is to tell.
    pub(super) fn play(&self, scene: &Scene) -> Result<Played, Error> {
        let mut simulator = Simulator::new(scene)?;
        let contents =
            Contents { samples: scene.samples, temperature: scene.temperature.is_some() };
        let (sink, unsaid) = self.sink(scene, contents)?;
        let mut files = Files {
            sink,
            truth: self.truth.map(|path| TruthWriter::create(path, scene)).transpose()?,
            terms: self.terms.map(|path| TermsWriter::create(path, scene)).transpose()?,
        };
        say_notes(&simulator.take_notes());
        let due = simulator.samples_left();
        let lost = files.write(&mut simulator)?;
        files.finish()?;
        if let Some(unsaid) = unsaid {
            super::say(&format!("imu: {}: {unsaid}", super::target_name(self.output)));
        }
        Ok(Played { samples: due - lost, lost })
    }

    /// The file or terminal that samples go to, and what it cannot say of them.
    fn sink(
        &self,
        scene: &Scene,
        contents: Contents,
    ) -> Result<(Box<dyn Sink>, Option<String>), Error> {
        if let Some(terminal) = Terminal::of(self.output)? {
            let told = |name: &Path| super::say(&format!("imu: a sensor is at {}", name.display()));
            let sink = terminal.open(scene.samples, scene.rate.hz(), self.speed, told)?;
            return Ok((sink, None));
        }
        let format = self.format.map_or_else(|| Format::of(self.output), Ok)?;
        let sink = recording::create_with(self.output, format, contents)?;
        Ok((sink, unsaid(format, contents)))
    }
}

/// Whether a file is in what a folder of EuRoC's layout, to be written, is made of.
fn holds(folder: &Path, file: &Path) -> bool {
    let is_inner = folder.file_name().is_some_and(|name| name == "mav0");
    let inside = if is_inner { folder.to_owned() } else { folder.join("mav0") };
    inside
        .canonicalize()
        .is_ok_and(|inside| file.canonicalize().is_ok_and(|file| file.starts_with(inside)))
}

/// Says remarks, and warnings as such.
pub(super) fn say_notes(notes: &[Note]) {
    for note in notes {
        match note {
            Note::Info(remark) => super::say(&format!("imu: {remark}")),
            Note::Warning(warning) => super::say(&format!("imu: warning: {warning}")),
        }
    }
}

/// What a recording of this format cannot say of its contents.
pub(super) fn unsaid(format: Format, contents: Contents) -> Option<String> {
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

/// Everything that is being written.
struct Files {
    sink: Box<dyn Sink>,
    truth: Option<TruthWriter>,
    terms: Option<TermsWriter>,
}

impl Files {
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
