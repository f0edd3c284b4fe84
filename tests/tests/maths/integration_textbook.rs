//! The textbook rules on the classic trajectory: published errors, to their last digit but one.

use imu_core::State;
use imu_core::integrate::{Rule, TextbookEuler, TextbookMidpoint, ThreeSample};
use imu_core::nalgebra::Vector3;
use imu_core::sample::Sample;
use imu_core::so3;
use imu_core::time::Step;
use imu_core::trajectory::{Ellipse, GRAVITY, Motion, Trajectory};
use imu_core::world::Flat;

const DURATION_S: i64 = 20;

/// Root mean square of the position's error in m and of the angle's in °, over all steps but the start, and the
/// position's error at the end.
#[derive(Clone, Copy, Debug)]
struct Errors {
    position: f64,
    last: f64,
    angle: f64,
}

fn sample(motion: &Motion<f64>) -> Sample<f64> {
    Sample::new(motion.angular_rate, motion.specific_force).unwrap()
}

fn norm(v: Vector3<f64>) -> f64 {
    v.x.hypot(v.y).hypot(v.z)
}

fn follow(rate: i64, mut rule: impl Rule<f64, Input = Sample<f64>>) -> Errors {
    let step_ns = 1_000_000_000 / rate;
    let dt = Step::from_nanoseconds(step_ns).unwrap();
    let world = Flat::new(Vector3::new(0.0, 0.0, -GRAVITY)).unwrap();
    let first: Motion<f64> = Ellipse::default().at(0);
    let mut state = State::new(first.attitude_wb, first.velocity_w, first.position_w).unwrap();
    let (mut squares, mut angles, mut last) = (0.0, 0.0, 0.0);
    for k in 1..=DURATION_S * rate {
        let truth: Motion<f64> = Ellipse::default().at(k * step_ns);
        state.advance(&mut rule, &sample(&truth), &dt, &world);
        last = norm(state.position_w() - truth.position_w);
        squares += last * last;
        let apart = so3::product(&so3::inverse(&truth.attitude_wb), &state.attitude_wb());
        angles += norm(so3::log(&apart)).to_degrees().powi(2);
    }
    let n = (DURATION_S * rate) as f64;
    Errors { position: (squares / n).sqrt(), last, angle: (angles / n).sqrt() }
}

/// Agreement with a printed number: one unit of its last digit but one.
fn printed(value: f64, number: f64, unit: f64) {
    assert!((value - number).abs() < 10.0 * unit, "{value} is printed as {number}");
}

/// Course program `vio_data_simulation` (He & Gao, 2019) in double precision: rate, position RMSE and final error,
/// rotation RMSE, each with the unit of its last digit.
#[test]
fn textbook_euler_is_as_far_off_as_published() {
    for (rate, position, last, angle) in [
        (100, 0.96476, 2.08435, 0.07124),
        (200, 0.48231, 1.04229, 0.03562),
        (400, 0.24114, 0.52118, 0.01781),
        (1000, 0.09645, 0.20848, 0.00712),
    ] {
        let errors = follow(rate, TextbookEuler);
        printed(errors.position, position, 1e-5);
        printed(errors.last, last, 1e-5);
        printed(errors.angle, angle, 1e-5);
    }
}

#[test]
fn textbook_midpoint_is_as_far_off_as_published() {
    let first: Motion<f64> = Ellipse::default().at(0);
    for (rate, (position, unit), (last, last_unit), (angle, angle_unit)) in [
        (100, (2.9916e-3, 1e-7), (5.1780e-3, 1e-7), (5.40e-4, 1e-6)),
        (200, (7.4776e-4, 1e-8), (1.2945e-3, 1e-7), (1.349e-4, 1e-7)),
        (400, (1.8692e-4, 1e-8), (3.2362e-4, 1e-8), (3.37e-5, 1e-7)),
        (1000, (2.9906e-5, 1e-9), (5.1780e-5, 1e-9), (5.40e-6, 1e-8)),
    ] {
        let errors = follow(rate, TextbookMidpoint::new(&sample(&first)));
        printed(errors.position, position, unit);
        printed(errors.last, last, last_unit);
        printed(errors.angle, angle, angle_unit);
    }
}

/// With the sample before the start at hand, three samples are within a micrometre at 200 Hz.
#[test]
fn three_samples_are_within_a_micrometre() {
    let at = |ns| sample(&Ellipse::default().at(ns));
    let dt = Step::from_nanoseconds(5_000_000).unwrap();
    let errors = follow(200, ThreeSample::after(&at(-5_000_000), &dt, &at(0)));
    assert!(errors.position < 1e-6, "{errors:?}");
    // Without it the first step is of second order, and its error of velocity stays.
    let errors = follow(200, ThreeSample::new(&at(0)));
    assert!(errors.position < 1e-5, "{errors:?}");
}
