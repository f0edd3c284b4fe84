//! Every sample of a recording, to the bit: for comparison with what other programs read.
//!
//! Usage: `dump FILE [TOPIC]`. A line a sample: `g` (gyroscope), `a` (accelerometer) or `t`
//! (thermometer), stamp in nanoseconds, the bits of the values in hexadecimal, in SI units. What the
//! reader has to tell goes to the standard error.

use std::io::{self, BufWriter, Write as _};

use imu_tools::recording::{self, Block, Note, ReadOptions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or("Usage: dump FILE [TOPIC]")?;
    let options = ReadOptions { topic: arguments.next(), ..ReadOptions::default() };
    let mut source = recording::open(file.as_ref(), &options)?;
    let mut out = BufWriter::new(io::stdout().lock());
    let mut block = Block::default();
    while source.next_block(&mut block)? {
        for (letter, samples) in [('g', &block.gyroscope), ('a', &block.accelerometer)] {
            for sample in samples {
                let [x, y, z] = sample.value.map(f64::to_bits);
                writeln!(out, "{letter} {} {x:016x} {y:016x} {z:016x}", sample.stamp_ns)?;
            }
        }
        for reading in &block.temperature {
            writeln!(out, "t {} {:016x}", reading.stamp_ns, reading.celsius.to_bits())?;
        }
    }
    for note in source.take_notes() {
        match note {
            Note::Info(text) => eprintln!("note: {text}"),
            Note::Warning(text) => eprintln!("warning: {text}"),
        }
    }
    out.flush()?;
    Ok(())
}
