//! Integration at the extremes: rates, angles and steps of every size, a thousand million steps, single precision far
//! from home, holes, reversal, free fall, gimbal lock, the turning Earth.
//!
//! In the table below ε is the scalar's distance from 1 to the next number. A step makes about ten roundings of half
//! an ε relative to what it adds to, and at worst they add up: that, and the rounding of the input itself, is what each
//! case allows.

use std::f64::consts::PI;

use imu_core::integrate::{ConingSculling, Midpoint, Rule as _, ThreeSample};
use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::sample::Sample;
use imu_core::time::Step;
use imu_core::world::{Flat, RotatingEarth, World};
use imu_core::{Compensated, State, so3};
use imu_tools::tradeoff::rules::follow::{CARRIERS, Carrier, Errors, RULES, Record, Rule, follow};
use imu_tools::tradeoff::rules::motion::{GRAVITY, Motion, Truth};

const LEVEL: Quaternion<f64> =
    Quaternion { coords: imu_core::nalgebra::Vector4::new(0.0, 0.0, 0.0, 1.0) };

fn epsilon(carrier: Carrier) -> f64 {
    if carrier == Carrier::F64 { f64::EPSILON } else { f32::EPSILON.into() }
}

fn norm(v: Vector3<f64>) -> f64 {
    v.x.hypot(v.y).hypot(v.z)
}

/// A record of a constant rate and force in body axes, of which the truth is known.
fn steady(
    step_ns: i64,
    steps: i64,
    (rate, force): (Vector3<f64>, Vector3<f64>),
    truth: impl Fn(f64) -> (Quaternion<f64>, Vector3<f64>, Vector3<f64>),
) -> Record {
    let stamps: Vec<i64> = (0..=steps).map(|k| k * step_ns).collect();
    let at = |&ns: &i64| {
        let (attitude_wb, velocity_w, position_w) = truth(ns as f64 / 1e9);
        Truth { attitude_wb, velocity_w, position_w, angular_rate: rate, specific_force: force }
    };
    let dt = step_ns as f64 / 1e9;
    let gathered = vec![[rate * dt, force * dt]; steps as usize];
    Record { truth: stamps.iter().map(at).collect(), stamps, gathered }
}

fn check(what: &str, record: &Record, allowed: impl Fn(f64) -> Errors) {
    for carrier in CARRIERS {
        let allowed = allowed(epsilon(carrier));
        for rule in RULES {
            let errors = follow(record, rule, carrier).unwrap();
            let within = errors.attitude_deg <= allowed.attitude_deg
                && errors.velocity <= allowed.velocity
                && errors.position <= allowed.position;
            assert!(
                within,
                "{what}, {}, {}: {errors:?}, allowed {allowed:?}",
                rule.name(),
                carrier.name()
            );
        }
    }
}

/// A turn about the vertical, from nothing to 1600 turns a second, for two seconds at 1 kHz.
#[test]
fn rates_of_every_size() {
    for rate in [0.0, 1e-300, 1e-40, 1e-20, 1e-9, 1e-3, 1.0, 300.0, 1e4] {
        let spin = (Vector3::new(0.0, 0.0, rate), Vector3::new(0.0, 0.0, GRAVITY));
        let still = |t: f64| {
            (so3::exp(Vector3::new(0.0, 0.0, rate * t)), Vector3::zeros(), Vector3::zeros())
        };
        let record = steady(1_000_000, 2000, spin, still);
        check(&format!("{rate} rad/s"), &record, |epsilon| Errors {
            // Every step's rounding, and of each step's angle: two of its own.
            attitude_deg: (2.0 * 2000.0 + 2.0 * rate * 2.0) * epsilon * 180.0 / PI,
            // Gravity, turned there and taken off, in every step.
            velocity: 8.0 * GRAVITY * 2.0 * epsilon,
            position: 8.0 * GRAVITY * 2.0 * epsilon * 2.0,
        });
    }
}

