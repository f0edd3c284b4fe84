//! Allan and Hadamard deviations of a column of numbers, as CSV.
//!
//! ```text
//! cargo run --release -p imu-tools --example allan_batch < values.txt
//! cargo run --release -p imu-tools --example allan_batch -- values.txt 1 2 4 10 100
//! ```
//! One value a line (evenly sampled rate, force or frequency; `#` starts a comment). Block lengths
//! in samples may follow the file's name; otherwise octaves. Deviations are in the values' unit,
//! with 17 digits; a field stays empty where the record is too short. `tests/peers/check_allan.py`
//! compares these columns with other programs.

use std::io::{self, Read, Write};

use anyhow::{Context, Result};
use imu_core::allan::Difference;
use imu_tools::calibrate::batch::Batch;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let text = match arguments.next().as_deref() {
        None | Some("-") => {
            let mut text = String::new();
            io::stdin().read_to_string(&mut text).context("cannot read standard input")?;
            text
        }
        Some(path) => {
            std::fs::read_to_string(path).with_context(|| format!("cannot read {path}"))?
        }
    };
    let values = text
        .lines()
        .enumerate()
        .map(|(i, line)| (i + 1, line.split('#').next().unwrap_or("").trim()))
        .filter(|(_, field)| !field.is_empty())
        .map(|(line, field)| {
            field.parse().with_context(|| format!("line {line}: {field:?} is not a number"))
        })
        .collect::<Result<Vec<f64>>>()?;
    let mut blocks = arguments
        .map(|m| m.parse().with_context(|| format!("{m:?} is not a number of samples")))
        .collect::<Result<Vec<usize>>>()?;
    let batch = Batch::new(&values).context("one of the values is not finite")?;
    if blocks.is_empty() {
        blocks = batch.octaves(Difference::Allan).collect();
    }
    let mut out = io::stdout().lock();
    writeln!(out, "m,adev,oadev,hdev,ohdev")?;
    for m in blocks {
        let field = |difference, stride| {
            batch
                .reading(difference, m, stride)
                .map_or_else(String::new, |reading| format!("{:.16e}", reading.deviation()))
        };
        let [adev, oadev] = [m, 1].map(|stride| field(Difference::Allan, stride));
        let [hdev, ohdev] = [m, 1].map(|stride| field(Difference::Hadamard, stride));
        writeln!(out, "{m},{adev},{oadev},{hdev},{ohdev}")?;
    }
    Ok(())
}
