use imu_core::nalgebra::Vector3;
use imu_core::so3;

use super::*;
use crate::recording::{Block, Source as _};
use crate::scene::Simulator;
use crate::spline::FormName;

/// A folder with ten seconds of poses, ten a second from 100 s on, of a body that swings.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<String> = (0..=100)
        .map(|k| {
            let t = 0.1 * f64::from(k);
            let q = so3::exp(Vector3::new(0.3 * t.sin(), 0.0, 0.5 * t));
            format!("{} {} {} 1 {} {} {} {}", 100.0 + t, t.cos(), t, q.i, q.j, q.k, q.w)
        })
        .collect();
    std::fs::write(folder.path().join("poses.tum"), rows.join("\n") + "\n").unwrap();
    folder
}

fn scene(folder: &tempfile::TempDir, text: &str) -> Result<Scene, String> {
    let name = folder.path().join("scene.toml");
    Scene::from_toml(text, name.to_str().unwrap()).map_err(|error| error.to_string())
}

#[test]
fn a_scene_follows_poses_from_the_first_to_the_last() {
    let folder = folder();
    let all = scene(&folder, "trajectory = 'poses.tum'").unwrap();
    assert_eq!((all.start_ns, all.duration_ns), (100_000_000_000, 10_000_000_000));
    let means =
        scene(&folder, "trajectory = 'poses.tum'\nsamples = 'mean'\nrate_hz = 100").unwrap();
    assert_eq!((means.start_ns, means.duration_ns), (100_010_000_000, 9_990_000_000));
    let later = scene(&folder, "trajectory = 'poses.tum'\nstart_ns = 104000000000").unwrap();
    assert_eq!((later.start_ns, later.duration_ns), (104_000_000_000, 6_000_000_000));
    let table =
        "[trajectory]\nfile = 'poses.tum'\nform = 'symmetric'\nwithin = '1mm'\nsmooth_hz = 20";
    let Path::Along(route) = scene(&folder, table).unwrap().motion else { panic!() };
    assert_eq!(route.form(), FormName::Symmetric);
    assert!(route.knots().step_ns() > 100_000_000);
}

#[test]
fn samples_are_those_of_the_curve_and_tell_of_it() {
    let folder = folder();
    let scene = scene(&folder, "trajectory = 'poses.tum'\nrate_hz = 10\ngravity = 9.8").unwrap();
    let mut simulator = Simulator::new(&scene).unwrap();
    assert!(matches!(&simulator.take_notes()[..], [Note::Info(text)]
            if text.contains("knots 0.1 s apart")));
    let mut block = Block::default();
    let truth = simulator.advance_with_truth(&mut block).unwrap();
    // The last pose's instant is one of them.
    assert_eq!(truth.motions.len(), 101);
    let Path::Along(route) = &scene.motion else { panic!() };
    for (k, (motion, rate)) in truth.motions.iter().zip(&block.gyroscope).enumerate() {
        let full = route.full(100_000_000_000 + 100_000_000 * k as i64).unwrap();
        assert_eq!(motion.position_w, full.pose.translation());
        assert_eq!(rate.value, <[f64; 3]>::from(full.angular_rate));
        // The poses themselves: six roundings of their decimals.
        let t = 0.1 * k as f64;
        assert!((motion.position_w - Vector3::new(t.cos(), t, 1.0)).abs().max() < 1e-12);
    }
}

/// Increments over pieces that begin and end anywhere between knots add up to the curve's own velocity, but for
/// gravity: of a body that does not turn Σ Δv = v(end) − v(begin) + g t, to roundings of 10⁻¹⁶ a sample.
#[test]
fn increments_are_integrals_across_knots() {
    let folder = folder();
    let rows: Vec<String> = (0..=100)
        .map(|k| {
            let t = 0.1 * f64::from(k);
            format!("{} {} {} {} 0 0 0 1", 100.0 + t, t.cos(), (2.0 * t).sin(), (5.0 * t).sin())
        })
        .collect();
    std::fs::write(folder.path().join("poses.tum"), rows.join("\n") + "\n").unwrap();
    // 3 and 7 a second: of each length, some intervals hold several knots and some none.
    for hz in [3.0, 7.0, 70.0] {
        let text = format!("trajectory = 'poses.tum'\nsamples = 'increments'\nrate_hz = {hz}");
        let scene = scene(&folder, &text).unwrap();
        let mut simulator = Simulator::new(&scene).unwrap();
        let mut block = Block::default();
        assert!(simulator.advance(&mut block));
        let sum = block
            .accelerometer
            .iter()
            .fold(Vector3::zeros(), |sum, s| sum + Vector3::from(s.value));
        let Path::Along(route) = &scene.motion else { panic!() };
        let count = block.accelerometer.len() as f64;
        let end = block.accelerometer.last().unwrap().stamp_ns;
        let v = |t_ns| route.full(t_ns).unwrap().velocity_w;
        let expected = v(end) - v(100_000_000_000) + Vector3::new(0.0, 0.0, 9.81 * count / hz);
        // Stamps of 1/3 s are rounded to 1 ns, at 25 m/s².
        assert!((sum - expected).abs().max() < 1e-7, "{hz} {}", sum - expected);
    }
}

#[test]
fn what_cannot_be_followed_is_refused_with_line_and_key() {
    let folder = folder();
    for (text, words) in [
        (
            "duration = '11s'\ntrajectory = 'poses.tum'",
            "line 1: the scene is 1 s longer than its trajectory",
        ),
        (
            "trajectory = 'poses.tum'\nstart_ns = 99000000000",
            "line 2: the scene begins 1 s before its trajectory",
        ),
        (
            "trajectory = 'poses.tum'\nsamples = 'mean'\nstart_ns = 100000000000",
            "line 3: the scene begins 0.005 s before its trajectory, the interval of the first sample included,",
        ),
        ("trajectory = 'poses.tum'\nstart_ns = 111000000000", "longer than its trajectory"),
        (
            "motion = 'rest'\ntrajectory = 'poses.tum'",
            "line 1: give a motion or a trajectory, not both",
        ),
        ("seed = 1\ntrajectory = 'no.tum'", "line 2: cannot read"),
        (
            "[trajectory]\nfile = 'poses.tum'\nspaceing_s = 1",
            "line 3: there is no key `spaceing_s`",
        ),
        ("[trajectory]\nform = 'plain'", "`file` is missing"),
        ("trajectory = {file = 'poses.tum', spacing_s = 0.1, within = '1mm'}", "not both"),
        ("trajectory = {file = 'poses.tum', spacing_s = 20}", "knots 20.0 s apart cannot be"),
        ("trajectory = {file = 'poses.tum', within = '5'}", "'5' is no distance"),
        ("trajectory = {file = 'poses.tum', smooth_hz = 0}", "smoothing at 0.0 Hz cannot be"),
        ("trajectory = 5", "a file of poses, or a table"),
    ] {
        let error = scene(&folder, text).unwrap_err();
        assert!(error.contains(words) && !error.contains('\n'), "{words}: {error}");
    }
}
