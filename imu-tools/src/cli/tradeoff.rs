//! `imu tradeoff`: what accuracy costs, on this machine.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::progress;
use crate::error::Error;
use crate::output::Output;
use crate::report;
use crate::scene::parse_duration;
use crate::tradeoff::allan::{Plan, measure};
use crate::tradeoff::{rules, spline};

/// Measure what accuracy costs, on this machine.
#[derive(Args, Debug)]
pub(super) struct Tradeoff {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Allan(Allan),
    Rules(Rules),
    Spline(Spline),
}

/// Of those that draw random numbers.
#[derive(Args, Debug)]
struct Seed {
    /// Seed of the first record
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// What all of them take.
#[derive(Args, Debug)]
struct Common {
    /// Print JSON
    #[arg(long)]
    json: bool,

    /// Write tradeoff.md, with its plots, into a folder; other sections of the page stay as they are
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
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

    #[command(flatten)]
    seed: Seed,

    #[command(flatten)]
    common: Common,
}

/// Integration rules: their errors on five motions, at any rate, in f64 and f32, beside their price.
///
/// Example: imu tradeoff rules -o docs
#[derive(Args, Debug)]
struct Rules {
    /// Samples a second of clean data, rising
    #[arg(long, value_name = "HZ,…", value_delimiter = ',', default_values_t = rules::Plan::default().rates)]
    rates: Vec<u32>,

    /// Samples a second of data with white noise, rising
    #[arg(long, value_name = "HZ,…", value_delimiter = ',', default_values_t = rules::Plan::default().noisy_rates)]
    noisy_rates: Vec<u32>,

    /// Leave noise out
    #[arg(long, conflicts_with = "noisy_rates")]
    no_noise: bool,

    /// Noisy records, of each motion and rate
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    records: u64,

    #[command(flatten)]
    seed: Seed,

    #[command(flatten)]
    common: Common,
}

/// Splines: their errors at any knot spacing, in every form, in f64 and f32, cached or not, beside their price.
///
/// Example: imu tradeoff spline -o docs
#[derive(Args, Debug)]
struct Spline {
    /// Seconds from knot to knot
    #[arg(long, value_name = "S,…", value_delimiter = ',', default_values_t = spline::Plan::default().spacings_s, allow_negative_numbers = true)]
    spacings: Vec<f64>,

    /// What is followed: ellipse, gait, coning, spin, rest
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', default_values_t = spline::Plan::default().motions.into_iter().map(|motion| motion.name().to_owned()))]
    motion: Vec<String>,

