//! What motions in closed form are made of: channels c + kt + ΣA sin(wt + φ) of position and of roll, pitch and yaw.

use super::{Motion, sin_cos};
use crate::sensor::Kinematics;
use crate::{Real, so3};
use nalgebra::{Quaternion, Vector3};

/// A sin(wt + φ): amplitude in m or rad, rate in rad/s, phase in rad.
pub(super) type Wave = (f64, f64, f64);

/// c + kt + ΣA sin(wt + φ).
pub(super) struct Channel<'a> {
    pub(super) constant: f64,
    pub(super) slope: f64,
    pub(super) waves: &'a [Wave],
}

impl<'a> Channel<'a> {
    pub(super) const fn new(constant: f64, slope: f64, waves: &'a [Wave]) -> Self {
        Self { constant, slope, waves }
    }

    /// The value at `t` seconds, with its first and second derivative.
    fn at(&self, t: f64) -> [f64; 3] {
        let mut channel = [self.constant + self.slope * t, self.slope, 0.0];
        for &(amplitude, rate, phase) in self.waves {
            let (sin, cos) = sin_cos(rate * t + phase);
            channel[0] += amplitude * sin;
            channel[1] += amplitude * rate * cos;
            channel[2] -= amplitude * rate * rate * sin;
        }
        channel
    }
}

/// A motion at one instant, with the angular acceleration.
pub(super) struct Instant {
    pub(super) motion: Motion<f64>,
    pub(super) angular_acceleration: Vector3<f64>,
}

impl Instant {
    /// Of position channels x, y, z and angle channels roll, pitch, yaw: R_wb = Rz(yaw) Ry(pitch) Rx(roll).
    pub(super) fn of(position: &[Channel; 3], angles: &[Channel; 3], t: f64, gravity: f64) -> Self {
        let [x, y, z] = position.each_ref().map(|channel| channel.at(t));
        let [[roll, roll1, roll2], [pitch, pitch1, pitch2], [yaw, yaw1, yaw2]] =
            angles.each_ref().map(|channel| channel.at(t));
        let ((sr, cr), (sp, cp)) = (sin_cos(roll), sin_cos(pitch));
        let angular_rate = Vector3::new(
            roll1 - sp * yaw1,
            cr * pitch1 + sr * cp * yaw1,
            cr * cp * yaw1 - sr * pitch1,
        );
        let angular_acceleration = Vector3::new(
            roll2 - sp * yaw2 - cp * pitch1 * yaw1,
            cr * pitch2 - sr * roll1 * pitch1
                + sr * cp * yaw2
                + yaw1 * (cr * cp * roll1 - sr * sp * pitch1),
            cr * cp * yaw2
                - yaw1 * (sr * cp * roll1 + cr * sp * pitch1)
                - sr * pitch2
                - cr * roll1 * pitch1,
        );
        let attitude_wb = about_axes(roll, pitch, yaw);
        let felt_w = Vector3::new(x[2], y[2], z[2] + gravity);
        let motion = Motion {
            position_w: Vector3::new(x[0], y[0], z[0]),
            velocity_w: Vector3::new(x[1], y[1], z[1]),
            attitude_wb,
            angular_rate,
            specific_force: so3::rotate(&so3::inverse(&attitude_wb), &felt_w),
        };
        Self { motion, angular_acceleration }
    }

    /// What a sensor at the body's origin feels.
    pub(super) fn felt<T: Real>(&self) -> Kinematics<T> {
        let cast = |v: Vector3<f64>| <[f64; 3]>::from(v).map(T::from_f64);
        Kinematics {
            angular_rate: cast(self.motion.angular_rate),
            angular_acceleration: cast(self.angular_acceleration),
            specific_force: cast(self.motion.specific_force),
        }
    }
}

/// The quaternion of Rz(yaw) Ry(pitch) Rx(roll).
pub(super) fn about_axes(roll: f64, pitch: f64, yaw: f64) -> Quaternion<f64> {
    let ((sr, cr), (sp, cp)) = (sin_cos(0.5 * roll), sin_cos(0.5 * pitch));
    let (sy, cy) = sin_cos(0.5 * yaw);
    Quaternion::new(
        cy * cp * cr + sy * sp * sr,
        cy * cp * sr - sy * sp * cr,
        cy * sp * cr + sy * cp * sr,
        sy * cp * cr - cy * sp * sr,
    )
}
