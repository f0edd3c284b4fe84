//! `imu live`: a calibration while the sensor streams.

use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;

use super::reading::Reading;
use super::results::Results;
use crate::calibrate::Options;
use crate::error::Error;
use crate::live::checkpoint::{self, Place};
use crate::live::face::Face;
use crate::live::goal::Goal;
use crate::live::intake::{self, Intake};
use crate::live::keep::Keep;
use crate::live::port::{self, Address, Expected, How};
use crate::live::protocol::Protocol;
use crate::live::run::{self, Decode, Ended};
use crate::live::screen::Screen;
use crate::live::session::{Before, Session, View};
use crate::output::{self, Output};
use crate::recording;
use crate::report;
use crate::scene::parse_duration;

const EXAMPLES: &str = "\
Examples:
  imu live still.bag
      a recording in the place of a sensor: look at the dashboard, q ends with the report
  imu live /dev/ttyUSB0 --record night.bag -o out
      plug in, watch, and keep the samples; --resume goes on after whatever happened
  imu live /dev/ttyACM0 --baud 921600 --until 10%
      ends by itself when N and K are known to ±10 %
  imu live tcp://imu.local:4000 --for 6h --json --every 1min
  socat - UDP-RECV:5000 | imu live -

Put the sensor on something solid and leave it alone. Keys: s save, p pause, m mark, q quit.";

/// Calibrate an IMU while it streams, and see when it is enough.
///
/// Reads a serial port, a network connection, a pipe or a recording, and shows the Allan deviation and
/// N and K with their intervals as they come to be known. The state is kept in a checkpoint every few seconds:
/// nothing is lost to Ctrl-C, an unplugged cable or a power cut.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Live {
    /// A serial port, tcp://host:port, - for a pipe, auto for the only serial port, or a recording
    #[arg(value_name = "PORT")]
    port: String,
    /// Bits a second of a serial port; without it the usual ones are tried
    #[arg(long, value_name = "BAUD", value_parser = clap::value_parser!(u32).range(1..))]
    baud: Option<u32>,
    /// What the sensor speaks; without it the bytes show it. docs/live-protocols.md lists the protocols
    #[arg(long, value_name = "NAME")]
    protocol: Option<Protocol>,
    /// Replay a recording so many times faster than it was recorded; without it, as fast as can be
    #[arg(long, value_name = "N", value_parser = speed)]
    speed: Option<f64>,
    /// End when N and K of all axes together are known to this part of their values, such as 10%
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    until: Option<f64>,
    /// End after this time of the sensor, such as 6h
    #[arg(long = "for", value_name = "TIME", value_parser = seconds)]
    span: Option<f64>,
    /// Keep the samples: a .bag, .mcap or .csv that grows in its place and can be read whatever happens
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Keep the bytes as they came
    #[arg(long, value_name = "FILE")]
    raw: Option<PathBuf>,
    /// Where the state is kept; not at all of a recording that is replayed, unless this is said
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Time between checkpoints: what a power cut costs at most
    #[arg(long, value_name = "TIME", default_value = "5s", value_parser = seconds)]
    checkpoint_every: f64,
    /// Go on with the checkpoint: the time since then is a gap
    #[arg(long, conflicts_with = "fresh")]
    resume: bool,
    /// Begin anew, over a checkpoint that another session left
    #[arg(long)]
    fresh: bool,
    /// Plain lines also on a terminal
    #[arg(long)]
    plain: bool,
    /// Print one JSON object a line: status now and then, the report at the end
    #[arg(long)]
    json: bool,
    /// Time between lines
    #[arg(long, value_name = "TIME", default_value = "10s", value_parser = seconds)]
    every: f64,
    #[command(flatten)]
    results: Results,
    #[command(flatten)]
    reading: Reading,
}

/// The checkpoint where none is named.
const CHECKPOINT: &str = "imu-live.checkpoint";

/// What is aimed at where no goal is given: how long until then is shown.
const WITHIN: f64 = 0.1;

/// How many times as fast; 0 for as fast as can be.
pub(super) fn speed(text: &str) -> Result<f64, String> {
    let number = if text == "max" { Ok(0.0) } else { text.parse() };
    let number = number.ok().filter(|speed: &f64| speed.is_finite() && *speed >= 0.0);
    number.ok_or_else(|| "how many times faster, such as 1 or 100, or max".into())
}

fn percent(text: &str) -> Result<f64, String> {
    let number = text.trim_end_matches('%').trim().parse().ok();
    let number = number.filter(|percent: &f64| *percent > 0.0 && *percent <= 100.0);
    number.map(|percent| percent / 100.0).ok_or_else(|| "a part such as 10%".into())
}

