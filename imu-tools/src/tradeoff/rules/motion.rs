//! Motions known in closed form, smooth and rough, on which rules are measured.
//!
//! The world is flat, z up, with 9.81 m/s² of gravity. Each motion says where a body is at any time, and what an ideal
//! IMU in it reads, at an instant or gathered over an interval.

use imu_core::nalgebra::Vector3;
use imu_core::trajectory::{Coning, Ellipse, Gait, Rest, Spin, Trajectory};

/// Gravity of all motions, m/s².
pub use imu_core::trajectory::GRAVITY;

/// Where a body is, and what an ideal IMU in it reads.
pub type Truth = imu_core::trajectory::Motion<f64>;

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

    /// Any of [`MOTIONS`] by what tables call it.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        MOTIONS.into_iter().find(|motion| motion.name() == name)
    }

    /// How long it is followed, s.
    #[must_use]
    pub fn duration_s(self) -> f64 {
        if self == Self::Spin { 10.0 } else { 60.0 }
    }

    /// The motion so many nanoseconds after it began.
    #[must_use]
    pub fn at(self, t_ns: i64) -> Truth {
        self.trajectory().at(t_ns)
    }

    fn trajectory(self) -> &'static dyn Trajectory<f64> {
        match self {
            Self::Ellipse => &Ellipse { gravity: GRAVITY },
            Self::Gait => &Gait { gravity: GRAVITY },
            Self::Coning => &Coning { gravity: GRAVITY },
            Self::Spin => &Spin { gravity: GRAVITY },
            Self::Rest => &Rest { gravity: GRAVITY },
        }
    }

    /// ∫ω dt in rad and ∫f dt in m/s from one time to another, both in ns, to a relative 1e-12.
    ///
    /// Gauss and Legendre's five points (Abramowitz & Stegun (1964), table 25.4) a millisecond: of 80 Hz, the fastest
    /// here, that is half a radian.
    #[must_use]
    pub fn gathered(self, from_ns: i64, to_ns: i64) -> [Vector3<f64>; 2] {
        const POINTS: [(f64, f64); 5] = [
            (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
            (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        ];
        let trajectory = self.trajectory();
        let length = (to_ns - from_ns) as f64 / 1e9;
        let panels = (length * 1e3).ceil().max(1.0);
        let half = length / panels / 2.0;
        let mut sums = [Vector3::zeros(); 2];
        for panel in 0..panels as u32 {
            let middle = (2.0 * f64::from(panel) + 1.0) * half;
            for (place, weight) in POINTS {
                let felt = trajectory.kinematics(from_ns, middle + place * half);
                sums[0] += Vector3::from(felt.angular_rate) * (weight * half);
                sums[1] += Vector3::from(felt.specific_force) * (weight * half);
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn norm(v: Vector3<f64>) -> f64 {
        v.x.hypot(v.y).hypot(v.z)
    }

    /// What is gathered over two parts is what is gathered over the whole, and it is the velocity of a fall.
    #[test]
    fn gathering_adds_up() {
        for motion in MOTIONS {
            let [angle, velocity] = motion.gathered(100_000_000, 120_000_000);
            let (first, second) = (
                motion.gathered(100_000_000, 111_000_000),
                motion.gathered(111_000_000, 120_000_000),
            );
            assert!(norm(angle - first[0] - second[0]) < 1e-12);
            assert!(norm(velocity - first[1] - second[1]) < 1e-12);
        }
        assert_eq!(Motion::Rest.gathered(0, 2_000_000_000)[0], Vector3::zeros());
        assert!((Motion::Rest.gathered(0, 2_000_000_000)[1].z - 2.0 * GRAVITY).abs() < 1e-11);
    }
}
