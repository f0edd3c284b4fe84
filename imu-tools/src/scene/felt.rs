//! What ideal sensors feel of a motion where they sit: at an instant, or on average over an interval.
//!
//! A mean is a Gauss-Legendre quadrature of four points on each piece of at most 0.05 s. Its error is
//! h⁸(4!)⁴/(9·8!³) = 5.6e-10 h⁸ times the eighth derivative (Davis & Rabinowitz (1984), Methods of
//! Numerical Integration, section 2.7). On the ellipse specific force is below 9000 m/s² for complex
//! times up to 2 s off the real axis, so by Cauchy's bound that derivative is below 8!·9000/2⁸ =
//! 1.4e6 m/s¹⁰, and the error below 4e-14 m/s²; of the rates, and of a lever arm of metres, below that.

use imu_core::sensor::{Kinematics, LeverArm, Placement};
use imu_core::trajectory::{Ellipse, Rest, Trajectory};

use super::Path;

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

impl Path {
    fn kinematics(self, gravity: f64, t_ns: i64, offset_s: f64) -> Kinematics<f64> {
        match self {
            Self::Rest => Rest { gravity }.kinematics(t_ns, offset_s),
            Self::Ellipse => Ellipse { gravity }.kinematics(t_ns, offset_s),
        }
    }

    /// What is felt `t_ns` after the start.
    pub(super) fn felt(self, gravity: f64, arms: &Arms, t_ns: i64) -> Felt {
        arms.felt(&self.kinematics(gravity, t_ns, 0.0))
    }

    /// The mean of what is felt over the `dt` seconds before.
    pub(super) fn mean_felt(self, gravity: f64, arms: &Arms, t_ns: i64, dt: f64) -> Felt {
        let pieces = (dt / LONGEST).ceil().max(1.0);
        let half = 0.5 * dt / pieces;
        let mut sum = Felt::default();
        for piece in 0..pieces as u64 {
            let middle = (2 * piece + 1) as f64 * half - dt;
            for (point, weight) in GAUSS {
                let felt = arms.felt(&self.kinematics(gravity, t_ns, middle + half * point));
                sum.add(&felt, 0.5 * weight / pieces);
            }
        }
        sum
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
            let whole = Path::Ellipse.mean_felt(9.81, &arms(), t_ns, dt);
            let mut sum = Felt::default();
            for part in 0..parts {
                let end = t_ns - part * dt_ms * 1_000_000;
                let felt = Path::Ellipse.mean_felt(9.81, &arms(), end, dt / parts as f64);
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
            let mean = Path::Ellipse.mean_felt(9.81, &arms(), t_ns + 500_000, 1e-3);
            let middle = Path::Ellipse.felt(9.81, &arms(), t_ns);
            for (mean, middle) in all(&mean).into_iter().zip(all(&middle)) {
                prop_assert!((mean - middle).abs() < 1e-5);
            }
        }
    }
}
