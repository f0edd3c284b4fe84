//! `imu integrate` as a user calls it: published figures, trajectories that are read again, refusals.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use imu_core::nalgebra::Vector3;
use imu_core::so3;
use imu_core::world::RotatingEarth;
use imu_tests::command::{Said, run};
use imu_tests::recordings::Folder;
use imu_tools::recording::poses::Poses;
use serde_json::Value;

/// A folder with the classic ellipse, 20 s and its last instant at 200 Hz, without any error, and its truth.
struct Ellipse(tempfile::TempDir);

impl Ellipse {
    fn new(samples: &str) -> Self {
        let ellipse = Self(tempfile::tempdir().expect("temporary folder"));
        let scene = format!(
            "rate_hz = 200\nduration = \"20.005s\"\nmotion = \"ellipse\"\nsamples = \"{samples}\"\n"
        );
        fs::write(ellipse.at("scene.toml"), scene).expect("written");
        let [scene, csv, truth] =
            ["scene.toml", "a.csv", "a.truth.csv"].map(|name| ellipse.at(name));
        let said = run(&["simulate", &scene, "-o", &csv, "--truth", &truth]);
        assert_eq!(said.code, 0, "{}", said.err);
        ellipse
    }

    fn at(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("the temporary folder is UTF-8").to_owned()
    }

    fn integrate(&self, file: &str, arguments: &[&str]) -> Said {
        run(&[&["integrate", &self.at(file)][..], arguments].concat())
    }

    /// The errors of a rule.
    fn errors(&self, file: &str, arguments: &[&str], rule: &str) -> Value {
        let said = self.integrate(file, &[arguments, &["--json"]].concat());
        assert_eq!(said.code, 0, "{}", said.err);
        let json: Value = serde_json::from_str(&said.out).expect("JSON");
        let rules = json["rules"].as_array().expect("a list");
        let rule = rules.iter().find(|one| one["rule"] == rule).expect("the rule");
        rule["errors"].clone()
    }

    /// The lines of the recording that are kept, with their header.
    fn edited(&self, to: &str, edit: impl Fn(i64, &str) -> Option<String>) {
        let text = fs::read_to_string(self.at("a.csv")).expect("written");
        let mut lines = text.lines();
        let mut edited = format!("{}\n", lines.next().expect("a header"));
        for line in lines {
            let (stamp, rest) = line.split_once(',').expect("columns");
            let at_ns = stamp.parse::<i64>().expect("a stamp") - 1_600_000_000_000_000_000;
            if let Some(line) = edit(at_ns, rest) {
                writeln!(edited, "{line}").expect("memory");
            }
        }
        fs::write(self.at(to), edited).expect("written");
    }
}

const AT: [&str; 2] = ["--samples", "instantaneous"];

fn stamped(at_ns: i64, rest: &str) -> Option<String> {
    Some(format!("{},{rest}", 1_600_000_000_000_000_000 + at_ns))
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or(f64::NAN)
}

/// He & Gao's figures for their program, recomputed in double precision: RMSE over i = 1…n and the final error.
#[test]
fn the_published_table_comes_out_to_its_last_digit() {
    let ellipse = Ellipse::new("instantaneous");
    let said = ellipse.integrate("a.csv", &AT);
    assert_eq!(said.code, 0, "{}", said.err);
    let row = |rule: &str| -> Vec<&str> {
        let line = said.out.lines().find(|line| line.split(' ').next() == Some(rule));
        line.unwrap_or_default().split_whitespace().skip(1).collect()
    };
    let euler = row("textbook-euler");
    assert_eq!(euler[..3], ["0.48231", "1.04229", "0.035623"], "{}", said.out);
    let midpoint = row("textbook-midpoint");
    assert_eq!(midpoint[..3], ["7.4776e-4", "1.2945e-3", "1.3490e-4"], "{}", said.out);
    assert!(said.out.contains("at 4000 instants after the start"));
    let three = ellipse.errors("a.csv", &AT, "three-sample");
    assert!(number(&three, "position_rmse_m") < 1e-6);
    // An alignment can only take away.
    assert!(number(&three, "ate_m") <= number(&three, "position_rmse_m"));
}