/// Steps that turn by the smallest number there is, by a little, by π and by more: with constant rate nothing is
/// ambiguous.
#[test]
fn angles_of_every_size_in_one_step() {
    for angle in
        [5e-324, 1e-300, 1e-45, 1e-30, 1e-8, 1e-4, 0.69, 0.71, 1.0, PI - 1e-9, PI, 3.5, 6.3, 50.0]
    {
        let spin = (Vector3::new(angle, 0.0, 0.0), Vector3::zeros());
        let fall = |t: f64| {
            let down = Vector3::new(0.0, 0.0, -GRAVITY);
            (so3::exp(Vector3::new(angle * t, 0.0, 0.0)), down * t, down * (t * t / 2.0))
        };
        let record = steady(1_000_000_000, 8, spin, fall);
        check(&format!("{angle} rad a step"), &record, |epsilon| Errors {
            attitude_deg: (2.0 * 8.0 + 2.0 * angle * 8.0) * epsilon * 180.0 / PI,
            velocity: 8.0 * GRAVITY * 8.0 * epsilon,
            position: 8.0 * GRAVITY * 32.0 * epsilon,
        });
    }
}

/// Steps of 1 ns to 1 s under a constant push, and free fall, which is none.
#[test]
fn steps_of_every_length() {
    for (step_ns, push) in
        [1, 1000, 125_000, 1_000_000, 1_000_000_000].into_iter().flat_map(|step| {
            [(step, Vector3::new(1.0, -2.0, 3.0)), (step, Vector3::new(0.0, 0.0, -GRAVITY))]
        })
    {
        let force = push + Vector3::new(0.0, 0.0, GRAVITY);
        let pushed = |t: f64| (LEVEL, push * t, push * (t * t / 2.0));
        let record = steady(step_ns, 1000, (Vector3::zeros(), force), pushed);
        let t = 1000.0 * step_ns as f64 / 1e9;
        check(&format!("steps of {step_ns} ns"), &record, |epsilon| Errors {
            attitude_deg: 0.0,
            velocity: 1000.0 * GRAVITY * t * epsilon,
            position: 1000.0 * GRAVITY * t * t * epsilon,
        });
    }
}

/// Pitched up by 90°, rolling: Euler angles would be undefined.
#[test]
fn gimbal_lock_is_no_place_of_note() {
    let up = so3::exp(Vector3::new(0.0, -PI / 2.0, 0.0));
    let felt = so3::rotate(&so3::inverse(&up), &Vector3::new(0.0, 0.0, GRAVITY));
    let rolling = |t: f64| {
        let roll = so3::exp(Vector3::new(20.0 * t, 0.0, 0.0));
        (so3::product(&up, &roll), Vector3::zeros(), Vector3::zeros())
    };
    // The force lies in the axis of the roll: (g, 0, 0), but for a rounding of 6e-16.
    let force = Vector3::new(felt.x, 0.0, 0.0);
    let record = steady(1_000_000, 2000, (Vector3::new(20.0, 0.0, 0.0), force), rolling);
    check("gimbal lock", &record, |epsilon| {
        let angle = (2.0 * 2000.0 + 2.0 * 40.0) * epsilon;
        Errors {
            attitude_deg: angle * 180.0 / PI,
            // An attitude that is off tilts gravity.
            velocity: (angle + 8.0 * epsilon) * GRAVITY * 2.0,
            position: (angle + 8.0 * epsilon) * GRAVITY * 4.0,
        }
    });
}

/// 1000 km from the origin, at 1 cm/s: a plain state in single precision does not move at all.
#[test]
fn far_from_home_and_slow() {
    let (home, slow) = (Vector3::new(1e6, -1e6, 0.0), Vector3::new(0.01, 0.01, 0.0));
    let gone = |t: f64| (LEVEL, slow, home + slow * t);
    let record =
        steady(1_000_000, 60_000, (Vector3::zeros(), Vector3::new(0.0, 0.0, GRAVITY)), gone);
    for rule in RULES {
        let position = |carrier| follow(&record, rule, carrier).unwrap().position;
        // 60 000 sums of half an ε of 10⁶ m, at worst.
        assert!(position(Carrier::F64) <= 60_000.0 * 0.5e6 * 2.0 * f64::EPSILON);
        // Numbers there lie 1/16 m apart, on two axes; what is behind them is not lost.
        for carrier in [Carrier::F32Compensated, Carrier::F32Blocks] {
            assert!(position(carrier) <= 2_f64.sqrt() / 32.0 + 1e-3, "{}", position(carrier));
        }
        assert!((position(Carrier::F32) - 0.6 * 2_f64.sqrt()).abs() < 0.1);
    }
}