    #[command(flatten)]
    common: Common,
}

impl Tradeoff {
    pub(super) fn run(self) -> Result<(), Error> {
        match self.what {
            What::Allan(allan) => allan.run(),
            What::Rules(rules) => rules.run(),
            What::Spline(spline) => spline.run(),
        }
    }
}

impl Allan {
    fn run(self) -> Result<(), Error> {
        let plan = Plan {
            duration_s: parse_duration(&self.duration)? as f64 / 1e9,
            rate_hz: self.rate,
            records: self.records,
            seed: self.seed.seed,
        };
        plan.check()?;
        let files = self.common.files(["tradeoff-allan.svg"])?;
        let bar = progress::records(2 * plan.records, "simulating");
        let tradeoff = measure(&plan, |done| bar.set_position(done))?;
        bar.finish_and_clear();
        if let Some(files) = files {
            let page = |before: Option<&str>, [picture]: [&str; 1]| {
                report::tradeoff::allan::page(before, &tradeoff, picture)
            };
            files.write(page, [report::plot::tradeoff(&tradeoff).svg().into_bytes()])?;
        }
        self.common.print(
            || report::tradeoff::allan::json(&tradeoff),
            || report::tradeoff::allan::table(&tradeoff),
        )
    }
}

impl Rules {
    fn run(self) -> Result<(), Error> {
        let sorted = |mut rates: Vec<u32>| {
            rates.sort_unstable();
            rates.dedup();
            rates
        };
        let plan = rules::Plan {
            rates: sorted(self.rates),
            noisy_rates: if self.no_noise { Vec::new() } else { sorted(self.noisy_rates) },
            records: self.records,
            seed: self.seed.seed,
        };
        plan.check()?;
        let files = self.common.files(["tradeoff-rules.svg"])?;
        let bar = progress::records(plan.steps(), "following motions");
        let tradeoff = rules::measure(&plan, |done| bar.set_position(done))?;
        bar.finish_and_clear();
        if let Some(files) = files {
            let page = |before: Option<&str>, [picture]: [&str; 1]| {
                report::tradeoff::rules::page(before, &tradeoff, picture)
            };
            files.write(page, [report::plot::rules(&tradeoff).svg().into_bytes()])?;
        }
        self.common.print(
            || report::tradeoff::rules::json(&tradeoff),
            || report::tradeoff::rules::table(&tradeoff),
        )
    }
}

/// The plots of splines: for the page, and in pixels.
const SPLINE: [&str; 4] = [
    "tradeoff-spline-orders.svg",
    "tradeoff-spline-price.svg",
    "tradeoff-spline-orders.png",
    "tradeoff-spline-price.png",
];

impl Spline {
    fn run(self) -> Result<(), Error> {
        let mut spacings_s = self.spacings;
        spacings_s.sort_unstable_by(|a, b| b.total_cmp(a));
        spacings_s.dedup();
        let motions = self.motion.iter().map(|name| spline::motion(name));
        let plan = spline::Plan { spacings_s, motions: motions.collect::<Result<_, _>>()? };
        plan.check()?;
        let files = self.common.files(SPLINE)?;
        let bar = progress::records(plan.steps(), "following motions");
        let tradeoff = spline::measure(&plan, |done| bar.set_position(done))?;
        bar.finish_and_clear();
        if let Some(files) = files {
            let page = |before: Option<&str>, [orders, price, ..]: [&str; 4]| {
                report::tradeoff::spline::page(before, &tradeoff, [orders, price])
            };
            let orders = report::plot::spline_orders(&tradeoff);
            let price = report::plot::spline_price(&tradeoff);
            let svg = [&orders, &price].map(|figure| figure.svg().into_bytes());
            let [orders_svg, price_svg] = svg;
            files.write(page, [orders_svg, price_svg, orders.png()?, price.png()?])?;
        }
        self.common.print(
            || report::tradeoff::spline::json(&tradeoff),
            || report::tradeoff::spline::table(&tradeoff),
        )
    }
}

impl Common {
    /// The page and the pictures, of these names, where a folder is asked for.
    fn files<const N: usize>(
        &self,
        pictures: [&'static str; N],
    ) -> Result<Option<Files<N>>, Error> {
        self.output.as_deref().map(|folder| Files::create(folder, pictures)).transpose()
    }

    /// As JSON or as tables.
    fn print(
        &self,
        json: impl FnOnce() -> serde_json::Value,
        table: impl FnOnce() -> String,
    ) -> Result<(), Error> {
        let text = if self.json { format!("{:#}\n", json()) } else { table() };
        super::print(&text)
    }
}

/// The page and its plots, begun before the work, so that a folder that cannot be written is told at once.
struct Files<const N: usize> {
    before: Option<String>,
    page: Output,
    names: [&'static str; N],
    pictures: Vec<Output>,
}

impl<const N: usize> Files<N> {
    /// The pictures are called by their `names`.
    fn create(folder: &Path, names: [&'static str; N]) -> Result<Self, Error> {
        if folder == Path::new("-") {
            return Err(Error::usage(
                "-o names a folder, in which a page and its plots are written, and no pipe"
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
        let pictures = names
            .iter()
            .map(|name| Output::create(&folder.join(name)))
            .collect::<Result<_, _>>()?;
        Ok(Self { before, page: Output::create(&page)?, names, pictures })
    }

    fn write(
        self,
        text: impl FnOnce(Option<&str>, [&str; N]) -> String,
        drawn: [Vec<u8>; N],
    ) -> Result<(), Error> {
        let Self { before, mut page, names, mut pictures } = self;
        for (picture, bytes) in pictures.iter_mut().zip(drawn) {
            picture.write(&bytes)?;
        }
        page.write(text(before.as_deref(), names).as_bytes())?;
        pictures.into_iter().try_for_each(Output::finish)?;
        page.finish()
    }
}
