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

/// FNV-1a of what the presets write: the bytes that they had before scenes knew kinds of samples, clocks
/// and places of sensors. What a scene does not switch on changes nothing.
#[test]
fn the_files_of_presets_never_change() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let hash = |path: &str| {
        let bytes = fs::read(path).expect("written");
        bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
        })
    };
    for (preset, name, expected) in [
        ("low", "a.csv", 0xf48a_69af_decb_4dcc),
        ("low", "a.bag", 0x2f79_244a_75a2_19ba),
        ("mid", "a.csv", 0xfb88_4814_785d_0bc7),
        ("mid", "a.bag", 0x559a_1624_b3cf_2105),
        ("mid", "a.mcap", 0x4ede_1d59_daec_aeb3),
        ("high", "a.csv", 0xabcd_7246_c4f2_b5f2),
        ("high", "a.bag", 0x4ffb_bc8b_f518_58d6),
    ] {
        let path = at(&folder, name);
        assert_eq!(run(&["simulate", preset, "--duration", "20s", "-o", &path]).code, 0);
        assert_eq!(hash(&path), expected, "{preset} {name}");
    }
    let (csv, truth) = (at(&folder, "moving.csv"), at(&folder, "truth.csv"));
    let moving = ["simulate", "mid", "--moving", "--duration", "20s", "--seed", "7"];
    let said = run(&[&moving[..], &["--lowpass", "42", "-o", &csv, "--truth", &truth]].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!((hash(&csv), hash(&truth)), (0x3ed7_def8_e19b_a8b0, 0xd817_1847_b024_857e));
}

/// The root of the repository.
fn root(path: &str) -> String {
    format!("{}/../{path}", env!("CARGO_MANIFEST_DIR"))
}

/// Every scene that comes with the program runs, and writes what it says.
#[test]
fn example_scenes_run() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let [csv, truth, terms] = ["a.csv", "truth.csv", "terms.csv"].map(|name| at(&folder, name));
    for scene in ["everything", "phone", "drone", "ellipse"] {
        let scene = root(&format!("examples/scenes/{scene}.toml"));
        let asked = ["simulate", &scene, "--duration", "3s", "-o", &csv];
        let beside = ["--truth", &truth, "--truth-terms", &terms];
        let said = run(&[&asked[..], &beside].concat());
        assert_eq!(said.code, 0, "{}", said.err);
        assert!(said.err.contains(&format!(", and the terms to {terms}")), "{}", said.err);
        let width = |path: &str| {
            let text = fs::read_to_string(path).expect("written");
            let mut widths = text.lines().map(|line| line.split(',').count());
            let first = widths.next().expect("a header");
            assert!(widths.all(|width| width == first), "{path}");
            (first, text.lines().count())
        };
        let (written, due) = (width(&csv).1, width(&truth).1);
        assert_eq!(width(&terms).1, due);
        assert!(written <= due && due > 600);
    }
}

/// Every scene that docs/scenes.md shows is one, beside poses where it follows some.
#[test]
fn the_scenes_of_the_documentation_are_scenes() {
    let text = fs::read_to_string(root("docs/scenes.md")).expect("the documentation");
    let shown = text.split("```toml\n").skip(1).map(|rest| rest.split("```").next());
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(at(&folder, "poses.tum"), imu_tests::flights::tum(5, 1)).expect("written");
    let mut count = 0;
    for scene in shown {
        imu_tools::scene::Scene::from_toml(scene.expect("an end"), &at(&folder, "scene.toml"))
            .expect("valid");
        count += 1;
    }
    assert_eq!(count, 3);
}

