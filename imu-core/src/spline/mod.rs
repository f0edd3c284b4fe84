//! Splines: a motion as a smooth curve through or near given poses, with the derivatives that an IMU feels.
//!
//! Uniform cubic B-splines in cumulative form: four neighbouring *control points* carry the curve on each interval, and
//! position, attitude, velocity and acceleration are continuous everywhere. Ask for the pose and pay for the pose;
//! times are integer nanoseconds, with an error outside the stated span.
//!
//! | curve | control points | what it is |
//! | --- | --- | --- |
//! | [`R3Spline`] | [`Vector3`](nalgebra::Vector3) | positions |
//! | [`So3Spline`] | [`Quaternion`](nalgebra::Quaternion) | attitudes: the cumulative product of Kim, Kim & Shin (1995) |
//! | [`SymmetricSo3Spline`] | the same | attitudes: the same curve seen from either end, of order 4 in the step where the product has 3 |
//! | [`SplitSpline`], [`SymmetricSplitSpline`] | [`Pose`](crate::se3::Pose) | positions beside attitudes: the one to take |
//! | [`Se3Spline`] | the same | positions and attitudes coupled along screws, as Lovegrove, Patron-Perez & Sibley (2013) have it |
//!
//! **Control points are not poses of the curve.** With the poses of a motion p as control points the curve is off by
//! (h²/6)p̈. [`interpolate`] makes control points of poses whose curve goes through them; [`quasi_interpolant`] takes
//! that error out but for h⁴, from three neighbours and without a solve, and [`Stream`] does it as poses come in. (On
//! screws it is [`quasi_interpolant_on_screws`].)
//!
//! Cubics only; there are no derivatives by control points yet.
//!
//! Control points are the caller's; constructors check them once. Where a curve is asked more than a few times,
//! [`cache`] works the logarithms out beforehand: [`Knot`] and [`ScrewKnot`] are control points, too. In `f32` that is
//! also what keeps acceleration right: a difference of positions that are 20 m away has lost 12 bits, [`cache`] forms
//! it of `f64` poses. Cortex-M4F, `f32`, cached: a pose takes 300 instructions, everything 645, what an IMU reads 415
//! (tests/firmware).
//!
//! ```
//! use imu_core::nalgebra::Vector3;
//! use imu_core::se3::Pose;
//! use imu_core::so3;
//! use imu_core::spline::{Knot, SplitSpline, cache, quasi_interpolant};
//!
//! // 2 m/s along a left-hand bend of 10 m, a pose every 0.1 s.
//! let on_the_bend = |k: i32| {
//!     let angle: f64 = 0.02 * f64::from(k);
//!     Pose::new(so3::exp(Vector3::new(0.0, 0.0, angle)), Vector3::new(angle.sin(), 1.0 - angle.cos(), 0.0) * 10.0)
//! };
//! let mut control = [Pose::identity(); 8];
//! for (k, point) in (0..).zip(&mut control) {
//!     *point = quasi_interpolant(&on_the_bend(k - 1)?, &on_the_bend(k)?, &on_the_bend(k + 1)?)?;
//! }
//! let mut knots = [Knot::<f64>::default(); 8];
//! cache(&control, &mut knots)?;
//! let curve = SplitSpline::from_control_points(0, 100_000_000, &knots)?;
//! let full = curve.full(300_000_000)?;
//! let there = on_the_bend(3)?.translation() - full.pose.translation();
//! assert!(there.abs().max() < 1e-7); // m; of order 4
//! assert!((full.angular_rate.z - 0.2).abs() < 1e-12); // rad/s
//! assert!((full.acceleration_w.y - 0.4).abs() < 1e-3); // v²/r, m/s²
//! // What an IMU reads under gravity.
//! let sample = curve.imu(350_000_000, &Vector3::new(0.0, 0.0, -9.81))?;
//! assert!((sample.specific_force().z - 9.81).abs() < 1e-12);
//! assert!(curve.pose(50_000_000).is_err()); // before the first interval
//! # Ok::<(), imu_core::Error>(())
//! ```

mod basis;
mod cached;
mod concrete;
mod control;
mod interpolate;
mod kinematics;
mod knots;
mod r3;
mod se3;
mod so3;
mod split;
mod stream;
mod symmetric;
mod turn;

pub use cached::{Knot, ScrewKnot, cache, cache_screws};
pub use concrete::{double, single};
pub use control::{Attitudes, ControlPoint, Curve, Positions, Screws};
pub use interpolate::{Interpolated, interpolate};
pub use kinematics::{Attitude, Full, PoseAndVelocity, Position};
pub use knots::Knots;
pub use r3::R3Spline;
pub use se3::Se3Spline;
pub use so3::{Form, OneSided, So3Curve, So3Spline, SymmetricSo3Spline};
pub use split::{SplitCurve, SplitSpline, SymmetricSplitSpline};
pub use stream::{Stream, quasi_interpolant, quasi_interpolant_on_screws};
pub use symmetric::TimeSymmetric;
