//! Integration rules: from samples, or increments, to a gravity-free [`Delta`] for every step.
//!
//! | rule | takes | order | what it is for |
//! | --- | --- | --- | --- |
//! | [`Euler`] | samples | 1 | nothing but comparison: half a metre off after 20 s of the classic ellipse (5 m/s) at 200 Hz |
//! | [`Midpoint`] | samples | 2 | what most estimators do |
//! | [`ConingSculling`] | samples | 2 | the price of midpoint, 0.44 to 0.5 of its attitude error |
//! | [`ThreeSample`] | samples | 3 | smooth motion: 1000 times better than midpoint at half as many instructions again |
//! | [`TwoSample`] | increments | 4 | sensors that gather Δθ and Δv, two at a time |
//! | [`PreviousIncrement`] | increments | 3 | the same sensors, one at a time |
//! | [`TextbookEuler`], [`TextbookMidpoint`] | samples | 1, 2 | published results, to their last digit |
//!
//! A rule remembers what it needs of the past: the sample before, or two. It begins with the first sample, and every
//! [`step`](Rule::step) takes the next and the time since. Across a hole begin with a new rule: nobody knows what
//! happened in it. What each rule costs and buys on which motion is measured by `imu tradeoff rules`.
//!
//! No step can fail or panic, and none takes a sine, a square root or, while `dt` stays the same, a division, as long
//! as a step turns by less than 0.7 rad (5600 rad/s at 8 kHz); the textbook forms alone take a square root.
//!
//! ```
//! use imu_core::delta::Delta;
//! use imu_core::integrate::{ConingSculling, Rule};
//! use imu_core::nalgebra::Vector3;
//! use imu_core::sample::Sample;
//! use imu_core::time::Step;
//!
//! let dt = Step::from_nanoseconds(1_000_000)?;
//! let at = |k: i32| {
//!     let t = f64::from(k) * 1e-3;
//!     Sample::new(Vector3::new(0.1, 0.0, t), Vector3::new(t, 0.0, 9.81))
//! };
//! let mut rule = ConingSculling::new(&at(0)?);
//! let mut moved = Delta::identity();
//! for k in 1..=1000 {
//!     moved = moved.then(&rule.step(&at(k)?, &dt));
//! }
//! assert_eq!(moved.nanoseconds(), 1_000_000_000);
//! assert!((moved.velocity().z - 9.8).abs() < 0.1);
//! # Ok::<(), imu_core::Error>(())
//! ```
//!
//! # Blocks: two speeds for single precision
//!
//! In `f32` a state loses digits with every step added to it. Deltas of eight steps are composed by
//! [`Delta::then`] first, where all numbers are small, and moved into the [`State`](crate::State) at an eighth of the
//! rate. [`Compensated`](crate::Compensated) goes further still.

mod concrete;
mod coning_sculling;
mod euler;
mod midpoint;
mod previous_increment;
mod textbook;
mod three_sample;
mod two_sample;

pub use concrete::{double, single};
pub use coning_sculling::ConingSculling;
pub use euler::Euler;
pub use midpoint::Midpoint;
pub use previous_increment::PreviousIncrement;
pub use textbook::{TextbookEuler, TextbookMidpoint};
pub use three_sample::ThreeSample;
pub use two_sample::{Halves, TwoSample};

use crate::Real;
use crate::delta::Delta;
use crate::sample::Bias;
use crate::time::Step;

/// A way to turn what an IMU says into motion, step by step.
pub trait Rule<T: Real> {
    /// What it takes: a [`Sample`](crate::sample::Sample) of an instant, or [`Increment`](crate::sample::Increment)s.
    type Input;

    /// Whether it takes the position by the trapezoid of the velocity: p = ½ v dt in every [`Delta`] of a step.
    const TRAPEZOID: bool;

    /// The motion from the input before to this one, which came `dt` later.
    fn step(&mut self, input: &Self::Input, dt: &Step<T>) -> Delta<T>;

    /// Takes a bias larger by `change` out of what it remembers, as if it had been out of every input: for whoever
    /// subtracts biases from inputs, and has come to know them better.
    fn rebias(&mut self, change: &Bias<T>);
}