/// Every twentieth sample lost, up to three in a row, and stamps up to 15 % off: no worse than twice a quarter of the
/// samples, evenly.
#[test]
fn uneven_and_missing_samples() {
    let mut state = 7_u64;
    let mut unit = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let stamps = (0..=20_000_i64)
        .filter_map(|k| {
            let (lost, early) = (unit() < 0.05, unit() - 0.5);
            (k == 0 || !lost).then(|| k * 1_000_000 + (0.3 * early * 1e6) as i64)
        })
        .collect();
    let uneven = Record::new(Motion::Gait, stamps, true);
    let even = Record::new(Motion::Gait, (0..=5000).map(|k| k * 4_000_000).collect(), true);
    for rule in RULES {
        let lossy = follow(&uneven, rule, Carrier::F64).unwrap();
        let slow = follow(&even, rule, Carrier::F64).unwrap();
        // Two increments are of third order where they are uneven, and of fourth where not.
        let more = if rule == Rule::TwoSample { 40.0 } else { 2.0 };
        assert!(lossy.attitude_deg <= more * slow.attitude_deg, "{rule:?} {lossy:?} {slow:?}");
        assert!(lossy.position <= more * 2.0 * slow.position, "{rule:?} {lossy:?} {slow:?}");
    }
}

/// What is not a number never reaches a state: there is no sample to advance by.
#[test]
fn what_is_no_number_is_no_sample() {
    let fine = Vector3::new(0.0, 0.0, 9.81);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
        assert!(Sample::new(Vector3::new(bad, 0.0, 0.0), fine).is_err());
        assert!(Sample::new(fine, Vector3::new(0.0, bad, 0.0)).is_err());
    }
    // The largest that is one, for the longest step there is, leaves a state of numbers.
    let wild = Vector3::new(1e6_f32, -1e6, 1e6);
    let sample = Sample::new(wild, -wild).unwrap();
    let dt = Step::from_nanoseconds(u32::MAX.into()).unwrap();
    let begin =
        State::new(Quaternion::new(1.0_f32, 0.0, 0.0, 0.0), Vector3::zeros(), Vector3::zeros());
    let (mut state, flat) = (begin.unwrap(), Flat::default());
    state.advance(&mut ThreeSample::new(&sample), &sample, &dt, &flat);
    state.advance(&mut ConingSculling::new(&sample), &sample, &dt, &flat);
    let numbers =
        state.attitude_wb().coords.iter().chain(&state.velocity_w()).all(|x| x.is_finite());
    assert!(numbers && state.position_w().iter().all(|x| x.is_finite()));
}

