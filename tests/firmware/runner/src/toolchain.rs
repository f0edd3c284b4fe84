//! Finds a compiler for bare-metal Arm: one that has the targets, or one that can build `core`.

use crate::Result;
use crate::images::TARGETS;
use std::path::{Path, PathBuf};
use std::process::Command;

const LINKER: &str = "arm-none-eabi-ld";
const HOW_TO_GET_ONE: &str = "no Rust compiler for bare-metal Arm: run \
    `rustup target add thumbv7em-none-eabihf thumbv6m-none-eabi`, or, on Debian, \
    `apt-get install rustc-web cargo-web rust-web-src gcc-arm-none-eabi`";

/// A compiler for the images.
pub struct Toolchain {
    /// Its cargo.
    pub cargo: PathBuf,
    /// Its rustc.
    pub rustc: PathBuf,
    /// Whether `core` must be built, because only its source is there.
    pub build_core: bool,
    /// The linker, if not rustc's own.
    pub linker: Option<&'static str>,
    /// What the compiler calls itself.
    pub version: String,
}

/// The compiler in use if it has the targets or the source of `core`; else the one in `/usr/bin`.
pub fn find() -> Result<Toolchain> {
    let variable = |name: &str, default: &str| {
        std::env::var_os(name).map_or_else(|| PathBuf::from(default), PathBuf::from)
    };
    let linker = Command::new(LINKER).arg("--version").output().is_ok().then_some(LINKER);
    let candidates = [
        (variable("CARGO", "cargo"), variable("RUSTC", "rustc")),
        ("/usr/bin/cargo".into(), "/usr/bin/rustc".into()),
    ];
    for (cargo, rustc) in candidates {
        let Some(version) = output(&rustc, &["--version"]) else { continue };
        let has_targets = TARGETS.iter().all(|target| {
            output(&rustc, &["--print", "target-libdir", "--target", target.triple])
                .is_some_and(|dir| Path::new(&dir).is_dir())
        });
        let has_source = output(&rustc, &["--print", "sysroot"]).is_some_and(|root| {
            Path::new(&root).join("lib/rustlib/src/rust/library/core").is_dir()
        });
        if has_targets || (has_source && linker.is_some()) {
            return Ok(Toolchain { cargo, rustc, build_core: !has_targets, linker, version });
        }
    }
    Err(HOW_TO_GET_ONE.into())
}

fn output(program: &Path, arguments: &[&str]) -> Option<String> {
    let output =
        Command::new(program).args(arguments).env_remove("LD_LIBRARY_PATH").output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_string())
}
