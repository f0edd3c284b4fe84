//! A motion of 4096 samples at 1 kHz, and a run of any rule over it.

use imu_core::integrate::Rule;
use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::sample::Sample;
use imu_core::time::Step;
use imu_core::world::{Flat, World};
use imu_core::{Real, State};

/// How many steps there are.
pub const STEPS: usize = 4096;

/// Rate and force at sample `k`: a body that shakes as it turns.
#[must_use]
pub fn at(k: usize) -> [[f64; 3]; 2] {
    let t = k as f64 / 1000.0;
    let rate = [1.2 * (9.0 * t).cos(), -0.8 * (3.0 * t).sin(), 1.5];
    [rate, [4.0 * (3.0 * t).sin(), 2.0, 9.81 + (9.0 * t).cos()]]
}

/// A vector in another scalar.
#[must_use]
pub fn vector<T: Real>(v: [f64; 3]) -> Vector3<T> {
    Vector3::from(v.map(T::from_f64))
}

/// The samples: one more than there are steps.
#[must_use]
pub fn samples<T: Real>() -> Vec<Sample<T>> {
    let sample = |[rate, force]: [[f64; 3]; 2]| Sample::new(vector(rate), vector(force));
    (0..=STEPS).map(|k| sample(at(k)).expect("finite")).collect()
}

/// The time between them.
#[must_use]
pub fn step<T: Real>() -> Step<T> {
    Step::from_nanoseconds(1_000_000).expect("a millisecond")
}

/// Under gravity alone.
#[must_use]
pub fn world<T: Real>() -> Flat<T> {
    Flat::new(vector([0.0, 0.0, -9.81])).expect("finite")
}

/// Level, at rest, at the origin.
#[must_use]
pub fn begin<T: Real>() -> State<T> {
    let q = [1.0, 0.0, 0.0, 0.0].map(T::from_f64);
    let zero = vector([0.0; 3]);
    State::new(Quaternion::new(q[0], q[1], q[2], q[3]), zero, zero).expect("finite")
}

/// A whole run: a function of its own, so that what stands around it changes nothing in its loop.
#[inline(never)]
#[must_use]
pub fn run<T: Real, R: Rule<T>>(
    mut rule: R,
    inputs: &[R::Input],
    dt: &Step<T>,
    world: &impl World<T>,
) -> State<T> {
    let mut state = begin();
    for input in inputs {
        state.advance(&mut rule, input, dt, world);
    }
    state
}
