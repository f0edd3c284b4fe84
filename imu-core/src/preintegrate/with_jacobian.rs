//! The mean and how it changes with the biases.
//!
//! Errors are carried in the frame at the beginning, as those of the group: φ = R δθ, ν = δv + v×φ, π = δp + p×φ. In
//! these the past does not change with the motion (Barrau & Bonnabel (2020), "A mathematical framework for IMU error
//! propagation with applications to preintegration": errors propagate autonomously): φ and ν stay, and π gains ν dt.
//! Of a midpoint step from R₀ to R₁ = R₀E with θ = log E, exactly:
//!
//! - δφ = −R₀ J_l(θ) dt δb_g
//! - δν = (v₁ − k)×δφ − ½(R₀ + R₁)dt δb_a, where k = ½ R₁f₁ dt
//! - δπ = ν₀ dt + (p₁ − ½k dt)×δφ − ¼(R₀ + R₁)dt² δb_a
//!
//! So no step multiplies two general matrices. It is the same derivative as by the recursion in (δθ, δv, δp), in
//! another order.

use super::{BiasJacobian, Biased, Mean, turn};
use crate::delta::Delta;
use crate::integrate::Rule;
use crate::matrix::{Rows, add_scaled, crossed, matrix, rotation, transposed_times};
use crate::sample::Bias;
use crate::time::Step;
use crate::{Real, so3};
use nalgebra::{Quaternion, Vector3};

/// The [`Delta`] since the interval began, with its [`BiasJacobian`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithJacobian<T: Real, R> {
    pub(super) mean: Mean<T, R>,
    gained: Gained<T>,
}

impl<T: Real, R: Rule<T>> WithJacobian<T, R>
where
    R::Input: Biased<T>,
{
    /// Begins where the rule does, which has seen the first sample *less this bias*: see
    /// [`Sample::minus`](crate::sample::Sample::minus).
    #[must_use]
    pub fn new(rule: R, bias: Bias<T>) -> Self {
        Self { mean: Mean::new(rule, bias), gained: Gained::none() }
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
        self.mean.restart(bias);
        self.gained = Gained::none();
    }

    /// The motion since the interval began.
    #[must_use]
    pub fn delta(&self) -> Delta<T> {
        self.mean.delta()
    }

    /// The bias that is taken out of all inputs, at which the Jacobians are.
    #[must_use]
    pub fn bias(&self) -> Bias<T> {
        self.mean.bias()
    }

    /// How the motion changes with the biases: (δθ, δv, δp) of (φ, ν, π), which is worth keeping.
    #[must_use]
    pub fn jacobian(&self) -> BiasJacobian<T> {
        self.gained.jacobian(&self.mean.velocity, &self.mean.position)
    }

    /// The motion if the bias is this one, to first order: [`BiasJacobian::corrected`].
    #[must_use]
    pub fn corrected(&self, bias: &Bias<T>) -> Delta<T> {
        self.jacobian().corrected(&self.delta(), &bias.less(&self.bias()))
    }

    /// A step; gives the arms about which a turn within it moves the velocity and the position at its end.
    #[inline(always)]
    pub(super) fn advance(&mut self, input: &R::Input, dt: &Step<T>) -> Arms<T> {
        let (moved, push) = self.mean.advance(input, dt);
        let arms = Arms::of(&self.mean, &push, dt);
        let (gained, h) = (&mut self.gained, dt.seconds());
        let half = h * T::from_f64(0.5);
        let jacobian = turn::times_left_jacobian(&gained.axes, &moved);
        let turned = jacobian.map(|row| row * h);
        let after = rotation(&self.mean.rotation);
        let sum = add_scaled(&gained.axes, T::ONE, &after);
        let pushed = sum.map(|row| row * half);
        // The position before the velocity: it wants the old one.
        gained.position_gyro = add_scaled(&gained.position_gyro, h, &gained.velocity_gyro);
        add(&mut gained.position_gyro, &crossed(&arms.position, &turned));
        add(&mut gained.velocity_gyro, &crossed(&arms.velocity, &turned));
        add(&mut gained.turn, &turned);
        gained.position_accel = add_scaled(&gained.position_accel, h, &gained.velocity_accel);
        gained.position_accel = add_scaled(&gained.position_accel, half, &pushed);
        add(&mut gained.velocity_accel, &pushed);
        gained.axes = after;
        arms
    }
}

/// About which points a turn δφ in a step moves the velocity and the position at its end: δν = arm×δφ, δπ = arm×δφ.
#[derive(Clone, Copy)]
pub(super) struct Arms<T: Real> {
    /// v₁ − k, m/s.
    pub(super) velocity: Vector3<T>,
    /// p₁ − ½k dt, m.
    pub(super) position: Vector3<T>,
}

impl<T: Real> Arms<T> {
    #[inline(always)]
    fn of<R>(mean: &Mean<T, R>, push: &Vector3<T>, dt: &Step<T>) -> Self {
        let half = T::from_f64(0.5);
        let k = so3::rotate(&mean.rotation, &(push * half));
        Self { velocity: mean.velocity - k, position: mean.position - k * (dt.seconds() * half) }
    }
}

/// What the steps have added up to: derivatives of (φ, ν, π) with their sign turned.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gained<T: Real> {
    /// R of the mean.
    axes: Rows<T>,
    /// −∂φ/∂b_g, s.
    turn: Rows<T>,
    /// −∂ν/∂b_g, m/s per rad/s.
    velocity_gyro: Rows<T>,
    /// −∂π/∂b_g, m per rad/s.
    position_gyro: Rows<T>,
    /// −∂ν/∂b_a, s.
    velocity_accel: Rows<T>,
    /// −∂π/∂b_a, s².
    position_accel: Rows<T>,
}

impl<T: Real> Gained<T> {
    fn none() -> Self {
        let zero = [Vector3::from([T::ZERO; 3]); 3];
        Self {
            axes: rotation(&Quaternion::new(T::ONE, T::ZERO, T::ZERO, T::ZERO)),
            turn: zero,
            velocity_gyro: zero,
            position_gyro: zero,
            velocity_accel: zero,
            position_accel: zero,
        }
    }

    /// Of (δθ, δv, δp) at this velocity and position. Apart from the rule: compiled once for all of them.
    fn jacobian(&self, velocity: &Vector3<T>, position: &Vector3<T>) -> BiasJacobian<T> {
        let Gained { axes, turn, velocity_gyro, position_gyro, velocity_accel, position_accel } =
            self;
        let negative = |m: &Rows<T>| matrix(&m.map(|row| -row));
        let by_turn = |m: &Rows<T>, arm| add_scaled(m, -T::ONE, &crossed(arm, turn));
        BiasJacobian {
            rotation_gyro: negative(&transposed_times(axes, turn)),
            velocity_gyro: negative(&by_turn(velocity_gyro, velocity)),
            velocity_accel: negative(velocity_accel),
            position_gyro: negative(&by_turn(position_gyro, position)),
            position_accel: negative(position_accel),
        }
    }
}

#[inline(always)]
fn add<T: Real>(sum: &mut Rows<T>, more: &Rows<T>) {
    for (row, more) in sum.iter_mut().zip(more) {
        *row += more;
    }
}
