//! One increment a step, with what the increment before says of how rate and force change.

use super::Rule;
use crate::delta::Delta;
use crate::sample::{Bias, Increment};
use crate::time::{Step, seconds};
use crate::vector::{cross, two_crosses};
use crate::{Real, so3};

/// With the increment before, (α₋, υ₋): θ = α + c α₋×α, Δv = υ + ½α×υ + ⅙α×(α×υ) + c(α₋×υ + υ₋×α), Δp =
/// dt(υ₋ + 5υ)/12 + (dt/6)α×υ, c = 1/12 while steps are even: third order.
///
/// For sensors that gather Δθ and Δv where every increment must be used as it comes, or where one is lost now and
/// then. Savage (1998), with the increment before in place of the half before. Uneven steps, a before h: c =
/// h²/(6a(a + h)), Δp = ½hυ − (h³/(6(a + h)))(υ/h − υ₋/a) + (h/6)α×υ. The first step, and one more than five times as
/// long as the step before, do without and are of second order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreviousIncrement<T: Real> {
    previous: Increment<T>,
    weights: Weights<T>,
}

impl<T: Real> PreviousIncrement<T> {
    /// Begins at the instant at which the first increment does.
    #[must_use]
    pub fn new() -> Self {
        let zero = nalgebra::Vector3::from([T::ZERO; 3]);
        let weights =
            Weights { steps: (0, 0), cross: T::ZERO, lever: [T::ZERO; 2], sixth: T::ZERO };
        Self { previous: Increment { angle: zero, velocity: zero }, weights }
    }

    /// Begins behind an increment that is known: third order from the beginning.
    #[must_use]
    pub fn after(previous: &Increment<T>, dt: &Step<T>) -> Self {
        let weights = Weights::of((0, dt.nanoseconds()), dt.seconds());
        Self { previous: *previous, weights }
    }
}

impl<T: Real> Default for PreviousIncrement<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real> Rule<T> for PreviousIncrement<T> {
    type Input = Increment<T>;
    const TRAPEZOID: bool = false;

    #[inline(always)]
    fn step(&mut self, increment: &Increment<T>, dt: &Step<T>) -> Delta<T> {
        let steps = (self.weights.steps.1, dt.nanoseconds());
        if self.weights.steps != steps {
            self.weights = Weights::of(steps, dt.seconds());
        }
        let weights = &self.weights;
        let (before, now) = (&self.previous, increment);
        let coning = cross(&before.angle, &now.angle);
        let sculling = two_crosses(&before.angle, &now.velocity, &before.velocity, &now.angle);
        let turned = cross(&now.angle, &now.velocity);
        let rotation = so3::exp(now.angle + coning * weights.cross);
        let velocity = now.velocity
            + turned * T::from_f64(0.5)
            + cross(&now.angle, &turned) * T::from_f64(1.0 / 6.0)
            + sculling * weights.cross;
        let position = before.velocity * weights.lever[0]
            + now.velocity * weights.lever[1]
            + turned * weights.sixth;
        self.previous = *increment;
        Delta::of_step(rotation, velocity, position, dt)
    }

    #[inline]
    fn rebias(&mut self, change: &Bias<T>) {
        // Before the first increment there is nothing, gathered in no time.
        let dt = seconds::<T>(self.weights.steps.1.into());
        self.previous = Increment {
            angle: self.previous.angle - change.angular_rate * dt,
            velocity: self.previous.velocity - change.specific_force * dt,
        };
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Weights<T> {
    /// The step before (0 at first) and this one, ns.
    steps: (u32, u32),
    /// c
    cross: T,
    /// Of the velocity gathered before, and of that gathered now, in the position, s.
    lever: [T; 2],
    /// h/6
    sixth: T,
}

impl<T: Real> Weights<T> {
    #[cold]
    fn of(steps: (u32, u32), h: T) -> Self {
        let (half, sixth) = (h * T::from_f64(0.5), h * T::from_f64(1.0 / 6.0));
        let (before, now) = steps;
        if before == 0 || now / 5 > before {
            return Self { steps, cross: T::ZERO, lever: [T::ZERO, half], sixth };
        }
        // In units of h.
        let a = T::from_u32(before) / T::from_u32(now);
        let both = T::ONE / (a + T::ONE);
        let cross = T::from_f64(1.0 / 6.0) * both / a;
        let lever = [sixth * both / a, half - sixth * both];
        Self { steps, cross, lever, sixth }
    }
}
