//! What a reader makes of a PX4 log, for the tests of whole and of damaged ones.

use std::io::{Cursor, Read};
use std::path::Path;

use imu_tools::error::Error;
use imu_tools::recording::{self, Block, Note, ReadOptions, Sample, Stream};

/// What a log gave.
#[derive(Debug, Default, PartialEq)]
pub struct Outcome {
    /// All samples.
    pub samples: Block,
    /// What was told.
    pub notes: Vec<Note>,
    /// What there was.
    pub streams: Vec<Stream>,
    /// Where angular rates and specific forces were found.
    pub topics: [String; 2],
}

impl Outcome {
    /// What was told as a warning.
    #[must_use]
    pub fn warnings(&self) -> Vec<&str> {
        let warnings = self.notes.iter().filter_map(|note| match note {
            Note::Warning(text) => Some(text.as_str()),
            Note::Info(_) => None,
        });
        warnings.collect()
    }
}

/// With this topic asked for.
#[must_use]
pub fn topic(topic: &str) -> ReadOptions {
    ReadOptions { topic: Some(topic.into()), ..ReadOptions::default() }
}

/// Reads a log to its end.
///
/// # Errors
/// What the reader says.
///
/// # Panics
/// When a block is too long, or something follows the end.
pub fn read_stream(stream: Box<dyn Read + Send>, options: &ReadOptions) -> Result<Outcome, Error> {
    let mut source = recording::read_from(Path::new("a.ulg"), stream, options)?;
    let (mut outcome, mut block) = (Outcome::default(), Block::default());
    while source.next_block(&mut block)? {
        assert!(block.gyroscope.len().max(block.accelerometer.len()) <= recording::BLOCK_SAMPLES);
        outcome.samples.gyroscope.append(&mut block.gyroscope);
        outcome.samples.accelerometer.append(&mut block.accelerometer);
        outcome.samples.temperature.append(&mut block.temperature);
    }
    assert!(!source.next_block(&mut block)?, "the end is the end");
    outcome.notes = source.take_notes();
    outcome.streams = source.streams();
    outcome.topics = [source.gyroscope().into(), source.accelerometer().into()];
    Ok(outcome)
}

/// The same of bytes.
///
/// # Errors
/// What the reader says.
pub fn read(bytes: &[u8], options: &ReadOptions) -> Result<Outcome, Error> {
    read_stream(Box::new(Cursor::new(bytes.to_vec())), options)
}

/// The same, which must succeed.
///
/// # Panics
/// When the log is refused.
#[must_use]
pub fn read_plainly(bytes: &[u8]) -> Outcome {
    read(bytes, &ReadOptions::default()).expect("a log")
}

/// Exit code and words of the error.
///
/// # Panics
/// When the log is read.
#[must_use]
pub fn refusal(bytes: &[u8], options: &ReadOptions) -> (u8, String) {
    let error = read(bytes, options).expect_err("no log");
    (error.exit_code(), error.to_string())
}

/// What a plain log holds of instance `n`.
#[must_use]
pub fn expected(n: u8, count: u16) -> Block {
    let mut block = Block::default();
    for i in 0..count {
        let stamp_ns = 20_000_000_000 + 5_000_000 * i64::from(i);
        let (v, w) = (f64::from(i), f64::from(n));
        block.gyroscope.push(Sample { stamp_ns, value: [v, w, -v] });
        let value = [w, v, f64::from(9.8_f32)];
        block.accelerometer.push(Sample { stamp_ns: stamp_ns + 7000, value });
        let celsius = 40.0 + w;
        block.temperature.push(recording::Temperature { stamp_ns, celsius });
    }
    block
}
