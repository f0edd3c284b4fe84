//! The recurrences beside the 4×4 matrices of the paper.

use super::*;
use crate::nalgebra::{Matrix3, Matrix4};
use proptest::prelude::*;

fn cross_matrix(v: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0)
}

fn hat(twist: &Twist<f64>) -> Matrix4<f64> {
    let mut m = Matrix4::zeros();
    m.fixed_view_mut::<3, 3>(0, 0).copy_from(&cross_matrix(&twist.angular));
    m.fixed_view_mut::<3, 1>(0, 3).copy_from(&twist.linear);
    m
}

fn homogeneous(pose: &Pose<f64>) -> Matrix4<f64> {
    let mut m = Matrix4::identity();
    let q = pose.rotation();
    for k in 0..3 {
        let mut axis = Vector3::zeros();
        axis[k] = 1.0;
        m.fixed_view_mut::<3, 1>(0, k).copy_from(&so3::rotate(&q, &axis));
    }
    m.fixed_view_mut::<3, 1>(0, 3).copy_from(&pose.translation());
    m
}

/// T, Ṫ and T̈ of Lovegrove et al. (2013), eqs. (5) and (6), with the 2 that reprints lose.
fn paper(four: &[Pose<f64>; 4], u: f64, rate: f64) -> [Matrix4<f64>; 3] {
    let weights = Weights::cubic(u, rate);
    let factor = |k: usize| {
        let screw = Screw::between(&four[k], &four[k + 1]);
        let (a, omega) = (homogeneous(&screw.part(weights.value[k])), hat(&screw.twist));
        let first = a * omega * weights.rate[k];
        [a, first, first * omega * weights.rate[k] + a * omega * weights.acceleration[k]]
    };
    let ([a, a1, a2], [b, b1, b2], [c, c1, c2]) = (factor(0), factor(1), factor(2));
    let base = homogeneous(&four[0]);
    [
        base * a * b * c,
        base * (a1 * b * c + a * b1 * c + a * b * c1),
        base * (a2 * b * c
            + a * b2 * c
            + a * b * c2
            + (a1 * b1 * c + a1 * b * c1 + a * b1 * c1) * 2.0),
    ]
}

fn any_pose() -> impl Strategy<Value = Pose<f64>> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0, -2.0..2.0, -2.0..2.0, -2.0..2.0_f64].prop_map(
        |[a, b, c, x, y, z]| {
            Pose::new(so3::exp(Vector3::new(a, b, c) * 0.8), Vector3::new(x, y, z)).unwrap()
        },
    )
}

proptest! {
    /// Second derivatives by u, of numbers up to 10: 1e-13 is some tens of roundings.
    #[test]
    fn derivatives_are_those_of_the_paper(a in any_pose(), b in any_pose(), c in any_pose(), d in any_pose(), u in 0.0..1.0) {
        let four = [a, b, c, d];
        let step = 1_000_000_000;
        let t_ns = step + (u * 1e9) as i64;
        let u = (t_ns - step) as f64 / 1e9;
        let curve = Se3Spline::from_control_points(0, 1_000_000_000, &four).unwrap();
        let full = curve.full(t_ns).unwrap();
        let [t, t1, t2] = paper(&four, u, 1.0);
        let pose = homogeneous(&full.pose);
        prop_assert!((pose - t).abs().max() < 1e-14);
        let rotation: Matrix3<f64> = pose.fixed_view::<3, 3>(0, 0).into();
        let rate = cross_matrix(&full.angular_rate);
        let first = rotation * rate;
        let second = rotation * (rate * rate + cross_matrix(&full.angular_acceleration));
        prop_assert!((first - t1.fixed_view::<3, 3>(0, 0)).abs().max() < 3e-14);
        prop_assert!((full.velocity_w - t1.fixed_view::<3, 1>(0, 3)).abs().max() < 3e-14);
        prop_assert!((second - t2.fixed_view::<3, 3>(0, 0)).abs().max() < 1e-13);
        prop_assert!((full.acceleration_w - t2.fixed_view::<3, 1>(0, 3)).abs().max() < 1e-13);
        let two = curve.pose_and_velocity(t_ns).unwrap();
        prop_assert_eq!((two.pose, two.velocity_w, two.angular_rate), (full.pose, full.velocity_w, full.angular_rate));
        prop_assert_eq!(curve.pose(t_ns).unwrap(), full.pose);
    }
}
