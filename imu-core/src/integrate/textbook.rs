//! Euler and midpoint as textbooks and course programs have them, so that published results can be reproduced.
//!
//! They turn by the quaternion (1, ½θ), taken to unit length, in place of the exponential: too little by θ³/12. All
//! else is [`Euler`](super::Euler)'s and [`Midpoint`](super::Midpoint)'s. The order of the updates, for i = 1…n (He &
//! Gao (2019), `vio_data_simulation`):
//!
//! - Euler: a = Q fᵢ + g with the old Q; Q ← Q·normalised(1, ½ωᵢdt); P ← P + V dt + ½a dt²; V ← V + a dt.
//! - midpoint: Q' = Q·normalised(1, ¼(ωᵢ₋₁ + ωᵢ)dt); a = ½(Q fᵢ₋₁ + Q' fᵢ) + g; P, V as before; Q ← Q'.
//!
//! A [`Delta`] and a flat world are exactly that, with the sums in another order.
//!
//! ```
//! use imu_core::integrate::{Midpoint, Rule, TextbookMidpoint};
//! use imu_core::nalgebra::Vector3;
//! use imu_core::sample::Sample;
//! use imu_core::time::Step;
//! use imu_core::so3;
//! let spin = Sample::new(Vector3::new(0.0, 0.0, 10.0), Vector3::zeros())?;
//! let dt = Step::from_nanoseconds(10_000_000)?; // 0.1 rad a step
//! let textbook = so3::log(&TextbookMidpoint::new(&spin).step(&spin, &dt).rotation()).z;
//! let exact = so3::log(&Midpoint::new(&spin).step(&spin, &dt).rotation()).z;
//! assert!((exact - 0.1_f64).abs() < 1e-15 && (exact - textbook - 0.1_f64.powi(3) / 12.0).abs() < 1e-6);
//! # Ok::<(), imu_core::Error>(())
//! ```

use super::Rule;
use crate::delta::Delta;
use crate::sample::{Bias, Sample};
use crate::time::Step;
use crate::{Real, so3};
use nalgebra::{Quaternion, Vector3};

/// Euler's rule with a first-order quaternion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TextbookEuler;

impl<T: Real> Rule<T> for TextbookEuler {
    type Input = Sample<T>;
    const TRAPEZOID: bool = true;

    #[inline(always)]
    fn step(&mut self, sample: &Sample<T>, dt: &Step<T>) -> Delta<T> {
        let half = dt.seconds() * T::from_f64(0.5);
        let velocity = sample.specific_force * dt.seconds();
        Delta::of_step(turn(sample.angular_rate * half), velocity, velocity * half, dt)
    }

    #[inline]
    fn rebias(&mut self, _: &Bias<T>) {}
}

/// The midpoint rule with a first-order quaternion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextbookMidpoint<T: Real> {
    previous: Sample<T>,
}

impl<T: Real> TextbookMidpoint<T> {
    /// Begins at the instant of this sample.
    #[must_use]
    pub fn new(first: &Sample<T>) -> Self {
        Self { previous: *first }
    }
}

impl<T: Real> Rule<T> for TextbookMidpoint<T> {
    type Input = Sample<T>;
    const TRAPEZOID: bool = true;

    #[inline(always)]
    fn step(&mut self, sample: &Sample<T>, dt: &Step<T>) -> Delta<T> {
        let half = dt.seconds() * T::from_f64(0.5);
        let mean = (self.previous.angular_rate + sample.angular_rate) * T::from_f64(0.5);
        let rotation = turn(mean * half);
        let later_force = so3::rotate(&rotation, &sample.specific_force);
        let velocity = (self.previous.specific_force + later_force) * half;
        self.previous = *sample;
        Delta::of_step(rotation, velocity, velocity * half, dt)
    }

    #[inline]
    fn rebias(&mut self, change: &Bias<T>) {
        self.previous = self.previous.minus(change);
    }
}

/// (1, half), of unit length.
#[inline(always)]
fn turn<T: Real>(half: Vector3<T>) -> Quaternion<T> {
    let q = Quaternion::new(T::ONE, half.x, half.y, half.z);
    Quaternion::from(q.coords / so3::length(&q))
}
