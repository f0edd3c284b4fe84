//! `imu live` as a user runs it: the numbers of `imu calibrate`, whatever happens on the way.

use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::Duration;

use imu_tests::command::{imu, run, said};
#[cfg(target_os = "linux")]
use imu_tests::streams::Streaming;
use imu_tools::calibrate::{Options, calibrate};
use imu_tools::live::link::Link;
use imu_tools::live::session::Session;
use imu_tools::recording::{self, Block, ReadOptions, Source as _};
use imu_tools::scene::{Preset, Rate, Scene, Simulator};
use serde_json::Value;

/// A recording of some minutes at 200 Hz, with a stretch in which the sensor is shaken.
fn recording(folder: &Path, minutes: u64) -> PathBuf {
    let path = folder.join("still.csv");
    let scene = Scene { duration_ns: minutes * 60_000_000_000, ..Preset::Mid.scene() };
    let mut source = Simulator::new(&scene).unwrap();
    let mut sink = recording::create(&path).unwrap();
    let (mut block, mut number) = (Block::default(), 0_u32);
    while source.next_block(&mut block).unwrap() {
        for sample in &mut block.gyroscope {
            number += 1;
            if (60_000..62_000).contains(&number) {
                sample.value[1] += 0.5 * f64::from(number).sin();
            }
        }
        sink.write_block(&block).unwrap();
    }
    sink.finish().unwrap();
    path
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// The last line of a live session, and what calibration says, without the sensors' names.
fn sensors(report: &str) -> (Value, Value) {
    let line = report.trim().lines().last().unwrap_or_default();
    let whole = if line.starts_with('{') { line } else { report };
    let mut report: Value = serde_json::from_str(whole).expect(report);
    for sensor in ["gyroscope", "accelerometer"] {
        report[sensor]["topic"] = Value::Null;
    }
    (report["gyroscope"].take(), report["accelerometer"].take())
}

fn calibrated(path: &Path) -> (Value, Value) {
    let said = run(&["calibrate", text(path), "--json"]);
    assert_eq!(said.code, 0, "{}", said.err);
    sensors(&said.out)
}

#[test]
fn an_hour_at_1_khz_is_what_calibration_says_bit_for_bit() {
    let scene = Preset::Mid.scene();
    let scene =
        Scene { duration_ns: 3_600_000_000_000, rate: Rate::from_hz(1000.0).unwrap(), ..scene };
    let options = Options::default();
    let source = Box::new(Simulator::new(&scene).unwrap());
    let offline = calibrate(source, "it", &options, |_| {}).unwrap();
    let mut session = Session::new("it", &options);
    let (mut source, mut block) = (Simulator::new(&scene).unwrap(), Block::default());
    let mut blocks = 0;
    while source.next_block(&mut block).unwrap() {
        // What a port hands over has any length.
        let mut first = Block::default();
        let at = (blocks * 977) % (block.gyroscope.len() + 1);
        first.gyroscope.extend(block.gyroscope.drain(..at));
        first.accelerometer.extend(block.accelerometer.drain(..at));
        session.take(&mut first);
        session.take(&mut block);
        blocks += 1;
    }
    let live = session.view(&Link::default()).snapshot.calibration;
    for (live, offline) in
        [(live.gyroscope, offline.gyroscope), (live.accelerometer, offline.accelerometer)]
    {
        let (live, offline) = (live.unwrap(), offline.unwrap());
        assert_eq!(live.stamps.samples, 3_600_000);
        assert_eq!((live.axes, live.pooled), (offline.axes, offline.pooled));
        assert_eq!(live.deviation, offline.deviation);
    }
}

#[test]
fn a_replay_ends_with_the_report_of_calibrate() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), 15);
    let live = run(&["live", text(&path), "--json"]);
    assert_eq!(live.code, 0, "{}", live.err);
    assert_eq!(sensors(&live.out), calibrated(&path));
    for line in live.out.lines() {
        let line: Value = serde_json::from_str(line).unwrap();
        assert!(matches!(line["kind"].as_str(), Some("status" | "report")));
    }
    let (table, plain) = (run(&["calibrate", text(&path)]), run(&["live", text(&path)]));
    let numbers =
        |out: &str| out.lines().filter(|l| l.starts_with("    ")).collect::<Vec<_>>().join("\n");
    assert_eq!(numbers(&plain.out), numbers(&table.out));
}

