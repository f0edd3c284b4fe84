//! Where a body is, how it is turned and how fast it goes: what dead reckoning carries from step to step.
//!
//! [`State`] is plain: in `f64` for anything, in `f32` for seconds to minutes. [`Compensated`] keeps what every
//! addition rounds away, and makes `f32` right at 8 kHz and after 10⁹ steps, for half as many instructions again.
//!
//! ```
//! use imu_core::integrate::Midpoint;
//! use imu_core::nalgebra::{Quaternion, Vector3};
//! use imu_core::sample::Sample;
//! use imu_core::time::Step;
//! use imu_core::world::Flat;
//! use imu_core::State;
//!
//! // A car on a left-hand bend: 10 m/s, 0.2 rad/s, for π/0.2 s; x ahead, y to the left, z up.
//! let sample = Sample::new(Vector3::new(0.0, 0.0, 0.2), Vector3::new(0.0, 2.0, 9.81))?;
//! let level = Quaternion::new(1.0, 0.0, 0.0, 0.0);
//! let mut car = State::new(level, Vector3::new(10.0, 0.0, 0.0), Vector3::zeros())?;
//! let (world, dt) = (Flat::new(Vector3::new(0.0, 0.0, -9.81))?, Step::from_nanoseconds(5_000_000)?);
//! let mut rule = Midpoint::new(&sample);
//! for _ in 0..3142 {
//!     car.advance(&mut rule, &sample, &dt, &world);
//! }
//! // Half a circle of 50 m, and on the way back.
//! assert!((car.position_w() - Vector3::new(0.0, 100.0, 0.0)).abs().max() < 0.03_f64);
//! assert!((car.velocity_w() - Vector3::new(-10.0, 0.0, 0.0)).abs().max() < 0.01);
//! # Ok::<(), imu_core::Error>(())
//! ```

mod compensated;

pub use compensated::Compensated;

use crate::delta::Delta;
use crate::integrate::Rule;
use crate::time::Step;
use crate::vector::within;
use crate::world::{Gain, World};
use crate::{Error, Real, so3};
use nalgebra::{Quaternion, Vector3, Vector4};

/// Attitude, velocity and position of a body in a world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T: Real> {
    attitude_wb: Quaternion<T>,
    velocity_w: Vector3<T>,
    position_w: Vector3<T>,
}

impl<T: Real> State<T> {
    /// From q_wb, which rotates body to world and is taken to unit length, the velocity in m/s and the position in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the argument: an attitude whose length is not near 1 (0.5 to 2), a velocity or a
    /// position with a component that is not a number, or beyond ±10¹².
    pub fn new(
        attitude_wb: Quaternion<T>,
        velocity_w: Vector3<T>,
        position_w: Vector3<T>,
    ) -> Result<Self, Error> {
        let length = so3::length(&attitude_wb);
        if !(length >= T::from_f64(0.5) && length <= T::from_u32(2)) {
            return Err(Error::OutOfRange("attitude_wb"));
        }
        let limit = T::from_f64(1e12);
        if !within(&velocity_w, limit) {
            return Err(Error::OutOfRange("velocity_w"));
        }
        if !within(&position_w, limit) {
            return Err(Error::OutOfRange("position_w"));
        }
        let attitude_wb = Quaternion::from(attitude_wb.coords / length);
        Ok(Self { attitude_wb, velocity_w, position_w })
    }

    /// q_wb: rotates body to world; of unit length up to rounding.
    #[must_use]
    #[inline]
    pub fn attitude_wb(&self) -> Quaternion<T> {
        self.attitude_wb
    }

    /// v_w, m/s.
    #[must_use]
    #[inline]
    pub fn velocity_w(&self) -> Vector3<T> {
        self.velocity_w
    }

    /// p_w, m.
    #[must_use]
    #[inline]
    pub fn position_w(&self) -> Vector3<T> {
        self.position_w
    }

    /// Moves the state by what was felt, in a world that adds its gravity.
    ///
    /// Exact up to rounding in a [`Flat`](crate::world::Flat) world, however long the delta. On a
    /// [`RotatingEarth`](crate::world::RotatingEarth) a delta should be short enough (seconds) for the Earth to turn by
    /// little. The attitude is rounded once: blocks of several steps are meant to come in here.
    #[inline]
    pub fn apply(&mut self, delta: &Delta<T>, world: &impl World<T>) {
        let felt = felt(&self.attitude_wb, delta);
        self.move_by(&felt, delta, world);
        let gain = attitude_gain(&self.attitude_wb, T::ZERO, delta, world);
        self.attitude_wb.coords += gain;
    }

    /// Integrates one more sample, or increment, by a rule: `dt` is the time since the one before.
    ///
    /// The same motion as [`apply`](Self::apply) of the rule's [`step`](Rule::step), up to rounding; where a rule takes
    /// the position by the trapezoid of the velocity, a rotation is saved.
    #[inline]
    pub fn advance<R: Rule<T>>(
        &mut self,
        rule: &mut R,
        input: &R::Input,
        dt: &Step<T>,
        world: &impl World<T>,
    ) {
        let delta = rule.step(input, dt);
        let felt = felt_in_step::<T, R>(&self.attitude_wb, &delta);
        self.move_by(&felt, &delta, world);
        let attitude = so3::product(&self.attitude_wb, &delta.rotation);
        let attitude =
            world.turn(delta.seconds).map_or(attitude, |turn| so3::product(&turn, &attitude));
        self.attitude_wb = so3::renormalised(&attitude);
    }

    #[inline(always)]
    fn move_by(&mut self, felt: &Gain<T>, delta: &Delta<T>, world: &impl World<T>) {
        let gain = world.gain(&self.velocity_w, &self.position_w, felt, delta.seconds);
        self.velocity_w += gain.velocity;
        self.position_w += gain.position;
    }
}

/// What a delta adds to the components of an attitude, formed without cancellation, and one step of Newton's towards
/// unit length. `beyond` is by how much q·(what was rounded off q) exceeds nothing.
#[inline(always)]
fn attitude_gain<T: Real>(
    q: &Quaternion<T>,
    beyond: T,
    delta: &Delta<T>,
    world: &impl World<T>,
) -> Vector4<T> {
    let mut gain = so3::product(q, &so3::less_one(&delta.rotation)).coords;
    if let Some(turn) = world.turn(delta.seconds) {
        let after = Quaternion::from(q.coords + gain);
        gain += so3::product(&so3::less_one(&turn), &after).coords;
    }
    let c = &q.coords;
    let square = c.x * c.x + c.y * c.y + c.z * c.z + c.w * c.w;
    // Along the attitude after the step: along the one before it, turns of more than a right angle would diverge.
    gain + (c + gain) * (T::from_f64(0.5) * (T::ONE - square) - beyond)
}

/// What was felt, in the axes of the world.
#[inline(always)]
fn felt<T: Real>(attitude_wb: &Quaternion<T>, delta: &Delta<T>) -> Gain<T> {
    Gain {
        velocity: so3::rotate(attitude_wb, &delta.velocity),
        position: so3::rotate(attitude_wb, &delta.position),
    }
}

/// The same of one step, for which the rule may promise a trapezoid.
#[inline(always)]
fn felt_in_step<T: Real, R: Rule<T>>(attitude_wb: &Quaternion<T>, delta: &Delta<T>) -> Gain<T> {
    if !R::TRAPEZOID {
        return felt(attitude_wb, delta);
    }
    let velocity = so3::rotate(attitude_wb, &delta.velocity);
    Gain { velocity, position: velocity * (delta.seconds * T::from_f64(0.5)) }
}

#[cfg(test)]
mod tests;