fn seconds(text: &str) -> Result<f64, String> {
    parse_duration(text).map(|ns| ns as f64 * 1e-9).map_err(|error| error.to_string())
}

impl Live {
    /// Runs, and says how it ended.
    pub(super) fn exit(self) -> Result<Option<i32>, Error> {
        let options = Options {
            unit_is_given: self.reading.accel_unit_is_given(),
            ..self.results.options()?
        };
        let address = Address::of(&self.port)?;
        self.check_uses(&address)?;
        let recordings = match &address {
            Address::Recording(path) => vec![path.clone()],
            _ => Vec::new(),
        };
        self.results.check(&recordings)?;
        self.results.make_folder()?;
        let checkpoint = self.checkpoint.clone().or_else(|| {
            let wanted = self.resume || !address.comes_again();
            wanted.then(|| PathBuf::from(CHECKPOINT))
        });
        self.check_names(checkpoint.as_deref())?;
        let place = checkpoint.as_deref().map(Place::take).transpose()?;
        let session = self.session(&address, &options, checkpoint.as_deref())?;
        let how = How {
            baud: self.baud,
            reading: self.reading.options(),
            speed: self.speed.unwrap_or(0.0),
            again_ns: session.taken_until(),
        };
        let protocol = intake::named(self.protocol, &how.reading);
        let decode: Option<Box<dyn Decode>> = if address.comes_again() {
            None
        } else {
            Some(Box::new(Intake::new(&address.name(), protocol, &how.reading)?))
        };
        let expected = Expected {
            protocol: protocol.map(Protocol::name),
            refused: &|bytes| intake::refused(protocol, &how.reading, bytes),
        };
        let port = port::open(&address, &how, &expected)?;
        output::heed_signals();
        let keep = Keep {
            checkpoint: place.map(|place| (place, Duration::from_secs_f64(self.checkpoint_every))),
            record: self
                .record
                .as_deref()
                .map(free)
                .map(|path| recording::grow(&path))
                .transpose()?,
            raw: self.raw.as_deref().map(free).map(|path| Output::growing(&path)).transpose()?,
            ..Keep::default()
        };
        let within = self.until.unwrap_or(WITHIN);
        let every = Duration::from_secs_f64(self.every);
        let mut face: Box<dyn Face> = if self.json {
            Box::new(Lines { every, within, json: true })
        } else if self.plain || !std::io::stdout().is_terminal() || !std::io::stdin().is_terminal()
        {
            Box::new(Lines { every, within, json: false })
        } else {
            Box::new(Screen::open(within)?)
        };
        let mut save = |view: &View| {
            let Some(folder) = &self.results.output else { return Ok(None) };
            if let Some(refusal) = &view.snapshot.refusal {
                return Err(Error::data(refusal.to_string()));
            }
            self.results.write(&view.snapshot.calibration)?;
            Ok(Some(folder.display().to_string()))
        };
        let goal = Goal { within: self.until, span_s: self.span };
        let live = run::Live { session, port, decode, keep, goal, save: &mut save };
        let (view, ended) = live.run(&mut *face);
        drop(face);
        let say = |sentence: &str| super::say(&format!("imu: {sentence}"));
        match (ended, nothing(&view)) {
            // Who ends it so early expects no report.
            (Ok(Ended::Quit), Some(why)) => {
                say(&why);
                Ok(None)
            }
            (Ok(Ended::Goal | Ended::Input | Ended::Quit), _) => self.tell(view).map(|()| None),
            (Ok(Ended::Signal(signal)), nothing) => {
                // A terminal that was closed takes no report, and a checkpoint is written.
                let told = nothing.map_or_else(|| self.tell(view), |why| Err(Error::data(why)));
                told.unwrap_or_else(|error| say(&error.to_string()));
                Ok(Some(signal))
            }
            (Err(error), _) => {
                // What was measured is told, whatever went wrong.
                if view.samples != [0, 0] {
                    self.tell(view).unwrap_or_else(|also| say(&also.to_string()));
                }
                Err(error)
            }
        }
    }

