//! What preintegration needs to know of a rule's input: how a bias is taken out, and the force at the end of a step.

use crate::Real;
use crate::integrate::Halves;
use crate::sample::{Bias, Increment, Sample};
use crate::time::Step;
use nalgebra::Vector3;

/// A rule's input that a bias can be taken out of: a [`Sample`], an [`Increment`], or two of them.
pub trait Biased<T: Real> {
    /// The same, of a sensor without this bias; `dt` is the step that ends with it.
    #[must_use]
    fn without(&self, bias: &Bias<T>, dt: &Step<T>) -> Self;

    /// f dt, m/s: the specific force at the end of the step, or the nearest to it that is known, in body axes, times
    /// the length of the step.
    fn push(&self, dt: &Step<T>) -> Vector3<T>;
}

impl<T: Real> Biased<T> for Sample<T> {
    #[inline(always)]
    fn without(&self, bias: &Bias<T>, _: &Step<T>) -> Self {
        self.minus(bias)
    }

    #[inline(always)]
    fn push(&self, dt: &Step<T>) -> Vector3<T> {
        self.specific_force * dt.seconds()
    }
}

impl<T: Real> Biased<T> for Increment<T> {
    #[inline(always)]
    fn without(&self, bias: &Bias<T>, dt: &Step<T>) -> Self {
        self.minus(bias, dt)
    }

    #[inline(always)]
    fn push(&self, _: &Step<T>) -> Vector3<T> {
        self.velocity
    }
}

impl<T: Real> Biased<T> for Halves<T> {
    #[inline(always)]
    fn without(&self, bias: &Bias<T>, dt: &Step<T>) -> Self {
        let half = dt.seconds() * T::from_f64(0.5);
        let (angle, velocity) = (bias.angular_rate * half, bias.specific_force * half);
        let less = |increment: &Increment<T>| Increment {
            angle: increment.angle - angle,
            velocity: increment.velocity - velocity,
        };
        Self { first: less(&self.first), second: less(&self.second) }
    }

    #[inline(always)]
    fn push(&self, _: &Step<T>) -> Vector3<T> {
        self.second.velocity + self.second.velocity
    }
}
