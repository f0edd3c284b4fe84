//! `Delta`: how an IMU moved between two instants, by what it felt alone.
//!
//! Rotation, velocity and position gained, seen from the body's frame at the beginning, with no word of gravity, of
//! where the body was, or how fast: those come in when a [`State`](crate::State) is moved by it. So deltas of
//! neighbouring intervals compose, and the same numbers serve dead reckoning, a factor between two camera frames, and
//! blocks that keep single precision right at high rates.
//!
//! They form a group (Barrau & Bonnabel (2020), "A mathematical framework for IMU error propagation with applications
//! to preintegration"; Forster et al. (2017), "On-manifold preintegration for real-time visual-inertial odometry"):
//!
//! (q₁, v₁, p₁, t₁)(q₂, v₂, p₂, t₂) = (q₁q₂, v₁ + q₁v₂, p₁ + v₁t₂ + q₁p₂, t₁ + t₂)
//!
//! ```
//! use imu_core::delta::Delta;
//! use imu_core::nalgebra::Vector3;
//! use imu_core::so3;
//! // One second of braking while turning left, and another one.
//! let turn = so3::exp(Vector3::new(0.0, 0.0, 0.5));
//! let second = Delta::new(turn, Vector3::new(-1.0, 0.0, 0.0), Vector3::new(-0.5, 0.0, 0.0), 1_000_000_000);
//! let both = second.then(&second);
//! assert_eq!(both.nanoseconds(), 2_000_000_000);
//! assert!((so3::log(&both.rotation()).z - 1.0_f64).abs() < 1e-15);
//! // There and back again is nowhere.
//! assert!(both.then(&both.inverse()).position().abs().max() < 1e-15);
//! ```

use crate::time::{Step, seconds};
use crate::{Real, so3};
use nalgebra::{Quaternion, Vector3};

/// Rotation, velocity and position gained over a time, without gravity; seen from the body as it was at the beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delta<T: Real> {
    pub(crate) rotation: Quaternion<T>,
    pub(crate) velocity: Vector3<T>,
    pub(crate) position: Vector3<T>,
    pub(crate) nanoseconds: i64,
    /// The same time, for arithmetic.
    pub(crate) seconds: T,
}

impl<T: Real> Delta<T> {
    /// A delta of known parts: the rotation from the body's frame at the end to that at the beginning (of unit
    /// length), the velocity in m/s and the position in m gained in the frame at the beginning, and the time.
    #[must_use]
    pub fn new(
        rotation: Quaternion<T>,
        velocity: Vector3<T>,
        position: Vector3<T>,
        nanoseconds: i64,
    ) -> Self {
        Self { rotation, velocity, position, nanoseconds, seconds: seconds(nanoseconds) }
    }

    /// No motion in no time: the group's one.
    #[must_use]
    pub fn identity() -> Self {
        let zero = Vector3::from([T::ZERO; 3]);
        Self::new(Quaternion::new(T::ONE, T::ZERO, T::ZERO, T::ZERO), zero, zero, 0)
    }

    /// What a rule has found for one step.
    #[inline(always)]
    pub(crate) fn of_step(
        rotation: Quaternion<T>,
        velocity: Vector3<T>,
        position: Vector3<T>,
        dt: &Step<T>,
    ) -> Self {
        let (nanoseconds, seconds) = (dt.nanoseconds().into(), dt.seconds());
        Self { rotation, velocity, position, nanoseconds, seconds }
    }

    /// q: rotates vectors of the frame at the end into the frame at the beginning.
    #[must_use]
    #[inline]
    pub fn rotation(&self) -> Quaternion<T> {
        self.rotation
    }

    /// v: velocity gained, m/s, in the frame at the beginning.
    #[must_use]
    #[inline]
    pub fn velocity(&self) -> Vector3<T> {
        self.velocity
    }

    /// p: position gained beyond what the velocity at the beginning explains, m, in the frame at the beginning.
    #[must_use]
    #[inline]
    pub fn position(&self) -> Vector3<T> {
        self.position
    }

    /// t: the time it took, ns. Of an inverse it is negative.
    #[must_use]
    #[inline]
    pub fn nanoseconds(&self) -> i64 {
        self.nanoseconds
    }

    /// This motion, and then the next: a product of the group.
    ///
    /// The rotation is taken back to unit length, so that any number of them stays one. Times add in integers; beyond
    /// ±292 years they stop at the end of the range.
    #[must_use]
    #[inline]
    pub fn then(&self, next: &Self) -> Self {
        let rotated = |v| so3::rotate(&self.rotation, v);
        let nanoseconds = self.nanoseconds.saturating_add(next.nanoseconds);
        Self {
            rotation: so3::renormalised(&so3::product(&self.rotation, &next.rotation)),
            velocity: self.velocity + rotated(&next.velocity),
            position: self.position + self.velocity * next.seconds + rotated(&next.position),
            nanoseconds,
            seconds: seconds(nanoseconds),
        }
    }

    /// The motion that takes this one back: (q*, −q*v, −q*(p − vt), −t).
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = so3::inverse(&self.rotation);
        let back = |v| -so3::rotate(&rotation, &v);
        Self {
            rotation,
            velocity: back(self.velocity),
            position: back(self.position - self.velocity * self.seconds),
            nanoseconds: self.nanoseconds.saturating_neg(),
            seconds: -self.seconds,
        }
    }
}

#[cfg(test)]
#[path = "delta_tests.rs"]
mod tests;