#[test]
fn it_ends_by_itself_when_it_is_enough() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), 15);
    let out = folder.path().join("out");
    let live = run(&["live", text(&path), "--for", "5min", "--json", "-o", text(&out)]);
    assert_eq!(live.code, 0, "{}", live.err);
    let (gyroscope, _) = sensors(&live.out);
    // Blocks of the reader are 20 s long.
    let span = gyroscope["span_s"].as_f64().unwrap();
    assert!((300.0..321.0).contains(&span), "{span}");
    assert!(out.join("report.html").exists() && out.join("imu.yaml").exists());
    // Both N and K of a sensor of which a quarter of an hour shows K to a half.
    let live = run(&["live", text(&path), "--until", "80%", "--json"]);
    let (gyroscope, _) = sensors(&live.out);
    assert!(gyroscope["span_s"].as_f64().unwrap() < 890.0, "{gyroscope}");
}

/// Checkpoints all the time.
const OFTEN: [&str; 2] = ["--checkpoint-every", "50ms"];

/// Waits until a file has so many bytes.
fn wait_for(path: &Path, bytes: u64) {
    while std::fs::metadata(path).map_or(true, |there| there.len() < bytes) {
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Starts a replay.
fn start(path: &Path, checkpoint: &Path, more: &[&str]) -> Child {
    imu()
        .args(["live", text(path), "--json", "--checkpoint", text(checkpoint)])
        .args(more)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

#[test]
fn killed_again_and_again_it_loses_and_doubles_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), 15);
    let checkpoint = folder.path().join("c");
    let speed = ["--speed", "200"];
    for (round, wait_ms) in [150, 650, 377, 520].into_iter().enumerate() {
        let resume: &[&str] = if round > 0 { &["--resume"] } else { &[] };
        let mut child = start(&path, &checkpoint, &[&speed, &OFTEN, resume].concat());
        wait_for(&checkpoint, 1);
        std::thread::sleep(Duration::from_millis(wait_ms));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let last = said(&start(&path, &checkpoint, &["--resume"]).wait_with_output().unwrap());
    assert_eq!(last.code, 0, "{}", last.err);
    assert_eq!(sensors(&last.out), calibrated(&path));
}

#[cfg(unix)]
#[test]
fn a_signal_leaves_a_checkpoint_and_whole_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), 15);
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        if signal == "HUP" && hang_ups_are_ignored() {
            continue;
        }
        let checkpoint = folder.path().join(format!("c-{signal}"));
        let record = folder.path().join(format!("r-{signal}.bag"));
        let more = ["--speed", "60", "--record", text(&record), "--checkpoint-every", "1h"];
        let child = start(&path, &checkpoint, &more);
        wait_for(&record, 100_000);
        let pid = child.id().to_string();
        assert!(
            std::process::Command::new("kill")
                .args(["-s", signal, &pid])
                .status()
                .unwrap()
                .success()
        );
        let ended = said(&child.wait_with_output().unwrap());
        assert_eq!(ended.code, code, "{}", ended.err);
        let resumed = said(&start(&path, &checkpoint, &["--resume"]).wait_with_output().unwrap());
        assert_eq!(sensors(&resumed.out), calibrated(&path), "{signal}");
        let info = run(&["info", text(&record)]);
        assert!(info.code == 0 && !info.err.contains("cut off"), "{}", info.err);
    }
}

/// Under `nohup` programs start with hang-ups ignored, and so they stay.
#[cfg(unix)]
fn hang_ups_are_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).is_ok_and(|mask| mask & 1 == 1))
}

#[test]
fn a_recording_outlives_the_program_that_writes_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), 15);
    for ending in ["bag", "mcap", "csv"] {
        let checkpoint = folder.path().join(format!("c-{ending}"));
        let record = folder.path().join(format!("r.{ending}"));
        let more = ["--speed", "60", "--record", text(&record)];
        let mut child = start(&path, &checkpoint, &[&more[..], &OFTEN].concat());
        wait_for(&record, 500_000);
        wait_for(&checkpoint, 1);
        child.kill().unwrap();
        child.wait().unwrap();
        let mut source = recording::open(&record, &ReadOptions::default()).unwrap();
        let (mut block, mut samples) = (Block::default(), 0);
        while source.next_block(&mut block).unwrap() {
            samples += block.gyroscope.len();
        }
        // A sample is no longer than 400 bytes in any of the formats.
        assert!(samples > 1200, "{ending}: {samples}");
        let mut again = start(&path, &checkpoint, &["--resume", "--record", text(&record)]);
        assert!(again.wait().unwrap().success());
        assert!(folder.path().join(format!("r-2.{ending}")).exists(), "the first one is kept");
    }
}

