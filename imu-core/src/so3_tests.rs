use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;

fn norm<T: Real>(v: Vector3<T>) -> T {
    dot(&v, &v).sqrt()
}

fn largest(parts: &[f64]) -> f64 {
    parts.iter().fold(0.0, |most, x| x.abs().max(most))
}

/// The largest difference of components.
fn apart(a: &Quaternion<f64>, b: &Quaternion<f64>) -> f64 {
    largest((a.coords - b.coords).as_slice())
}

/// The same rotation by the general form, in double precision.
fn exact(rotation: Vector3<f64>) -> Quaternion<f64> {
    let half = norm(rotation) / 2.0;
    let sinc = if half == 0.0 { 1.0 } else { half.sin() / half };
    let v = rotation * (0.5 * sinc);
    Quaternion::new(half.cos(), v.x, v.y, v.z)
}

/// Rotation vectors of angles up to `most`, evenly in angle.
fn rotations(most: f64) -> impl Iterator<Item = Vector3<f64>> {
    (0..20_000).map(move |k| {
        let (turn, tilt) =
            (2.399_963 * f64::from(k), (f64::from(k) * 0.618_034).fract() * 2.0 - 1.0);
        let across = (1.0 - tilt * tilt).sqrt();
        Vector3::new(across * turn.cos(), across * turn.sin(), tilt) * (most * f64::from(k) / 2e4)
    })
}

fn single(v: Vector3<f64>) -> Vector3<f32> {
    Vector3::new(v.x as f32, v.y as f32, v.z as f32)
}

fn double(v: Vector3<f32>) -> Vector3<f64> {
    Vector3::new(v.x.into(), v.y.into(), v.z.into())
}

fn double_quaternion(q: Quaternion<f32>) -> Quaternion<f64> {
    let [i, j, k, w] = <[f32; 4]>::from(q.coords).map(f64::from);
    Quaternion::new(w, i, j, k)
}

/// The errors that the documentation of `exp` states, of the angle that each scalar was given.
#[test]
fn exp_is_right_to_rounding() {
    // Rounding of the polynomial's last steps: two thirds of 6e-8, and one of 1.1e-16 beside the peer's own; of a
    // larger angle, its own rounding: up to 1.2e-7 (2.2e-16) of π.
    for (most, single_error, double_error) in [(0.6999, 4.3e-8, 2.3e-16), (6.2, 3e-7, 6e-16)] {
        let (mut in_single, mut in_double) = (0.0_f64, 0.0_f64);
        for rotation in rotations(most) {
            let rounded = single(rotation);
            let q = double_quaternion(exp(rounded));
            in_single = in_single.max(apart(&q, &exact(double(rounded))));
            in_double = in_double.max(apart(&exp(rotation), &exact(rotation)));
        }
        assert!(in_single < single_error, "{most}: {in_single:e}");
        assert!(in_double < double_error, "{most}: {in_double:e}");
    }
}

/// Nothing jumps where the polynomial ends.
#[test]
fn both_forms_agree_where_they_meet() {
    let x = SMALL;
    let ((cos, sinc), (cos_large, sinc_large)) = (small::<f64, f64>(x, Real::from_f64), large(x));
    assert!((cos - cos_large).abs() < 3e-16 && (sinc - sinc_large).abs() < 3e-16);
    let ((cos, sinc), (cos_large, sinc_large)) =
        (small::<f32, f32>(x as f32, Real::from_f64), large(x as f32));
    assert!((cos - cos_large).abs() < 1.2e-7 && (sinc - sinc_large).abs() < 1.2e-7);
}

#[test]
fn tiny_rotations_keep_their_digits() {
    for size in [5e-324, 1e-300, 1e-160, 1e-30, 1e-9] {
        let rotation = Vector3::new(size, -size, 2.0 * size);
        assert_eq!(exp(rotation).coords.w, 1.0);
        let back = log(&exp(rotation));
        // Halving a denormal loses its last bit.
        assert!(largest((back - rotation).as_slice()) <= 4e-16 * size + 5e-324, "{size}: {back:?}");
    }
}

#[test]
fn a_half_turn_has_a_logarithm() {
    for [x, y, z] in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]] {
        let half_turn = log(&Quaternion::new(0.0, x, y, z));
        assert!(largest((half_turn - Vector3::new(x, y, z) * PI).as_slice()) < 1e-15);
    }
}

/// What is no rotation gives no panic, and what the documentation says.
#[test]
fn what_is_no_rotation() {
    assert_eq!(log(&Quaternion::new(0.0, 0.0, 0.0, 0.0)), Vector3::new(0.0, 0.0, 0.0));
    for bad in [f64::NAN, f64::INFINITY, -1e200] {
        assert!(exp(Vector3::new(bad, 0.0, 0.0)).coords.iter().any(|x| x.is_nan()), "{bad}");
        assert!(exp(Vector3::new(0.0, bad as f32, 0.0)).coords.iter().any(|x| x.is_nan()), "{bad}");
    }
    assert!(log(&Quaternion::new(f64::NAN, 0.0, 0.0, 1.0)).iter().any(|x| x.is_nan()));
    assert!(exp(Vector3::new(1e17_f32, 0.0, 0.0)).coords.iter().all(|x| x.is_finite()));
    assert!(exp(Vector3::new(0.0, 1e149_f64, 0.0)).coords.iter().all(|x| x.is_finite()));
}

