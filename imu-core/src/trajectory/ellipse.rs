//! The classic simulated trajectory: an ellipse of 30 × 40 m every 20 s, bobbing and rolling.
//!
//! With κ = π/10 s⁻¹: p = (15 cos κt + 5, 20 sin κt + 5, sin 10κt + 5) m; roll 0.1 cos t, pitch
//! 0.2 sin t, yaw κt rad; R_wb = Rz(yaw) Ry(pitch) Rx(roll). It is the motion of the course program
//! `vio_data_simulation` (He & Gao, 2019), whose own constants are single precision: its files
//! differ from this by up to 3.5e-6 m and 1.7e-5 m/s² in 20 s.

use super::waves::about_axes;
use super::{GRAVITY, Motion, Trajectory, sin_cos};
use crate::Real;
use crate::sensor::Kinematics;
use core::f64::consts::PI;
use nalgebra::{Matrix3, Vector3};

/// The classic ellipse, one round in 20 s, starting at (20, 5, 5) m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    /// g, m/s².
    pub gravity: f64,
}

impl Default for Ellipse {
    /// Under [`GRAVITY`].
    fn default() -> Self {
        Self { gravity: GRAVITY }
    }
}

impl<T: Real> Trajectory<T> for Ellipse {
    fn at(&self, t_ns: i64) -> Motion<T> {
        self.motion(t_ns as f64 / 1e9).cast()
    }

    fn kinematics(&self, t_ns: i64, offset_s: f64) -> Kinematics<T> {
        let t = t_ns as f64 / 1e9 + offset_s;
        let Motion { angular_rate, specific_force, .. } = self.motion(t);
        let cast = |v: Vector3<f64>| <[f64; 3]>::from(v).map(T::from_f64);
        Kinematics {
            angular_rate: cast(angular_rate),
            angular_acceleration: cast(angular_acceleration(t)),
            specific_force: cast(specific_force),
        }
    }
}

/// κ, the rate of the round and of the yaw, rad/s.
const K: f64 = PI / 10.0;

impl Ellipse {
    /// The motion at `t` seconds.
    fn motion(&self, t: f64) -> Motion<f64> {
        const BOB: f64 = 10.0 * K;
        let ((sin_k, cos_k), (sin_b, cos_b)) = (sin_cos(K * t), sin_cos(BOB * t));
        let acceleration =
            Vector3::new(-15.0 * K * K * cos_k, -20.0 * K * K * sin_k, -BOB * BOB * sin_b);

        let (sin_t, cos_t) = sin_cos(t);
        let (roll, pitch) = (0.1 * cos_t, 0.2 * sin_t);
        let (roll_rate, pitch_rate) = (-0.1 * sin_t, 0.2 * cos_t);
        let ((sr, cr), (sp, cp)) = (sin_cos(roll), sin_cos(pitch));
        let angular_rate = Vector3::new(
            roll_rate - K * sp,
            cr * pitch_rate + K * sr * cp,
            -sr * pitch_rate + K * cr * cp,
        );
        // Rz(yaw) Ry(pitch) Rx(roll) transposed: world to body.
        let r_bw = Matrix3::new(
            cos_k * cp,
            sin_k * cp,
            -sp,
            cos_k * sp * sr - sin_k * cr,
            sin_k * sp * sr + cos_k * cr,
            cp * sr,
            cos_k * sp * cr + sin_k * sr,
            sin_k * sp * cr - cos_k * sr,
            cp * cr,
        );
        Motion {
            position_w: Vector3::new(15.0 * cos_k + 5.0, 20.0 * sin_k + 5.0, sin_b + 5.0),
            velocity_w: Vector3::new(-15.0 * K * sin_k, 20.0 * K * cos_k, BOB * cos_b),
            attitude_wb: about_axes(roll, pitch, K * t),
            angular_rate,
            specific_force: r_bw * (acceleration + Vector3::new(0.0, 0.0, self.gravity)),
        }
    }
}

