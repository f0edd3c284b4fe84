//! A recording into another format, every sample as it was.
//!
//! ```
//! use imu_tools::recording::{self, Block, Format, ReadOptions, Sample};
//!
//! let folder = tempfile::tempdir().unwrap();
//! let (bag, csv) = (folder.path().join("imu.bag"), folder.path().join("imu.csv"));
//! let mut sink = recording::create(&bag)?;
//! let sample = Sample { stamp_ns: 5_000_000, value: [0.1, 0.2, 0.3] };
//! sink.write_block(&Block { gyroscope: vec![sample], ..Block::default() })?;
//! sink.finish()?;
//!
//! let source = recording::open(&bag, &ReadOptions::default())?;
//! let sink = recording::create(&csv)?;
//! let converted = recording::convert(source, "imu.bag", sink, |_| {})?;
//! assert_eq!((converted.gyroscope, converted.accelerometer), (1, 0));
//! # Ok::<(), imu_tools::error::Error>(())
//! ```

use super::align::Aligner;
use super::{Block, Note, Sample, Sink, Source, Stream, TABLE, read_ahead};
use crate::error::Error;

/// What was written, and what was not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Converted {
    /// Samples of the gyroscope.
    pub gyroscope: u64,
    /// Samples of the accelerometer.
    pub accelerometer: u64,
    /// First and last stamp written, nanoseconds.
    pub span_ns: Option<(i64, i64)>,
    /// What was taken for granted.
    pub remarks: Vec<String>,
    /// What is wrong with the recording.
    pub warnings: Vec<String>,
    /// What the recording has and the new file has not, a sentence each.
    pub left_out: Vec<String>,
}

/// Writes all samples that `source` gives to `sink`, in order, and completes the file; `path` names
/// the recording in messages, and `progress` is told the bytes read now and then.
///
/// # Errors
/// What source and sink say; no sample; several records ([`Source::record_number`]) that overlap in time,
/// since one file holds one.
pub fn convert(
    source: Box<dyn Source>,
    path: &str,
    mut sink: Box<dyn Sink>,
    mut progress: impl FnMut(u64),
) -> Result<Converted, Error> {
    let mut converted = Converted::default();
    let (mut aligner, mut temperatures, mut record) = (Aligner::default(), 0, 0);
    let mut source = read_ahead(source, |block, at| {
        if at.record != record {
            record = at.record;
            sink.write_block(&std::mem::take(&mut aligner).finish())?;
            refuse_overlap(path, converted.span_ns, block)?;
        }
        converted.count(block);
        temperatures += block.temperature.len() as u64;
        sink.write_block(aligner.take(block))?;
        progress(at.bytes);
        Ok(())
    })?;
    sink.write_block(&aligner.finish())?;
    if converted.span_ns.is_none() {
        return Err(Error::data(format!(
            "{path} holds no sample that can be read: nothing was written"
        )));
    }
    for note in source.take_notes() {
        match note {
            Note::Info(text) => converted.remarks.push(text),
            Note::Warning(text) => converted.warnings.push(text),
        }
    }
    converted.left_out = left_out(&source.streams(), temperatures);
    sink.finish()?;
    Ok(converted)
}

impl Converted {
    fn count(&mut self, block: &Block) {
        self.gyroscope += block.gyroscope.len() as u64;
        self.accelerometer += block.accelerometer.len() as u64;
        for Sample { stamp_ns, .. } in block.gyroscope.iter().chain(&block.accelerometer) {
            let (first, last) = self.span_ns.unwrap_or((*stamp_ns, *stamp_ns));
            self.span_ns = Some((first.min(*stamp_ns), last.max(*stamp_ns)));
        }
    }
}

/// Two records of one time would be one muddle in one file.
fn refuse_overlap(path: &str, written: Option<(i64, i64)>, block: &Block) -> Result<(), Error> {
    let starts = [block.gyroscope.first(), block.accelerometer.first()];
    let start = starts.into_iter().flatten().map(|sample| sample.stamp_ns).min();
    match (written, start) {
        (Some((_, last)), Some(start)) if start <= last => Err(Error::data(format!(
            "{path} overlap in time, and one file cannot hold both: convert them one by one"
        ))),
        _ => Ok(()),
    }
}

/// What the recording has beyond samples of one IMU, a sentence each.
fn left_out(streams: &[Stream], temperatures: u64) -> Vec<String> {
    /// So many topics are named, the others counted.
    const NAMED: usize = 5;
    let mut sentences = Vec::new();
    if streams.iter().any(|stream| stream.used && stream.type_name.ends_with("/Imu")) {
        sentences.push(
            "orientation, covariances and frame of the messages, and the time at which they were \
             recorded, are not written"
                .to_owned(),
        );
    }
    if temperatures > 0 {
        sentences.push(format!("{temperatures} readings of a thermometer are not written"));
    }
    let left = streams.iter().filter(|stream| !stream.used && stream.messages > 0);
    let (columns, others): (Vec<&Stream>, Vec<&Stream>) = left.partition(|s| s.type_name == TABLE);
    for Stream { name, .. } in columns {
        sentences.push(format!("other columns of the table are not written: {name}"));
    }
    if !others.is_empty() {
        let messages: u64 = others.iter().map(|stream| stream.messages).sum();
        let mut names: Vec<&str> = others.iter().take(NAMED).map(|s| s.name.as_str()).collect();
        let more = format!("{} more", others.len().saturating_sub(NAMED));
        if others.len() > NAMED {
            names.push(&more);
        }
        let names = names.join(", ");
        sentences.push(format!("{messages} messages of other topics are not written: {names}"));
    }
    sentences
}
