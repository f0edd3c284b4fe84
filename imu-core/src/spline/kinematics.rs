//! What a curve says of one instant.

use crate::sample::Sample;
use crate::se3::Pose;
use crate::{Error, Real, so3};
use nalgebra::{Quaternion, Vector3};

/// Position and its derivatives in the world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position<T: Real> {
    /// p, m.
    pub position_w: Vector3<T>,
    /// v, m/s.
    pub velocity_w: Vector3<T>,
    /// a, m/s².
    pub acceleration_w: Vector3<T>,
}

/// Attitude and its derivatives in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attitude<T: Real> {
    /// q_wb: rotates body to world; of unit length up to rounding.
    pub attitude_wb: Quaternion<T>,
    /// ω, rad/s: Ṙ = R \[ω\]×.
    pub angular_rate: Vector3<T>,
    /// α = ω̇, rad/s².
    pub angular_acceleration: Vector3<T>,
}

/// A pose and its first derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseAndVelocity<T: Real> {
    /// `T_wb`.
    pub pose: Pose<T>,
    /// v, in the world frame, m/s.
    pub velocity_w: Vector3<T>,
    /// ω, in body axes, rad/s.
    pub angular_rate: Vector3<T>,
}

/// A pose with its first and second derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Full<T: Real> {
    /// `T_wb`.
    pub pose: Pose<T>,
    /// v, in the world frame, m/s.
    pub velocity_w: Vector3<T>,
    /// a, in the world frame, m/s².
    pub acceleration_w: Vector3<T>,
    /// ω, in body axes, rad/s.
    pub angular_rate: Vector3<T>,
    /// α = ω̇, in body axes, rad/s².
    pub angular_acceleration: Vector3<T>,
}

/// What an ideal gyroscope and accelerometer at the body's origin read: ω and Rᵀ(a − g).
#[inline(always)]
pub(super) fn felt<T: Real>(
    attitude_wb: &Quaternion<T>,
    angular_rate: Vector3<T>,
    acceleration_w: &Vector3<T>,
    gravity_w: &Vector3<T>,
) -> Result<Sample<T>, Error> {
    let back = so3::inverse(attitude_wb);
    Sample::new(angular_rate, so3::rotate(&back, &(acceleration_w - gravity_w)))
}