/// dω/dt at `t` seconds, rad/s²: the derivative of the rates in [`Ellipse::motion`], the yaw's own
/// rate being constant.
fn angular_acceleration(t: f64) -> Vector3<f64> {
    let (sin_t, cos_t) = sin_cos(t);
    let (roll, pitch) = (0.1 * cos_t, 0.2 * sin_t);
    let (roll_rate, pitch_rate) = (-0.1 * sin_t, 0.2 * cos_t);
    let ((sr, cr), (sp, cp)) = (sin_cos(roll), sin_cos(pitch));
    Vector3::new(
        -roll - K * cp * pitch_rate,
        -sr * roll_rate * pitch_rate - cr * pitch
            + K * (cr * cp * roll_rate - sr * sp * pitch_rate),
        -cr * roll_rate * pitch_rate + sr * pitch
            - K * (sr * cp * roll_rate + cr * sp * pitch_rate),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Quaternion;
    use proptest::prelude::*;

    fn at(t_ns: i64) -> Motion<f64> {
        Ellipse::default().at(t_ns)
    }

    /// `q` rotates the vector `v`.
    fn rotate(q: &Quaternion<f64>, v: Vector3<f64>) -> Vector3<f64> {
        let u = Vector3::new(q.i, q.j, q.k);
        let t = u.cross(&v) * 2.0;
        v + t * q.w + u.cross(&t)
    }

    fn largest(v: Vector3<f64>) -> f64 {
        v.iter().fold(0.0, |m, x| m.max(x.abs()))
    }

    /// Six printed digits of the course program's first row.
    #[test]
    fn the_first_instant_is_the_published_one() {
        let m = at(0);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 6e-6, "{a} {b}");
        assert_eq!(m.position_w, Vector3::new(20.0, 5.0, 5.0));
        near(m.attitude_wb.w, 0.99875);
        near(m.attitude_wb.i, 0.0499792);
        assert_eq!((m.attitude_wb.j, m.attitude_wb.k), (0.0, 0.0));
        for (a, b) in m.angular_rate.iter().zip([0.0, 0.230364, 0.292623]) {
            near(*a, b);
        }
        for (a, b) in m.specific_force.iter().zip([-1.48044, 0.979366, 9.76099]) {
            near(*a, b);
        }
    }

    proptest! {
        /// Central differences with h = 1e-4 s are off by h²/6 of the third derivative: of p at
        /// most π³ m/s³, of v π⁴ + 1 m/s⁴, of q below 1; rounding adds at most 1e-9.
        #[test]
        fn derivatives_are_those_of_the_pose(t_ns in 0_i64..100_000_000_000) {
            const H: i64 = 100_000;
            let h = H as f64 / 1e9;
            let (before, now, after) = (at(t_ns - H), at(t_ns), at(t_ns + H));
            let v = (after.position_w - before.position_w) / (2.0 * h);
            prop_assert!(largest(v - now.velocity_w) < 6e-8);
            let a = (after.velocity_w - before.velocity_w) / (2.0 * h);
            let f_w = rotate(&now.attitude_wb, now.specific_force);
            prop_assert!(largest(f_w - a - Vector3::new(0.0, 0.0, 9.81)) < 2e-7);
            // q̇ = ½ q (0, ω)
            let (q0, q1, q) = (before.attitude_wb, after.attitude_wb, now.attitude_wb);
            let rate = |x: f64, y: f64| (y - x) / (2.0 * h);
            let (w, u) = (now.angular_rate, Vector3::new(q.i, q.j, q.k));
            let vector = (w * q.w + u.cross(&w)) * 0.5;
            prop_assert!((rate(q0.w, q1.w) + 0.5 * u.dot(&w)).abs() < 4e-9);
            prop_assert!((rate(q0.i, q1.i) - vector.x).abs() < 4e-9);
            prop_assert!((rate(q0.j, q1.j) - vector.y).abs() < 4e-9);
            prop_assert!((rate(q0.k, q1.k) - vector.z).abs() < 4e-9);
            let norm = q.w * q.w + u.dot(&u);
            prop_assert!((norm - 1.0).abs() < 1e-14);
        }

        /// What a sensor feels is the motion, and its angular acceleration the derivative of the rate:
        /// h²/6 of the rate's third derivative, below 1 rad/s⁴, is 2e-9; rounding of t adds 1e-10.
        #[test]
        fn kinematics_are_those_of_the_motion(t_ns in 0_i64..100_000_000_000) {
            const H: f64 = 1e-4;
            let felt: Kinematics<f64> = Ellipse::default().kinematics(t_ns, 0.0);
            let now = at(t_ns);
            prop_assert_eq!(felt.angular_rate, <[f64; 3]>::from(now.angular_rate));
            prop_assert_eq!(felt.specific_force, <[f64; 3]>::from(now.specific_force));
            let (before, after): (Kinematics<f64>, Kinematics<f64>) =
                (Ellipse::default().kinematics(t_ns, -H), Ellipse::default().kinematics(t_ns, H));
            for axis in 0..3 {
                let difference = (after.angular_rate[axis] - before.angular_rate[axis]) / (2.0 * H);
                prop_assert!((difference - felt.angular_acceleration[axis]).abs() < 1e-8);
            }
        }

        /// Rounded once: f32 holds 24 bits of the double-precision motion, at any time.
        #[test]
        fn single_precision_is_as_true_after_hours(t_ns in 0_i64..1_000_000_000_000_000) {
            let (double, single): (_, Motion<f32>) = (at(t_ns), Ellipse::default().at(t_ns));
            for (a, b) in double.position_w.iter().zip(single.position_w.iter()) {
                prop_assert!((a - f64::from(*b)).abs() <= a.abs() * f64::from(f32::EPSILON));
            }
        }
    }
}
