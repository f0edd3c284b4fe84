//! Several files as one recording.
//!
//! The files are put in order of their first stamps and read one after the other, each opened when
//! its turn comes. A file that goes on where the one before it ends is the same record, and what
//! lies between counts as missing. One that begins before the other ends, or more than an hour
//! after, is a record of its own ([`Source::record_number`]): another sensor or another day, whose bias
//! says nothing of the other's.

mod part;
mod refusal;

use std::path::PathBuf;

use super::sensor::Sensor;
use super::{Block, Note, ReadOptions, SampleKind, Source, Stream, add_streams};
use crate::error::Error;
use part::Part;

/// Whoever leaves a sensor for longer has switched it off: the limit of a
/// [`timeline`](super::timeline), in ns.
const LONGEST_GAP: i64 = 3_600_000_000_000;

/// Several files being read as one recording.
pub struct Joined {
    options: ReadOptions,
    /// Those to come, the next one last.
    parts: Vec<Part>,
    names: Vec<String>,
    /// The file being read.
    source: Box<dyn Source>,
    name: String,
    /// A block of it that was read already.
    first: Option<Block>,
    /// Last stamps of gyroscope and accelerometer so far in this record.
    last: [Option<i64>; 2],
    /// The names of each record's files.
    records: Vec<Vec<String>>,
    streams: Vec<Stream>,
    notes: Vec<Note>,
    /// Bytes of the files before this one, and of all.
    done: u64,
    total: Option<u64>,
    sensors: [String; 2],
    /// What all files say that their samples are.
    samples: Option<SampleKind>,
}

impl Joined {
    /// Looks into each of the files, and starts to read the earliest.
    ///
    /// # Errors
    /// As [`open`](super::open) for each of them; when one is named twice, when their rates differ, or when none
    /// holds a sample.
    pub fn open(paths: &[PathBuf], options: &ReadOptions) -> Result<Self, Error> {
        refusal::twice(paths)?;
        let mut notes = Vec::new();
        let mut parts: Vec<Part> = Vec::new();
        for path in paths {
            match Part::open(path, options)? {
                Some(part) => parts.push(part),
                None => notes.push(Note::Warning(format!(
                    "{} holds no samples and is left out",
                    part::name(path)
                ))),
            }
        }
        refusal::two_rates(&parts)?;
        refusal::two_units(&parts)?;
        parts.sort_by_key(Part::start);
        refusal::copies(&parts)?;
        let names = parts.iter().map(Part::name).collect();
        let total = parts.iter().map(|part| part.bytes).sum();
        let kind = parts.first().and_then(|part| part.samples);
        let samples = kind.filter(|_| parts.iter().all(|part| part.samples == kind));
        parts.reverse();
        let Some(part) = parts.pop() else {
            return Err(Error::data("none of these files holds a sample of an IMU"));
        };
        let own = part.name();
        let (source, first) = part.begin(options)?;
        let sensors = [source.gyroscope().to_owned(), source.accelerometer().to_owned()];
        Ok(Self {
            options: options.clone(),
            parts,
            names,
            source,
            records: vec![vec![own.clone()]],
            name: own,
            first,
            last: [None; 2],
            streams: Vec::new(),
            notes,
            done: 0,
            total,
            sensors,
            samples,
        })
    }