/// The way back: samples in reverse order, with the rate reversed, from the end with the velocity reversed.
///
/// Midpoint is time-symmetric and returns to rounding; the others to within twice their own error.
#[test]
fn a_reversed_motion_returns_to_its_start() {
    let stamps = (0..=10_000).map(|k| k * 1_000_000).collect();
    let record = Record::new(Motion::Gait, stamps, false);
    let samples: Vec<_> = record
        .truth
        .iter()
        .map(|truth| Sample::new(truth.angular_rate, truth.specific_force).unwrap())
        .collect();
    let back: Vec<_> = samples
        .iter()
        .rev()
        .map(|sample| Sample::new(-sample.angular_rate(), sample.specific_force()).unwrap())
        .collect();
    let (dt, first) = (Step::from_nanoseconds(1_000_000).unwrap(), record.truth[0]);
    let world = Flat::new(Vector3::new(0.0, 0.0, -GRAVITY)).unwrap();
    let begin = State::new(first.attitude_wb, first.velocity_w, first.position_w).unwrap();
    let returned = |there: &mut dyn FnMut(&mut State<f64>),
                    home: &mut dyn FnMut(&mut State<f64>)| {
        let mut state = begin;
        there(&mut state);
        let mut state =
            State::new(state.attitude_wb(), -state.velocity_w(), state.position_w()).unwrap();
        home(&mut state);
        norm(state.position_w() - first.position_w)
    };
    let mut there = Midpoint::new(&samples[0]);
    let mut home = Midpoint::new(&back[0]);
    let midpoint = returned(
        &mut |state| samples[1..].iter().for_each(|s| state.advance(&mut there, s, &dt, &world)),
        &mut |state| back[1..].iter().for_each(|s| state.advance(&mut home, s, &dt, &world)),
    );
    // 20 000 steps whose roundings of 1e-15 of 10 m/s² tilt and push, over 20 s.
    assert!(midpoint < 1e-8, "{midpoint}");
    let mut there = ThreeSample::new(&samples[0]);
    let mut home = ThreeSample::new(&back[0]);
    let three = returned(
        &mut |state| samples[1..].iter().for_each(|s| state.advance(&mut there, s, &dt, &world)),
        &mut |state| back[1..].iter().for_each(|s| state.advance(&mut home, s, &dt, &world)),
    );
    let one_way = follow(&record, Rule::ThreeSample, Carrier::F64).unwrap().position;
    // The error of velocity on the way there goes on for as long on the way back.
    assert!(three < 4.0 * one_way, "{three}, one way {one_way}");
}

/// What an IMU on the ellipse reads where the world turns, and how far off three samples are after 60 s at 1 kHz.
fn on_the_earth(latitude: f64, world: &impl World<f64>) -> f64 {
    let earth = RotatingEarth::<f64>::new(latitude, 0.0).unwrap();
    let (turn, gravity) = (earth.rate(), earth.gravity());
    let read = |ns: i64| {
        let truth = Motion::Ellipse.at(ns);
        let body = |v: Vector3<f64>| so3::rotate(&so3::inverse(&truth.attitude_wb), &v);
        let acceleration = so3::rotate(&truth.attitude_wb, &truth.specific_force)
            - Vector3::new(0.0, 0.0, GRAVITY);
        let cross = |a: Vector3<f64>, b: Vector3<f64>| {
            Vector3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
        };
        let coriolis = cross(turn, truth.velocity_w) * 2.0;
        let centrifugal = cross(turn, cross(turn, truth.position_w));
        let force = body(acceleration + coriolis + centrifugal - gravity);
        (truth, Sample::new(truth.angular_rate + body(turn), force).unwrap())
    };
    let (first, sample) = read(0);
    let mut state = State::new(first.attitude_wb, first.velocity_w, first.position_w).unwrap();
    let dt = Step::from_nanoseconds(1_000_000).unwrap();
    let mut rule = ThreeSample::after(&read(-1_000_000).1, &dt, &sample);
    let mut error: f64 = 0.0;
    for k in 1..=60_000 {
        let (truth, sample) = read(k * 1_000_000);
        state.advance(&mut rule, &sample, &dt, world);
        error = error.max(norm(state.position_w() - truth.position_w));
    }
    error
}

/// 60 s without any other reference, at the equator, at the poles and between.
#[test]
fn the_earth_turns() {
    for latitude in [0.0, PI / 2.0, -PI / 2.0, 0.8, -0.3] {
        let earth = RotatingEarth::new(latitude, 0.0).unwrap();
        let error = on_the_earth(latitude, &earth);
        assert!(error < 1e-3, "{latitude}: {error} m");
        // A flat world under the same gravity does not know why the gyroscope turns.
        let flat = Flat::new(earth.gravity()).unwrap();
        assert!(on_the_earth(latitude, &flat) > 10.0 || latitude.abs() > 1.5);
    }
}