#[test]
fn a_session_that_was_interrupted_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), 2);
    let checkpoint = folder.path().join("c");
    let mut child = start(&path, &checkpoint, &[&["--speed", "10"][..], &OFTEN].concat());
    wait_for(&checkpoint, 1);
    child.kill().unwrap();
    child.wait().unwrap();
    let refused = said(&start(&path, &checkpoint, &[]).wait_with_output().unwrap());
    assert_eq!(refused.code, 2);
    assert!(
        refused.err.contains("say --resume to go on with it, --fresh to begin anew"),
        "{}",
        refused.err
    );
    let fresh = said(&start(&path, &checkpoint, &["--fresh"]).wait_with_output().unwrap());
    assert_eq!(fresh.code, 0, "{}", fresh.err);
    // It has ended as it should: another one may begin.
    assert!(start(&path, &checkpoint, &[]).wait().unwrap().success());
    // A damaged checkpoint falls back to the one before, and says so.
    let mut bytes = std::fs::read(&checkpoint).unwrap();
    bytes[100] ^= 1;
    std::fs::write(&checkpoint, bytes).unwrap();
    let resumed = said(&start(&path, &checkpoint, &["--resume"]).wait_with_output().unwrap());
    assert!(resumed.err.contains("the one before it") && resumed.code == 0, "{}", resumed.err);
}

#[test]
fn what_cannot_be_is_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let path = recording(folder.path(), 1);
    for (arguments, code, words) in [
        (&["live", "/dev/no-such-port"][..], 1, "there is no port or recording /dev/no-such-port"),
        (&["live", "tcp://localhost"], 2, "write it as tcp://host:4000"),
        (&["live", text(&path), "--until", "0"], 2, "a part such as 10%"),
        (
            &["live", text(&path), "--resume", "--checkpoint", text(&folder.path().join("c"))],
            1,
            "there is no checkpoint",
        ),
        (&["live", "-", "--raw", "q", "--record", "q"], 2, "--record and --raw name the same"),
        (&["live", ""], 2, "no port is named"),
        (&["live", text(&path), "--raw", "q"], 2, "--raw is for bytes of a sensor, and"),
        (&["live", "-", "--speed", "2"], 2, "--speed is for a recording, and the pipe is none"),
        (
            &["live", "-", "--protocol", "xsens", "--gyro-unit", "deg/s"],
            2,
            "--gyro-unit is for lines of text, and xsens tells that itself",
        ),
        (
            &["live", text(&path), "--fresh", "--checkpoint", text(&path)],
            2,
            "is no checkpoint, and is not replaced",
        ),
        (&["live", text(&path), "-o", text(&path)], 1, "cannot make the folder"),
        (
            &["live", text(&path), "--checkpoint", "/no/such"],
            1,
            "cannot write the checkpoint /no/such",
        ),
        (&["live", text(&path), "--record", "a.txt"], 2, "cannot tell the format"),
        (&["live", text(&path), "--record", "/no/such/a.bag"], 1, "no such file or folder"),
    ] {
        let said = run(arguments);
        assert_eq!((said.code, said.err.lines().count()), (code, 1), "{arguments:?}: {}", said.err);
        assert!(said.err.contains(words), "{}", said.err);
    }
}

#[test]
fn two_sessions_do_not_share_a_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let (path, checkpoint) = (recording(folder.path(), 2), folder.path().join("c"));
    let mut first = start(&path, &checkpoint, &["--speed", "1"]);
    wait_for(&folder.path().join("c.part"), 0);
    for more in [&[][..], &["--fresh"], &["--resume"]] {
        let second = said(&start(&path, &checkpoint, more).wait_with_output().unwrap());
        assert_eq!(second.code, 1);
        assert!(second.err.contains("another imu live keeps its checkpoints in"), "{}", second.err);
    }
    first.kill().unwrap();
    first.wait().unwrap();
    let third = said(&start(&path, &checkpoint, &[]).wait_with_output().unwrap());
    assert_eq!(third.code, 0, "{}", third.err);
}

