//! A state that keeps what every addition rounds away.
//!
//! A step of an IMU is small beside the state it is added to. In `f32` at 8 kHz the position of a walker takes a
//! quarter of a millimetre a step, and rounds by as much as soon as it is 4 km away; the attitude of a slow turn rounds
//! by a thousandth of its step. Here each sum keeps its remainder and hands it to the next one
//! (Kahan (1965); Møller (1965); the exact remainder by Knuth, The Art of Computer Programming, volume 2, theorem 4.2.2
//! B), and the attitude grows by the difference q(r − 1), formed without cancellation, in place of a product.
//!
//! ```
//! use imu_core::integrate::Midpoint;
//! use imu_core::nalgebra::{Quaternion, Vector3};
//! use imu_core::sample::Sample;
//! use imu_core::time::Step;
//! use imu_core::world::Flat;
//! use imu_core::{Compensated, State, so3};
//!
//! // 0.1 rad/s for 128 s at 8 kHz: a million steps.
//! let spin = Sample::new(Vector3::new(0.0, 0.0, 0.1), Vector3::zeros())?;
//! let begin = State::new(Quaternion::new(1.0_f32, 0.0, 0.0, 0.0), Vector3::zeros(), Vector3::zeros())?;
//! let (world, dt) = (Flat::new(Vector3::zeros())?, Step::from_nanoseconds(125_000)?);
//! let (mut plain, mut compensated) = (begin, Compensated::from(begin));
//! let (mut rule, mut same) = (Midpoint::new(&spin), Midpoint::new(&spin));
//! for _ in 0..1_024_000 {
//!     plain.advance(&mut rule, &spin, &dt, &world);
//!     compensated.advance(&mut same, &spin, &dt, &world);
//! }
//! let turned = so3::exp(Vector3::new(0.0, 0.0, f64::from(0.1_f32) * 128.0));
//! let error = |state: &State<f32>| {
//!     let q = state.attitude_wb().coords.map(f64::from);
//!     let q = Quaternion::new(q.w, q.x, q.y, q.z);
//!     so3::log(&so3::product(&so3::inverse(&turned), &q)).z.abs().to_degrees()
//! };
//! assert!(error(&plain) > 1e-3 && error(&compensated.state()) < 1e-4);
//! # Ok::<(), imu_core::Error>(())
//! ```

use super::{State, attitude_gain, felt, felt_in_step};
use crate::Real;
use crate::delta::Delta;
use crate::integrate::Rule;
use crate::time::Step;
use crate::world::{Gain, World};
use nalgebra::{SVector, Vector3, Vector4};

/// A [`State`] and what its sums have rounded away: twice the memory, and in `f32` errors 30 times smaller and more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensated<T: Real> {
    state: State<T>,
    attitude_rest: Vector4<T>,
    velocity_rest: Vector3<T>,
    position_rest: Vector3<T>,
}

impl<T: Real> From<State<T>> for Compensated<T> {
    fn from(state: State<T>) -> Self {
        let rest = Vector3::from([T::ZERO; 3]);
        Self {
            state,
            attitude_rest: Vector4::from([T::ZERO; 4]),
            velocity_rest: rest,
            position_rest: rest,
        }
    }
}

impl<T: Real> Compensated<T> {
    /// The state, rounded.
    #[must_use]
    #[inline]
    pub fn state(&self) -> State<T> {
        self.state
    }

    /// As [`State::apply`].
    #[inline]
    pub fn apply(&mut self, delta: &Delta<T>, world: &impl World<T>) {
        let felt = felt(&self.state.attitude_wb, delta);
        self.gain(delta, &felt, world);
    }

    /// As [`State::advance`].
    #[inline]
    pub fn advance<R: Rule<T>>(
        &mut self,
        rule: &mut R,
        input: &R::Input,
        dt: &Step<T>,
        world: &impl World<T>,
    ) {
        let delta = rule.step(input, dt);
        let felt = felt_in_step::<T, R>(&self.state.attitude_wb, &delta);
        self.gain(&delta, &felt, world);
    }

    #[inline(always)]
    fn gain(&mut self, delta: &Delta<T>, felt: &Gain<T>, world: &impl World<T>) {
        let State { attitude_wb: q, velocity_w, position_w } = &mut self.state;
        let gain = world.gain(velocity_w, position_w, felt, delta.seconds);
        add(velocity_w, &mut self.velocity_rest, gain.velocity);
        add(position_w, &mut self.position_rest, gain.position);

        // |q + c|² = |q|² + 2 q·c, of the attitude and what was rounded off it.
        let (c, rest) = (&q.coords, &self.attitude_rest);
        let across = c.x * rest.x + c.y * rest.y + c.z * rest.z + c.w * rest.w;
        let turned = attitude_gain(q, across, delta, world);
        add(&mut q.coords, &mut self.attitude_rest, turned);
    }
}

/// Adds to a sum and its remainder; what rounding takes from the sum is exactly the new remainder.
#[inline(always)]
fn add<T: Real, const N: usize>(
    sum: &mut SVector<T, N>,
    rest: &mut SVector<T, N>,
    more: SVector<T, N>,
) {
    let more = more + *rest;
    let total = *sum + more;
    let back = total - *sum;
    *rest = (*sum - (total - back)) + (more - back);
    *sum = total;
}
