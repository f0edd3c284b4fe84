//! `imu live` killed outright at random moments and gone on with: how often a checkpoint is lost, and
//! whether the end is what an undisturbed run says.
//!
//! `cargo run --release -p imu-tests --example live_kills -- 100` (Linux; so many kills of each)
//!
//! A recording of 15 minutes at 200 Hz is replayed 60 times faster than it was recorded, with a checkpoint every
//! 50 ms. Whenever a replay comes to its end, and the last one does, its report is compared with that of
//! `imu calibrate`, number by number, and another begins.
//!
//! A sensor that streams 1 kHz in bursts of 16 ms goes on while nobody reads it. What it sent from the beginning to
//! the end is there or missing, each sample once.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use imu_tests::command::{imu, run, said};
use imu_tests::streams::Streaming;
use imu_tools::calibrate::Options;
use imu_tools::live::checkpoint;
use imu_tools::live::link::Link;
use imu_tools::live::session::{Before, Session};
use imu_tools::recording::{self, Block, Source as _};
use imu_tools::scene::{Preset, Scene, Simulator};
use serde_json::Value;

fn main() {
    let kills = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(100);
    let mut moments = Moments(1);
    replays(kills, &mut moments);
    streams(kills, &mut moments);
}

/// Random moments, for which a generator needs no quality.
struct Moments(u64);

impl Moments {
    /// 150 ms and up to `range_ms` more.
    fn next(&mut self, range_ms: u64) -> Duration {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        Duration::from_millis(150 + (self.0 >> 33) % range_ms)
    }
}

fn replays(kills: u32, moments: &mut Moments) {
    let folder = tempfile::tempdir().expect("a folder for the recording");
    let path = folder.path().join("still.csv");
    record(&path);
    let wanted = numbers(&run(&["calibrate", &path.display().to_string(), "--json"]).out);
    let checkpoint = folder.path().join("c");
    let (mut killed, mut lost, mut rounds, mut wrong) = (0, 0, 0, 0);
    let mut resume = false;
    // The last one that was killed is gone on with to its end.
    while killed < kills || resume {
        let mut child = start(&path, &checkpoint, resume, &["--speed", "60"]);
        if killed < kills {
            sleep(moments.next(1250));
            if child.try_wait().expect("a child").is_none() {
                kill(&mut child);
                killed += 1;
                resume = checkpoint.exists();
                continue;
            }
        }
        let ended = said(&child.wait_with_output().expect("a child"));
        resume = false;
        if ended.code == 0 {
            rounds += 1;
            wrong += u32::from(numbers(&ended.out) != wanted);
            std::fs::remove_file(&checkpoint).expect("a checkpoint");
        } else {
            lost += 1;
            eprint!("{}", ended.err);
        }
    }
    println!("replays killed                            {killed}");
    println!("resumes refused                           {lost}");
    println!("replays that came to their end            {rounds}");
    println!("of these, with other numbers than offline {wrong}");
}

fn streams(kills: u32, moments: &mut Moments) {
    const LINE: [&str; 4] = ["--baud", "115200", "--protocol", "imu-frame"];
    // Samples are held back for two seconds, until their clock is known.
    const SETTLED: Duration = Duration::from_secs(5);
    let folder = tempfile::tempdir().expect("a folder for checkpoints");
    let checkpoint = folder.path().join("c");
    let sensor = Streaming::start();
    let begun = sensor.sent();
    let (mut refused, mut fewer, mut kept) = (0, 0, 0);
    for number in 0..kills {
        let mut child = start(&sensor.device, &checkpoint, number > 0, &LINE);
        sleep(if number == 0 { SETTLED } else { moments.next(5850) });
        refused += u32::from(child.try_wait().expect("a child").is_some());
        kill(&mut child);
        let now = samples(&checkpoint);
        fewer += u32::from(now < kept);
        kept = now;
    }
    let child = start(&sensor.device, &checkpoint, true, &LINE);
    sleep(SETTLED);
    let pid = child.id().to_string();
    Command::new("kill").args(["-s", "INT", &pid]).status().expect("a signal");
    let [gyroscope, _] = numbers(&said(&child.wait_with_output().expect("a child")).out);
    // Up to its end: the last of them came too late.
    let sent = sensor.sent() - begun;
    let of = |name: &str| gyroscope[name].as_u64().expect("a count");
    println!("streams killed                            {kills}");
    println!("resumes refused                           {refused}");
    println!("checkpoints with fewer than the one before {fewer}");
    println!("samples sent                              {sent}");
    println!(
        "there, and missing in {:>3} gaps            {} + {} = {}",
        of("gap_count"),
        of("samples"),
        of("missing"),
        of("samples") + of("missing")
    );
    println!(
        "twice, backward, restarts                 {}, {}, {}",
        of("duplicates"),
        of("backward"),
        of("restarts")
    );
}

fn kill(child: &mut Child) {
    child.kill().expect("a child");
    child.wait().expect("a child");
}

/// Samples of the gyroscope that a checkpoint holds.
fn samples(path: &Path) -> u64 {
    let found = checkpoint::read(path).expect("a checkpoint").expect("a checkpoint");
    let session = Session::resume("it", &Options::default(), &found.payload, Before::IsPast);
    let view = session.expect("a session").view(&Link::default());
    view.snapshot.calibration.gyroscope.map_or(0, |sensor| sensor.stamps.samples)
}

fn record(path: &Path) {
    let scene = Scene { duration_ns: 900_000_000_000, ..Preset::Mid.scene() };
    let mut source = Simulator::new(&scene).expect("a scene");
    let mut sink = recording::create(path).expect("a recording");
    let mut block = Block::default();
    while source.next_block(&mut block).expect("a block") {
        sink.write_block(&block).expect("room");
    }
    sink.finish().expect("room");
}

/// Both sensors of a report, without their names.
fn numbers(report: &str) -> [Value; 2] {
    let last = report.trim().lines().last().unwrap_or_default();
    let text = if last.starts_with('{') { last } else { report };
    let mut report: Value = serde_json::from_str(text).expect("a report");
    ["gyroscope", "accelerometer"].map(|sensor| {
        let mut sensor = report[sensor].take();
        sensor["topic"] = Value::Null;
        sensor
    })
}

fn start(path: &Path, checkpoint: &Path, resume: bool, more: &[&str]) -> Child {
    let mut command = imu();
    command.arg("live").arg(path).args(["--json", "--checkpoint-every", "50ms"]).args(more);
    command.arg("--checkpoint").arg(checkpoint);
    command.arg(if resume { "--resume" } else { "--fresh" });
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("imu can be started")
}
