//! Two increments make a step: the fourth-order rule for sensors that gather Δθ and Δv.

use super::Rule;
use crate::delta::Delta;
use crate::sample::{Bias, Increment};
use crate::time::Step;
use crate::vector::{cross, dot, two_crosses};
use crate::{Real, so3};

/// Two increments of equal lengths, one after the other: what [`TwoSample`] takes at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halves<T: Real> {
    /// Of the first half of the step.
    pub first: Increment<T>,
    /// Of the second half.
    pub second: Increment<T>,
}

/// With α = α₁ + α₂, υ = υ₁ + υ₂: θ = α + ⅔α₁×α₂, u = υ + ⅔(α₁×υ₂ + υ₁×α₂), Δv = u + (½ − |θ|²/24)θ×u +
/// ⅙θ×(θ×u), Δp = (h/6)(5υ₁ + υ₂) + (h/3)α₁×υ + (h/24)α×(α×υ): fourth order in attitude, velocity and position.
///
/// θ and u are Savage's (1998; Miller's coning algorithm of two samples, 1983, and its equivalent for sculling); the
/// terms that the position needs for its fourth order, and that of |θ|² in the velocity, are derived in the same way.
/// `dt` is the time of both halves together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwoSample;

impl<T: Real> Rule<T> for TwoSample {
    type Input = Halves<T>;
    const TRAPEZOID: bool = false;

    #[inline(always)]
    fn step(&mut self, halves: &Halves<T>, dt: &Step<T>) -> Delta<T> {
        let Halves { first, second } = halves;
        let coefficient = T::from_f64(2.0 / 3.0);
        let h = dt.seconds();
        let (angle, push) = (first.angle + second.angle, first.velocity + second.velocity);
        let position = (first.velocity * T::from_u32(5) + second.velocity)
            * (h * T::from_f64(1.0 / 6.0))
            + cross(&first.angle, &push) * (h * T::from_f64(1.0 / 3.0))
            + cross(&angle, &cross(&angle, &push)) * (h * T::from_f64(1.0 / 24.0));
        finished(halves, coefficient, position, dt)
    }

    #[inline]
    fn rebias(&mut self, _: &Bias<T>) {}
}

impl TwoSample {
    /// Two increments of unequal lengths, a and b: third order, and the better the more even they are.
    ///
    /// ⅔ becomes h²/(6ab), and Δp = ½hυ − (h²/6)(υ₂/b − υ₁/a) + (h/6)(α − (h/2)(α₂/b − α₁/a))×υ + (h/24)α×(α×υ), which
    /// is the form for halves where they are equal. None where both together are longer than a [`Step`] may be.
    #[must_use]
    pub fn uneven<T: Real>(
        halves: &Halves<T>,
        first: &Step<T>,
        second: &Step<T>,
    ) -> Option<Delta<T>> {
        let nanoseconds = i64::from(first.nanoseconds()) + i64::from(second.nanoseconds());
        let dt = Step::from_nanoseconds(nanoseconds).ok()?;
        let (a, b, h) = (first.seconds(), second.seconds(), dt.seconds());
        let (half, sixth) = (T::from_f64(0.5), T::from_f64(1.0 / 6.0));
        let (one, two) = (&halves.first, &halves.second);
        let (angle, push) = (one.angle + two.angle, one.velocity + two.velocity);
        // h times the change of the mean force, and of the mean rate.
        let later_push = two.velocity * (h / b) - one.velocity * (h / a);
        let later_angle = two.angle * (h / b) - one.angle * (h / a);
        let position = push * (h * half) - later_push * (h * sixth)
            + cross(&(angle - later_angle * half), &push) * (h * sixth)
            + cross(&angle, &cross(&angle, &push)) * (h * T::from_f64(1.0 / 24.0));
        Some(finished(halves, sixth * (h / a) * (h / b), position, &dt))
    }
}

/// Rotation and velocity, which even and uneven halves have in common but for one number.
#[inline(always)]
fn finished<T: Real>(
    Halves { first, second }: &Halves<T>,
    coefficient: T,
    position: nalgebra::Vector3<T>,
    dt: &Step<T>,
) -> Delta<T> {
    let (angle, push) = (first.angle + second.angle, first.velocity + second.velocity);
    let coning = cross(&first.angle, &second.angle);
    let sculling = two_crosses(&first.angle, &second.velocity, &first.velocity, &second.angle);
    let theta = angle + coning * coefficient;
    let u = push + sculling * coefficient;
    let turned = cross(&theta, &u);
    let velocity = u
        + turned * (T::from_f64(0.5) - dot(&theta, &theta) * T::from_f64(1.0 / 24.0))
        + cross(&theta, &turned) * T::from_f64(1.0 / 6.0);
    Delta::of_step(so3::exp(theta), velocity, position, dt)
}
