//! `imu simulate` as a user calls it: what it writes, what it says, how it refuses.

use std::fs;
use std::io::Read as _;
use std::process::Stdio;

use imu_tests::command::{imu, run};
use imu_tools::recording::{self, Block, ReadOptions};

const SHORT: [&str; 4] = ["simulate", "mid", "--duration", "10s"];

/// A file's path in a folder, as text.
fn at(folder: &tempfile::TempDir, name: &str) -> String {
    folder.path().join(name).to_str().expect("the temporary folder is UTF-8").to_owned()
}

fn samples(path: &str) -> Block {
    let mut source =
        recording::open(path.as_ref(), &ReadOptions::default()).expect("a recording is readable");
    let (mut all, mut block) = (Block::default(), Block::default());
    while source.next_block(&mut block).expect("a recording is readable") {
        all.gyroscope.extend(&block.gyroscope);
        all.accelerometer.extend(&block.accelerometer);
    }
    all
}

#[test]
fn bag_csv_and_pipe_hold_the_same_samples_again_and_again() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let (bag, csv, again) = (at(&folder, "a.bag"), at(&folder, "a.csv"), at(&folder, "b.bag"));
    for path in [&bag, &csv, &again] {
        let said = run(&[&SHORT[..], &["-o", path]].concat());
        assert_eq!((said.code, said.out.as_str()), (0, ""));
        assert_eq!(
            said.err,
            format!("imu: wrote 2000 samples of both sensors (10 s at 200 Hz, seed 1) to {path}\n")
        );
    }
    let piped = run(&[&SHORT[..], &["-o", "-"]].concat());
    assert_eq!(piped.out, fs::read_to_string(&csv).expect("written"));
    assert_eq!(fs::read(&bag).expect("written"), fs::read(&again).expect("written"));
    let from_bag = samples(&bag);
    assert_eq!(from_bag.gyroscope.len(), 2000);
    assert_eq!(from_bag.gyroscope[0].stamp_ns, 1_600_000_000_000_000_000);
    assert_eq!(from_bag, samples(&csv));
}

#[test]
fn truth_stands_beside_the_samples() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let (csv, truth) = (at(&folder, "a.csv"), at(&folder, "truth.csv"));
    let said = run(&[&SHORT[..], &["--moving", "-o", &csv, "--truth", &truth]].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    let text = fs::read_to_string(&truth).expect("written");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    assert_eq!(names.len(), 23);
    let column = |line: &str, name: &str| -> f64 {
        let at = names.iter().position(|column| *column == name).expect("a column");
        line.split(',').nth(at).and_then(|field| field.parse().ok()).expect("a number")
    };
    let measured = samples(&csv);
    let mut count = 0;
    // White noise of the mid preset: N√200 = 0.212 rad/s and 0.269 m/s², six of them.
    for (line, (rate, force)) in lines.zip(measured.gyroscope.iter().zip(&measured.accelerometer)) {
        let noise =
            rate.value[2] - column(line, "rate_z_rad_s") - column(line, "gyro_bias_z_rad_s");
        assert!(noise.abs() < 6.0 * 0.2122, "{line}");
        let noise =
            force.value[0] - column(line, "force_x_m_s2") - column(line, "accel_bias_x_m_s2");
        assert!(noise.abs() < 6.0 * 0.2687, "{line}");
        count += 1;
    }
    assert_eq!(count, 2000);
    let first = text.lines().nth(1).expect("a line");
    assert_eq!((column(first, "p_x_m"), column(first, "gyro_bias_x_rad_s")), (20.0, 0.0));
}

#[test]
fn flags_stand_over_a_scene_file() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let (scene, csv) = (at(&folder, "scene.toml"), at(&folder, "a.csv"));
    fs::write(&scene, "rate_hz = 50\nseed = 3\nstart_ns = 0\nduration = \"2s\"\n")
        .expect("written");
    let said = run(&["simulate", &scene, "--rate", "100", "--seed", "9", "-o", &csv]);
    assert!(
        said.err.contains("200 samples of both sensors (2 s at 100 Hz, seed 9)"),
        "{}",
        said.err
    );
    let read = samples(&csv);
    assert_eq!(read.gyroscope[1].stamp_ns, 10_000_000);
    assert!(read.accelerometer.iter().all(|sample| sample.value == [0.0, 0.0, 9.81]));
}

