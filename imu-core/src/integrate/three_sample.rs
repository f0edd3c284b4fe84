//! Three samples: a parabola through the last three, and all terms of third order.

use super::Rule;
use crate::delta::Delta;
use crate::sample::{Bias, Sample};
use crate::time::Step;
use crate::vector::{cross, two_crosses};
use crate::{Real, so3};
use nalgebra::Vector3;

/// α and υ by the parabola through the last three samples, then θ = α + (dt²/12)ω₀×ω₁, Δv = υ + ½α×υ + ⅙α×(α×υ) +
/// (dt²/12)(ω₀×f₁ + f₀×ω₁), Δp by the parabola twice integrated + (dt/6)α×υ: third order, with uneven steps, too.
///
/// Derived as [`ConingSculling`](super::ConingSculling) is (Savage, 1998), with rate and force quadratic in time.
/// The weights of the three samples follow the lengths of the last two steps, and are worked out when those change.
/// The first step, and one more than five times as long as the step before (where a parabola would be
/// extrapolation), know two samples only and are of second order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreeSample<T: Real> {
    earlier: Sample<T>,
    previous: Sample<T>,
    weights: Weights<T>,
}

impl<T: Real> ThreeSample<T> {
    /// Begins at the instant of this sample.
    #[must_use]
    pub fn new(first: &Sample<T>) -> Self {
        let zero = [T::ZERO; 3];
        let weights = Weights {
            steps: (0, 0),
            half_mean: zero,
            mean: zero,
            lever: zero,
            twelfth: T::ZERO,
            third: T::ZERO,
        };
        Self { earlier: *first, previous: *first, weights }
    }

    /// Begins at the instant of `first`, a step after a sample that is known, too: third order from the beginning.
    #[must_use]
    pub fn after(earlier: &Sample<T>, dt: &Step<T>, first: &Sample<T>) -> Self {
        let weights = Weights::of((0, dt.nanoseconds()), dt.seconds());
        Self { earlier: *earlier, previous: *first, weights }
    }
}

impl<T: Real> Rule<T> for ThreeSample<T> {
    type Input = Sample<T>;
    const TRAPEZOID: bool = false;

    #[inline(always)]
    fn step(&mut self, sample: &Sample<T>, dt: &Step<T>) -> Delta<T> {
        let steps = (self.weights.steps.1, dt.nanoseconds());
        if self.weights.steps != steps {
            self.weights = Weights::of(steps, dt.seconds());
        }
        let weights = &self.weights;
        let (twelfth, third) = (weights.twelfth, weights.third);
        let (earlier, before, now) = (&self.earlier, &self.previous, sample);
        let rates = [&earlier.angular_rate, &before.angular_rate, &now.angular_rate];
        let forces = [&earlier.specific_force, &before.specific_force, &now.specific_force];
        let half_angle = weighted(&weights.half_mean, rates);
        let push = weighted(&weights.mean, forces);
        let coning = cross(&before.angular_rate, &now.angular_rate);
        let sculling = two_crosses(
            &before.angular_rate,
            &now.specific_force,
            &before.specific_force,
            &now.angular_rate,
        );
        let turned = cross(&half_angle, &push);
        let rotation = so3::exp_of_half(half_angle + coning * (twelfth * T::from_f64(0.5)));
        let velocity = push
            + turned
            + cross(&half_angle, &turned) * T::from_f64(2.0 / 3.0)
            + sculling * twelfth;
        let position = weighted(&weights.lever, forces) + turned * third;
        self.earlier = self.previous;
        self.previous = *sample;
        Delta::of_step(rotation, velocity, position, dt)
    }

    #[inline]
    fn rebias(&mut self, change: &Bias<T>) {
        self.earlier = self.earlier.minus(change);
        self.previous = self.previous.minus(change);
    }
}

/// What three samples weigh in a step of one length after a step of another.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Weights<T> {
    /// The step before (0 at first) and this one, ns.
    steps: (u32, u32),
    /// Half of the next: what the angle takes, which is wanted by halves.
    half_mean: [T; 3],
    /// Of the earlier, the previous and the new sample in the integral, s.
    mean: [T; 3],
    /// In the integral's integral, s².
    lever: [T; 3],
    /// h²/12
    twelfth: T,
    /// h/3
    third: T,
}

impl<T: Real> Weights<T> {
    /// The integrals of Lagrange's polynomials through samples at −a, 0 and h.
    #[cold]
    fn of(steps: (u32, u32), h: T) -> Self {
        let number = |x: u32| T::from_u32(x);
        let (square, half) = (h * h, h * T::from_f64(0.5));
        let sixth = h * T::from_f64(1.0 / 6.0);
        // Of a straight line through the last two.
        let (mut mean, mut lever) =
            ([T::ZERO, half, half], [T::ZERO, square * T::from_f64(1.0 / 3.0), h * sixth]);
        let (before, now) = steps;
        if before > 0 && now / 5 <= before {
            // In units of h: 1/a and 1/(a + 1).
            let a = number(before) / number(now);
            let (over, both) = (T::ONE / a, T::ONE / (a + T::ONE));
            mean =
                [-over * both, (T::ONE + number(3) * a) * over, (number(2) + number(3) * a) * both]
                    .map(|weight| weight * sixth);
            let twelfth = square * T::from_f64(1.0 / 12.0);
            lever =
                [-over * both, (T::ONE + number(4) * a) * over, (T::ONE + number(2) * a) * both]
                    .map(|weight| weight * twelfth);
        }
        Self {
            steps,
            half_mean: mean.map(|weight| weight * T::from_f64(0.5)),
            mean,
            lever,
            twelfth: square * T::from_f64(1.0 / 12.0),
            third: h * T::from_f64(1.0 / 3.0),
        }
    }
}

#[inline(always)]
fn weighted<T: Real>(weights: &[T; 3], of: [&Vector3<T>; 3]) -> Vector3<T> {
    of[0] * weights[0] + of[1] * weights[1] + of[2] * weights[2]
}