/// The order of the kinds: means taken for instants cost more than the difference between any two rules for them.
#[test]
fn what_a_sample_is_matters_more_than_the_rule() {
    let ellipse = Ellipse::new("mean");
    let arguments = ["--samples", "mean"];
    let two = ellipse.errors("a.csv", &arguments, "two-increments");
    let one = ellipse.errors("a.csv", &arguments, "previous-increment");
    assert!(number(&two, "position_rmse_m") < 1e-8, "{two}");
    assert!(number(&two, "rotation_rmse_deg") < 1e-9, "{two}");
    assert!(number(&one, "position_rmse_m") < 1e-4, "{one}");
    // Its header says what they are, so that it has to be passed over.
    let columns = [&AT[..], &["--columns", "t,gx,gy,gz,ax,ay,az", "--time-unit", "ns"]].concat();
    let wrong = ellipse.errors("a.csv", &columns, "three-sample");
    assert!(number(&wrong, "position_rmse_m") > 0.1, "{wrong}");
}

/// Headers as `imu simulate` writes them; `--columns` passes over a header that is wrong.
#[test]
fn a_header_that_says_what_samples_are_is_believed() {
    let means = Ellipse::new("mean");
    let refused = |ellipse: &Ellipse, arguments: &[&str], code: i32, sentence: &str| {
        let said = ellipse.integrate("a.csv", arguments);
        assert_eq!((said.code, said.err.lines().count()), (code, 1), "{}", said.err);
        assert!(said.err.contains(sentence), "{}", said.err);
    };
    refused(&means, &AT, 2, "by its header they are means: take --samples mean");
    assert_eq!(means.integrate("a.csv", &["--samples", "mean"]).code, 0);
    let columns = ["--columns", "t,gx,gy,gz,ax,ay,az", "--time-unit", "ns"];
    assert_eq!(means.integrate("a.csv", &[&AT[..], &columns].concat()).code, 0);
    let increments = Ellipse::new("increments");
    refused(&increments, &AT, 2, "by its header they are means: take --samples mean");
}

/// The ellipse's increments, divided by their time when they are read, are its means: what is lost is the rounding
/// of a product and a quotient, 2e-16 of 10 m/s², far below what is left of the rule (1e-8 m).
#[test]
fn increments_integrate_as_means_do() {
    let increments = Ellipse::new("increments");
    let said = increments.integrate("a.csv", &["--samples", "mean"]);
    assert!(
        said.err.contains("holds increments of angle and velocity: each is divided"),
        "{}",
        said.err
    );
    assert!(!said.err.contains("warning"), "{}", said.err);
    let map = "t=timestamp,gx=delta_angle_x,gy=delta_angle_y,gz=delta_angle_z,ax=delta_velocity_x,\
               ay=delta_velocity_y,az=delta_velocity_z";
    for arguments in [&["--samples", "mean"][..], &["--samples", "mean", "--map", map]] {
        let two = increments.errors("a.csv", arguments, "two-increments");
        assert!(number(&two, "position_rmse_m") < 1e-8, "{two}");
        assert!(number(&two, "rotation_rmse_deg") < 1e-9, "{two}");
    }
}