#[test]
fn mistakes_are_one_sentence_and_leave_no_file() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let bag = at(&folder, "a.bag");
    let scene = at(&folder, "scene.toml");
    fs::write(&scene, "seed = 1\nsede = 2\n").expect("written");
    let latin = at(&folder, "latin.toml");
    fs::write(&latin, b"# \xe9\n").expect("written");
    let absent = at(&folder, "absent.toml");
    let nowhere = at(&folder, "nowhere/a.bag");
    let here = folder.path().to_str().expect("UTF-8");
    for (arguments, code, words) in [
        (&["hgih", "-o", &bag][..], 2, "no preset 'hgih': take low, mid or high"),
        (&["mid"], 2, "--output"),
        (&["mid", "-o", &bag, "--rate", "0"], 2, "a rate of 0 Hz"),
        (&["mid", "-o", &bag, "--rate", "-5"], 2, "a rate of -5 Hz"),
        (&["mid", "-o", &bag, "--rate", "fast"], 2, "'fast'"),
        (&["mid", "-o", &bag, "--duration", "-4h"], 2, "'-4h' is negative"),
        (&["mid", "-o", &bag, "--duration", "soon"], 2, "'soon' cannot be read"),
        (&["mid", "-o", &bag, "--lowpass", "-1"], 2, "a low-pass at -1 Hz"),
        (&["mid", "-o", &bag, "--truth", &bag], 2, "cannot both go to"),
        (&["mid", "-o", &bag, "--truth", &at(&folder, "./a.bag")], 2, "cannot both go to"),
        (&["mid", "-o", "-", "--truth", "/dev/stdout"], 2, "cannot both go to"),
        (&["mid", "-o", &bag, "--seed", "-1"], 2, "'-1'"),
        (&[&latin, "-o", &bag], 1, "latin.toml is no scene file: it is not text in UTF-8"),
        (&["mid", "-o", &at(&folder, "a.xlsx")], 2, "a.xlsx"),
        (&["mid", "-o", &nowhere], 1, "no such file or folder"),
        (&[&absent, "-o", &bag], 1, "cannot read"),
        (&[&scene, "-o", &bag], 1, "line 2: unknown field `sede`"),
        (&["mid", "-o", here], 2, here),
    ] {
        let said = run(&[&["simulate"], arguments].concat());
        assert_eq!(said.code, code, "{arguments:?}: {}", said.err);
        assert!(said.err.starts_with("imu: ") && said.err.contains(words), "{}", said.err);
        assert_eq!(said.err.lines().count(), 1, "{}", said.err);
        assert_eq!(said.out, "");
        let left = fs::read_dir(folder.path()).expect("the folder").count();
        assert_eq!(left, 2, "only the scene files: {arguments:?}");
    }
}

#[test]
fn a_scene_is_never_written_over() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let (scene, csv) = (at(&folder, "scene.toml"), at(&folder, "a.csv"));
    fs::write(&scene, "duration = \"1s\"\n").expect("written");
    for arguments in [&["-o", &scene, "--to", "csv"][..], &["-o", &csv, "--truth", &scene]] {
        let said = run(&[&["simulate", &scene][..], arguments].concat());
        assert_eq!(said.code, 2, "{}", said.err);
        assert!(said.err.contains("is the scene itself"), "{}", said.err);
    }
    assert_eq!(fs::read_to_string(&scene).expect("read"), "duration = \"1s\"\n");
}

#[test]
fn a_reader_that_leaves_ends_the_program_quietly() {
    let mut call = imu();
    call.args(["simulate", "low", "--duration", "1h", "-o", "-"]);
    let mut child = call.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("started");
    let mut first = [0; 10];
    child.stdout.take().expect("piped").read_exact(&mut first).expect("a header");
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "{:?}", output.status);
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[cfg(target_os = "linux")]
#[test]
fn nobody_to_tell_is_no_panic() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let csv = at(&folder, "a.csv");
    for (arguments, code) in [
        (&["simulate", "low", "--duration", "1s", "-o", &csv][..], 0),
        (&["calibrate", &at(&folder, "absent.csv")], 1),
        (&["nonsense"], 2),
    ] {
        let full = fs::File::options().write(true).open("/dev/full").expect("opened");
        let status = imu().args(arguments).stderr(full).status().expect("started");
        assert_eq!(status.code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn help_shows_examples() {
    let said = run(&["simulate", "--help"]);
    assert_eq!(said.code, 0);
    assert!(said.out.contains("imu simulate low -o still.bag"), "{}", said.out);
}
