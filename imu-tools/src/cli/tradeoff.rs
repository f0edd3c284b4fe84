//! `imu tradeoff`: what accuracy costs, on this machine.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::progress;
use crate::error::Error;
use crate::output::Output;
use crate::report;
use crate::scene::parse_duration;
use crate::tradeoff::allan::{Plan, measure};

/// Measure what accuracy costs, on this machine.
#[derive(Args, Debug)]
pub(super) struct Tradeoff {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Allan(Allan),
}

/// Estimators of N and K: their errors, over many simulated records, beside their price.
///
/// Ladders of octaves over disjoint blocks and over four windows an averaging time, all overlapping
/// windows, and exact maximum likelihood; in f32 and f64; read by the fit and by slopes.
#[derive(Args, Debug)]
struct Allan {
    /// Records of three axes, of each of two noises
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    records: u64,

    /// Length of a record: 4h, 90min, 600s
    #[arg(long, value_name = "TIME", default_value = "4h")]
    duration: String,

    /// Samples a second
    #[arg(long, value_name = "HZ", default_value_t = 20.0, allow_negative_numbers = true)]
    rate: f64,

    /// Seed of the first record
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Print JSON
    #[arg(long)]
    json: bool,

    /// Write tradeoff.md, with a plot, into a folder; other sections of the page stay as they are
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
}

impl Tradeoff {
    pub(super) fn run(self) -> Result<(), Error> {
        match self.what {
            What::Allan(allan) => allan.run(),
        }
    }
}

impl Allan {
    fn run(self) -> Result<(), Error> {
        let plan = Plan {
            duration_s: parse_duration(&self.duration)? as f64 / 1e9,
            rate_hz: self.rate,
            records: self.records,
            seed: self.seed,
        };
        plan.check()?;
        let files = self.output.as_deref().map(Files::create).transpose()?;
        let bar = progress::records(2 * plan.records, "simulating");
        let tradeoff = measure(&plan, |done| bar.set_position(done))?;
        bar.finish_and_clear();
        if let Some(files) = files {
            files.write(&tradeoff)?;
        }
        if self.json {
            super::print(&format!("{:#}\n", report::tradeoff::json(&tradeoff)))
        } else {
            super::print(&report::tradeoff::table(&tradeoff))
        }
    }
}

/// The page and its plot, begun before the work, so that a folder that cannot be written is told at once.
struct Files {
    before: Option<String>,
    page: Output,
    picture: Output,
}

impl Files {
    const PICTURE: &str = "tradeoff-allan.svg";

    fn create(folder: &Path) -> Result<Self, Error> {
        if folder == Path::new("-") {
            return Err(Error::usage(
                "-o names a folder, in which a page and its plot are written, and no pipe"
                    .to_owned(),
            ));
        }
        std::fs::create_dir_all(folder).map_err(|e| Error::io("make the folder", folder, e))?;
        let page = folder.join("tradeoff.md");
        let before = match std::fs::read_to_string(&page) {
            Ok(text) => Some(text),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
            Err(error) => return Err(Error::io("read", &page, error)),
        };
        let picture = Output::create(&folder.join(Self::PICTURE))?;
        Ok(Self { before, page: Output::create(&page)?, picture })
    }

    fn write(self, tradeoff: &crate::tradeoff::allan::Tradeoff) -> Result<(), Error> {
        let Self { before, mut page, mut picture } = self;
        let text = report::tradeoff::page(before.as_deref(), tradeoff, Self::PICTURE);
        picture.write(report::plot::tradeoff(tradeoff).svg().as_bytes())?;
        page.write(text.as_bytes())?;
        picture.finish()?;
        page.finish()
    }
}
