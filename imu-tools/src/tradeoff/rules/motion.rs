//! Motions known in closed form, smooth and rough, on which rules are measured.
//!
//! The world is flat, z up, with 9.81 m/s² of gravity. Each motion says where a body is at any time, and what an ideal
//! IMU in it reads, at an instant or gathered over an interval.

use std::f64::consts::PI;

use imu_core::nalgebra::{Matrix3, Quaternion, Vector3};
use imu_core::so3;

/// Gravity of all motions, m/s².
pub const GRAVITY: f64 = 9.81;

/// A motion by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// The classic simulated trajectory: 30 × 40 m every 20 s, bobbing and rolling; 60 s.
    Ellipse,
    /// Something held in the hand of a walker: steps, swings, and a tremor of 6 Hz; 60 s.
    Gait,
    /// An axis that goes round a cone of 1°, 25 times a second; 60 s.
    Coning,
    /// 2000 °/s about one axis, shaken at 80 Hz by 5 g, as on a spinning shell or a cracked propeller; 10 s.
    Spin,
    /// Nothing moves; 60 s.
    Rest,
}

/// All of them, in the order of tables.
pub const MOTIONS: [Motion; 5] =
    [Motion::Ellipse, Motion::Gait, Motion::Coning, Motion::Spin, Motion::Rest];

/// Where a body is, and what an ideal IMU in it reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// q_wb, body to world.
    pub attitude_wb: Quaternion<f64>,
    /// m/s
    pub velocity_w: Vector3<f64>,
    /// m
    pub position_w: Vector3<f64>,
    /// ω in body axes, rad/s.
    pub angular_rate: Vector3<f64>,
    /// f in body axes, m/s².
    pub specific_force: Vector3<f64>,
}

impl Motion {
    /// What tables call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ellipse => "ellipse",
            Self::Gait => "gait",
            Self::Coning => "coning",
            Self::Spin => "spin",
            Self::Rest => "rest",
        }
    }

    /// How long it is followed, s.
    #[must_use]
    pub fn duration_s(self) -> f64 {
        if self == Self::Spin { 10.0 } else { 60.0 }
    }

    /// The motion `t` seconds after it began.
    #[must_use]
    pub fn at(self, t: f64) -> Truth {
        match self {
            Self::Ellipse => ellipse(t),
            Self::Gait => gait(t),
            Self::Coning => coning(t),
            Self::Spin => spin(t),
            Self::Rest => posed(t, [&[], &[], &[]], [&[], &[], &[]], [[0.0; 2]; 6]),
        }
    }

    /// ∫ω dt in rad and ∫f dt in m/s from one time to another, to a relative 1e-12.
    ///
    /// Gauss and Legendre's five points (Abramowitz & Stegun (1964), table 25.4) a millisecond: of 80 Hz, the fastest
    /// here, that is half a radian.
    #[must_use]
    pub fn gathered(self, from: f64, to: f64) -> [Vector3<f64>; 2] {
        const POINTS: [(f64, f64); 5] = [
            (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
            (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        ];
        let panels = ((to - from) * 1e3).ceil().max(1.0);
        let half = (to - from) / panels / 2.0;
        let mut sums = [Vector3::zeros(); 2];
        for panel in 0..panels as u32 {
            let middle = from + (2.0 * f64::from(panel) + 1.0) * half;
            for (place, weight) in POINTS {
                let truth = self.at(middle + place * half);
                sums[0] += truth.angular_rate * (weight * half);
                sums[1] += truth.specific_force * (weight * half);
            }
        }
        sums
    }
}

/// A sin(wt + φ): its amplitude, rate in rad/s and phase.
type Wave = (f64, f64, f64);

/// c + kt + ΣA sin(wt + φ), with its first and second derivative.
fn channel(t: f64, [constant, slope]: [f64; 2], waves: &[Wave]) -> [f64; 3] {
    let mut channel = [constant + slope * t, slope, 0.0];
    for &(amplitude, rate, phase) in waves {
        let (sin, cos) = (rate * t + phase).sin_cos();
        channel[0] += amplitude * sin;
        channel[1] += amplitude * rate * cos;
        channel[2] -= amplitude * rate * rate * sin;
    }
    channel
}

/// A body whose position and roll, pitch and yaw are channels; `lines` are c and k of all six.
fn posed(t: f64, position: [&[Wave]; 3], angles: [&[Wave]; 3], lines: [[f64; 2]; 6]) -> Truth {
    let [x, y, z] = [0, 1, 2].map(|axis| channel(t, lines[axis], position[axis]));
    let [roll, pitch, yaw] = [0, 1, 2].map(|axis| channel(t, lines[3 + axis], angles[axis]));
    let acceleration = Vector3::new(x[2], y[2], z[2]);
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll[0].sin_cos(), pitch[0].sin_cos(), yaw[0].sin_cos());
    // Rz(yaw) Ry(pitch) Rx(roll), and the rates of those angles in body axes.
    let r_wb = Matrix3::new(
        cy * cp,
        cy * sp * sr - sy * cr,
        cy * sp * cr + sy * sr,
        sy * cp,
        sy * sp * sr + cy * cr,
        sy * sp * cr - cy * sr,
        -sp,
        cp * sr,
        cp * cr,
    );
    let angular_rate = Vector3::new(
        roll[1] - sp * yaw[1],
        cr * pitch[1] + sr * cp * yaw[1],
        -sr * pitch[1] + cr * cp * yaw[1],
    );
    let about = |angle: f64, axis: fn(f64) -> Vector3<f64>| so3::exp(axis(angle));
    let turned = so3::product(
        &about(yaw[0], |z| Vector3::new(0.0, 0.0, z)),
        &about(pitch[0], |y| Vector3::new(0.0, y, 0.0)),
    );
    let attitude_wb = so3::product(&turned, &about(roll[0], |x| Vector3::new(x, 0.0, 0.0)));
    Truth {
        attitude_wb,
        velocity_w: Vector3::new(x[1], y[1], z[1]),
        position_w: Vector3::new(x[0], y[0], z[0]),
        angular_rate,
        specific_force: r_wb.transpose() * (acceleration + Vector3::new(0.0, 0.0, GRAVITY)),
    }
}

