//! What ideal sensors feel of a motion where they sit: at an instant, or on average over an interval.
//!
//! A mean is a Gauss-Legendre quadrature of four points on each piece of at most 0.05 s. Its error is
//! h⁸(4!)⁴/(9·8!³) = 5.6e-10 h⁸ times the eighth derivative (Davis & Rabinowitz (1984), Methods of
//! Numerical Integration, section 2.7). On the ellipse specific force is below 9000 m/s² for complex
//! times up to 2 s off the real axis, so by Cauchy's bound that derivative is below 8!·9000/2⁸ =
//! 1.4e6 m/s¹⁰, and the error below 4e-14 m/s²; of the rates, and of a lever arm of metres, below that.
//! A curve through poses is smooth only between its knots: pieces end there, too.

use imu_core::nalgebra::Vector3;
use imu_core::sensor::{Kinematics, LeverArm, Placement};
use imu_core::so3;
use imu_core::trajectory::{Ellipse, Motion, Rest, Trajectory};

use super::{Path, Scene};

/// The longest piece of a quadrature, s.
const LONGEST: f64 = 0.05;

/// Points and weights of the quadrature over −1 … 1 (Abramowitz & Stegun (1964), table 25.4).
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// What ideal sensors feel: at the point that the motion describes, and where they sit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Felt {
    /// Angular rate, everywhere on the body, rad/s.
    pub(super) rate: [f64; 3],
    /// Specific force at the point that the motion describes, m/s².
    pub(super) force: [f64; 3],
    /// Specific force at the gyroscope.
    pub(super) at_gyroscope: [f64; 3],
    /// Specific force at the accelerometer.
    pub(super) at_accelerometer: [f64; 3],
}

/// Where the sensors sit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arms {
    gyroscope: Option<LeverArm<f64>>,
    accelerometer: Option<LeverArm<f64>>,
}

impl Arms {
    pub(super) fn new(gyroscope: [f64; 3], accelerometer: [f64; 3]) -> Self {
        let there = |arm: [f64; 3]| (arm != [0.0; 3]).then_some(LeverArm { arm });
        Self { gyroscope: there(gyroscope), accelerometer: there(accelerometer) }
    }

    pub(super) fn are_zero(&self) -> bool {
        self.gyroscope.is_none() && self.accelerometer.is_none()
    }

    /// The motion of the accelerometer, where that of the point is known and what is felt.
    fn motion_there(&self, motion: Motion<f64>, felt: impl FnOnce() -> Felt) -> Motion<f64> {
        let Some(LeverArm { arm }) = self.accelerometer else { return motion };
        let arm = Vector3::from(arm);
        let to_world = |v: &Vector3<f64>| so3::rotate(&motion.attitude_wb, v);
        Motion {
            position_w: motion.position_w + to_world(&arm),
            velocity_w: motion.velocity_w + to_world(&motion.angular_rate.cross(&arm)),
            specific_force: felt().at_accelerometer.into(),
            ..motion
        }
    }

    pub(super) fn of_accelerometer(&self) -> bool {
        self.accelerometer.is_some()
    }

    fn felt(&self, motion: &Kinematics<f64>) -> Felt {
        let force = motion.specific_force;
        let at = |arm: &Option<LeverArm<f64>>| match arm {
            Some(arm) => arm.felt(motion).specific_force,
            None => force,
        };
        Felt {
            rate: motion.angular_rate,
            force,
            at_gyroscope: at(&self.gyroscope),
            at_accelerometer: at(&self.accelerometer),
        }
    }
}

/// A scene's motion as it is played: times are ns after the scene's start.
#[derive(Debug)]
pub(super) struct Played {
    path: Path,
    gravity: f64,
    start_ns: i64,
}

impl Played {
    pub(super) fn new(scene: &Scene) -> Self {
        Self { path: scene.motion.clone(), gravity: scene.gravity, start_ns: scene.start_ns }
    }

    /// Whether nothing ever changes.
    pub(super) fn is_still(&self) -> bool {
        matches!(self.path, Path::Rest)
    }

    /// The motion `t_ns` after the start.
    pub(super) fn motion(&self, t_ns: i64) -> Motion<f64> {
        let gravity = self.gravity;
        match &self.path {
            Path::Rest => Rest { gravity }.at(t_ns),
            Path::Ellipse => Ellipse { gravity }.at(t_ns),
            Path::Along(route) => route.motion(gravity, self.start_ns.saturating_add(t_ns)),
        }
    }

    /// The same of the accelerometer.
    pub(super) fn motion_of_accelerometer(&self, arms: &Arms, t_ns: i64) -> Motion<f64> {
        arms.motion_there(self.motion(t_ns), || self.felt(arms, t_ns))
    }

    fn kinematics(&self, t_ns: i64, offset_s: f64) -> Kinematics<f64> {
        let gravity = self.gravity;
        match &self.path {
            Path::Rest => Rest { gravity }.kinematics(t_ns, offset_s),
            Path::Ellipse => Ellipse { gravity }.kinematics(t_ns, offset_s),
            Path::Along(route) => {
                route.kinematics(gravity, self.start_ns.saturating_add(t_ns), offset_s)
            }
        }
    }

