//! The images: their targets, their build, the flash that they take.

use crate::toolchain::Toolchain;
use crate::{Result, panics};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A processor and the machine that QEMU runs it in.
pub struct Target {
    /// The name in the table of ceilings.
    pub name: &'static str,
    /// What rustc calls it.
    pub triple: &'static str,
    /// QEMU's arguments for a machine with this processor and 1 MB of each memory.
    pub machine: &'static [&'static str],
    /// Instructions in a tick of SysTick: 1 ns each, at the machine's processor clock.
    pub instructions_per_tick: f64,
}

/// The processors that the images are for.
pub const TARGETS: [Target; 2] = [
    Target {
        name: "M4F",
        triple: "thumbv7em-none-eabihf",
        machine: &["-machine", "mps2-an386"],
        // 25 MHz.
        instructions_per_tick: 40.0,
    },
    Target {
        name: "M0",
        triple: "thumbv6m-none-eabi",
        machine: &[
            "-machine",
            "microbit",
            "-global",
            "nrf51-soc.sram-size=1048576",
            "-global",
            "nrf51-soc.flash-size=4194304",
        ],
        // 16 MHz.
        instructions_per_tick: 62.5,
    },
];

/// Images of one function each, for the flash that it takes with all it needs.
pub const SINGLE: &[&str] = &["white_alone", "white_composed", "fit_only"];

/// The images of one target.
pub struct Built(PathBuf);

impl Built {
    /// The path of an image.
    pub fn image(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

/// Builds all images of a target.
pub fn build(
    toolchain: &Toolchain,
    target: &Target,
    folder: &Path,
    target_dir: &Path,
) -> Result<Built> {
    let output = cargo(toolchain, target, folder, target_dir, &[])?;
    if output.status.success() {
        return Ok(Built(target_dir.join(target.triple).join("release")));
    }
    let messages = String::from_utf8_lossy(&output.stderr);
    if !messages.contains(panics::SYMBOL) {
        return Err(format!("the images for {} do not build:\n{messages}", target.name));
    }
    let output = cargo(toolchain, target, folder, target_dir, &["--features", "find-panics"])?;
    let mut places = Vec::new();
    if output.status.success() {
        let built = Built(target_dir.join(target.triple).join("release"));
        for name in ["all"].iter().chain(SINGLE) {
            places.extend(panics::places(&built.image(name)));
        }
    }
    Err(format!(
        "a panic is reachable in the images for {}:\n{}",
        target.name,
        if places.is_empty() { messages.into_owned() } else { places.join("\n") }
    ))
}

fn cargo(
    toolchain: &Toolchain,
    target: &Target,
    folder: &Path,
    target_dir: &Path,
    extra: &[&str],
) -> Result<Output> {
    let mut flags = vec![format!("-Clink-arg=-T{}", folder.join("image/link.x").display())];
    if let Some(linker) = toolchain.linker {
        flags.push(format!("-Clinker={linker}"));
        flags.push("-Clinker-flavor=ld".into());
    }
    let mut command = Command::new(&toolchain.cargo);
    command
        .args(["build", "--quiet", "--release", "--package", "firmware-image"])
        .args(["--target", target.triple])
        .arg("--manifest-path")
        .arg(folder.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(target_dir)
        .args(extra)
        .env("RUSTC", &toolchain.rustc)
        .env("CARGO_ENCODED_RUSTFLAGS", flags.join("\x1f"))
        .env_remove("RUSTFLAGS")
        .env_remove("LD_LIBRARY_PATH");
    if toolchain.build_core {
        // The source of `core` belongs to this very compiler, stable or not.
        command.arg("-Zbuild-std=core").env("RUSTC_BOOTSTRAP", "1");
    }
    command.output().map_err(|e| format!("{}: {e}", toolchain.cargo.display()))
}

/// The bytes that an image puts into flash: code, constants, initial values.
pub fn flash_bytes(image: &Path) -> Result<u32> {
    let file = std::fs::read(image).map_err(|e| format!("{}: {e}", image.display()))?;
    allocated(&file).ok_or_else(|| format!("{} is no 32-bit ELF file", image.display()))
}

/// The sizes of a 32-bit little-endian ELF file's sections that have contents and are loaded.
fn allocated(file: &[u8]) -> Option<u32> {
    const ALLOCATED: u32 = 2;
    const NO_CONTENTS: u32 = 8;
    let half = |at: usize| Some(u16::from_le_bytes(file.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(file.get(at..at + 4)?.try_into().ok()?));
    let (table, entry, entries) = (word(32)? as usize, half(46)? as usize, half(48)? as usize);
    let mut bytes = 0;
    for section in (0..entries).map(|index| table + index * entry) {
        if word(section + 8)? & ALLOCATED != 0 && word(section + 4)? != NO_CONTENTS {
            bytes += word(section + 20)?;
        }
    }
    Some(bytes)
}
