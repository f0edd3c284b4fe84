//! Evaluations compiled here: for firmware built for size, as in [`integrate`](crate::integrate).

macro_rules! concrete {
    ($(#[$module:meta])* $scalar:ident, $T:ty) => {
        $(#[$module])*
        pub mod $scalar {
            use crate::Error;
            use crate::nalgebra::Vector3;
            use crate::sample::Sample;
            use crate::se3::Pose;
            use crate::spline::{
                Full, Knot, PoseAndVelocity, ScrewKnot, Se3Spline, SplitSpline,
                SymmetricSplitSpline,
            };

            concrete!(@ $T, "SplitSpline", "cached", SplitSpline<'_, $T, Knot<$T>>,
                pose, pose_and_velocity, full, imu);
            concrete!(@ $T, "SplitSpline", "uncached", SplitSpline<'_, $T, Pose<$T>>,
                uncached_pose, uncached_pose_and_velocity, uncached_full, uncached_imu);
            concrete!(@ $T, "SymmetricSplitSpline", "cached", SymmetricSplitSpline<'_, $T, Knot<$T>>,
                symmetric_pose, symmetric_pose_and_velocity, symmetric_full, symmetric_imu);
            concrete!(@ $T, "SymmetricSplitSpline", "uncached", SymmetricSplitSpline<'_, $T, Pose<$T>>,
                uncached_symmetric_pose, uncached_symmetric_pose_and_velocity,
                uncached_symmetric_full, uncached_symmetric_imu);
            concrete!(@ $T, "Se3Spline", "cached", Se3Spline<'_, $T, ScrewKnot<$T>>,
                se3_pose, se3_pose_and_velocity, se3_full, se3_imu);
            concrete!(@ $T, "Se3Spline", "uncached", Se3Spline<'_, $T, Pose<$T>>,
                uncached_se3_pose, uncached_se3_pose_and_velocity, uncached_se3_full,
                uncached_se3_imu);
        }
    };
    (@ $T:ty, $curve:literal, $points:literal, $Curve:ty, $pose:ident, $velocity:ident, $full:ident, $imu:ident) => {
        #[doc = concat!("`pose` of a [`", $curve, "`], ", $points, ".\n\n# Errors\nAs of the method.")]
        #[inline(never)]
        pub fn $pose(curve: &$Curve, t_ns: i64) -> Result<Pose<$T>, Error> {
            curve.pose(t_ns)
        }

        #[doc = concat!("`pose_and_velocity` of a [`", $curve, "`], ", $points, ".\n\n# Errors\nAs of the method.")]
        #[inline(never)]
        pub fn $velocity(curve: &$Curve, t_ns: i64) -> Result<PoseAndVelocity<$T>, Error> {
            curve.pose_and_velocity(t_ns)
        }

        #[doc = concat!("`full` of a [`", $curve, "`], ", $points, ".\n\n# Errors\nAs of the method.")]
        #[inline(never)]
        pub fn $full(curve: &$Curve, t_ns: i64) -> Result<Full<$T>, Error> {
            curve.full(t_ns)
        }

        #[doc = concat!("`imu` of a [`", $curve, "`], ", $points, ".\n\n# Errors\nAs of the method.")]
        #[inline(never)]
        pub fn $imu(
            curve: &$Curve,
            t_ns: i64,
            gravity_w: &Vector3<$T>,
        ) -> Result<Sample<$T>, Error> {
            curve.imu(t_ns, gravity_w)
        }
    };
}

concrete!(
    /// Evaluations in `f32`, compiled at this crate's own optimisation level.
    single, f32
);
concrete!(
    /// Evaluations in `f64`, compiled at this crate's own optimisation level.
    double, f64
);