/// At rest on the turning Earth, in single precision: 7e-8 rad a step at 1 kHz, which a plain state cannot even add.
#[test]
fn at_rest_on_the_earth_in_single_precision() {
    let earth = RotatingEarth::<f32>::new(0.8, 100.0).unwrap();
    let sample = Sample::new(earth.rate(), -earth.gravity()).unwrap();
    let level =
        State::new(Quaternion::new(1.0_f32, 0.0, 0.0, 0.0), Vector3::zeros(), Vector3::zeros())
            .unwrap();
    let (mut state, mut rule) = (Compensated::from(level), Midpoint::new(&sample));
    let dt = Step::from_nanoseconds(1_000_000).unwrap();
    for _ in 0..60_000 {
        state.advance(&mut rule, &sample, &dt, &earth);
    }
    let state = state.state();
    let tilt = so3::log(&state.attitude_wb());
    // What is felt and what the world turns cancel to a rounding of 7e-8 rad in each step: 60 000 × 7e-8 × 6e-8 rad.
    assert!(tilt.iter().all(|x| x.abs() < 1e-7), "{tilt}");
    assert!(state.position_w().iter().all(|x| x.abs() < 1e-2), "{}", state.position_w());
}

/// A constant rate of 0.01 rad/s at 512 Hz for so many steps: what a compensated state in single precision and a plain
/// one in double are off by, in °.
fn long_turn(steps: u64) -> [f64; 2] {
    const RATE: f32 = 0.01;
    const STEP_NS: i64 = 1_953_125;
    let spin = Sample::new(Vector3::new(0.0, 0.0, RATE), Vector3::zeros()).unwrap();
    let begin =
        State::new(Quaternion::new(1.0_f32, 0.0, 0.0, 0.0), Vector3::zeros(), Vector3::zeros());
    let (mut single, mut rule) = (Compensated::from(begin.unwrap()), Midpoint::new(&spin));
    let spin = Sample::new(Vector3::new(0.0, 0.0, f64::from(RATE)), Vector3::zeros()).unwrap();
    let begin = State::new(LEVEL, Vector3::zeros(), Vector3::zeros()).unwrap();
    let (mut double, mut same) = (begin, Midpoint::new(&spin));
    let (dt, dt64) =
        (Step::from_nanoseconds(STEP_NS).unwrap(), Step::from_nanoseconds(STEP_NS).unwrap());
    for _ in 0..steps {
        let delta =
            rule.step(&Sample::new(Vector3::new(0.0, 0.0, RATE), Vector3::zeros()).unwrap(), &dt);
        single.apply(&delta, &Flat::default());
        let delta = same.step(&spin, &dt64);
        double.apply(&delta, &Flat::default());
    }
    let turned = (f64::from(RATE) * STEP_NS as f64 / 1e9 * steps as f64) % (4.0 * PI);
    let truth = so3::exp(Vector3::new(0.0, 0.0, turned));
    let error = |q: Quaternion<f64>| {
        so3::log(&so3::product(&so3::inverse(&truth), &q)).z.abs().to_degrees()
    };
    let q = single.state().attitude_wb().coords.map(f64::from);
    [error(Quaternion::new(q.w, q.x, q.y, q.z)), error(double.attitude_wb())]
}

/// Four million steps; `cargo test --release -p imu-tests --test maths integration_extremes -- --ignored` takes all 10⁹.
#[test]
fn a_long_turn() {
    let [single, double] = long_turn(4_000_000);
    // The step's angle is rounded by up to ε/4 of itself: 78 rad × 3e-8, in °.
    assert!(single < 78.2 * 3e-8 * 180.0 / PI * 2.0, "{single}°");
    assert!(double < 1e-8, "{double}°");
}

#[test]
#[ignore = "a thousand million steps, minutes"]
fn a_thousand_million_steps() {
    let [single, double] = long_turn(1_000_000_000);
    println!("after 10⁹ steps: f32, compensated {single:.2e}°, f64 {double:.2e}°");
    assert!(single <= 1.0 && double <= 1e-6);
}
