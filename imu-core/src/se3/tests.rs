use super::*;
use crate::vector::norm;
use nalgebra::{Matrix6, Vector6};
use proptest::prelude::*;
use std::f64::consts::PI;

fn any_twist(most: f64) -> impl Strategy<Value = Twist<f64>> {
    let part = || [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64].prop_map(Vector3::from);
    (part(), part(), 0.0..most).prop_filter_map("no axis", |(linear, axis, angle)| {
        let length = norm(&axis);
        (length > 1e-3).then(|| Twist { linear: linear * 5.0, angular: axis * (angle / length) })
    })
}

fn vector(twist: &Twist<f64>) -> Vector6<f64> {
    let Twist { linear, angular } = twist;
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

fn single(twist: &Twist<f64>) -> Twist<f32> {
    Twist { linear: twist.linear.map(|x| x as f32), angular: twist.angular.map(|x| x as f32) }
}

fn off_from_one(a: &Blocks<f64>, b: &Blocks<f64>) -> f64 {
    (a.matrix() * b.matrix() - Matrix6::identity()).abs().max()
}

proptest! {
    /// J_l⁻¹ is up to π/2, Q up to |ρ|/2 = 4.3: some roundings of their product.
    #[test]
    fn inverses_invert(twist in any_twist(PI)) {
        let off = off_from_one(&left_jacobian(&twist), &inverse_left_jacobian(&twist));
        prop_assert!(off < 3e-14, "{off:e}");
        let off = off_from_one(&right_jacobian(&twist), &inverse_right_jacobian(&twist));
        prop_assert!(off < 3e-14, "{off:e}");
        let to_double = |b: Blocks<f32>| Blocks {
            diagonal: b.diagonal.map(f64::from),
            corner: b.corner.map(f64::from),
        };
        let twist = single(&twist);
        let (j, i) = (left_jacobian(&twist), inverse_left_jacobian(&twist));
        let off = off_from_one(&to_double(j), &to_double(i));
        prop_assert!(off < 1e-5, "{off:e}");
    }

    /// exp(ξ + hδ) = exp(h J_l δ) exp(ξ) = exp(ξ) exp(h J_r δ): central differences of h = 1e-5 are off by h² times
    /// third derivatives below 10, and by rounding of 5 m over h, 1e-10.
    #[test]
    fn jacobians_are_derivatives(twist in any_twist(3.0), d in any_twist(1.0)) {
        const H: f64 = 1e-5;
        let at = |h: f64| exp(&(twist + d * h));
        let middle = at(0.0).inverse();
        let (after, before) = (at(H), at(-H));
        let slope = |a: &Twist<f64>, b: &Twist<f64>| (vector(a) - vector(b)) / (2.0 * H);
        let left = slope(&log(&after.then(&middle)), &log(&before.then(&middle)));
        prop_assert!((left - vector(&left_jacobian(&twist).times(&d))).abs().max() < 3e-8);
        let right = slope(&log(&middle.then(&after)), &log(&middle.then(&before)));
        prop_assert!((right - vector(&right_jacobian(&twist).times(&d))).abs().max() < 3e-8);
    }

    /// Roundings of 9 m and of π, times J_l⁻¹ of at most π/2.
    #[test]
    fn log_undoes_exp(twist in any_twist(PI - 1e-6)) {
        let back = log(&exp(&twist));
        prop_assert!((vector(&back) - vector(&twist)).abs().max() < 5e-14);
        let twist = single(&twist);
        let back = log(&exp(&twist));
        prop_assert!(norm(&(back.linear - twist.linear)) < 2e-5);
    }

    /// T exp(ξ) T⁻¹ = exp(Ad(T)ξ), and its derivative is the bracket.
    #[test]
    fn adjoints_carry_twists(a in any_twist(3.0), b in any_twist(3.0)) {
        let pose = exp(&a);
        let there = pose.then(&exp(&b)).then(&pose.inverse());
        let carried = adjoint(&pose).times(&b);
        let same = exp(&carried);
        // Of lengths up to 40 m.
        prop_assert!(norm(&(there.translation() - same.translation())) < 1e-12);
        prop_assert!((vector(&pose.twist_inside(&carried)) - vector(&b)).abs().max() < 1e-13);
        let bracket = small_adjoint(&a).times(&b);
        prop_assert!((vector(&bracket) - vector(&a.bracket(&b))).abs().max() < 1e-14);
    }
}

#[test]
fn what_is_no_pose_is_refused() {
    use crate::Error;
    use nalgebra::Quaternion;
    let zero = Vector3::new(0.0, 0.0, 0.0);
    for w in [0.9989, 1.0011, 0.0, f64::NAN, f64::INFINITY, 1e200] {
        let refused = Pose::new(Quaternion::new(w, 0.0, 0.0, 0.0), zero);
        assert_eq!(refused, Err(Error::OutOfRange("rotation")), "{w}");
    }
    for x in [1.1e9, f64::NAN, f64::NEG_INFINITY] {
        let refused = Pose::new(Quaternion::new(1.0, 0.0, 0.0, 0.0), Vector3::new(0.0, x, 0.0));
        assert_eq!(refused, Err(Error::OutOfRange("translation")), "{x}");
    }
    let nearly = Pose::new(Quaternion::new(0.9995, 0.0, 0.0, 0.0), zero).unwrap();
    assert_eq!(nearly.rotation().w, 1.0);
}
