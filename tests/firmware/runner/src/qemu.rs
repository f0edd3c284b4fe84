//! Runs an image and reads what it prints.

use crate::Result;
use crate::ceilings::Figure;
use crate::images::Target;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

const QEMU: &str = "qemu-system-arm";

/// What an image reported.
#[derive(Default)]
pub struct Report {
    /// Each case's name and words.
    pub words: Vec<(String, Vec<u64>)>,
    /// Each figure.
    pub figures: Vec<Figure>,
}

/// Fails, and says how to get it, if there is no QEMU.
pub fn find() -> Result<()> {
    match Command::new(QEMU).arg("--version").output() {
        Ok(output) if output.status.success() => Ok(()),
        _ => Err("no qemu-system-arm: install QEMU's Arm system emulator (Debian: `apt-get \
                  install qemu-system-arm`; macOS: `brew install qemu`; others: qemu.org)"
            .into()),
    }
}

/// Runs an image to its end, one nanosecond of its time an instruction.
pub fn run(target: &Target, image: &Path) -> Result<Report> {
    let output = Command::new(QEMU)
        .args(target.machine)
        .args(["-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-icount", "shift=0,sleep=off"])
        .args(["-chardev", "stdio,id=out"])
        .args(["-semihosting-config", "enable=on,target=native,chardev=out"])
        .arg("-kernel")
        .arg(image)
        .output()
        .map_err(|e| format!("{QEMU}: {e}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        return Err(format!(
            "{} stopped on {} ({}): {}{}",
            image.display(),
            target.name,
            output.status,
            text.lines().last().unwrap_or_default(),
            String::from_utf8_lossy(&output.stderr)
        ));
    }
    let mut report = Report::default();
    for line in text.lines() {
        parse(line, target, &mut report)
            .ok_or_else(|| format!("{} on {} printed: {line}", image.display(), target.name))?;
    }
    Ok(report)
}

/// An image that runs, in real time, with its serial line on a terminal of the host.
pub struct Stream {
    qemu: Child,
    /// The terminal.
    pub port: String,
}

impl Stream {
    /// Starts an image.
    pub fn start(target: &Target, image: &Path) -> Result<Self> {
        let failed = |e| format!("{QEMU}: {e}");
        let mut qemu = Command::new(QEMU)
            .args(target.machine)
            .args(["-display", "none", "-monitor", "none", "-serial", "pty", "-kernel"])
            .arg(image)
            .stdout(Stdio::piped())
            .spawn()
            .map_err(failed)?;
        let said = qemu.stdout.take().map(BufReader::new);
        // "char device redirected to /dev/pts/3 (label serial0)"
        let port = said.into_iter().flat_map(|said| said.lines()).map_while(|line| line.ok());
        let port = port.filter_map(|line| {
            line.split(' ').find(|word| word.starts_with("/dev/")).map(str::to_owned)
        });
        match port.take(1).next() {
            Some(port) => Ok(Self { qemu, port }),
            None => {
                let _ = qemu.kill();
                Err(format!("{QEMU} names no terminal for the serial line"))
            }
        }
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        // It runs for ever.
        let _ = self.qemu.kill();
        let _ = self.qemu.wait();
    }
}

fn parse(line: &str, target: &Target, report: &mut Report) -> Option<()> {
    let (kind, rest) = line.split_once(' ').unwrap_or((line, ""));
    match kind {
        "case" => report.words.push((rest.into(), Vec::new())),
        "words" => {
            for word in rest.split(' ') {
                report.words.last_mut()?.1.push(u64::from_str_radix(word, 16).ok()?);
            }
        }
        "ticks" | "stack" | "state" => {
            let mut fields = rest.splitn(3, ' ');
            let value = f64::from(u32::from_str_radix(fields.next()?, 16).ok()?);
            let calls = f64::from(u32::from_str_radix(fields.next()?, 16).ok()?);
            let what = fields.next()?;
            let (value, what, unit) = match kind {
                "ticks" => {
                    (value * target.instructions_per_tick / calls, what.into(), "instructions")
                }
                _ => (value, format!("{what} {kind}"), "bytes"),
            };
            report.figures.push(Figure {
                target: target.name.into(),
                case: report.words.last()?.0.clone(),
                what,
                unit: unit.into(),
                value,
            });
        }
        "done" => {}
        _ => return None,
    }
    Some(())
}
