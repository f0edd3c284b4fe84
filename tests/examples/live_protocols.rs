//! An hour at 1 kHz through every protocol: bytes, decoder, clock and session against `calibrate` offline.
//!
//! `cargo run --release -p imu-tests --example live_protocols`
//!
//! Bytes are read when a timer of 16 ms fires, as USB adapters do. Two comparisons, of N and K of all axes of
//! both sensors: with the calibration of the very samples that came out of the decoder, bit for bit; and with
//! that of the scene, whose samples the protocol rounds and whose stamps the clock found again. Protocols that
//! have increments send the scene once more as such.

use imu_core::allan::Parameter;
use imu_tools::calibrate::{Calibration, Options, calibrate};
use imu_tools::error::Error;
use imu_tools::live::intake::Intake;
use imu_tools::live::link::Link;
use imu_tools::live::protocol::{Encoder, Protocol};
use imu_tools::live::run::{Decode as _, Step};
use imu_tools::live::session::Session;
use imu_tools::live::{Count, Kind, Message, Ticks};
use imu_tools::recording::{Block, Note, ReadOptions, Source, Stream};
use imu_tools::scene::{Preset, Rate, Scene, Simulator};

/// Between two readings of the line.
const BURST_NS: i64 = 16_000_000;

/// Between two samples.
const PERIOD_S: f64 = 1e-3;

fn main() {
    let scene = Scene {
        duration_ns: 3_600_000_000_000,
        rate: Rate::from_hz(1000.0).expect("a rate"),
        ..Preset::Mid.scene()
    };
    let source = Box::new(Simulator::new(&scene).expect("a scene"));
    let offline = calibrate(source, "it", &Options::default(), |_| {}).expect("a calibration");
    println!(
        "protocol,of,messages,lost,as offline of the decoded samples,N off the scene's,K off it"
    );
    let kinds =
        [("rates", Kind::Rates), ("increments", Kind::Increments { over_s: Some(PERIOD_S) })];
    let sent = Protocol::ALL.into_iter().flat_map(|protocol| kinds.map(|kind| (protocol, kind)));
    for (protocol, (name, kind)) in
        sent.filter(|(protocol, (_, kind))| Encoder::can_send(*protocol, *kind))
    {
        let (live, decoded, link) = listen(protocol, kind, &scene);
        let again = calibrate(Box::new(Kept::new(decoded)), "it", &Options::default(), |_| {});
        let same = numbers(&live) == numbers(&again.expect("a calibration"));
        let [n, k] = furthest(&live, &offline);
        let lost = link.clock.map_or(0, |clock| clock.lost);
        println!(
            "{protocol},{name},{},{lost},{},{n:.1e},{k:.1e}",
            link.messages,
            if same { "bit for bit" } else { "NOT the same" }
        );
    }
}

/// What a session says of a scene that a sensor sends, the samples it took, and the way.
fn listen(protocol: Protocol, kind: Kind, scene: &Scene) -> (Calibration, Vec<Block>, Link) {
    let times = if kind == Kind::Rates { 1.0 } else { PERIOD_S };
    let mut source = Simulator::new(scene).expect("a scene");
    let (mut encoder, mut block) = (Encoder::new(protocol), Block::default());
    let mut intake = Intake::new("it", Some(protocol), &ReadOptions::default()).expect("an intake");
    let mut session = Session::new("it", &Options::default());
    let (mut bytes, mut steps, mut decoded) = (Vec::new(), Vec::new(), Vec::new());
    let (mut number, mut read_ns) = (0_u32, None);
    let mut take = |steps: &mut Vec<Step>| {
        for step in steps.drain(..) {
            let Step::Samples(mut block, _) = step else { panic!("nothing began anew") };
            session.take(&mut block);
            decoded.push(block);
        }
    };
    while source.next_block(&mut block).expect("a block") {
        for (gyroscope, accelerometer) in block.gyroscope.iter().zip(&block.accelerometer) {
            let sent_ns = gyroscope.stamp_ns;
            let fires_ns = (sent_ns / BURST_NS + 1) * BURST_NS;
            if let Some(arrival_ns) = read_ns.replace(fires_ns).filter(|at| *at != fires_ns) {
                intake.feed(arrival_ns, &bytes, &mut steps).expect("a known protocol");
                bytes.clear();
                take(&mut steps);
            }
            let message = Message {
                gyroscope: Some(gyroscope.value.map(|rate| rate * times)),
                accelerometer: Some(accelerometer.value.map(|force| force * times)),
                kind,
                ticks: Some(Ticks {
                    value: sent_ns as u64,
                    per_second: 1_000_000_000,
                    wraps_at: None,
                }),
                count: Some(Count { value: number, wraps_at: 1 << 32 }),
                celsius: Some(25.0),
                ..Message::default()
            };
            encoder.encode(&message, &mut bytes);
            number += 1;
        }
    }
    intake.feed(read_ns.unwrap_or_default(), &bytes, &mut steps).expect("a known protocol");
    intake.finish(&mut steps).expect("a known protocol");
    take(&mut steps);
    let mut link = Link::default();
    intake.tell(&mut link);
    (session.view(&link).snapshot.calibration, decoded, link)
}

/// N and K of each axis of both sensors.
fn numbers(calibration: &Calibration) -> Vec<[Parameter; 2]> {
    let sensors = [&calibration.gyroscope, &calibration.accelerometer];
    let axes = sensors.into_iter().flatten().flat_map(|sensor| &sensor.axes);
    axes.map(|axis| [axis.noise_density, axis.random_walk]).collect()
}

/// The largest relative differences of N and of K, of those that can be seen at all; not a number where only
/// one of the two sees it.
fn furthest(live: &Calibration, offline: &Calibration) -> [f64; 2] {
    let off = |pair: (Parameter, Parameter)| match pair {
        (Parameter::Observable { value: a, .. }, Parameter::Observable { value: b, .. }) => {
            (a / b - 1.0).abs()
        }
        (Parameter::Observable { .. }, _) | (_, Parameter::Observable { .. }) => f64::NAN,
        _ => 0.0,
    };
    let (live, offline) = (numbers(live), numbers(offline));
    [0, 1].map(|which| {
        let off = live.iter().zip(&offline).map(|(a, b)| off((a[which], b[which])));
        off.fold(0.0, |most: f64, off| if off > most || off.is_nan() { off } else { most })
    })
}

/// Samples that were kept, as a recording.
struct Kept(std::vec::IntoIter<Block>);

impl Kept {
    fn new(blocks: Vec<Block>) -> Self {
        Self(blocks.into_iter())
    }
}

impl Source for Kept {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        let next = self.0.next();
        let there = next.is_some();
        *block = next.unwrap_or_default();
        Ok(there)
    }

    fn streams(&self) -> Vec<Stream> {
        Vec::new()
    }

    fn gyroscope(&self) -> &str {
        "it"
    }

    fn accelerometer(&self) -> &str {
        "it"
    }

    fn take_notes(&mut self) -> Vec<Note> {
        Vec::new()
    }

    fn bytes_read(&self) -> u64 {
        0
    }

    fn bytes_total(&self) -> Option<u64> {
        None
    }
}
