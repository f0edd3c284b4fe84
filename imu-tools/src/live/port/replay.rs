//! A recording in the place of a sensor, as fast as it was recorded, faster, or as fast as can be.

use std::path::Path;
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

use super::{Arrival, How};
use crate::error::Error;
use crate::recording::{self, Block, Sample, Source};

/// Real time between pieces of a replay that keeps time.
const PACE: Duration = Duration::from_millis(50);

/// Opens the recording, and begins to read.
pub(super) fn open(path: &Path, how: &How, to: SyncSender<Arrival>) -> Result<(), Error> {
    let source = recording::open(path, &how.reading)?;
    let (speed, again_ns) = (how.speed, how.again_ns);
    std::thread::spawn(move || {
        let told = match play(source, speed, again_ns, &to) {
            None => return,
            Some(Ok(())) => Arrival::End,
            Some(Err(error)) => Arrival::Failed(error),
        };
        // Nobody may listen any more.
        let _ = to.send(told);
    });
    Ok(())
}

/// Hands all blocks on, what is stamped up to `again_ns` at once; `None` when nobody listens.
fn play(
    mut source: Box<dyn Source>,
    speed: f64,
    again_ns: Option<i64>,
    to: &SyncSender<Arrival>,
) -> Option<Result<(), Error>> {
    let mut start = None;
    loop {
        let mut block = Block::default();
        let more = source.next_block(&mut block);
        for note in source.take_notes() {
            to.send(Arrival::Note(note)).ok()?;
        }
        match more {
            Err(error) => return Some(Err(error)),
            Ok(false) => return Some(Ok(())),
            Ok(true) if speed > 0.0 => {
                let samples = source.samples().unwrap_or_default();
                if let Some(again_ns) = again_ns {
                    let again = before(&mut block, again_ns);
                    to.send(Arrival::Samples(again, samples)).ok()?;
                }
                let (began, first_ns) = match (start, block.first_ns()) {
                    (Some(start), _) => start,
                    (None, Some(first_ns)) => (Instant::now(), first_ns),
                    (None, None) => continue,
                };
                start = Some((began, first_ns));
                while !block.is_empty() {
                    let passed = began.elapsed().as_secs_f64() * speed * 1e9;
                    let now = before(&mut block, first_ns.saturating_add(passed as i64));
                    if !now.is_empty() {
                        to.send(Arrival::Samples(now, samples)).ok()?;
                    }
                    std::thread::sleep(PACE);
                }
            }
            Ok(true) => {
                let samples = source.samples().unwrap_or_default();
                to.send(Arrival::Samples(block, samples)).ok()?;
            }
        }
    }
}

/// Takes out of a block what is stamped up to `until_ns`.
fn before(block: &mut Block, until_ns: i64) -> Block {
    let split = |list: &mut Vec<Sample>| {
        let later = list.iter().position(|sample| sample.stamp_ns > until_ns);
        list.drain(..later.unwrap_or(list.len())).collect()
    };
    let gyroscope = split(&mut block.gyroscope);
    let accelerometer = split(&mut block.accelerometer);
    let later = block.temperature.iter().position(|t| t.stamp_ns > until_ns);
    let temperature = block.temperature.drain(..later.unwrap_or(block.temperature.len())).collect();
    Block { gyroscope, accelerometer, temperature, ..Block::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Preset, Scene, Simulator};

    /// An hour at the speed of its recording, of which all but the end was taken before.
    #[test]
    fn what_was_taken_before_comes_at_once() {
        let scene = Scene { start_ns: 0, duration_ns: 3_600_000_000_000, ..Preset::Mid.scene() };
        let source = Box::new(Simulator::new(&scene).unwrap());
        let (to, arrivals) = std::sync::mpsc::sync_channel(1024);
        std::thread::spawn(move || play(source, 1.0, Some(3_599_900_000_000), &to));
        let mut samples = 0;
        for arrival in arrivals {
            if let Arrival::Samples(block, _) = arrival {
                samples += block.gyroscope.len();
            }
        }
        assert_eq!(samples, 720_000);
    }
}
