//! The `imu` program, for tests that run it as a user does.

use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

/// A call of the `imu` program, built (once a test program) as the tests themselves were.
///
/// # Panics
/// When the program cannot be built.
#[must_use]
pub fn imu() -> Command {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    Command::new(PROGRAM.get_or_init(build))
}

/// What a call printed and how it ended.
#[derive(Debug)]
pub struct Said {
    /// The exit code; -1 after a signal.
    pub code: i32,
    /// The standard output.
    pub out: String,
    /// The standard error.
    pub err: String,
}

/// Runs `imu` with these arguments and an empty standard input.
///
/// # Panics
/// When the program cannot be started.
#[must_use]
pub fn run(arguments: &[&str]) -> Said {
    let output = imu().args(arguments).stdin(Stdio::null()).output();
    said(&output.expect("imu can be started"))
}

/// A finished call's words.
#[must_use]
pub fn said(output: &Output) -> Said {
    Said {
        code: output.status.code().unwrap_or(-1),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// Builds the program with the profile, and into the folder, of the test that is running: cargo
/// builds a package's program for its own tests only.
fn build() -> PathBuf {
    let test = std::env::current_exe().expect("a test knows its own path");
    // target/PROFILE/deps/test
    let folder = test.ancestors().nth(2).expect("tests stand in target/PROFILE/deps");
    let profile = if folder.ends_with("debug") { "test" } else { "release" };
    let target = folder.parent().expect("PROFILE stands in the target folder");
    let built = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--package", "imu-tools", "--bin", "imu"])
        .args(["--profile", profile, "--target-dir"])
        .arg(target)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo can be started");
    assert!(built.status.success(), "{}", said(&built).err);
    folder.join(format!("imu{}", std::env::consts::EXE_SUFFIX))
}
