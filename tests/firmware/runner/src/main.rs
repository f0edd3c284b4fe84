//! Proves that `imu_core` does on a Cortex-M what it does on the host, at the price stated.
//!
//! Builds the images for Cortex-M4F and M0, which link only if no panic is reachable; runs them
//! under QEMU; compares every result with the host's bit for bit, and every figure (instructions,
//! stack, state, flash) with the table of ceilings. `README.md` beside this workspace says more.

mod ceilings;
mod host;
mod images;
mod live;
mod lockfile;
mod panics;
mod qemu;
mod toolchain;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// A result with an error in one sentence.
type Result<T> = std::result::Result<T, String>;

const USAGE: &str = "usage: tests/firmware/run [--bless | --live]
  --bless  write the figures measured now into tests/firmware/ceilings.csv
  --live   stream frames from the emulated board into imu live instead, and compare what it finds";

fn main() -> ExitCode {
    let (mut bless, mut live) = (false, false);
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "--bless" => bless = true,
            "--live" => live = true,
            "--help" | "-h" => {
                println!("{USAGE}");
                return ExitCode::SUCCESS;
            }
            _ => {
                eprintln!("{USAGE}");
                return ExitCode::from(2);
            }
        }
    }
    match if live { stream() } else { check(bless) } {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("firmware: {error}");
            ExitCode::FAILURE
        }
    }
}

/// This workspace.
fn folder() -> Result<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    folder.canonicalize().map_err(|e| format!("{}: {e}", folder.display()))
}

/// Where images are built.
fn target_dir(folder: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| folder.join("target"), PathBuf::from)
        .join("firmware")
}

/// From the board's serial line to `imu live`; true if all is as it should be.
fn stream() -> Result<bool> {
    let folder = folder()?;
    let toolchain = toolchain::find()?;
    qemu::find()?;
    live::check(&toolchain, &folder, &target_dir(&folder))
}

/// Everything else; true if all is as it should be.
fn check(bless: bool) -> Result<bool> {
    let folder = folder()?;
    lockfile::same_versions(&folder.join("../../Cargo.lock"), &folder.join("Cargo.lock"))?;
    let toolchain = toolchain::find()?;
    qemu::find()?;
    let target_dir = target_dir(&folder);

    let (expected, measured) = std::thread::scope(|scope| {
        // The emulators take nearly all the time, a processor each.
        let runs = images::TARGETS
            .each_ref()
            .map(|target| scope.spawn(|| measure(&toolchain, target, &folder, &target_dir)));
        let expected = host::run();
        (expected, runs.map(|run| run.join().map_err(|_| "a run on QEMU panicked".to_string())))
    });
    let mut good = true;
    let mut figures = Vec::new();
    for (target, measured) in images::TARGETS.iter().zip(measured) {
        let report = measured??;
        good &= host::compare(target.name, &expected, &report.words);
        figures.extend(report.figures);
    }
    good &= ceilings::check(&folder.join("ceilings.csv"), &figures, &toolchain.version, bless)?;
    Ok(good)
}

/// Builds the images of a target and runs them: what they print, and the flash of those of one function.
fn measure(
    toolchain: &toolchain::Toolchain,
    target: &images::Target,
    folder: &Path,
    target_dir: &Path,
) -> Result<qemu::Report> {
    let built = images::build(toolchain, target, folder, target_dir)?;
    let mut report = qemu::run(target, &built.image("all"))?;
    for name in images::SINGLE {
        qemu::run(target, &built.image(name))?;
        report.figures.push(ceilings::Figure {
            target: target.name.into(),
            case: (*name).into(),
            what: "flash".into(),
            unit: "bytes".into(),
            value: images::flash_bytes(&built.image(name))? as f64,
        });
    }
    Ok(report)
}
