//! Poses into ideal IMU data at 200 Hz, 1 kHz and 4 kHz, and back: how far integration ends from the curve's own poses.
//!
//! `cargo run --release -p imu-tests --example closure -- POSES [KNOTS_S [SMOOTH_HZ]]`

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use imu_tests::closure::closure;
use imu_tools::error::Error;
use imu_tools::recording::SampleKind;
use imu_tools::spline::{FormName, Options, Route, asked};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match print(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(error.exit_code())
        }
    }
}

fn print(arguments: &[String]) -> Result<(), Error> {
    let Some(poses) = arguments.first() else {
        return Err(Error::usage("name a file of poses: POSES [KNOTS_S [SMOOTH_HZ]]"));
    };
    let number = |at: usize| arguments.get(at).and_then(|text| text.parse::<f64>().ok());
    for form in [FormName::Plain, FormName::Symmetric] {
        let mut options = Options { form: Some(form), ..Options::default() };
        if let Some(seconds) = number(1) {
            options.spacing = asked::every(seconds)?;
        }
        if let Some(hertz) = number(2) {
            options.smoothing_s = asked::smoothing_s(hertz)?;
        }
        let route = Arc::new(Route::open(Path::new(poses), &options)?);
        println!("{}, knots {} s apart", form.name(), f64::from(route.knots().step_ns()) / 1e9);
        for (kind, rule) in
            [(SampleKind::Instantaneous, "three-sample"), (SampleKind::Increments, "two-sample")]
        {
            for rate_hz in [200.0, 1000.0, 4000.0] {
                let found = closure(&route, rate_hz, kind);
                println!(
                    "  {:<14} {rule:<13} {rate_hz:>5} Hz: worst 10 s {:.2e} m (after {} s), all {:.1} s {:.2e} m",
                    kind.name(),
                    found.worst_window_m,
                    found.worst_after_s,
                    found.length_s,
                    found.whole_m,
                );
            }
        }
    }
    Ok(())
}
