//! One of several files: what a look into it shows before its turn comes.

use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::recording::{Block, ReadOptions, Sample, SampleKind, Source, open, timeline};

/// One of the files, of which the first block was read.
pub struct Part {
    path: PathBuf,
    /// First samples of gyroscope and accelerometer.
    pub first: [Option<Sample>; 2],
    /// Their rates, where the first block shows them.
    pub rates: [Option<f64>; 2],
    /// Length of the mean specific force, m/s².
    pub force: Option<f64>,
    /// What the file says that its samples are, where it does.
    pub samples: Option<SampleKind>,
    /// Length of the file, where that is known.
    pub bytes: Option<u64>,
    /// What cannot be opened again (a pipe) stays open, with its first block.
    held: Option<(Box<dyn Source>, Block)>,
}

impl Part {
    /// Looks into a file; `None` where it holds no sample.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Option<Self>, Error> {
        let mut source = open(path, options)?;
        let mut block = Block::default();
        loop {
            if !source.next_block(&mut block)? {
                return Ok(None);
            }
            if !block.gyroscope.is_empty() || !block.accelerometer.is_empty() {
                break;
            }
        }
        let lists = [&block.gyroscope, &block.accelerometer];
        let (first, rates) =
            (lists.map(|list| list.first().copied()), lists.map(|list| timeline::rate(list)));
        let force = mean_length(&block.accelerometer);
        let (samples, bytes) = (source.samples(), source.bytes_total());
        let again = path != Path::new("-") && (path.is_file() || path.is_dir());
        let held = if again { None } else { Some((source, block)) };
        Ok(Some(Self { path: path.to_owned(), first, rates, force, samples, bytes, held }))
    }

    /// The first stamp of either sensor.
    pub fn start(&self) -> i64 {
        let stamps = self.first.iter().flatten().map(|sample| sample.stamp_ns);
        stamps.min().unwrap_or(i64::MAX)
    }

    /// The file from its beginning, and its first block if that was read already.
    pub fn begin(self, options: &ReadOptions) -> Result<(Box<dyn Source>, Option<Block>), Error> {
        match self.held {
            Some((source, block)) => Ok((source, Some(block))),
            None => Ok((open(&self.path, options)?, None)),
        }
    }

    /// As messages call it.
    pub fn name(&self) -> String {
        name(&self.path)
    }
}

/// A file as messages call it.
pub fn name(path: &Path) -> String {
    match path.to_str() {
        Some("-") => "standard input".into(),
        _ => path.display().to_string(),
    }
}

/// Length of the mean of a sensor's finite samples; `None` without any.
fn mean_length(samples: &[Sample]) -> Option<f64> {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for sample in samples.iter().filter(|s| s.value.iter().all(|x| x.is_finite())) {
        for (sum, x) in sum.iter_mut().zip(sample.value) {
            *sum += x;
        }
        count += 1.0;
    }
    (count > 0.0).then(|| sum.iter().map(|x| x * x).sum::<f64>().sqrt() / count)
}