/// A session that took nothing leaves nothing to go on with.
#[test]
fn what_holds_no_sample_leaves_no_checkpoint() {
    use std::io::Write as _;
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = folder.path().join("c");
    let mut child = imu()
        .args(["live", "-", "--checkpoint", text(&checkpoint)])
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let noise: Vec<u8> =
        (0..9000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    child.stdin.take().unwrap().write_all(&noise).unwrap();
    let said = said(&child.wait_with_output().unwrap());
    assert_eq!((said.code, checkpoint.exists()), (1, false), "{}", said.err);
    assert!(said.err.contains("is of no known protocol"), "{}", said.err);
}

/// Ends a session as Ctrl-C does, and takes its report.
#[cfg(unix)]
fn interrupt(child: Child) -> imu_tests::command::Said {
    let pid = child.id().to_string();
    assert!(
        std::process::Command::new("kill").args(["-s", "INT", &pid]).status().unwrap().success()
    );
    said(&child.wait_with_output().unwrap())
}

/// It is not an error of who ends it that nobody knows the protocol yet, and what did come is said.
#[cfg(unix)]
#[test]
fn a_signal_before_the_protocol_is_known_says_what_came() {
    use std::io::{BufRead as _, BufReader, Write as _};
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = folder.path().join("c");
    for (bytes, wanted) in [
        ("who knows", "what the pipe sends is of no known protocol"),
        ("", "not a byte came of the pipe"),
    ] {
        let mut child = imu()
            .args(["live", "-", "--json", "--every", "10ms", "--checkpoint", text(&checkpoint)])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut to = child.stdin.take().unwrap();
        to.write_all(bytes.as_bytes()).unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let came = format!("\"bytes\":{}", bytes.len());
        while !lines.next().unwrap().unwrap().contains(&came) {}
        let ended = interrupt(child);
        assert_eq!(ended.code, 130, "{}", ended.err);
        assert!(ended.err.contains(wanted) && !ended.err.contains("usable"), "{}", ended.err);
        drop(to);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_stream_is_what_calibration_says_of_the_samples_that_were_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let (checkpoint, record) = (folder.path().join("c"), folder.path().join("r.csv"));
    let sensor = Streaming::start();
    let more = ["--baud", "115200", "--record", text(&record)];
    let child = start(&sensor.device, &checkpoint, &more);
    wait_for(&record, 1_000_000);
    let ended = interrupt(child);
    assert_eq!(ended.code, 130, "{}", ended.err);
    let (live, offline) = (sensors(&ended.out), calibrated(&record));
    assert!(live.0["samples"].as_u64().unwrap() > 5000, "{}", ended.out);
    assert_eq!(live.0["missing"], 0, "{}", live.0);
    assert_eq!(live, offline);
}

/// What is missing after a kill is a gap as long as the clock says, and nothing is there twice.
#[cfg(target_os = "linux")]
#[test]
fn a_killed_stream_goes_on_with_a_gap() {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = folder.path().join("c");
    let sensor = Streaming::start();
    let more = [&["--baud", "115200", "--protocol", "imu-frame"], &OFTEN[..]].concat();
    let mut child = start(&sensor.device, &checkpoint, &more);
    // The first samples are held back for two seconds, until their clock is known.
    std::thread::sleep(Duration::from_millis(6000));
    wait_for(&checkpoint, 100_000);
    child.kill().unwrap();
    child.wait().unwrap();
    std::thread::sleep(Duration::from_millis(700));
    let child = start(&sensor.device, &checkpoint, &[&more[..], &["--resume"]].concat());
    std::thread::sleep(Duration::from_millis(6000));
    let ended = interrupt(child);
    let sent = sensor.sent();
    assert_eq!(ended.code, 130, "{}", ended.err);
    let (gyroscope, _) = sensors(&ended.out);
    let of = |name: &str| gyroscope[name].as_u64().unwrap();
    assert_eq!((of("duplicates"), of("backward"), of("restarts")), (0, 0, 0), "{gyroscope}");
    assert_eq!(of("gap_count"), 1, "{gyroscope}");
    // At least the pause is missing; and all that was sent is there or missing, but for the beginning
    // before the port was open, and the burst at the end.
    assert!(of("missing") >= 700, "{gyroscope}");
    assert!(of("samples") + of("missing") <= sent, "{gyroscope} of {sent}");
}
