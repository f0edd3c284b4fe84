//! The motion along a spline of poses: a user's own trajectory, as an IMU would feel it.

use super::{GRAVITY, Motion, Trajectory};
use crate::sensor::Kinematics;
use crate::spline::{Curve, Full};
use crate::{Real, so3};
use nalgebra::Vector3;

/// A body that moves along a curve of poses in double precision, a [`SplitSpline`](crate::spline::SplitSpline), a
/// [`SymmetricSplitSpline`](crate::spline::SymmetricSplitSpline) or an [`Se3Spline`](crate::spline::Se3Spline).
///
/// The clock of the curve is the trajectory's. There is no motion beyond the ends of the curve: every number is NaN
/// there, so look at [`span`](Trajectory::span) first.
///
/// ```
/// use imu_core::se3::Pose;
/// use imu_core::spline::SplitSpline;
/// use imu_core::trajectory::{AlongSpline, Motion, Trajectory};
/// let still = [Pose::identity(); 5];
/// let along = AlongSpline::new(SplitSpline::from_control_points(0, 100_000_000, &still)?);
/// let motion: Motion<f32> = along.at(150_000_000);
/// assert_eq!(motion.specific_force.z, 9.81);
/// assert_eq!(Trajectory::<f32>::span(&along), (100_000_000, 300_000_000));
/// # Ok::<(), imu_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlongSpline<S> {
    /// The curve, in double precision.
    pub curve: S,
    /// g, m/s²; the world's z axis points up.
    pub gravity: f64,
}

impl<S> AlongSpline<S> {
    /// Under [`GRAVITY`].
    #[must_use]
    pub fn new(curve: S) -> Self {
        Self { curve, gravity: GRAVITY }
    }
}

impl<S: Curve<f64>> AlongSpline<S> {
    /// The curve itself, and what an accelerometer feels on it.
    fn felt(&self, t_ns: i64, offset_s: f64) -> Option<(Full<f64>, Vector3<f64>)> {
        let full = self.curve.full_between(t_ns, offset_s).ok()?;
        let back = so3::inverse(&full.pose.rotation());
        let gravity = Vector3::new(0.0, 0.0, self.gravity);
        Some((full, so3::rotate(&back, &(full.acceleration_w + gravity))))
    }
}

impl<T: Real, S: Curve<f64>> Trajectory<T> for AlongSpline<S> {
    fn span(&self) -> (i64, i64) {
        self.curve.knots().span()
    }

    fn at(&self, t_ns: i64) -> Motion<T> {
        let motion = match self.felt(t_ns, 0.0) {
            Some((full, specific_force)) => Motion {
                position_w: full.pose.translation(),
                velocity_w: full.velocity_w,
                attitude_wb: full.pose.rotation(),
                angular_rate: full.angular_rate,
                specific_force,
            },
            None => nowhere(),
        };
        motion.cast()
    }

    fn kinematics(&self, t_ns: i64, offset_s: f64) -> Kinematics<T> {
        let cast = |v: Vector3<f64>| <[f64; 3]>::from(v).map(T::from_f64);
        match self.felt(t_ns, offset_s) {
            Some((full, specific_force)) => Kinematics {
                angular_rate: cast(full.angular_rate),
                angular_acceleration: cast(full.angular_acceleration),
                specific_force: cast(specific_force),
            },
            None => {
                let nan = [T::from_f64(f64::NAN); 3];
                Kinematics { angular_rate: nan, angular_acceleration: nan, specific_force: nan }
            }
        }
    }
}

fn nowhere() -> Motion<f64> {
    let nan = Vector3::from([f64::NAN; 3]);
    Motion {
        position_w: nan,
        velocity_w: nan,
        attitude_wb: [f64::NAN; 4].into(),
        angular_rate: nan,
        specific_force: nan,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::se3::Pose;
    use crate::spline::SymmetricSplitSpline;
    use crate::trajectory::Ellipse;

    /// Control poses of the ellipse every 10 ms: off by h²/6 of the second derivatives, 2.6e-4 m where it bobs.
    #[test]
    fn along_the_ellipse_is_nearly_the_ellipse() {
        let poses: std::vec::Vec<_> = (0..200)
            .map(|k| {
                let m: Motion<f64> = Ellipse::default().at(k * 10_000_000);
                Pose::new(m.attitude_wb, m.position_w).unwrap()
            })
            .collect();
        let along = AlongSpline::new(
            SymmetricSplitSpline::from_control_points(0, 10_000_000, &poses).unwrap(),
        );
        assert_eq!(Trajectory::<f64>::span(&along), (10_000_000, 1_980_000_000));
        for k in 0..100 {
            let t_ns = 10_000_000 + k * 19_700_000;
            let (a, b): (Motion<f64>, Motion<f64>) = (along.at(t_ns), Ellipse::default().at(t_ns));
            assert!((a.position_w - b.position_w).abs().max() < 3e-4);
            // h²/6 of derivatives of fourth order, κ = π: 97 m/s⁴, and 3.1 rad/s³.
            assert!((a.specific_force - b.specific_force).abs().max() < 4e-3);
            assert!((a.angular_rate - b.angular_rate).abs().max() < 1e-4);
            let felt: Kinematics<f64> = along.kinematics(t_ns - 1_000_000, 1e-3);
            assert!((Vector3::from(felt.specific_force) - a.specific_force).abs().max() < 1e-12);
        }
        for t_ns in [i64::MIN, 9_999_999, 1_980_000_001, i64::MAX] {
            let outside: Motion<f32> = along.at(t_ns);
            assert!(outside.position_w.x.is_nan() && outside.attitude_wb.w.is_nan());
            let felt: Kinematics<f32> = along.kinematics(t_ns, 0.0);
            assert!(felt.angular_rate[0].is_nan() && felt.specific_force[2].is_nan());
        }
    }
}
