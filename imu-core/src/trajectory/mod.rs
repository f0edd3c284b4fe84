//! True motion at any instant: what an ideal IMU at that place would read.
//!
//! World frame ENU with gravity (0, 0, −g); q_wb rotates body to world (Hamilton, w first). The
//! accelerometer reads specific force, f = R_wbᵀ(p̈ − g_w): at rest and level (0, 0, +g).
//!
//! ```
//! use imu_core::nalgebra::Vector3;
//! use imu_core::trajectory::{Ellipse, Motion, Trajectory};
//! let motion: Motion<f64> = Ellipse::default().at(0);
//! assert_eq!(motion.position_w, Vector3::new(20.0, 5.0, 5.0));
//! assert!((motion.specific_force.z - 9.760_991).abs() < 1e-6);
//! ```

mod along_spline;
mod coning;
mod ellipse;
mod gait;
mod rest;
mod spin;
mod waves;

pub use along_spline::AlongSpline;
pub use coning::Coning;
pub use ellipse::Ellipse;
pub use gait::Gait;
pub use rest::Rest;
pub use spin::Spin;

use crate::Real;
use crate::sensor::Kinematics;
use nalgebra::{Quaternion, Vector3};

/// Gravity of the classic simulators, m/s²; what the trajectories here take if not told otherwise.
pub const GRAVITY: f64 = 9.81;

/// Position, attitude and their derivatives at one instant, as an ideal IMU would feel them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<T: Real> {
    /// p_w: position in the world frame, m.
    pub position_w: Vector3<T>,
    /// v_w: velocity in the world frame, m/s.
    pub velocity_w: Vector3<T>,
    /// q_wb: rotates body vectors to the world frame; Hamilton, of unit length, w ≥ 0 not promised.
    pub attitude_wb: Quaternion<T>,
    /// ω: angular rate of the body against the world, in body axes, rad/s.
    pub angular_rate: Vector3<T>,
    /// f: specific force in body axes, m/s².
    pub specific_force: Vector3<T>,
}

impl Motion<f64> {
    /// The same motion in another scalar, every number rounded once.
    pub fn cast<T: Real>(&self) -> Motion<T> {
        let vector = |v: &Vector3<f64>| Vector3::from(<[f64; 3]>::from(*v).map(T::from_f64));
        let [i, j, k, w] = <[f64; 4]>::from(self.attitude_wb.coords).map(T::from_f64);
        Motion {
            position_w: vector(&self.position_w),
            velocity_w: vector(&self.velocity_w),
            attitude_wb: Quaternion::new(w, i, j, k),
            angular_rate: vector(&self.angular_rate),
            specific_force: vector(&self.specific_force),
        }
    }
}

/// A motion known at every instant of its span, with its derivatives.
pub trait Trajectory<T: Real> {
    /// The first and the last instant at which it is known, ns; all there are, if not told otherwise. Outside of it
    /// every number of [`at`](Self::at) and [`kinematics`](Self::kinematics) is NaN.
    fn span(&self) -> (i64, i64) {
        (i64::MIN, i64::MAX)
    }

    /// The motion `t_ns` nanoseconds after the trajectory's own beginning (negative: before it).
    ///
    /// Computed in double precision from the integer time and rounded once to `T`: so an `f32`
    /// trajectory is as true after four hours as in its first second.
    fn at(&self, t_ns: i64) -> Motion<T>;

    /// What an ideal sensor at the body's origin feels `offset_s` seconds after that instant: at
    /// the instants between nanoseconds too, which a mean over an interval is made of.
    fn kinematics(&self, t_ns: i64, offset_s: f64) -> Kinematics<T>;
}

/// The one definition of [`Real`], also where the standard library offers its own.
fn sin_cos(angle: f64) -> (f64, f64) {
    Real::sin_cos(angle)
}

#[cfg(test)]
#[path = "closed_form_tests.rs"]
mod closed_form_tests;
