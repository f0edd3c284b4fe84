//! `imu live` killed outright at random moments and gone on with: how often a checkpoint is lost, and
//! whether the end is what an undisturbed run says.
//!
//! `cargo run --release -p imu-tests --example live_kills -- 100`
//!
//! A recording of 15 minutes at 200 Hz is replayed 60 times faster than it was recorded, with a checkpoint every
//! 50 ms. Whenever a replay comes to its end, its report is compared with that of `imu calibrate`, number by
//! number, and another begins.

use std::path::Path;
use std::process::{Child, Stdio};
use std::time::Duration;

use imu_tests::command::{imu, run, said};
use imu_tools::recording::{self, Block, Source as _};
use imu_tools::scene::{Preset, Scene, Simulator};
use serde_json::Value;

fn main() {
    let kills = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(100);
    let folder = tempfile::tempdir().expect("a folder for the recording");
    let path = folder.path().join("still.csv");
    record(&path);
    let wanted = numbers(&run(&["calibrate", &path.display().to_string(), "--json"]).out);
    let checkpoint = folder.path().join("c");
    let (mut killed, mut lost, mut rounds, mut wrong, mut number) = (0, 0, 0, 0, 1_u64);
    let mut resume = false;
    while killed < kills {
        let mut child = start(&path, &checkpoint, resume);
        // A generator of random moments needs no quality: 150 ms to 1.4 s.
        number =
            number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        std::thread::sleep(Duration::from_millis(150 + (number >> 33) % 1250));
        if child.try_wait().expect("a child").is_none() {
            child.kill().expect("a child");
            killed += 1;
            child.wait().expect("a child");
            resume = checkpoint.exists();
            continue;
        }
        let ended = said(&child.wait_with_output().expect("a child"));
        if ended.code == 0 {
            rounds += 1;
            wrong += u32::from(numbers(&ended.out) != wanted);
            resume = false;
            std::fs::remove_file(&checkpoint).expect("a checkpoint");
        } else {
            lost += 1;
            eprint!("{}", ended.err);
            resume = false;
        }
    }
    println!("kills                                   {killed}");
    println!("resumes refused                         {lost}");
    println!("replays that came to their end          {rounds}");
    println!("of these, with other numbers than offline {wrong}");
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

fn start(path: &Path, checkpoint: &Path, resume: bool) -> Child {
    let mut command = imu();
    command.arg("live").arg(path).args(["--json", "--speed", "60", "--checkpoint-every", "50ms"]);
    command.arg("--checkpoint").arg(checkpoint);
    command.arg(if resume { "--resume" } else { "--fresh" });
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("imu can be started")
}