/// What a format can say of the kind of its samples, and of the temperature, it says; else the user is
/// told.
#[test]
fn formats_tell_what_their_samples_are() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let scene = at(&folder, "scene.toml");
    fs::write(
        &scene,
        "duration = 2\nsamples = \"increments\"\n[temperature]\nstart_c = 30\nrate_k_s = 2\n",
    )
    .expect("written");
    let [csv, bag, euroc] = ["a.csv", "a.bag", "mav0"].map(|name| at(&folder, name));
    let said = run(&["simulate", &scene, "-o", &csv]);
    assert_eq!((said.code, said.err.lines().count()), (0, 1), "{}", said.err);
    let text = fs::read_to_string(&csv).expect("written");
    let header = text.lines().next().expect("a header");
    assert!(header.contains(",delta_angle_x [rad],"), "{header}");
    assert!(header.ends_with(",temperature [degC]"), "{header}");
    assert!(text.lines().nth(2).expect("a line").ends_with(",0.04905,30.01"));
    let said = run(&["simulate", &scene, "-o", &bag]);
    assert!(said.err.contains("increments of angle in rad and of velocity in m/s"), "{}", said.err);
    assert!(said.err.contains("the temperature is not in it"), "{}", said.err);
    let said = run(&["simulate", &scene, "-o", &euroc]);
    assert!(!said.err.contains("increments"), "{}", said.err);
    let yaml = fs::read_to_string(format!("{euroc}/imu0/sensor.yaml")).expect("written");
    assert!(yaml.contains("comment: increments of angle in rad"), "{yaml}");
    // EuRoC's folders and tables alike are read as means, and written as such; a bag cannot say it.
    for from in [&csv, &euroc] {
        let to = at(&folder, "means.csv");
        let said = run(&["convert", from, &to, "--force"]);
        assert_eq!(said.code, 0, "{}", said.err);
        assert!(said.err.contains("holds increments of angle and velocity"), "{}", said.err);
        let text = fs::read_to_string(&to).expect("written");
        assert!(text.lines().next().is_some_and(|header| header.contains(",accel_mean_z [m/s^2]")));
        assert!(text.lines().nth(2).is_some_and(|row| row.ends_with(",9.81")), "{text:.300}");
    }
    let said = run(&["convert", &csv, &bag, "--force"]);
    assert!(said.err.contains("no place for the kind of its samples"), "{}", said.err);

    let said = run(&["simulate", &scene, "--samples", "mean", "-o", &csv]);
    assert_eq!(said.code, 0, "{}", said.err);
    let mut source = recording::open(csv.as_ref(), &ReadOptions::default()).expect("readable");
    let mut block = Block::default();
    assert!(source.next_block(&mut block).expect("readable"));
    assert_eq!(block.accelerometer[7].value, [0.0, 0.0, 9.81]);
    assert_eq!((block.temperature.len(), block.temperature[1].celsius), (400, 30.01));
}

/// Increments divided by their time are means to a rounding of each, 2e-16 of 9.81 m/s² and of a rate below
/// 1 rad/s: beside noise of 1e-3, N moves by less than 1e-12 of itself.
#[test]
fn increments_calibrate_as_means_do() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let csv = at(&folder, "a.csv");
    let densities = ["mean", "increments"].map(|samples| {
        let scene = ["simulate", "low", "--duration", "10min", "--samples", samples, "-o", &csv];
        assert_eq!(run(&scene).code, 0);
        let said = run(&["calibrate", &csv, "--json"]);
        assert_eq!(said.code, 0, "{}", said.err);
        let json: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
        ["gyroscope", "accelerometer"].map(|sensor| {
            let axes = json[sensor]["axes"].as_array().expect("axes");
            let density = |axis: &serde_json::Value| axis["noise_density"]["value"].as_f64();
            axes.iter().map(|axis| density(axis).expect("a density")).collect::<Vec<_>>()
        })
    });
    let [means, increments] = densities.map(|densities| densities.concat());
    assert_eq!(means.len(), 6);
    for (mean, increment) in means.iter().zip(&increments) {
        assert!((increment / mean - 1.0).abs() < 1e-9, "{mean} {increment}");
    }
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
        (&["mid", "-o", &bag, "--truth-terms", &bag], 2, "the recording and the terms cannot both"),
        (&["mid", "-o", &bag, "--samples", "means"], 2, "instantaneous, mean or increments"),
        (&["mid", "-o", &bag, "--seed", "-1"], 2, "'-1'"),
        (&[&latin, "-o", &bag], 1, "latin.toml is no scene file: it is not text in UTF-8"),
        (&["mid", "-o", &at(&folder, "a.xlsx")], 2, "a.xlsx"),
        (&["mid", "-o", &nowhere], 1, "no such file or folder"),
        (&[&absent, "-o", &bag], 1, "cannot read"),
        (&[&scene, "-o", &bag], 1, "line 2: there is no key `sede`; `seed` is meant?"),
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
    // Nor are the poses that it follows.
    let inside = folder.path().join("all/mav0/imu0/data.csv");
    fs::create_dir_all(inside.parent().expect("a folder")).expect("made");
    let poses: String = (0..9).map(|k| format!("{k} {k} 0 0 0 0 0 1\n")).collect();
    for poses_file in [csv.as_str(), inside.to_str().expect("text")] {
        fs::write(poses_file, &poses).expect("written");
        fs::write(&scene, format!("trajectory = {poses_file:?}\n")).expect("written");
        let (other, all) = (at(&folder, "b.csv"), at(&folder, "all/"));
        let ways = [&["-o", &other, "--truth", poses_file][..], &["-o", poses_file], &["-o", &all]];
        // The last one writes into the folder of the second file.
        for arguments in &ways[..if poses_file.contains("mav0") { 3 } else { 2 }] {
            let said = run(&[&["simulate", &scene][..], *arguments].concat());
            assert_eq!(said.code, 2, "{arguments:?}: {}", said.err);
            assert!(said.err.contains("is the trajectory of the scene"), "{}", said.err);
            assert_eq!(fs::read_to_string(poses_file).expect("read"), poses);
        }
    }
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
