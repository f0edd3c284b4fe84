//! The time-symmetric attitude: half way between the product from the first control point and that from the last.
//!
//! F = R₀ exp(B₁d₁) exp(B₂d₂) exp(B₃d₃) is not what one gets from the other end, G = R₃ exp(−(1 − B₃)d₃)
//! exp(−(1 − B₂)d₂) exp(−(1 − B₁)d₁): commutators of neighbouring turns, of the size h³, remain. S = F exp(½ log FᵀG)
//! cancels them. It has the same four control points, is twice continuously differentiable, gives the reversed curve
//! for reversed control points, and reaches order 4 in the step (ω 3, α 2), where the product alone has 3 (2, 1).
//!
//! As quaternions of the same sign S = (q_F + q_G)/|q_F + q_G|; with (w, e) = q_F* q_G, k = ½e/(1 + w), H = FᵀS:
//!
//! a = Hᵀω_F, b = Hω_G, ω = ½(a + b) + k×(a − b); a' = Hᵀα_F + a×ω, b' = Hα_G + b×ω, α = ½(a' + b') + k×(a' − b')
//!
//! (k̇ is parallel to b − a, and falls out). No trigonometry beyond the factors'. Derivation: `docs/splines.md`.

use super::basis::Weights;
use super::control::Sealed;
use super::kinematics::Attitude;
use super::so3::{Form, Turns, attitude, attitude_and_rate, full};
use super::turn::Turn;
use crate::vector::cross;
use crate::{Real, so3};
use nalgebra::{Quaternion, Vector3};

/// The mean of the product from the first control point and the one from the last: of order 4, and the same curve in
/// either direction of time. The same control points give another curve than [`OneSided`](super::OneSided) ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeSymmetric;

impl Sealed for TimeSymmetric {}

/// Turns and weights as they come from the last control point.
#[inline(always)]
fn from_the_end<T: Real>(window: &Turns<T>, u: T, rate: T) -> ([Turn<T>; 3], Weights<T, 3>) {
    let reversed = |[a, b, c]: [T; 3]| [c, b, a];
    let [first, second, third] = window.steps;
    let forwards = Weights::cubic(u, rate);
    let weights = Weights {
        value: reversed(Weights::from_the_end(u)),
        rate: reversed(forwards.rate),
        acceleration: reversed(forwards.acceleration),
    };
    ([third, second, first], weights)
}

/// S, with what leads from F to S (H) and k.
struct Mean<T: Real> {
    attitude_wb: Quaternion<T>,
    to_mean: Quaternion<T>,
    k: Vector3<T>,
}

impl<T: Real> Mean<T> {
    #[inline(always)]
    fn of(f: &Quaternion<T>, g: &Quaternion<T>) -> Self {
        let between = so3::product(&so3::inverse(f), g).coords;
        let sign = if between.w < T::ZERO { -T::ONE } else { T::ONE };
        let above = T::ONE + between.w * sign;
        // |q_F + q_G|² = 2 + 2w; H = q_F* S = (1 + w, e)/|q_F + q_G|.
        let scale = T::ONE / (above + above).sqrt();
        let e = Vector3::new(between.x, between.y, between.z) * sign;
        let h = e * scale;
        Self {
            attitude_wb: Quaternion::from((f.coords + g.coords * sign) * scale),
            to_mean: Quaternion::new(above * scale, h.x, h.y, h.z),
            k: e * (scale * scale),
        }
    }

    /// ½(a + b) + k×(a − b)
    #[inline(always)]
    fn mixed(&self, a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
        (a + b) * T::from_f64(0.5) + cross(&self.k, &(a - b))
    }
}

impl<T: Real> Form<T> for TimeSymmetric {
    #[inline(always)]
    fn attitude(window: &Turns<T>, u: T) -> Quaternion<T> {
        let (turns, weights) = from_the_end(window, u, T::ONE);
        let f = attitude(&window.first, &window.steps, &Weights::cubic(u, T::ONE));
        Mean::of(&f, &attitude(&window.last, &turns, &weights)).attitude_wb
    }

    #[inline(always)]
    fn attitude_and_rate(window: &Turns<T>, u: T, rate: T) -> (Quaternion<T>, Vector3<T>) {
        let (turns, weights) = from_the_end(window, u, rate);
        let (f, rate_f) = attitude_and_rate(&window.first, &window.steps, &Weights::cubic(u, rate));
        let (g, rate_g) = attitude_and_rate(&window.last, &turns, &weights);
        let mean = Mean::of(&f, &g);
        let a = so3::rotate(&so3::inverse(&mean.to_mean), &rate_f);
        let b = so3::rotate(&mean.to_mean, &rate_g);
        (mean.attitude_wb, mean.mixed(&a, &b))
    }

    #[inline(always)]
    fn full(window: &Turns<T>, u: T, rate: T) -> Attitude<T> {
        let (turns, weights) = from_the_end(window, u, rate);
        let f = full(&window.first, &window.steps, &Weights::cubic(u, rate));
        let g = full(&window.last, &turns, &weights);
        let mean = Mean::of(&f.attitude_wb, &g.attitude_wb);
        let back = so3::inverse(&mean.to_mean);
        let a = so3::rotate(&back, &f.angular_rate);
        let b = so3::rotate(&mean.to_mean, &g.angular_rate);
        let angular_rate = mean.mixed(&a, &b);
        let a_dot = so3::rotate(&back, &f.angular_acceleration) + cross(&a, &angular_rate);
        let b_dot = so3::rotate(&mean.to_mean, &g.angular_acceleration) + cross(&b, &angular_rate);
        Attitude {
            attitude_wb: mean.attitude_wb,
            angular_rate,
            angular_acceleration: mean.mixed(&a_dot, &b_dot),
        }
    }
}
