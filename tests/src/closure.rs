//! From poses to IMU data and back: an ideal IMU along a curve, integrated, against the curve's own poses.

use std::sync::Arc;

use imu_core::State;
use imu_core::integrate::{Halves, Rule, ThreeSample, TwoSample};
use imu_core::nalgebra::Vector3;
use imu_core::sample::{Increment, Sample};
use imu_core::time::Step;
use imu_core::world::Flat;
use imu_tools::recording::{Block, SampleKind};
use imu_tools::scene::{Rate, Scene, Simulator};
use imu_tools::spline::Route;

/// Windows are this long, s, …
const WINDOW_S: f64 = 10.0;
/// … and one begins every so many seconds.
const STRIDE_S: f64 = 1.0;

/// How far integration ends from the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closure {
    /// The largest distance at the end of any window of 10 s, m.
    pub worst_window_m: f64,
    /// When that window begins, s after the first sample.
    pub worst_after_s: f64,
    /// The distance at the end of everything, m.
    pub whole_m: f64,
    /// How long everything is, s.
    pub length_s: f64,
}

/// Ideal samples by the three-sample rule, or increments by the two-sample rule.
///
/// # Panics
/// When the curve cannot be simulated at this rate.
#[must_use]
pub fn closure(route: &Arc<Route>, rate_hz: f64, kind: SampleKind) -> Closure {
    let rate = Rate::from_hz(rate_hz).expect("a rate");
    let scene = Scene::along(Arc::clone(route), rate, kind);
    let mut simulator = Simulator::new(&scene).expect("a scene");
    let (mut rates, mut forces, mut block) = (Vec::new(), Vec::new(), Block::default());
    while simulator.advance(&mut block) {
        rates.append(&mut block.gyroscope);
        forces.append(&mut block.accelerometer);
    }
    let both = rates.iter().zip(&forces);
    let rows: Vec<_> =
        both.map(|(w, f)| (w.stamp_ns, Vector3::from(w.value), Vector3::from(f.value))).collect();
    let window = (WINDOW_S * rate_hz).round() as usize;
    let stride = (STRIDE_S * rate_hz).round() as usize;
    let run = |from: usize, steps: usize| match kind {
        SampleKind::Instantaneous => by_three_samples(route, &rows[from..=from + steps]),
        SampleKind::Mean | SampleKind::Increments => {
            by_two_increments(route, &rows[from..from + steps / 2 * 2], rate_hz)
        }
    };
    let most = rows.len() - 1;
    let windows = (0..=most.saturating_sub(window)).step_by(stride);
    let ends = windows.map(|from| (run(from, window.min(most)), from as f64 / rate_hz));
    let (worst_window_m, worst_after_s) =
        ends.fold((0.0, 0.0), |worst, end| if end.0 > worst.0 { end } else { worst });
    let length_s = most as f64 / rate_hz;
    Closure { worst_window_m, worst_after_s, whole_m: run(0, most), length_s }
}

type Row = (i64, Vector3<f64>, Vector3<f64>);

/// The state of the curve itself.
fn start(route: &Route, t_ns: i64) -> State<f64> {
    let full = route.full(t_ns).expect("within the curve");
    State::new(full.pose.rotation(), full.velocity_w, full.pose.translation()).expect("a state")
}

fn distance(route: &Route, t_ns: i64, state: &State<f64>) -> f64 {
    let there = route.full(t_ns).expect("within the curve").pose.translation();
    let [x, y, z] = (state.position_w() - there).into();
    x.hypot(y).hypot(z)
}

fn world() -> Flat<f64> {
    Flat::new(Vector3::new(0.0, 0.0, -9.81)).expect("gravity")
}

fn by_three_samples(route: &Route, rows: &[Row]) -> f64 {
    let sample = |(_, w, f): &Row| Sample::new(*w, *f).expect("a sample");
    let (first, last) = (rows[0].0, rows[rows.len() - 1].0);
    let (mut state, world) = (start(route, first), world());
    let mut rule = ThreeSample::new(&sample(&rows[0]));
    for two in rows.windows(2) {
        let dt = Step::between(two[0].0, two[1].0).expect("a step");
        state.apply(&rule.step(&sample(&two[1]), &dt), &world);
    }
    distance(route, last, &state)
}

fn by_two_increments(route: &Route, rows: &[Row], rate_hz: f64) -> f64 {
    let period_ns = (1e9 / rate_hz).round() as i64;
    let increment = |(_, w, f): &Row| Increment::new(*w, *f).expect("an increment");
    let (mut state, world) = (start(route, rows[0].0 - period_ns), world());
    let dt = Step::from_nanoseconds(2 * period_ns).expect("a step");
    for two in rows.chunks_exact(2) {
        let halves = Halves { first: increment(&two[0]), second: increment(&two[1]) };
        state.apply(&TwoSample.step(&halves, &dt), &world);
    }
    distance(route, rows[rows.len() - 1].0, &state)
}
