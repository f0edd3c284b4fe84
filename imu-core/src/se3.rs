//! Poses: rotation and translation together, their exponential and logarithm, Jacobians and adjoints.
//!
//! A [`Pose`] `T_ab` takes points of frame b to frame a, and `T_ac = T_ab T_bc`. A [`Twist`] is (ρ, φ), the linear part
//! first: metres and radians, or metres and radians a second, in axes of the body. Rotation and translation are coupled
//! here: exp(ρ, φ) turns and moves at once, along a screw. Who wants them apart takes [`so3`] and a vector.
//!
//! Matrices of this group on twists have one shape, [`Blocks`]: \[D C; 0 D\]. Source: Barfoot (2017), "State Estimation
//! for Robotics", sections 7.1.2 to 7.1.5 and eq. (7.86); the coefficients of its Q here are right at any angle.
//!
//! ```
//! use imu_core::nalgebra::Vector3;
//! use imu_core::se3::{self, Twist};
//! // A quarter of a circle of radius 2 m, driven forwards and to the left.
//! let quarter = core::f64::consts::FRAC_PI_2;
//! let arc = Twist { linear: Vector3::new(2.0 * quarter, 0.0, 0.0), angular: Vector3::new(0.0, 0.0, quarter) };
//! let end = se3::exp(&arc);
//! assert!((end.translation() - Vector3::new(2.0, 2.0, 0.0)).abs().max() < 1e-15);
//! assert!((se3::log(&end).linear - arc.linear).abs().max() < 1e-15);
//! ```

mod blocks;
mod pose;

pub use blocks::{
    Blocks, adjoint, inverse_left_jacobian, inverse_right_jacobian, left_jacobian, right_jacobian,
    small_adjoint,
};
pub use pose::Pose;

use crate::matrix::rows_times;
use crate::vector::{cross, dot};
use crate::{Real, so3};
use core::ops::{Add, Mul, Neg};
use nalgebra::Vector3;

/// A velocity of a rigid body, or what it adds up to: linear and angular, in axes of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist<T: Real> {
    /// ρ: m, or m/s for a rate.
    pub linear: Vector3<T>,
    /// φ: rad, or rad/s for a rate.
    pub angular: Vector3<T>,
}

impl<T: Real> Twist<T> {
    /// No motion.
    #[must_use]
    pub fn zero() -> Self {
        let zero = Vector3::from([T::ZERO; 3]);
        Self { linear: zero, angular: zero }
    }

    /// ad(ξ)η, the Lie bracket of two twists: (φ×ρ' + ρ×φ', φ×φ').
    #[must_use]
    #[inline]
    pub fn bracket(&self, other: &Self) -> Self {
        Self {
            linear: cross(&self.angular, &other.linear) + cross(&self.linear, &other.angular),
            angular: cross(&self.angular, &other.angular),
        }
    }
}

impl<T: Real> Add for Twist<T> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { linear: self.linear + other.linear, angular: self.angular + other.angular }
    }
}

impl<T: Real> Mul<T> for Twist<T> {
    type Output = Self;

    #[inline]
    fn mul(self, factor: T) -> Self {
        Self { linear: self.linear * factor, angular: self.angular * factor }
    }
}

impl<T: Real> Neg for Twist<T> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { linear: -self.linear, angular: -self.angular }
    }
}

/// The pose that a twist leads to: (exp φ, J_l(φ)ρ).
///
/// Right to a few roundings of |ρ| and of one turn. A twist that is not finite gives NaN.
#[must_use]
#[inline]
pub fn exp<T: Real>(twist: &Twist<T>) -> Pose<T> {
    exp_of_squared(twist, dot(&twist.angular, &twist.angular))
}

/// The same where the square of the angle, in rad², is known.
#[inline(always)]
pub(crate) fn exp_of_squared<T: Real>(twist: &Twist<T>, square: T) -> Pose<T> {
    let Twist { linear, angular } = twist;
    let (half, quarter) = (T::from_f64(0.5), T::from_f64(0.25));
    let rotation = so3::exp_of_squared_half(angular * half, square * quarter);
    let (b, c) = so3::coefficients(square);
    let once = cross(angular, linear);
    Pose::of_unit(rotation, linear + once * b + cross(angular, &once) * c)
}

/// The twist that leads to a pose: (J_l⁻¹(φ) p, φ) with φ = log R, of an angle from 0 to π.
#[must_use]
pub fn log<T: Real>(pose: &Pose<T>) -> Twist<T> {
    let angular = so3::log_of_unit(&pose.rotation());
    let inverse = so3::inverse_left_rows(&angular);
    Twist { linear: rows_times(&inverse, &pose.translation()), angular }
}

#[cfg(test)]
mod tests;
