//! The `imu` command: see [`imu_tools::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    imu_tools::cli::run()
}
