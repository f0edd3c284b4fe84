//! `imu spline` as a user calls it, scenes along poses, and from poses to IMU data and back.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use imu_tests::closure::closure;
use imu_tests::command::{Said, run};
use imu_tests::flights::tum;
use imu_tools::recording::SampleKind;
use imu_tools::spline::{FormName, Options, Route, asked};
use serde_json::Value;

/// A folder with the poses of a flight.
struct Flight(tempfile::TempDir);

impl Flight {
    fn new(seconds: u32) -> Self {
        let flight = Self(tempfile::tempdir().expect("temporary folder"));
        flight.put("poses.tum", &tum(seconds, 1));
        flight
    }

    fn put(&self, name: &str, text: &str) {
        fs::write(self.at(name), text).expect("written");
    }

    fn at(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("the temporary folder is UTF-8").to_owned()
    }

    /// Calls `imu` with names of this folder where an argument begins with @.
    fn run(&self, arguments: &str) -> Said {
        let arguments: Vec<String> = arguments
            .split(' ')
            .map(|word| word.strip_prefix('@').map_or(word.to_owned(), |name| self.at(name)))
            .collect();
        run(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    }

    fn fine(&self, arguments: &str) -> Said {
        let said = self.run(arguments);
        assert_eq!(said.code, 0, "{arguments}: {}", said.err);
        said
    }

    fn refused(&self, arguments: &str, code: i32, words: &str) {
        let said = self.run(arguments);
        assert_eq!((said.code, said.out.as_str()), (code, ""), "{arguments}: {}", said.err);
        assert!(said.err.contains(words), "{words}: {}", said.err);
        assert_eq!(said.err.lines().count(), 1, "{}", said.err);
    }
}

#[test]
fn a_fit_says_how_far_it_is_and_what_else_there_is() {
    let flight = Flight::new(20);
    let said = flight.fine("spline fit @poses.tum -o @a.spline --spacing 0.05 --plots @plots");
    for words in [
        "401 poses in 20.00 s, 20.00 a second",
        "curve: plain, 403 control points 0.05000 s apart, through every pose",
        "From poses to the curve",
        "The poses jitter by",
        "m/s² of acceleration",
        "An accelerometer along it would read",
        "knots, s",
    ] {
        assert!(said.out.contains(words), "{words}: {}", said.out);
    }
    assert_eq!(said.err, "");
    flight.refused(
        "spline sample @a.spline --rate 10 --form plain -o @a.csv",
        2,
        "is a curve already",
    );
    for name in ["curve.svg", "curve.png", "residual.svg", "residual.png"] {
        assert!(Path::new(&flight.at("plots")).join(name).is_file(), "{name}");
    }
    let said = flight.fine("spline fit @poses.tum -o @b.spline --within 5mm,0.1deg --json");
    let json: Value = serde_json::from_str(&said.out).expect("JSON");
    let made = &json["choices"][0];
    assert!(made["position_largest_m"].as_f64().expect("a number") <= 5e-3, "{json}");
    assert!(made["rotation_largest_deg"].as_f64().expect("a number") <= 0.1);
    assert!(made["step_s"].as_f64().expect("a number") > 0.06);
    // Noise falls as knots are taken apart, and as it is smoothed. (Of knots a second apart nothing turns with the flight:
    // that choice is not there.)
    let smoothed = json["choices"].as_array().expect("a list").iter();
    let smoothed = smoothed.filter(|choice| choice["smooth_hz"].is_number()).count();
    let said = flight.fine("spline fit @poses.tum -o @c.spline --spacing 0.05 --json");
    let json: Value = serde_json::from_str(&said.out).expect("JSON");
    let noise: Vec<_> = json["choices"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|choice| choice["jitter"]["acceleration_m_s2"].as_f64().expect("a number"))
        .collect();
    let [made, wide, wider, smooth, smoother] = noise[..] else { panic!("{json}") };
    assert!(wider < wide && wide < made, "{json}");
    assert!(smoothed == 2 && smoother < smooth && smooth < made, "{json}");
}

#[test]
fn a_curve_in_a_file_is_the_curve_of_its_poses() {
    let flight = Flight::new(10);
    for form in ["plain", "symmetric"] {
        let how = format!("--form {form} --spacing 0.1 --smooth 4");
        flight.fine(&format!("spline fit @poses.tum -o @a.spline {how}"));
        let samples = "--rate 100 --samples mean --lever-arm 0.1,0,-0.05 --gravity 9.8";
        flight.fine(&format!("spline imu @a.spline {samples} -o @a.csv"));
        flight.fine(&format!("spline imu @poses.tum {samples} {how} -o @b.csv"));
        let [a, b] = ["a.csv", "b.csv"].map(|name| fs::read(flight.at(name)).expect("written"));
        assert!(a == b && a.starts_with(b"timestamp [ns],gyro_mean_x [rad/s]"), "{form}");
        flight.fine("spline sample @a.spline --rate 100 -o @a.tum");
        flight.fine(&format!("spline sample @poses.tum --rate 100 {how} -o @b.tum"));
        let [a, b] = ["a.tum", "b.tum"].map(|name| fs::read(flight.at(name)).expect("written"));
        assert_eq!(a, b);
    }
    // The form is a choice: the same control points are another curve.
    let text = fs::read_to_string(flight.at("a.spline")).expect("written");
    flight.put("c.spline", &text.replace("form: symmetric", "form: plain"));
    flight.fine("spline sample @c.spline --rate 100 -o @c.tum");
    let [a, c] = ["a.tum", "c.tum"].map(|name| fs::read(flight.at(name)).expect("written"));
    assert!(a != c);
}

#[test]
fn a_sampled_curve_is_a_truth_and_its_imu_integrates_to_it() {
    let flight = Flight::new(10);
    flight.fine("spline fit @poses.tum -o @a.spline --spacing 0.1");
    flight.fine("spline sample @a.spline --rate 200 -o @a.truth.csv");
    for (kind, integrated, rule) in [
        ("instantaneous", "instantaneous", "three-sample"),
        ("mean", "mean", "two-increments"),
        ("increments", "mean", "two-increments"),
    ] {
        flight.fine(&format!("spline imu @a.spline --rate 200 --samples {kind} -o @a.csv"));
        let said =
            flight.fine(&format!("integrate @a.csv --samples {integrated} --rule {rule} --json"));
        let json: Value = serde_json::from_str(&said.out).expect("JSON");
        let error = json["rules"][0]["errors"]["position_final_m"].as_f64().expect("a number");
        assert!(error < 2e-3, "{kind}: {error}");
    }
    // The truth beside an IMU away from the poses' point is the IMU's own.
    flight.fine(
        "spline imu @a.spline --rate 200 --lever-arm 1,-2,0.5 -o @b.csv --truth @b.truth.csv",
    );
    let said = flight.fine("integrate @b.csv --samples instantaneous --rule three-sample --json");
    let json: Value = serde_json::from_str(&said.out).expect("JSON");
    let error = json["rules"][0]["errors"]["position_final_m"].as_f64().expect("a number");
    assert!(error < 2e-3, "{error}");
}

#[test]
fn a_pose_that_jumps_is_told_of() {
    let flight = Flight::new(5);
    let text = fs::read_to_string(flight.at("poses.tum")).expect("written");
    let row = text.lines().nth(50).expect("a row");
    let mut fields: Vec<_> = row.split(' ').collect();
    fields[1] = "5.5";
    flight.put("jump.tum", &text.replacen(row, &fields.join(" "), 1));
    let said = flight.fine("spline fit @jump.tum -o @x");
    assert!(said.err.contains("s after the start: do poses jump there"), "{}", said.err);
}

#[test]
fn scenes_follow_poses_with_every_error() {
    let flight = Flight::new(10);
    flight.put(
        "scene.toml",
        "rate_hz = 100\nsamples = 'increments'\n[trajectory]\nfile = 'poses.tum'\nspacing_s = 0.1\n\
         [gyroscope]\nnoise_density = 1e-3\n[accelerometer]\nlever_arm_m = [0.1, 0, 0]\nconstant_bias = 0.1\n\
         [clock]\njitter_s = 1e-5\nlost_fraction = 0.01\n",
    );
    let said =
        flight.fine("simulate @scene.toml -o @a.csv --truth @a.truth.csv --truth-terms @terms.csv");
    assert!(
        said.err.contains("a plain curve with knots 0.1 s apart through 201 poses"),
        "{}",
        said.err
    );
    let terms = fs::read_to_string(flight.at("terms.csv")).expect("written");
    assert!(terms.lines().next().unwrap_or_default().contains("lever_arm"), "{terms:.200}");
    flight.put("long.toml", "duration = '11s'\ntrajectory = 'poses.tum'\n");
    flight.refused(
        "simulate @long.toml -o @b.csv",
        1,
        "longer than its trajectory: make the duration",
    );
    flight.fine("simulate @long.toml --duration 5s -o @b.csv");
    flight.refused(
        "simulate @long.toml --duration 5s --moving -o @b.csv",
        2,
        "a trajectory of its own",
    );
}

#[test]
fn what_cannot_be_is_refused_in_one_sentence() {
    let flight = Flight::new(5);
    let text = fs::read_to_string(flight.at("poses.tum")).expect("written");
    let lines: Vec<&str> = text.lines().collect();
    flight.put("three.tum", &(lines[..4].join("\n") + "\n"));
    flight.put("nan.tum", &text.replacen(lines[9], "1403715273.7 nan 0 0 0 0 0 1", 1));
    let mut back = lines.clone();
    back.swap(5, 6);
    flight.put("back.tum", &back.join("\n"));
    flight.put("swapped.tum", "0 0 0 0 1 5 6 7.5\n1 0 0 0 1 5 6 7.5\n");
    for (arguments, code, words) in [
        (
            "spline fit @three.tum -o @x",
            1,
            "holds 3 poses of different instants, and a curve needs 4",
        ),
        ("spline fit @nan.tum -o @x", 1, "line 10: the pose has a value that is no number"),
        ("spline fit @back.tum -o @x", 1, "line 7: the stamp is 0.05"),
        ("spline fit @swapped.tum -o @x", 1, "position and rotation are swapped"),
        ("spline fit @no.tum -o @x", 1, "there is no such file"),
        ("spline fit @poses.tum -o @poses.tum", 2, "is read, and would be written over"),
        ("spline fit @poses.tum -o @p/curve.svg --plots @p", 2, "cannot both go to"),
        ("spline fit @poses.tum -o - --json", 2, "cannot both go to the standard output"),
        ("spline fit @poses.tum -o @x --plots -", 2, "plots go into a folder"),
        ("spline fit @poses.tum -o @x --form odd", 2, "plain or symmetric"),
        ("spline fit @poses.tum -o @x --spacing 0", 2, "knots 0.0 s apart cannot be"),
        ("spline fit @poses.tum -o @x --spacing 4.2 --smooth -1", 2, "smoothing at -1.0 Hz"),
        ("spline fit @poses.tum -o @x --within 5", 2, "'5' is no distance"),
        ("spline fit @poses.tum -o @x --within 1um", 2, "'1um' is no distance"),
        ("spline fit @poses.tum -o @x --within 1e-20m", 1, "no curve stays within what was asked"),
        ("spline sample @poses.tum --rate 100 -o @x.bag", 2, "says no format"),
        ("spline sample @poses.tum --rate 0 -o @x.csv", 2, "a rate of 0 Hz"),
        ("spline imu @poses.tum --rate 100 -o @x.xyz", 2, "x.xyz"),
        ("spline imu @poses.tum --rate 100 -o @x.csv --lever-arm 1,2", 2, "is no X,Y,Z"),
        ("spline imu @poses.tum --rate 100 -o @x.csv --lever-arm 1,2,nan", 2, "lever_arm_m = NaN"),
        (
            "spline imu @poses.tum --rate 100 -o @x.csv --truth @poses.tum",
            2,
            "the trajectory itself",
        ),
        ("spline imu @poses.tum --rate 100 -o @x.csv --truth @t.tum", 2, "truth is written as CSV"),
    ] {
        flight.refused(arguments, code, words);
        assert!(!Path::new(&flight.at("x")).exists() && !Path::new(&flight.at("x.csv")).exists());
    }
}

/// An ideal IMU along a flight of a minute, integrated over every 10 s, ends at the curve's own poses; nearer the
/// faster it samples, by the order of its rule: h³, but that jerk jumps at knots, which leaves h² of a rule that
/// looks back across them (25 and 16 here); h⁴ of two increments whose pairs end at knots (625), down to rounding.
#[test]
fn poses_become_imu_data_and_poses_again() {
    let flight = Flight::new(60);
    let poses = flight.at("poses.tum");
    for form in [FormName::Plain, FormName::Symmetric] {
        let options = Options {
            form: Some(form),
            spacing: asked::every(0.05).expect("a spacing"),
            smoothing_s: 0.0,
        };
        let route = Arc::new(Route::open(Path::new(&poses), &options).expect("a curve"));
        let [slow, fast, faster] = [200.0, 1000.0, 2000.0]
            .map(|hz| closure(&route, hz, SampleKind::Instantaneous).worst_window_m);
        assert!(
            slow <= 2e-3 && fast <= 1e-4 && fast <= slow / 15.0 && faster <= fast / 3.0,
            "{slow} {fast} {faster}"
        );
        let [slow, fast] =
            [200.0, 1000.0].map(|hz| closure(&route, hz, SampleKind::Increments).worst_window_m);
        assert!(slow <= 2e-3 && fast <= 1e-4 && fast <= slow / 100.0, "{slow} {fast}");
    }
}
