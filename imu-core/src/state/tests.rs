use super::*;
use crate::integrate::{ConingSculling, Midpoint, ThreeSample};
use crate::sample::Sample;
use crate::world::{Flat, RotatingEarth};
use proptest::prelude::*;
use std::vec::Vec;

fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-size..size, -size..size, -size..size].prop_map(Vector3::from)
}

fn state() -> impl Strategy<Value = State<f64>> {
    (vector(3.0), vector(10.0), vector(100.0)).prop_map(|(turn, velocity, position)| {
        State::new(so3::exp(turn), velocity, position).unwrap()
    })
}

fn samples() -> impl Strategy<Value = Vec<Sample<f64>>> {
    let sample =
        (vector(5.0), vector(20.0)).prop_map(|(rate, force)| Sample::new(rate, force).unwrap());
    prop::collection::vec(sample, 2..20)
}

/// The largest difference of any number.
fn apart(a: &State<f64>, b: &State<f64>) -> f64 {
    let turned = so3::product(&so3::inverse(&a.attitude_wb), &b.attitude_wb);
    so3::log(&turned)
        .abs()
        .max()
        .max((a.velocity_w - b.velocity_w).abs().max())
        .max((a.position_w - b.position_w).abs().max())
}

/// The same states by a rule's own steps, and by `advance`.
fn both_ways<R: Rule<f64, Input = Sample<f64>> + Clone>(
    rule: R,
    begin: State<f64>,
    samples: &[Sample<f64>],
    world: &impl World<f64>,
) -> [State<f64>; 3] {
    let dt = Step::from_nanoseconds(10_000_000).unwrap();
    let (mut stepping, mut moving) = (rule.clone(), rule);
    let (mut applied, mut advanced, mut compensated) = (begin, begin, Compensated::from(begin));
    for sample in samples {
        let delta = stepping.step(sample, &dt);
        applied.apply(&delta, world);
        compensated.apply(&delta, world);
        advanced.advance(&mut moving, sample, &dt, world);
    }
    [applied, advanced, compensated.state()]
}

// Twenty steps of numbers up to 500: a few hundred of their units of 6e-14 would be 1e-11.
proptest! {
    #[test]
    fn advancing_is_stepping_and_applying(begin in state(), samples in samples(), latitude in -1.5..1.5) {
        let flat = Flat::default();
        let earth = RotatingEarth::new(latitude, 100.0).unwrap();
        let first = &samples[0];
        let all = [
            both_ways(Midpoint::new(first), begin, &samples, &flat),
            both_ways(ConingSculling::new(first), begin, &samples, &earth),
            both_ways(ThreeSample::new(first), begin, &samples, &flat),
            both_ways(ThreeSample::new(first), begin, &samples, &earth),
        ];
        for [applied, advanced, compensated] in all {
            prop_assert!(apart(&applied, &advanced) < 1e-11);
            prop_assert!(apart(&applied, &compensated) < 1e-11);
        }
    }

    #[test]
    fn a_composed_delta_moves_as_its_steps_do(begin in state(), samples in samples()) {
        let (flat, dt) = (Flat::default(), Step::from_nanoseconds(10_000_000).unwrap());
        let mut rule = ThreeSample::new(&samples[0]);
        let (mut steps, mut whole) = (begin, Delta::identity());
        for sample in &samples {
            let delta = rule.step(sample, &dt);
            steps.apply(&delta, &flat);
            whole = whole.then(&delta);
        }
        let mut at_once = begin;
        at_once.apply(&whole, &flat);
        prop_assert!(apart(&steps, &at_once) < 1e-11);
    }
}

#[test]
fn what_is_no_state_is_refused() {
    let (q, zero) = (Quaternion::new(1.0_f32, 0.0, 0.0, 0.0), Vector3::zeros());
    for bad in [f32::NAN, f32::INFINITY, 1e13] {
        let v = Vector3::new(0.0, bad, 0.0);
        assert_eq!(State::new(q, v, zero), Err(Error::OutOfRange("velocity_w")));
        assert_eq!(State::new(q, zero, v), Err(Error::OutOfRange("position_w")));
        let no_rotation = Quaternion::new(bad, 0.0, 0.0, 0.0);
        assert_eq!(State::new(no_rotation, zero, zero), Err(Error::OutOfRange("attitude_wb")));
    }
    assert!(State::new(Quaternion::new(0.0, 0.0, 0.0, 0.0), zero, zero).is_err());
    let near = State::new(Quaternion::new(0.0, 1.5, 0.0, 0.0), zero, zero).unwrap();
    assert_eq!(near.attitude_wb(), Quaternion::new(0.0, 1.0, 0.0, 0.0));
}
