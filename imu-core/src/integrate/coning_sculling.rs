//! Coning and sculling: midpoint's price, with the cross terms of a rate and a force that change linearly.

use super::Rule;
use crate::delta::Delta;
use crate::sample::{Bias, Sample};
use crate::time::Step;
use crate::vector::{cross, two_crosses};
use crate::{Real, so3};

/// With α = ½(ω₀ + ω₁)dt and υ = ½(f₀ + f₁)dt: θ = α + (dt²/12)ω₀×ω₁, Δv = υ + ½α×υ + (dt²/12)(ω₀×f₁ + f₀×ω₁),
/// Δp = ½Δv dt; second order.
///
/// From Savage (1998), "Strapdown inertial navigation integration algorithm design", parts 1 and 2, for a rate and a
/// force that are linear over one step. Attitude errs by 0.44 to 0.5 of [`Midpoint`](super::Midpoint)'s, as does the
/// velocity of a body that shakes as it turns; the trapezoid of the position is as wrong as midpoint's, so on smooth
/// motion the position gains nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConingSculling<T: Real> {
    previous: Sample<T>,
}

impl<T: Real> ConingSculling<T> {
    /// Begins at the instant of this sample.
    #[must_use]
    pub fn new(first: &Sample<T>) -> Self {
        Self { previous: *first }
    }
}

impl<T: Real> Rule<T> for ConingSculling<T> {
    type Input = Sample<T>;
    const TRAPEZOID: bool = true;

    #[inline(always)]
    fn step(&mut self, sample: &Sample<T>, dt: &Step<T>) -> Delta<T> {
        let (before, now) = (&self.previous, sample);
        let half = dt.seconds() * T::from_f64(0.5);
        let quarter = half * T::from_f64(0.5);
        let sixth = dt.seconds() * T::from_f64(1.0 / 6.0);
        let half_angle = (before.angular_rate + now.angular_rate) * quarter;
        let push = (before.specific_force + now.specific_force) * half;
        // ω₀×ω₁ = (2/dt)ω₀×α, and ω₀×f₁ + f₀×ω₁ = (2/dt)(ω₀×υ + f₀×α).
        let lead = before.angular_rate * sixth;
        let rotation = so3::exp_of_half(half_angle + cross(&lead, &half_angle));
        let sculling = two_crosses(
            &(half_angle + lead),
            &push,
            &before.specific_force,
            &(half_angle * (sixth + sixth)),
        );
        let velocity = push + sculling;
        self.previous = *sample;
        Delta::of_step(rotation, velocity, velocity * half, dt)
    }

    #[inline]
    fn rebias(&mut self, change: &Bias<T>) {
        self.previous = self.previous.minus(change);
    }
}