fn any_rotation(most: f64) -> impl Strategy<Value = Vector3<f64>> {
    let part = -1.0..1.0_f64;
    (part.clone(), part.clone(), part, 0.0..most).prop_filter_map("no axis", |(x, y, z, angle)| {
        let axis = Vector3::new(x, y, z);
        (norm(axis) > 1e-3).then(|| axis * (angle / norm(axis)))
    })
}

fn any_vector() -> impl Strategy<Value = Vector3<f64>> {
    let part = -10.0..10.0_f64;
    (part.clone(), part.clone(), part).prop_map(|(x, y, z)| Vector3::new(x, y, z))
}

proptest! {
    // A few roundings of numbers up to π, and of the vectors' 17: 1e-14 is dozens of them.
    #[test]
    fn log_undoes_exp(rotation in any_rotation(PI - 1e-6)) {
        prop_assert!(largest((log(&exp(rotation)) - rotation).as_slice()) < 1e-14);
        let single = single(rotation);
        prop_assert!(norm(log(&exp(single)) - single) < 2e-6);
    }

    #[test]
    fn the_same_turn_beyond_a_full_one(rotation in any_rotation(PI - 1e-6)) {
        prop_assume!(norm(rotation) > 1e-6);
        let turned = rotation * (1.0 + 2.0 * PI / norm(rotation));
        prop_assert!(largest((log(&exp(turned)) - rotation).as_slice()) < 1e-13);
    }

    #[test]
    fn products_compose_rotations(
        a in any_rotation(6.0), b in any_rotation(6.0), v in any_vector()
    ) {
        let (a, b) = (exp(a), exp(b));
        let at_once = rotate(&product(&a, &b), &v);
        prop_assert!(norm(at_once - rotate(&a, &rotate(&b, &v))) < 1e-13);
        prop_assert!(norm(rotate(&inverse(&a), &rotate(&a, &v)) - v) < 1e-13);
        let one = product(&a, &inverse(&a));
        prop_assert!(apart(&one, &Quaternion::new(1.0, 0.0, 0.0, 0.0)) < 1e-15);
    }

    /// Rodrigues' formula: what q does to a vector, of the vector that it is the exponential of.
    #[test]
    fn vectors_turn_by_the_angle_about_the_axis(rotation in any_rotation(6.0), v in any_vector()) {
        let angle = norm(rotation);
        prop_assume!(angle > 1e-3);
        let axis = rotation * (1.0 / angle);
        let turned = v * angle.cos()
            + cross(&axis, &v) * angle.sin()
            + axis * (dot(&axis, &v) * (1.0 - angle.cos()));
        prop_assert!(norm(rotate(&exp(rotation), &v) - turned) < 1e-13);
    }

    #[test]
    fn renormalising_squares_the_error(rotation in any_rotation(6.0), off in -0.01..0.01_f64) {
        let long = Quaternion::from(exp(rotation).coords * (1.0 + off));
        let q = renormalised(&long);
        let length = largest(product(&q, &inverse(&q)).coords.as_slice()).sqrt();
        // 1.5ε² + ½ε³, and rounding.
        prop_assert!((length - 1.0).abs() <= 1.51 * off * off + 4e-16);
    }
}

/// q − 1 and R(b) − b beside the same in twice as many digits: in single precision beside double.
#[test]
fn small_differences_keep_their_digits() {
    for rotation in rotations(6.2) {
        let rotation = single(rotation);
        let q = exp(rotation);
        let in_double = exact(double(rotation));
        // To 2 units of its own size below 0.7 rad, and to the rounding of the angle above.
        let small = norm(double(rotation)) < 0.7;
        let less = double_quaternion(less_one(&q)).coords;
        let mut wanted = in_double.coords;
        // cos a − 1 = −2 sin² a/2, of a = θ/2
        wanted.w = -2.0 * (norm(double(rotation)) / 4.0).sin().powi(2);
        let size = norm(double(rotation)).min(1.0);
        let limit = if small { 2.4e-7 * size } else { 4e-7 };
        assert!((less - wanted).abs().max() <= limit, "{rotation:?}");

        let b = Vector3::new(0.3_f32, -0.4, 0.5);
        let there = double(displacement(&q, &b));
        let exactly = rotate(&in_double, &double(b)) - double(b);
        assert!((there - exactly).abs().max() <= if small { 3.6e-7 * size } else { 1e-6 });
    }
}

/// log(exp(d)) = d to 4 units in the last place of |d|, from 1e-300 to π − 1e-9.
#[test]
fn the_way_there_and_back_keeps_the_last_digits() {
    let ulp = |x: f64| f64::from_bits(x.to_bits() + 1) - x;
    for (k, axis) in rotations(1.0).skip(1).enumerate() {
        let exponent = -300.0 * (k as f64 * 0.618_034).fract();
        let near = PI - 10_f64.powf(-9.0 * (k as f64 * 0.414_214).fract());
        let even = (PI - 1e-9) * (k as f64 * 0.732_051).fract();
        for angle in [3.0 * 10_f64.powf(exponent), near, even, PI - 1e-9] {
            let d = axis * (angle / norm(axis));
            let off = norm(log(&exp(d)) - d);
            assert!(off <= 4.0 * ulp(angle), "{angle:e}: {} ulp", off / ulp(angle));
        }
    }
}
