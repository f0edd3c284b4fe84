//! `imu demo`: the whole story on no input.

use std::path::Path;

use clap::Args;

use super::progress;
use super::results::write_into;
use crate::calibrate::{Options, calibrate};
use crate::error::Error;
use crate::output::Output;
use crate::report;
use crate::report::demo::{Level, table};
use crate::report::formats::Form;
use crate::scene::{Preset, Simulator};

/// Simulate three noise levels for four hours each, calibrate them, and compare with the truth.
///
/// No file in between: 4 h at 200 Hz of each level go straight from the simulator into the
/// calibration. Beside the estimates stands what two classic tools print for the same data. A page
/// with all of it, imu-demo/demo.html, and each level's report.html, plots, imu.yaml and allan.csv are
/// written.
#[derive(Args, Debug)]
pub(super) struct Demo {
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

impl Demo {
    pub(super) fn run(self) -> Result<(), Error> {
        let folder = Path::new("imu-demo");
        let mut levels = Vec::new();
        for preset in Preset::ALL {
            let mut scene = preset.scene();
            scene.seed = self.seed;
            let simulator = Simulator::new(&scene)?;
            let bar = progress::bar(simulator.samples_left(), preset.name());
            let name = format!("imu simulate {} --seed {}", preset.name(), self.seed);
            let options = Options { keep_signal: true, ..Options::default() };
            let calibration =
                calibrate(Box::new(simulator), &name, &options, |at| bar.set_position(at.samples))?;
            bar.finish_and_clear();
            write_into(&folder.join(preset.name()), &calibration, Form::Kalibr)?;
            levels.push(Level { name: preset.name(), scene, calibration });
        }
        let mut page = Output::create(&folder.join("demo.html"))?;
        page.write(report::html::demo(&levels).as_bytes())?;
        page.finish()?;
        super::print(&table(&levels))?;
        super::print(
            "\nimu-demo/demo.html shows all of it; report.html, plots, imu.yaml and allan.csv of each level \
             are beside it.\n",
        )
    }
}