    /// Refuses what such a port has no use for.
    fn check_uses(&self, address: &Address) -> Result<(), Error> {
        let is_recording = address.comes_again();
        let is_serial = matches!(address, Address::Serial(_));
        let uses = [
            ("--baud", self.baud.is_some(), is_serial, "a serial port"),
            ("--protocol", self.protocol.is_some(), !is_recording, "bytes of a sensor"),
            ("--raw", self.raw.is_some(), !is_recording, "bytes of a sensor"),
            ("--speed", self.speed.is_some(), is_recording, "a recording"),
        ];
        match uses.iter().find(|(_, is_given, is_used, _)| *is_given && !is_used) {
            Some((option, _, _, what)) => Err(Error::usage(format!(
                "{option} is for {what}, and {} is none: leave it out",
                address.name()
            ))),
            None => Ok(()),
        }
    }

    /// Refuses one name for two files.
    fn check_names(&self, checkpoint: Option<&Path>) -> Result<(), Error> {
        let files = [
            ("--checkpoint", checkpoint),
            ("--record", self.record.as_deref()),
            ("--raw", self.raw.as_deref()),
        ];
        let mut pairs = files.iter().enumerate().flat_map(|(n, a)| {
            let others = files.iter().skip(n + 1);
            others.filter(move |b| a.1.is_some() && a.1 == b.1).map(move |b| (a.0, b.0))
        });
        pairs.next().map_or(Ok(()), |(one, other)| {
            Err(Error::usage(format!(
                "{one} and {other} name the same file: name another for one of them"
            )))
        })
    }

    /// A session that goes on, or a new one, if nothing is lost by that.
    fn session(
        &self,
        address: &Address,
        options: &Options,
        checkpoint: Option<&Path>,
    ) -> Result<Session, Error> {
        let name = address.name();
        let Some(path) = checkpoint else { return Ok(Session::new(&name, options)) };
        if self.fresh {
            checkpoint::check_is_one(path)?;
            return Ok(Session::new(&name, options));
        }
        let found = checkpoint::read(path)?;
        let Some(found) = found else {
            if self.resume {
                return Err(Error::data(format!(
                    "there is no checkpoint {} to go on with: leave --resume out to begin",
                    path.display()
                )));
            }
            return Ok(Session::new(&name, options));
        };
        if let Some(warning) = &found.warning {
            super::say(&format!("imu: warning: {warning}"));
        }
        if self.resume {
            let again = address.comes_again();
            let before = if again { Before::ComesAgain } else { Before::IsPast };
            return Session::resume(&name, options, &found.payload, before);
        }
        if Session::has_ended(&found.payload)? {
            return Ok(Session::new(&name, options));
        }
        Err(Error::usage(format!(
            "{} holds a session that was interrupted: say --resume to go on with it, --fresh to begin \
             anew, or name another with --checkpoint",
            path.display()
        )))
    }

    /// The report of `imu calibrate`.
    fn tell(&self, view: View) -> Result<(), Error> {
        let calibration = &view.snapshot.calibration;
        if let Some(refusal) = view.snapshot.refusal {
            return Err(refusal);
        }
        let written = self.results.write(calibration);
        if self.json {
            let mut report = report::json::calibration(calibration);
            if let Some(fields) = report.as_object_mut() {
                fields.shift_insert(0, "kind".into(), "report".into());
            }
            super::print(&format!("{report}\n"))?;
        } else {
            self.results.say(calibration)?;
        }
        written
    }
}

/// Why there is nothing to report, if so.
fn nothing(view: &View) -> Option<String> {
    let View { samples, link, snapshot, .. } = view;
    if *samples != [0, 0] {
        return snapshot.refusal.as_ref().map(ToString::to_string);
    }
    let none = || format!("no sample of {} came", link.name);
    Some(link.amiss.clone().unwrap_or_else(none))
}

/// The first name that is free: `night.bag`, `night-2.bag`, …
fn free(path: &Path) -> PathBuf {
    let ending = path.extension().map(|e| format!(".{}", e.to_string_lossy())).unwrap_or_default();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let names = (2..).map(|n: u32| path.with_file_name(format!("{stem}-{n}{ending}")));
    let mut names = std::iter::once(path.to_owned()).chain(names);
    names.find(|path| !path.exists()).unwrap_or_else(|| path.to_owned())
}

/// Plain lines, or an object a line.
struct Lines {
    every: Duration,
    within: f64,
    json: bool,
}

impl Face for Lines {
    fn every(&self) -> Duration {
        self.every
    }

    fn show(&mut self, view: &View) -> Result<(), Error> {
        if self.json {
            return super::print(&format!("{}\n", report::live::json(view, self.within)));
        }
        super::say(&report::live::line(view, self.within));
        Ok(())
    }

    fn say(&mut self, sentence: &str) {
        super::say(&format!("imu: {sentence}"));
    }
}
