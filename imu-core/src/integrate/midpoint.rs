//! The midpoint rule: the mean of two samples, the second one turned back into the first one's axes.

use super::Rule;
use crate::delta::Delta;
use crate::sample::{Bias, Sample};
use crate::time::Step;
use crate::{Real, so3};

/// θ = ½(ω₀ + ω₁)dt, Δv = ½(f₀ + exp(θ)f₁)dt, Δp = ½Δv dt: second order.
///
/// What VINS-Mono (Qin, Li & Shen, 2018) and its kin integrate by.
/// [`TextbookMidpoint`](super::TextbookMidpoint) is the same with a first-order quaternion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Midpoint<T: Real> {
    previous: Sample<T>,
}

impl<T: Real> Midpoint<T> {
    /// Begins at the instant of this sample.
    #[must_use]
    pub fn new(first: &Sample<T>) -> Self {
        Self { previous: *first }
    }
}

impl<T: Real> Rule<T> for Midpoint<T> {
    type Input = Sample<T>;
    const TRAPEZOID: bool = true;

    #[inline(always)]
    fn step(&mut self, sample: &Sample<T>, dt: &Step<T>) -> Delta<T> {
        let half = dt.seconds() * T::from_f64(0.5);
        let quarter = half * T::from_f64(0.5);
        let rate = self.previous.angular_rate + sample.angular_rate;
        let rotation = so3::exp_of_half(rate * quarter);
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