/// He & Gao (2019), `vio_data_simulation`.
fn ellipse(t: f64) -> Truth {
    const K: f64 = PI / 10.0;
    let quarter = PI / 2.0;
    posed(
        t,
        [&[(15.0, K, quarter)], &[(20.0, K, 0.0)], &[(1.0, 10.0 * K, 0.0)]],
        [&[(0.1, 1.0, quarter)], &[(0.2, 1.0, 0.0)], &[]],
        [[5.0, 0.0], [5.0, 0.0], [5.0, 0.0], [0.0; 2], [0.0; 2], [0.0, K]],
    )
}

fn gait(t: f64) -> Truth {
    const DEGREE: f64 = PI / 180.0;
    let (stride, step, tremor) = (2.0 * PI, 4.0 * PI, 12.0 * PI);
    posed(
        t,
        [
            &[(0.02, step, 0.3)],
            &[(0.03, stride, 0.1), (0.002, tremor, 0.0)],
            &[(0.025, step, 0.0), (0.002, tremor, 1.0)],
        ],
        [
            &[(5.0 * DEGREE, stride, 0.0), (DEGREE, tremor, 0.4)],
            &[(5.0 * DEGREE, step, 1.0), (DEGREE, tremor, 1.2)],
            &[(8.0 * DEGREE, stride, 2.0)],
        ],
        [[0.0, 1.2], [0.0; 2], [1.2, 0.0], [0.0; 2], [0.0; 2], [0.0, 0.1]],
    )
}