#[test]
fn trajectories_are_read_again_and_truth_at_other_instants_is_interpolated() {
    let ellipse = Ellipse::new("instantaneous");
    let out = ellipse.at("out");
    let said =
        ellipse.integrate("a.csv", &[&AT[..], &["--rule", "three-sample", "-o", &out]].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    let mut names: Vec<String> = fs::read_dir(&out)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    let expected = [
        "error.png",
        "error.svg",
        "trajectory.png",
        "trajectory.svg",
        "trajectory_three-sample.csv",
        "trajectory_three-sample.tum",
    ];
    assert_eq!(names, expected);
    let poses = |name: &str| {
        let mut poses = Poses::open(&Path::new(&out).join(name)).expect("poses");
        let mut all = Vec::new();
        while let Some(pose) = poses.next_pose().expect("a pose") {
            all.push(pose);
        }
        all
    };
    let (csv, tum) = (poses("trajectory_three-sample.csv"), poses("trajectory_three-sample.tum"));
    assert_eq!((csv.len(), tum.len()), (4001, 4001));
    assert_eq!(csv[4000].stamp_ns, 1_600_000_020_000_000_000);
    for (csv, tum) in csv.iter().zip(&tum) {
        assert_eq!(
            (csv.stamp_ns, csv.position, csv.orientation),
            (tum.stamp_ns, tum.position, tum.orientation)
        );
        assert!(csv.velocity.is_some() && tum.velocity.is_none());
    }
    // Every other sample against the truth at all instants: between samples 10 ms apart a turn whose rate changes by
    // α = 0.3 rad/s² bends by αh²/8 = 4e-6 rad from the shortest way; positions by a cubic, h⁴p⁗/384 < 3e-9 m.
    ellipse
        .edited("half.csv", |at, rest| if at % 10_000_000 == 0 { stamped(at, rest) } else { None });
    let truth = ellipse.at("a.truth.csv");
    let arguments = [&AT[..], &["--truth", &truth]].concat();
    let all = ellipse.errors("half.csv", &arguments, "three-sample");
    assert_eq!(all["instants"], 4000);
    assert!(number(&all, "rotation_rmse_deg") < 3e-4, "{all}");
    assert!(number(&all, "position_rmse_m") < 1e-5, "{all}");
    // A truth of poses alone: the velocity at the start comes from its positions.
    let tum = Path::new(&out).join("trajectory_three-sample.tum");
    let arguments = [&AT[..], &["--truth", tum.to_str().expect("UTF-8")]].concat();
    let said = ellipse.integrate("a.csv", &arguments);
    assert!(said.err.contains("comes from its positions within 0.1 s"), "{}", said.err);
    let poses = ellipse.errors("a.csv", &arguments, "three-sample");
    // A parabola through 0.1 s of jerk π³ errs by (τ²/10)·π³ = 3e-2 m/s in the velocity: 0.6 m after 20 s.
    assert!(number(&poses, "position_final_m") < 1.0, "{poses}");
    assert!(poses["velocity_final_m_s"].is_null());
}

#[test]
fn from_rest_without_truth() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let bag = folder.path().join("still.bag");
    let bag = bag.to_str().expect("UTF-8");
    assert_eq!(run(&["simulate", "low", "--duration", "5s", "-o", bag]).code, 0);
    let said = run(&["integrate", bag, "--samples", "instantaneous", "--rule", "midpoint"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.err.contains("there is no truth to compare with"), "{}", said.err);
    assert!(said.err.contains("heading unknown, taken as 0.0°"), "{}", said.err);
    assert!(said.out.contains("The last state"), "{}", said.out);
    let said = run(&["integrate", bag, "--samples", "instantaneous", "--latitude", "47"]);
    assert!(said.out.contains("of the place, on the turning Earth"), "{}", said.out);
}

#[test]
fn what_cannot_be_asked_is_refused_with_a_sentence() {
    let ellipse = Ellipse::new("instantaneous");
    fs::remove_file(ellipse.at("a.truth.csv")).expect("there");
    fs::write(ellipse.at("empty.csv"), "").expect("written");
    let mean = ["--samples", "mean"];
    for (file, arguments, code, sentence) in [
        ("a.csv", vec![], 2, "say what a sample is"),
        (
            "a.csv",
            [&mean[..], &["--rule", "midpoint"]].concat(),
            2,
            "takes instantaneous samples, and these are said to be mean: take previous-increment, two-increments",
        ),
        (
            "a.csv",
            [&AT[..], &["--rule", "rk4"]].concat(),
            2,
            "there is no rule 'rk4': rules are all,",
        ),
        ("a.csv", [&AT[..], &["--start", "truth"]].concat(), 2, "name it with --truth FILE"),
        ("a.csv", [&AT[..], &["--truth", "no.csv"]].concat(), 1, "no such file"),
        ("a.csv", AT.to_vec(), 1, "are not at rest (the angular rate x changes by"),
        (
            "a.csv",
            [&AT[..], &["--rest", "100"]].concat(),
            1,
            "ends before the 100 s at rest are over",
        ),
        ("a.csv", [&AT[..], &["--bias", "1,2"]].concat(), 2, "six numbers"),
        ("a.csv", [&AT[..], &["--latitude", "91"]].concat(), 2, "degrees from -90 to 90"),
        ("a.csv", [&AT[..], &["--from", "2", "--to", "1"]].concat(), 2, "not before"),
        ("a.csv", [&AT[..], &["--from", "100"]].concat(), 1, "lies between --from and --to"),
        ("a.csv", [&AT[..], &["-o", "-"]].concat(), 2, "go into a folder"),
        ("empty.csv", AT.to_vec(), 1, "is empty"),
    ] {
        let said = ellipse.integrate(file, &arguments);
        assert_eq!(said.code, code, "{arguments:?}: {}", said.err);
        assert!(said.err.contains(sentence), "{arguments:?}: {}", said.err);
        assert_eq!((said.out.as_str(), said.err.lines().count()), ("", 1), "{arguments:?}");
    }
}

/// A sensor at rest at 46° N, in some attitude: it feels RᵀΩ and −Rᵀg.
#[test]
fn on_the_turning_earth_a_sensor_at_rest_stays() {
    let (degrees, height) = (46.0_f64, 1200.0);
    let earth = RotatingEarth::<f64>::new(degrees.to_radians(), height).expect("a place");
    let attitude = so3::exp(Vector3::new(0.4, -0.7, 1.1));
    let body = |v: Vector3<f64>| so3::rotate(&so3::inverse(&attitude), &v);
    let (rate, force) = (body(earth.rate()), body(-earth.gravity()));
    let (mut csv, mut tum) = (String::from("t [s],gx,gy,gz,ax,ay,az\n"), String::new());
    for k in 0..=6000 {
        let t = f64::from(k) / 100.0;
        let [gx, gy, gz, ax, ay, az] = [rate.x, rate.y, rate.z, force.x, force.y, force.z];
        writeln!(csv, "{t},{gx},{gy},{gz},{ax},{ay},{az}").expect("memory");
        let q = attitude;
        writeln!(tum, "{t} 0 0 0 {} {} {} {}", q.i, q.j, q.k, q.w).expect("memory");
    }
    let folder = Folder::new();
    let (file, truth) = (folder.put("a.csv", csv), folder.put("true.tum", tum));
    let errors = |samples: &str, place: &[&str]| -> Vec<(bool, f64)> {
        let call = ["integrate", &file, "--samples", samples, "--truth", &truth, "--json"];
        let said = run(&[&call[..], place].concat());
        assert_eq!(said.code, 0, "{}", said.err);
        let json: Value = serde_json::from_str(&said.out).expect("JSON");
        let rules = json["rules"].as_array().expect("a list");
        let is_euler = |rule: &Value| rule["rule"].as_str().expect("a name").contains("euler");
        let error = |rule| (is_euler(rule), number(&rule["errors"], "position_final_m"));
        rules.iter().map(error).collect()
    };
    let north = earth.rate().y;
    let gravity = -earth.gravity().z;
    for samples in ["instantaneous", "mean"] {
        let here = errors(samples, &["--latitude", "46", "--height", "1200"]);
        // Euler's rule takes the force in the attitude before the step: tilted by Ω cos φ h/2, 4.5 mm in a minute.
        let tilt = gravity * north * (0.01 / 2.0) * 60.0 * 60.0 / 2.0;
        let most = |euler: bool| if euler { 1e-3_f64.max(1.01 * tilt) } else { 1e-3 };
        assert!(here.iter().all(|(euler, metres)| *metres < most(*euler)), "{here:?} {tilt}");
        // On the ellipsoid gravity is larger by 2gh/a(1 + f + m − 2f sin²) = 3.70e-3 m/s², and it falls: gt²/2.
        let below = RotatingEarth::<f64>::new(degrees.to_radians(), 0.0).expect("a place");
        let fall = (earth.gravity().z - below.gravity().z) * 60.0 * 60.0 / 2.0;
        let low = errors(samples, &["--latitude", "46"]);
        assert!(low.iter().all(|(_, metres)| (metres / fall - 1.0).abs() < 0.01), "{low:?} {fall}");
        // Where the world does not turn, the rate tilts the force by Ω cos φ · t to the east: g Ω cos φ t³/6, and the
        // next orders are smaller by Ωt = 0.4 %.
        let east = gravity * north * 60.0_f64.powi(3) / 6.0;
        let flat = errors(samples, &["--gravity", &gravity.to_string()]);
        assert!(
            flat.iter().all(|(_, metres)| (metres / east - 1.0).abs() < 0.01),
            "{flat:?} {east}"
        );
    }
}

#[test]
fn an_hour_missing_is_crossed_by_the_truth_or_not_at_all() {
    let ellipse = Ellipse::new("instantaneous");
    let hour = 3_600_000_000_000_i64;
    let later = |at: i64| if at >= 10_000_000_000 { at + hour } else { at };
    ellipse.edited("hole.csv", |at, rest| stamped(later(at), rest));
    let truth = fs::read_to_string(ellipse.at("a.truth.csv")).expect("written");
    let shifted = truth.lines().enumerate().fold(String::new(), |mut text, (line, row)| {
        let shifted = row.split_once(',').and_then(|(stamp, rest)| {
            let at = stamp.parse::<i64>().ok()? - 1_600_000_000_000_000_000;
            stamped(later(at), rest)
        });
        assert!(line == 0 || shifted.is_some());
        writeln!(text, "{}", shifted.as_deref().unwrap_or(row)).expect("memory");
        text
    });
    fs::write(ellipse.at("hole.truth.csv"), shifted).expect("written");
    let said = ellipse.integrate("hole.csv", &AT);
    assert_eq!(said.code, 0, "{}", said.err);
    let missing = "1 h 0.005 s are missing after 9.995 s, which dead reckoning cannot cross";
    assert!(said.err.contains(&format!("{missing}: it begins anew")), "{}", said.err);
    let errors = ellipse.errors("hole.csv", &AT, "three-sample");
    // 4001 instants less two starts.
    assert_eq!(errors["instants"], 3999);
    assert!(number(&errors, "position_rmse_m") < 1e-6, "{errors}");
    // The truth of the first half alone leads nowhere.
    let truth = ellipse.at("a.truth.csv");
    let said = ellipse.integrate("hole.csv", &[&AT[..], &["--truth", &truth]].concat());
    assert!(said.err.contains("knows nothing of their end: it ends there"), "{}", said.err);
    assert!(said.out.contains("1999 steps"), "{}", said.out);
}

#[test]
fn stamps_that_go_back_and_what_is_no_number_are_left_out_and_counted() {
    let ellipse = Ellipse::new("instantaneous");
    let truth = ellipse.at("a.truth.csv");
    let arguments = [&AT[..], &["--truth", &truth]].concat();
    ellipse.edited("bad.csv", |at, rest| match at {
        5_000_000_000 => stamped(at - 1_000_000_000, rest),
        6_000_000_000 => stamped(at - 5_000_000, rest),
        7_000_000_000 => stamped(at, "nan,nan,nan,nan,nan,nan"),
        _ => stamped(at, rest),
    });
    let said = ellipse.integrate("bad.csv", &arguments);
    assert_eq!(said.code, 0, "{}", said.err);
    for sentence in [
        "2 are not numbers",
        "2 have the stamp of the one before",
        "2 are stamped before the one before, by up to 0.995 s",
        "3 steps are longer than usual",
    ] {
        assert!(said.err.contains(sentence), "{sentence}: {}", said.err);
    }
    let errors = ellipse.errors("bad.csv", &arguments, "three-sample");
    assert!(number(&errors, "position_rmse_m") < 1e-2, "{errors}");
    // The truth of another day.
    let text = fs::read_to_string(&truth).expect("written").replace("\n16000", "\n17000");
    let other = ellipse.at("other.csv");
    fs::write(&other, text).expect("written");
    let said = ellipse.integrate("a.csv", &[&AT[..], &["--truth", &other]].concat());
    let sentence = "it begins 100000000.000 s after its first sample; are their clocks the same?";
    assert_eq!((said.code, said.out.as_str()), (1, ""));
    assert!(said.err.contains(sentence), "{}", said.err);
    // All of one instant: a rate of 0.
    ellipse.edited("stopped.csv", |_, rest| stamped(0, rest));
    let said = ellipse.integrate("stopped.csv", &arguments);
    assert_eq!((said.code, said.out.as_str()), (1, ""), "{}", said.err);
}
