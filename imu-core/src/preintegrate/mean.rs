//! The mean alone: the delta between two frames, of samples less their bias.

use super::Biased;
use crate::delta::Delta;
use crate::integrate::Rule;
use crate::sample::Bias;
use crate::time::Step;
use crate::{Real, so3};
use nalgebra::{Quaternion, Vector3};

/// The [`Delta`] since the interval began, by any rule.
///
/// The same numbers, to the bit, as [`Delta::then`] of every step; without its division.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean<T: Real, R> {
    rule: R,
    bias: Bias<T>,
    pub(super) rotation: Quaternion<T>,
    pub(super) velocity: Vector3<T>,
    pub(super) position: Vector3<T>,
    nanoseconds: i64,
}

impl<T: Real, R: Rule<T>> Mean<T, R>
where
    R::Input: Biased<T>,
{
    /// Begins where the rule does, which has seen the first sample *less this bias*: see
    /// [`Sample::minus`](crate::sample::Sample::minus).
    #[must_use]
    pub fn new(rule: R, bias: Bias<T>) -> Self {
        let Delta { rotation, velocity, position, nanoseconds, .. } = Delta::identity();
        Self { rule, bias, rotation, velocity, position, nanoseconds }
    }

    /// Takes the next input as the sensor gives it, bias and all, `dt` after the one before.
    #[inline]
    pub fn step(&mut self, input: &R::Input, dt: &Step<T>) {
        self.advance(input, dt);
    }

    /// The next interval: from the instant of the last input, with the bias that is now thought right.
    ///
    /// The rule keeps what it remembers, less the new bias in place of the old.
    pub fn restart(&mut self, bias: Bias<T>) {
        self.rule.rebias(&bias.less(&self.bias));
        self.bias = bias;
        let Delta { rotation, velocity, position, nanoseconds, .. } = Delta::identity();
        (self.rotation, self.velocity, self.position) = (rotation, velocity, position);
        self.nanoseconds = nanoseconds;
    }

    /// The motion since the interval began.
    #[must_use]
    pub fn delta(&self) -> Delta<T> {
        Delta::new(self.rotation, self.velocity, self.position, self.nanoseconds)
    }

    /// The bias that is taken out of all inputs.
    #[must_use]
    pub fn bias(&self) -> Bias<T> {
        self.bias
    }

    /// A step: its own rotation, and the force at its end times dt, both as the body's axes are, m/s.
    #[inline(always)]
    pub(super) fn advance(
        &mut self,
        input: &R::Input,
        dt: &Step<T>,
    ) -> (Quaternion<T>, Vector3<T>) {
        let input = input.without(&self.bias, dt);
        let moved = self.rule.step(&input, dt);
        let rotated = |v| so3::rotate(&self.rotation, v);
        self.position = self.position + self.velocity * dt.seconds() + rotated(&moved.position);
        self.velocity += rotated(&moved.velocity);
        self.rotation = so3::renormalised(&so3::product(&self.rotation, &moved.rotation));
        self.nanoseconds = self.nanoseconds.saturating_add(dt.nanoseconds().into());
        (moved.rotation, input.push(dt))
    }
}