fn coning(t: f64) -> Truth {
    const RATE: f64 = 50.0 * PI;
    const HALF_CONE: f64 = PI / 180.0;
    let ((sin_a, cos_a), (sin_h, cos_h)) = (HALF_CONE.sin_cos(), (HALF_CONE / 2.0).sin_cos());
    let (sin, cos) = (RATE * t).sin_cos();
    let attitude_wb = Quaternion::new(cos_h, sin_h * cos, sin_h * sin, 0.0);
    // R(q)ᵀ(0, 0, g), of a rotation by a about (cos wt, sin wt, 0).
    let specific_force = Vector3::new(-sin_a * sin, sin_a * cos, cos_a) * GRAVITY;
    Truth {
        attitude_wb,
        velocity_w: Vector3::zeros(),
        position_w: Vector3::zeros(),
        angular_rate: Vector3::new(-sin_a * sin, sin_a * cos, cos_a - 1.0) * RATE,
        specific_force,
    }
}

fn spin(t: f64) -> Truth {
    const DEGREE: f64 = PI / 180.0;
    const SHAKE: f64 = 160.0 * PI;
    let reach = 5.0 * GRAVITY / (SHAKE * SHAKE);
    let half = 0.5 * DEGREE;
    posed(
        t,
        [
            &[(reach, SHAKE, 0.0)],
            &[(3.0, 2.0, 0.0), (reach, SHAKE, 1.0)],
            &[(2.0, 3.0, 0.0), (reach, SHAKE, 2.0)],
        ],
        [
            &[(half, SHAKE, 0.0)],
            &[(30.0 * DEGREE, 4.0, 0.0), (half, SHAKE, PI / 2.0)],
            &[(0.2 * DEGREE, SHAKE, 1.0)],
        ],
        [[0.0, 10.0], [0.0; 2], [0.0; 2], [0.0, 2000.0 * DEGREE], [0.0; 2], [0.0, 1.0]],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn norm(v: Vector3<f64>) -> f64 {
        v.x.hypot(v.y).hypot(v.z)
    }

    /// Each motion's readings are the derivatives of its own poses, by central differences of 1e-4 s.
    #[test]
    fn readings_are_the_derivatives_of_the_poses() {
        const H: f64 = 1e-4;
        for motion in MOTIONS {
            for k in 0..40 {
                let t = 0.013 + 0.137 * f64::from(k);
                let [before, now, after] = [t - H, t, t + H].map(|t| motion.at(t));
                // (wh)²/6 of the fastest wave, 500 rad/s: 4e-4 of its size.
                let turn = so3::product(&so3::inverse(&before.attitude_wb), &after.attitude_wb);
                let rate = so3::log(&turn) / (2.0 * H);
                let size = 1.0 + norm(now.angular_rate);
                assert!(norm(rate - now.angular_rate) < 2e-3 * size, "{motion:?} {t}");
                let velocity = (after.position_w - before.position_w) / (2.0 * H);
                assert!(norm(velocity - now.velocity_w) < 1e-3 * (1.0 + norm(velocity)));
                let acceleration = (after.velocity_w - before.velocity_w) / (2.0 * H);
                let felt = acceleration + Vector3::new(0.0, 0.0, GRAVITY);
                let felt = so3::rotate(&so3::inverse(&now.attitude_wb), &felt);
                assert!(
                    norm(felt - now.specific_force) < 2e-3 * (1.0 + norm(felt)),
                    "{motion:?} {t}"
                );
                assert!((so3::length(&now.attitude_wb) - 1.0).abs() < 1e-14);
            }
        }
    }

    /// What is gathered over two parts is what is gathered over the whole, and it is the velocity of a fall.
    #[test]
    fn gathering_adds_up() {
        for motion in MOTIONS {
            let [angle, velocity] = motion.gathered(0.1, 0.12);
            let (first, second) = (motion.gathered(0.1, 0.111), motion.gathered(0.111, 0.12));
            assert!(norm(angle - first[0] - second[0]) < 1e-12);
            assert!(norm(velocity - first[1] - second[1]) < 1e-12);
        }
        assert_eq!(Motion::Rest.gathered(0.0, 2.0)[0], Vector3::zeros());
        assert!((Motion::Rest.gathered(0.0, 2.0)[1].z - 2.0 * GRAVITY).abs() < 1e-11);
    }
}
