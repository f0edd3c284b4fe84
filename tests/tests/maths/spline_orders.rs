//! Splines through poses of the classic ellipse: of which order each error is in the knot spacing, and how large.
//!
//! Steps divide the span of 12 s; errors are the largest of those at eight instants an interval. Slopes are fitted over
//! 25 to 3 ms, where nothing but the step decides: the smallest error there, 7e-14 rad, is a hundred roundings, and above,
//! the ends are further off than the middle.

use imu_core::nalgebra::Vector3;
use imu_core::se3::Pose;
use imu_core::sensor::Kinematics;
use imu_core::so3;
use imu_core::spline::{Form, OneSided, SplitCurve, TimeSymmetric, interpolate};
use imu_core::trajectory::{Ellipse, Motion, Trajectory};

use super::spline::order;

const SPAN_NS: i64 = 12_000_000_000;
const STEPS_NS: [u32; 4] = [25_000_000, 12_500_000, 6_250_000, 3_125_000];

fn pose(t_ns: i64) -> Pose<f64> {
    let motion: Motion<f64> = Ellipse::default().at(t_ns);
    Pose::new(motion.attitude_wb, motion.position_w).unwrap()
}

fn norm(v: Vector3<f64>) -> f64 {
    v.x.hypot(v.y).hypot(v.z)
}

/// Rotation, ω and α; position and acceleration.
type Errors = [f64; 5];

/// The largest errors of a curve from `start_ns` on at instants within the span.
fn errors<F: Form<f64>>(start_ns: i64, step_ns: u32, control: &[Pose<f64>]) -> Errors {
    let curve = SplitCurve::<_, _, F>::from_control_points(start_ns, step_ns, control).unwrap();
    let mut largest = [0.0_f64; 5];
    for k in 0..SPAN_NS / i64::from(step_ns) * 8 {
        let t_ns = (2 * k + 1) * i64::from(step_ns) / 16;
        let there = curve.full(t_ns).unwrap();
        let truth: Motion<f64> = Ellipse::default().at(t_ns);
        let felt: Kinematics<f64> = Ellipse::default().kinematics(t_ns, 0.0);
        let back = so3::inverse(&truth.attitude_wb);
        let force = so3::rotate(&truth.attitude_wb, &truth.specific_force);
        let errors = [
            so3::log(&so3::product(&back, &there.pose.rotation())),
            there.angular_rate - truth.angular_rate,
            there.angular_acceleration - Vector3::from(felt.angular_acceleration),
            there.pose.translation() - truth.position_w,
            there.acceleration_w - (force - Vector3::new(0.0, 0.0, 9.81)),
        ];
        for (largest, error) in largest.iter_mut().zip(errors) {
            *largest = largest.max(norm(error));
        }
    }
    largest
}

/// Control points of the curve through a pose every step, the first of one step before the span.
fn interpolated<F: Form<f64>>(step_ns: u32) -> Vec<Pose<f64>> {
    let step = i64::from(step_ns);
    let poses: Vec<_> = (0..=SPAN_NS / step).map(|k| pose(k * step)).collect();
    let mut control = vec![Pose::identity(); poses.len() + 2];
    interpolate::<_, F>(&poses, &mut control, &mut vec![Vector3::zeros(); poses.len()]).unwrap();
    // Through the poses themselves: 25 m and unit quaternions to 1e-12.
    let curve = SplitCurve::<_, _, F>::from_control_points(-step, step_ns, &control).unwrap();
    for (k, pose) in (0..).zip(&poses) {
        let there = curve.pose(k * step).unwrap();
        assert!(norm(there.translation() - pose.translation()) <= 1e-12);
        let turn = so3::product(&so3::inverse(&there.rotation()), &pose.rotation());
        assert!(norm(so3::log(&turn)) <= 1e-12);
    }
    control
}

fn of_step<F: Form<f64>>(step_ns: u32) -> Errors {
    errors::<F>(-i64::from(step_ns), step_ns, &interpolated::<F>(step_ns))
}

fn has_orders<F: Form<f64>>(name: &str, orders: [f64; 5]) -> [Errors; 4] {
    let errors = STEPS_NS.map(of_step::<F>);
    for (which, expected) in orders.into_iter().enumerate() {
        let measured = order(STEPS_NS.iter().zip(&errors).map(|(h, e)| (f64::from(*h), e[which])));
        assert!((measured - expected).abs() <= 0.15, "{name} {which}: {measured} of {expected}");
    }
    errors
}

#[test]
fn the_product_is_of_order_3_and_the_symmetric_form_of_order_4() {
    let plain = has_orders::<OneSided>("plain", [3.0, 2.0, 1.0, 4.0, 2.0]);
    let symmetric = has_orders::<TimeSymmetric>("symmetric", [4.0, 3.0, 2.0, 4.0, 2.0]);
    // At 0.025 s: 3.7e-9 rad and 4.5e-7 rad/s of the product.
    let [rotation, rate, ..] = symmetric[0];
    assert!(rotation <= 4e-10 && rate <= 5e-8, "{rotation:e} {rate:e}");
    assert!(plain[0][0] > 8.0 * rotation && plain[0][1] > 8.0 * rate, "{:?}", plain[0]);
}

/// (h²/6)|p̈| of 10 m/s² less what the fourth derivative takes off it.
#[test]
fn poses_are_no_control_points() {
    let step = 200_000_000;
    let poses: Vec<_> = (-1..=SPAN_NS / step + 1).map(|k| pose(k * step)).collect();
    let [.., position, _] = errors::<OneSided>(-step, 200_000_000, &poses);
    assert!((position - 0.065).abs() < 0.0005, "{position}");
}
