//! The command line: one subcommand a file, each arguments in, calls, words out. No maths here.
//!
//! Results go to the standard output; a failure is one sentence, `imu: …`, on the standard error,
//! with exit code 2 for a mistake on the command line and 1 for everything else. A reader that
//! closes the pipe early (`imu … | head`) ends the program quietly.

mod calibrate;
mod convert;
mod demo;
mod info;
mod integrate;
mod live;
mod play;
mod progress;
mod reading;
mod results;
mod simulate;
mod spline;
mod terminal;
mod tradeoff;

use std::ffi::OsString;
use std::io;
use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::error::Error;
use crate::output;
use terminal::{print, say};

/// Calibrate an IMU's noise, or simulate one: from a recording to noise numbers to trust.
#[derive(Debug, Parser)]
#[command(name = "imu", version, arg_required_else_help = true)]
struct Imu {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Calibrate(calibrate::Calibrate),
    Convert(convert::Convert),
    Demo(demo::Demo),
    Info(info::Info),
    Integrate(integrate::Integrate),
    Live(live::Live),
    Simulate(simulate::Simulate),
    Spline(spline::Spline),
    Tradeoff(tradeoff::Tradeoff),
}

/// Runs the program on its own arguments.
#[must_use]
pub fn run() -> ExitCode {
    output::clean_up_on_signals();
    run_with(std::env::args_os())
}

fn run_with(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let command = match Imu::try_parse_from(arguments) {
        Ok(imu) => imu.command,
        Err(refusal) => return refuse(&refusal),
    };
    let result = match command {
        Command::Calibrate(calibrate) => calibrate.run(),
        Command::Convert(convert) => convert.run(),
        Command::Demo(demo) => demo.run(),
        Command::Info(info) => info.run(),
        Command::Integrate(integrate) => integrate.run(),
        Command::Live(live) => match live.exit() {
            Ok(Some(signal)) => return ExitCode::from(128_u8.saturating_add(signal as u8)),
            ended => ended.map(drop),
        },
        Command::Simulate(simulate) => simulate.run(),
        Command::Spline(spline) => spline.run(),
        Command::Tradeoff(tradeoff) => tradeoff.run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Error::Io { source, .. }) if source.kind() == io::ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Err(error) => {
            say(&format!("imu: {error}"));
            ExitCode::from(error.exit_code())
        }
    }
}

/// A file to be written as a person knows it.
fn target_name(path: &Path) -> String {
    match path.to_str() {
        Some("-") => "the pipe".into(),
        _ => path.display().to_string(),
    }
}

/// Whether two paths to be written lead to one file, through links or by other names of its folder,
/// or both to the standard output.
fn same_target(a: &Path, b: &Path) -> bool {
    let target = |path: &Path| match path.to_str() {
        Some("-") => output::target(Path::new("/dev/stdout")),
        _ => output::target(path),
    };
    a == b || target(a) == target(b)
}

/// Prints clap's help as it is, and its complaints as one sentence.
fn refuse(refusal: &clap::Error) -> ExitCode {
    use clap::error::ErrorKind::{
        DisplayHelp, DisplayHelpOnMissingArgumentOrSubcommand, DisplayVersion,
    };
    match refusal.kind() {
        DisplayHelp | DisplayVersion => {
            // A closed pipe is no failure of help.
            let _ = refusal.print();
            ExitCode::SUCCESS
        }
        DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = refusal.print();
            ExitCode::from(2)
        }
        _ => {
            say(&format!("imu: {}", sentence(&refusal.render().to_string())));
            ExitCode::from(2)
        }
    }
}

/// The first paragraph of clap's complaint, without its prefix, and where to read more.
fn sentence(complaint: &str) -> String {
    let lines = complaint.lines().map(str::trim).take_while(|line| !line.is_empty());
    let first = lines.collect::<Vec<_>>().join(" ");
    let first = first.strip_prefix("error: ").unwrap_or(&first);
    format!("{first}; --help shows what there is")
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn the_definition_of_the_command_line_holds_together() {
        Imu::command().debug_assert();
    }

    #[test]
    fn a_complaint_becomes_one_sentence() {
        let refusal = Imu::try_parse_from(["imu", "simulate", "--no-such-flag"]).unwrap_err();
        let said = sentence(&refusal.render().to_string());
        assert_eq!(said, "unexpected argument '--no-such-flag' found; --help shows what there is");
    }
}