    /// The names of the files, by their first stamps.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Goes on to the next file; `false` after the last one.
    fn advance(&mut self) -> Result<bool, Error> {
        let Some(part) = self.parts.pop() else { return Ok(false) };
        self.close_file();
        let own = part.name();
        let starts = part.first.map(|first| first.map(|sample| sample.stamp_ns));
        let note = match gap(self.last, starts) {
            Some(gap) if gap < 0 => {
                Err(format!("{own} begins before {} ends: no difference spans both", self.name))
            }
            Some(gap) if gap > LONGEST_GAP => Err(format!(
                "{own} begins {:.1} h after {} ends: no difference spans both",
                gap as f64 / LONGEST_GAP as f64,
                self.name
            )),
            Some(gap) => {
                Ok(format!("{own} goes on {:.3} s after {} ends", gap as f64 * 1e-9, self.name))
            }
            None if overlap(self.last, starts) => {
                return Err(Error::data(format!(
                    "{} and {own} are of one time and have a sensor each: make one recording of \
                     both, such as a table with the columns of either, in which a field is empty \
                     where its sensor has no sample",
                    self.name
                )));
            }
            None => Err(format!(
                "{own} and {} have no sensor in common: no difference spans both",
                self.name
            )),
        };
        match &note {
            Ok(_) => {
                if let Some(record) = self.records.last_mut() {
                    record.push(own.clone());
                }
            }
            Err(_) => {
                self.records.push(vec![own.clone()]);
                self.last = [None; 2];
            }
        }
        self.notes.push(Note::Info(note.unwrap_or_else(|apart| apart)));
        (self.source, self.first) = part.begin(&self.options)?;
        self.name = own;
        let sensors = [self.source.gyroscope(), self.source.accelerometer()];
        for (sensor, (here, first)) in
            Sensor::BOTH.into_iter().zip(sensors.iter().zip(&mut self.sensors))
        {
            if first.is_empty() {
                (*here).clone_into(first);
            } else if !here.is_empty() && here != first {
                self.notes.push(Note::Info(format!(
                    "{}: the {} is {here}, where the first file has {first}",
                    self.name,
                    sensor.name()
                )));
            }
        }
        Ok(true)
    }

    /// Takes what there is to tell of the file that has ended.
    fn close_file(&mut self) {
        self.gather_notes();
        self.done += self.source.bytes_total().unwrap_or_else(|| self.source.bytes_read());
        add_streams(&mut self.streams, self.source.streams());
    }

    /// Takes the file's notes, and puts its name to those that do not say it.
    fn gather_notes(&mut self) {
        let name = &self.name;
        let named =
            |text: String| if text.contains(name) { text } else { format!("{name}: {text}") };
        for note in self.source.take_notes() {
            self.notes.push(match note {
                Note::Info(text) => Note::Info(named(text)),
                Note::Warning(text) => Note::Warning(named(text)),
            });
        }
    }
}

impl Source for Joined {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        loop {
            let more = match self.first.take() {
                Some(first) => {
                    *block = first;
                    true
                }
                None => self.source.next_block(block)?,
            };
            if more {
                let ends = [block.gyroscope.last(), block.accelerometer.last()];
                for (last, end) in self.last.iter_mut().zip(ends) {
                    *last = end.map(|sample| sample.stamp_ns).or(*last);
                }
                return Ok(true);
            }
            if !self.advance()? {
                return Ok(false);
            }
        }
    }

    fn streams(&self) -> Vec<Stream> {
        let mut streams = self.streams.clone();
        add_streams(&mut streams, self.source.streams());
        streams
    }

    fn gyroscope(&self) -> &str {
        let [gyroscope, _] = &self.sensors;
        gyroscope
    }

    fn accelerometer(&self) -> &str {
        let [_, accelerometer] = &self.sensors;
        accelerometer
    }

    fn take_notes(&mut self) -> Vec<Note> {
        self.gather_notes();
        std::mem::take(&mut self.notes)
    }

    fn samples(&self) -> Option<SampleKind> {
        self.samples
    }

    fn bytes_read(&self) -> u64 {
        self.done + self.source.bytes_read()
    }

    fn bytes_total(&self) -> Option<u64> {
        self.total
    }

    fn record_number(&self) -> usize {
        self.records.len().saturating_sub(1)
    }

    fn record_name(&self, record: usize) -> Option<String> {
        let several = self.records.len() > 1;
        self.records.get(record).filter(|_| several).map(|names| names.join(", "))
    }
}

/// Nanoseconds from the end of one file to the start of the next, by the sensor that has fewer;
/// `None` where no sensor is in both.
fn gap(last: [Option<i64>; 2], first: [Option<i64>; 2]) -> Option<i64> {
    let gaps = last.iter().zip(first);
    gaps.filter_map(|(last, first)| Some(first?.saturating_sub((*last)?))).min()
}

