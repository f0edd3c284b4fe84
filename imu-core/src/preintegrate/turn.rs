//! J_l of the rotation of a step, from its quaternion: without trigonometry, root or division below 0.7 rad.
//!
//! J_l(θ) = 1 + ((1 − cos θ)/θ²)[θ]× + ((θ − sin θ)/θ³)[θ]×². With the half angle h, q = (w, v) = (cos h, n sin h):
//!
//! J_l = 1 + a[v]× + b[v]×², a = sin h/h, b = (1 − w a)/(1 − w²).
//!
//! Both are analytic in y = 1 − w with the nearest singularity at y = 2, and a step of 0.7 rad has y = 0.06: ten terms
//! are right to rounding. Source of J_l: Chirikjian (2011), "Stochastic Models, Information Theory, and Lie Groups",
//! vol. 2, eq. (10.86); Forster et al. (2017), eq. (8), has J_r = J_lᵀ.

use crate::matrix::{Rows, add_scaled, crossed_behind};
use crate::vector::dot;
use crate::{Real, so3};
use nalgebra::{Quaternion, Vector3};

/// cos 0.35: above it the angle is below 0.7 rad.
const SMALL: f64 = 0.939_372_712_847_379;

/// m J_l(log q). Largest error of an element of J_l, measured: in `f32` 5.4e-8 below 0.7 rad and 2.3e-7 above; in `f64`
/// 8e-16, the rounding of what it was compared with included.
///
/// For turns of less than π.
#[inline(always)]
pub(super) fn times_left_jacobian<T: Real>(m: &Rows<T>, q: &Quaternion<T>) -> Rows<T> {
    let c = &q.coords;
    let (a, b) = if c.w > T::from_f64(SMALL) { small(T::ONE - c.w) } else { large(q) };
    let v = Vector3::new(c.x, c.y, c.z);
    let once = crossed_behind(m, &v);
    let twice = crossed_behind(&once, &v);
    add_scaled(&add_scaled(m, a, &once), b, &twice)
}

/// a and b by their series in y = 1 − w.
#[inline(always)]
fn small<T: Real>(y: T) -> (T, T) {
    const A: [f64; 10] = [
        1.0,
        -1.0 / 3.0,
        -1.0 / 45.0,
        -1.0 / 189.0,
        -0.001_622_574_955_908_289_2,
        -0.000_562_236_117_791_673_4,
        -0.000_209_529_056_089_902_65,
        -8.196_597_967_321_071e-5,
        -3.319_615_323_626_805e-5,
        -1.379_939_753_078_049e-5,
    ];
    const B: [f64; 10] = [
        2.0 / 3.0,
        8.0 / 45.0,
        76.0 / 945.0,
        0.038_377_425_044_091_71,
        0.018_658_543_102_987_55,
        0.009_152_918_020_642_888,
        0.004_512_677_471_213_098,
        0.002_231_953_822_838_077_8,
        0.001_106_278_533_566_295,
        0.000_549_166_558_272_583_2,
    ];
    let terms = if T::EPSILON.to_f64() > 1e-10 { 5 } else { A.len() };
    let horner = |series: &[f64; 10]| {
        series.iter().take(terms).rev().fold(T::ZERO, |sum, term| sum * y + T::from_f64(*term))
    };
    (horner(&A), horner(&B))
}

/// a and b of a step that turns far.
#[cold]
fn large<T: Real>(q: &Quaternion<T>) -> (T, T) {
    let half = so3::log(q) * T::from_f64(0.5);
    let angle = dot(&half, &half).sqrt();
    let (sin, cos) = angle.sin_cos();
    let a = sin / angle;
    (a, (T::ONE - cos * a) / (sin * sin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::{matrix, rotation};
    use nalgebra::Matrix3;
    use proptest::prelude::*;

    /// J_l(θ) = ∫₀¹ exp(sθ) ds, by Gauss and Legendre's rule of five points on 8 pieces: off by less than
    /// 4e-13 (π/8)¹⁰ = 4e-17.
    fn integral(turn: Vector3<f64>) -> Matrix3<f64> {
        let root = 2.0 * (10.0_f64 / 7.0).sqrt();
        let (inner, outer) = ((5.0 - root).sqrt() / 3.0, (5.0 + root).sqrt() / 3.0);
        let shift = 13.0 * 70.0_f64.sqrt();
        let (more, less) = ((322.0 + shift) / 900.0, (322.0 - shift) / 900.0);
        let points =
            [(0.0, 128.0 / 225.0), (inner, more), (-inner, more), (outer, less), (-outer, less)];
        let mut sum = Matrix3::zeros();
        for piece in 0..8 {
            for (at, weight) in points {
                let s = (f64::from(piece) + 0.5 + 0.5 * at) / 8.0;
                sum += matrix(&rotation(&so3::exp(turn * s))) * (weight / 16.0);
            }
        }
        sum
    }

    fn left_jacobian<T: Real>(turn: Vector3<T>) -> Matrix3<f64> {
        let one = rotation(&so3::exp(turn * T::ZERO));
        let jacobian = matrix(&times_left_jacobian(&one, &so3::exp(turn)));
        Matrix3::from(<[[T; 3]; 3]>::from(jacobian).map(|column| column.map(T::to_f64)))
    }

    proptest! {
        /// A few units of 1.1e-16 and 6e-8, and the 40 additions of the integral.
        #[test]
        fn it_is_the_integral_of_the_rotation(turn in [-1.0..1.0, -1.0..1.0, -1.0..1.0], size in 0.0..3.0) {
            let turn = Vector3::from(turn) * (size / 1.8);
            let exact = integral(turn);
            prop_assert!((left_jacobian(turn) - exact).abs().max() < 2e-15);
            let single = turn.map(|x| x as f32);
            prop_assert!((left_jacobian(single) - exact).abs().max() < 1e-6);
        }
    }

    #[test]
    fn nothing_breaks_at_the_threshold_or_at_no_turn() {
        for angle in [0.0, 1e-300, 1e-8, 0.7 - 1e-12, 0.7 + 1e-12, 3.1] {
            let turn = Vector3::new(0.6, 0.0, -0.8) * angle;
            assert!((left_jacobian(turn) - integral(turn)).abs().max() < 2e-15);
        }
    }
}