    /// What is felt `t_ns` after the start.
    pub(super) fn felt(&self, arms: &Arms, t_ns: i64) -> Felt {
        arms.felt(&self.kinematics(t_ns, 0.0))
    }

    /// The mean of what is felt over the `dt` seconds before.
    pub(super) fn mean_felt(&self, arms: &Arms, t_ns: i64, dt: f64) -> Felt {
        let mut sum = Felt::default();
        let mut from = -dt;
        for to in self.knots(t_ns, dt).chain([0.0]) {
            let pieces = ((to - from) / LONGEST).ceil().max(1.0);
            let half = 0.5 * (to - from) / pieces;
            for piece in 0..pieces as u64 {
                let middle = (2 * piece + 1) as f64 * half + from;
                for (point, weight) in GAUSS {
                    let felt = arms.felt(&self.kinematics(t_ns, middle + half * point));
                    sum.add(&felt, weight * half / dt);
                }
            }
            from = to;
        }
        sum
    }

    /// Where the motion is not smooth within the `dt` seconds before `t_ns`: seconds, below zero.
    fn knots(&self, t_ns: i64, dt: f64) -> impl Iterator<Item = f64> + use<> {
        let knots = match &self.path {
            Path::Along(route) => Some(*route.knots()),
            Path::Rest | Path::Ellipse => None,
        };
        let start_ns = self.start_ns;
        let step_ns = knots.map_or(0, |knots| i64::from(knots.step_ns()));
        // ns since the last knot at or before the end.
        let since = knots.map_or(0, |knots| {
            let elapsed = i128::from(start_ns) + i128::from(t_ns) - i128::from(knots.start_ns());
            elapsed.rem_euclid(i128::from(step_ns)) as i64
        });
        let count = if step_ns > 0 { 1e9 * dt / step_ns as f64 + 1.0 } else { 0.0 };
        let at = (0..count.ceil() as i64).map(move |k| -1e-9 * (since + k * step_ns) as f64);
        // Knots at the ends, but for rounding, divide nothing; the first come first.
        let within: Vec<f64> = at.filter(|at| *at < -1e-10 && *at > 1e-10 - dt).collect();
        within.into_iter().rev()
    }
}

impl Felt {
    fn add(&mut self, other: &Self, weight: f64) {
        let add = |sum: &mut [f64; 3], more: &[f64; 3]| {
            sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += weight * more);
        };
        add(&mut self.rate, &other.rate);
        add(&mut self.force, &other.force);
        add(&mut self.at_gyroscope, &other.at_gyroscope);
        add(&mut self.at_accelerometer, &other.at_accelerometer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ellipse() -> Played {
        Played::new(&Scene { motion: Path::Ellipse, ..Scene::default() })
    }

    fn arms() -> Arms {
        Arms::new([0.1, -0.2, 0.3], [-0.5, 0.4, 1.0])
    }

    fn all(felt: &Felt) -> [f64; 12] {
        let Felt { rate, force, at_gyroscope, at_accelerometer } = felt;
        let mut all = [0.0; 12];
        let parts = [rate, force, at_gyroscope, at_accelerometer];
        all.iter_mut().zip(parts.into_iter().flatten()).for_each(|(all, part)| *all = *part);
        all
    }

    proptest! {
        /// A mean over an interval is that of its parts': each within 4e-14, and rounding of t, below
        /// 1e-14 s here, by at most 40 m/s³.
        #[test]
        fn means_add_up(t_ns in 0_i64..60_000_000_000, dt_ms in 1_i64..400, parts in 2_i64..9) {
            let dt_ns = dt_ms * 1_000_000 * parts;
            let dt = dt_ns as f64 / 1e9;
            let whole = ellipse().mean_felt(&arms(), t_ns, dt);
            let mut sum = Felt::default();
            for part in 0..parts {
                let end = t_ns - part * dt_ms * 1_000_000;
                let felt = ellipse().mean_felt(&arms(), end, dt / parts as f64);
                sum.add(&felt, 1.0 / parts as f64);
            }
            for (whole, sum) in all(&whole).into_iter().zip(all(&sum)) {
                prop_assert!((whole - sum).abs() < 2e-12, "{whole} {sum}");
            }
        }

        /// Over a short interval a mean is the instant in its middle, but for dt²/24 of the second
        /// derivative, below 200: 1e-5 at 1 ms.
        #[test]
        fn a_short_mean_is_its_middle(t_ns in 0_i64..60_000_000_000) {
            let mean = ellipse().mean_felt(&arms(), t_ns + 500_000, 1e-3);
            let middle = ellipse().felt(&arms(), t_ns);
            for (mean, middle) in all(&mean).into_iter().zip(all(&middle)) {
                prop_assert!((mean - middle).abs() < 1e-5);
            }
        }
    }
}
