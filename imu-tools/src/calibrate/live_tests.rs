//! A running calibration is the offline one, to the bit, however it is cut.

use super::*;
use crate::calibrate::calibrate;
use crate::recording::Source;
use crate::scene::{Preset, Scene, Simulator};

/// A quarter of an hour of 200 Hz with losses and jitter, a blow to the sensor, and a hole.
fn samples() -> Block {
    let scene = Scene { duration_ns: 900_000_000_000, ..Preset::Mid.scene() };
    let mut source = Simulator::new(&scene).unwrap();
    let (mut all, mut block) = (Block::default(), Block::default());
    while source.next_block(&mut block).unwrap() {
        all.gyroscope.extend(&block.gyroscope);
        all.accelerometer.extend(&block.accelerometer);
    }
    for list in [&mut all.gyroscope, &mut all.accelerometer] {
        let first = list[0].stamp_ns;
        let at = |s: &Sample| (s.stamp_ns - first) as f64 * 1e-9;
        let mut number = 0_u64;
        list.retain(|s| {
            number += 1;
            !number.is_multiple_of(97) && !(500.0..560.0).contains(&at(s))
        });
        for (k, sample) in list.iter_mut().enumerate() {
            if (400.0..420.0).contains(&((sample.stamp_ns - first) as f64 * 1e-9)) {
                sample.value[0] += 3.0 * (k as f64).sin();
            }
            sample.stamp_ns += (k as i64 * 7919) % 2_000_000;
        }
    }
    all
}

/// A recording in memory, in blocks of some size.
struct Kept(Block, usize);

impl Source for Kept {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        block.clear();
        for (from, to) in [
            (&mut self.0.gyroscope, &mut block.gyroscope),
            (&mut self.0.accelerometer, &mut block.accelerometer),
        ] {
            to.extend(from.drain(..self.1.min(from.len())));
        }
        Ok(!block.is_empty())
    }
    fn streams(&self) -> Vec<crate::recording::Stream> {
        Vec::new()
    }
    fn gyroscope(&self) -> &str {
        "it"
    }
    fn accelerometer(&self) -> &str {
        "it"
    }
    fn take_notes(&mut self) -> Vec<crate::recording::Note> {
        Vec::new()
    }
    fn bytes_read(&self) -> u64 {
        0
    }
    fn bytes_total(&self) -> Option<u64> {
        None
    }
}

/// All that is said of both sensors: numbers are printed with the digits that tell doubles apart.
fn told(calibration: &Calibration) -> String {
    format!("{:?} {:?}", calibration.gyroscope, calibration.accelerometer)
}

fn take(running: &mut Running, all: &Block, range: std::ops::Range<usize>) {
    let part =
        |list: &[Sample]| list[range.start.min(list.len())..range.end.min(list.len())].to_vec();
    running.push(&Block {
        gyroscope: part(&all.gyroscope),
        accelerometer: part(&all.accelerometer),
        ..Block::default()
    });
}

#[test]
fn running_is_calibrating_whatever_the_blocks_and_wherever_it_is_kept_and_read() {
    let all = samples();
    let options = Options { keep_signal: true, ..Options::default() };
    let offline = calibrate(Box::new(Kept(all.clone(), 4096)), "it", &options, |_| {}).unwrap();
    let wanted = told(&offline);
    let noise = offline.gyroscope.as_ref().unwrap();
    assert!(noise.stamps.missing > 6000 && !noise.disturbed.is_empty(), "{noise:?}");
    let length = all.gyroscope.len();
    // Nothing yet, while stamps are held back, the last and first of those, windows that wait, the blow,
    // the hole, after it.
    let cuts = [0, 1, 1000, 4095, 4096, 4097, 40_000, 79_400, 80_500, 98_980, 98_990, 104_000];
    for (piece, cuts) in [(length, &[][..]), (1, &cuts), (37, &cuts[..3]), (5000, &cuts[5..])] {
        let mut running = Running::new(&options);
        let mut at = 0;
        while at < length {
            let next = cuts.iter().copied().find(|cut| *cut > at).unwrap_or(length);
            let end = (at + piece).min(next);
            take(&mut running, &all, at..end);
            at = end;
            if cuts.contains(&at) {
                let before = running.to_bytes().unwrap();
                let _ = running.snapshot("it");
                assert_eq!(running.to_bytes().unwrap(), before, "a snapshot disturbs nothing");
                running = Running::from_bytes(&before, &options).unwrap();
            }
        }
        let told = told(&running.snapshot("it").calibration);
        assert_eq!(told, wanted, "pieces of {piece}");
    }
}

#[test]
fn a_restart_is_another_record() {
    let all = samples();
    let mut running = Running::new(&Options::default());
    take(&mut running, &all, 0..30_000);
    running.restart();
    take(&mut running, &all, 30_000..60_000);
    let noise = running.snapshot("it").calibration.gyroscope.unwrap();
    assert_eq!(noise.record_means.len(), 2);
    assert_eq!(running.samples()[0], 60_000.min(all.gyroscope.len() as u64));
}

#[test]
fn other_bytes_are_refused() {
    let bytes = Running::new(&Options::default()).to_bytes().unwrap();
    for bytes in [&bytes[..bytes.len() / 2], b"something else", b""] {
        assert!(Running::from_bytes(bytes, &Options::default()).is_err());
    }
}
