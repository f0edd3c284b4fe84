//! From the firmware's serial line to `imu live`: what it streams is what is found.

use crate::images::{self, Target};
use crate::toolchain::Toolchain;
use crate::{Result, qemu};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// So long it listens.
const SECONDS: &str = "10s";
/// What `stream` sends: samples a second, and N of both sensors.
const RATE_HZ: f64 = 200.0;
const NOISE: [(&str, f64); 2] = [("gyroscope", 1e-3), ("accelerometer", 2e-3)];

/// Runs the image `stream`, listens to it with `imu live`, and compares; true if all is as it should be.
pub fn check(toolchain: &Toolchain, folder: &Path, target_dir: &Path) -> Result<bool> {
    let [board, _] = &images::TARGETS;
    let imu = program(folder)?;
    let image = images::build(toolchain, board, folder, target_dir)?.image("stream");
    let report = listen(&imu, board, &image, target_dir)?;
    let mut good = true;
    let mut compare = |what: &str, found: f64, low: f64, high: f64| {
        let fine = (low..=high).contains(&found);
        println!("live: {what} {found} of {low} to {high}{}", if fine { "" } else { ": WRONG" });
        good &= fine;
    };
    for (sensor, noise) in NOISE {
        let number = |path: &[&str]| {
            let whole = [&[sensor], path].concat();
            whole
                .iter()
                .fold(&report, |at, key| &at[key])
                .as_f64()
                .ok_or_else(|| format!("the report has no {}", whole.join(".")))
        };
        // The emulator keeps real time, but for what 10 s of its bursts leave.
        compare(&format!("{sensor}, Hz"), number(&["rate_hz"])?, 0.98 * RATE_HZ, 1.02 * RATE_HZ);
        compare(&format!("{sensor}, missing"), number(&["missing"])?, 0.0, 0.0);
        let found = number(&["pooled", "noise_density", "value"])?;
        let sd = number(&["pooled", "noise_density", "sd"])?;
        // Six standard deviations: once in 10⁹ runs.
        compare(&format!("{sensor}, N"), found, noise - 6.0 * sd, noise + 6.0 * sd);
    }
    Ok(good)
}

/// The program `imu`, built as the tests are.
fn program(folder: &Path) -> Result<PathBuf> {
    let root = folder.join("../..");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let target =
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let built = Command::new(&cargo)
        .args(["build", "--quiet", "--package", "imu-tools", "--bin", "imu", "--profile", "test"])
        .arg("--target-dir")
        .arg(&target)
        .current_dir(&root)
        .status()
        .map_err(|e| format!("{}: {e}", cargo.display()))?;
    if built.success() { Ok(target.join("debug/imu")) } else { Err("imu does not build".into()) }
}

/// The report of `imu live` on the image's serial line.
fn listen(imu: &Path, board: &Target, image: &Path, target_dir: &Path) -> Result<Value> {
    let stream = qemu::Stream::start(board, image)?;
    let output = Command::new(imu)
        .arg("live")
        .arg(&stream.port)
        .args(["--json", "--fresh", "--every", "2s", "--for", SECONDS, "--checkpoint"])
        .arg(target_dir.join("stream.checkpoint"))
        .output()
        .map_err(|e| format!("{}: {e}", imu.display()))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let report = text.lines().rfind(|line| line.starts_with("{\"kind\":\"report\""));
    let status = text.lines().any(|line| line.contains("\"protocol\":\"imu-frame\""));
    match report {
        Some(report) if output.status.success() && status => {
            serde_json::from_str(report).map_err(|e| format!("imu live says no JSON: {e}"))
        }
        _ => Err(format!("imu live {}: {}", stream.port, String::from_utf8_lossy(&output.stderr))),
    }
}