/// Whether one file begins before the other ends, whatever the sensor.
fn overlap(last: [Option<i64>; 2], first: [Option<i64>; 2]) -> bool {
    let (end, start) = (last.into_iter().flatten().max(), first.into_iter().flatten().min());
    start.zip(end).is_some_and(|(start, end)| start <= end)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::recording::{BLOCK_SAMPLES, Sample, create};

    const STEP: i64 = 10_000_000;

    /// `count` samples from `start_ns` on, of both sensors.
    fn samples(start_ns: i64, count: usize, bias: f64) -> Block {
        let mut block = Block::default();
        for i in 0..count {
            let stamp_ns = start_ns + i as i64 * STEP;
            block.gyroscope.push(Sample { stamp_ns, value: [bias, 0.0, i as f64] });
            block.accelerometer.push(Sample { stamp_ns, value: [0.0, i as f64, 9.81] });
        }
        block
    }

    fn write(path: &Path, block: &Block) {
        let mut sink = create(path).unwrap();
        sink.write_block(block).unwrap();
        sink.finish().unwrap();
    }

    /// Writes each block into a file of its own, and reads them in the order named.
    fn joined(blocks: &[Block], order: &[usize]) -> Result<(Joined, tempfile::TempDir), Error> {
        let folder = tempfile::tempdir().unwrap();
        let paths: Vec<_> =
            (0..blocks.len()).map(|i| folder.path().join(format!("{i}.bag"))).collect();
        for (path, block) in paths.iter().zip(blocks) {
            write(path, block);
        }
        let named: Vec<_> = order.iter().map(|&i| paths[i].clone()).collect();
        Joined::open(&named, &ReadOptions::default()).map(|joined| (joined, folder))
    }

    /// All samples, and the record of each block.
    fn read(joined: &mut Joined) -> (Block, Vec<usize>) {
        let (mut all, mut block, mut records) = (Block::default(), Block::default(), Vec::new());
        while joined.next_block(&mut block).unwrap() {
            assert!(block.gyroscope.len() <= BLOCK_SAMPLES);
            all.gyroscope.append(&mut block.gyroscope);
            all.accelerometer.append(&mut block.accelerometer);
            records.push(joined.record_number());
        }
        records.dedup();
        (all, records)
    }

    #[test]
    fn pieces_in_any_order_are_the_whole() {
        let start = 1_600_000_000_000_000_000;
        let parts = [0, 100, 300].map(|i| samples(start + i * STEP, 100, 0.0));
        for order in [[0, 1, 2], [2, 0, 1]] {
            let (mut joined, _folder) = joined(&parts, &order).unwrap();
            let (all, records) = read(&mut joined);
            assert_eq!(records, [0]);
            let stamps: Vec<_> = all.gyroscope.iter().map(|s| s.stamp_ns).collect();
            assert!(stamps.is_sorted() && stamps.len() == 300);
            assert_eq!(Some(joined.bytes_read()), joined.bytes_total());
            let streams = joined.streams();
            assert_eq!((streams.len(), streams[0].messages), (1, 300));
            let notes = joined.take_notes();
            let gaps =
                notes.iter().filter(|n| matches!(n, Note::Info(text) if text.contains("goes on")));
            assert_eq!(gaps.count(), 2, "{notes:?}");
            assert!(joined.names().is_sorted());
        }
    }

    #[test]
    fn overlaps_and_other_days_are_records_of_their_own() {
        let start = 1_600_000_000_000_000_000;
        for later in [50 * STEP, 3_700_000_000_000] {
            let parts = [samples(start, 100, 0.0), samples(start + later, 100, 1.0)];
            let (mut joined, _folder) = joined(&parts, &[0, 1]).unwrap();
            assert_eq!(joined.record_name(0), None);
            let (all, records) = read(&mut joined);
            assert_eq!((all.gyroscope.len(), records), (200, vec![0, 1]));
            assert!(joined.record_name(1).unwrap().ends_with("1.bag"));
        }
    }

    #[test]
    fn what_cannot_be_one_recording_is_refused() {
        let start = 1_600_000_000_000_000_000;
        let one = samples(start, 100, 0.0);
        let refused = |blocks: &[Block], order: &[usize]| {
            joined(blocks, order).map(drop).unwrap_err().to_string()
        };
        assert!(refused(std::slice::from_ref(&one), &[0, 0]).contains("is named twice"));
        assert!(
            refused(&[one.clone(), one.clone()], &[0, 1]).contains("begin with the same samples")
        );
        let mut faster = samples(start + 200 * STEP, 100, 0.0);
        for (i, sample) in faster.gyroscope.iter_mut().enumerate() {
            sample.stamp_ns = start + 200 * STEP + i as i64 * STEP / 2;
        }
        let said = refused(&[one, faster], &[0, 1]);
        assert!(said.contains("the gyroscope has 100.0 samples a second in"), "{said}");
        assert!(said.contains("200.0"), "{said}");
    }
}
