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
use super::so3::{Form, Turning, Turns, attitude, attitude_and_rate, full};
use super::turn::Turn;
use crate::Real;
use crate::lanes::{self, Four};
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

/// S, with what leads from F to S (H) and k, in lanes.
struct Mean<F> {
    attitude: F,
    to_mean: F,
    k: F,
}

impl<F> Mean<F> {
    #[inline(always)]
    fn of<T: Real<Four = F>>(f: F, g: F) -> Self
    where
        F: Four<T>,
    {
        let between = lanes::product(lanes::inverse(f), g);
        let [.., w] = between.lanes();
        let sign = if w < T::ZERO { -T::ONE } else { T::ONE };
        let above = T::ONE + w * sign;
        // |q_F + q_G|² = 2 + 2w; H = q_F* S = (1 + w, e)/|q_F + q_G|.
        let scale = T::ONE / (above + above).sqrt();
        let e = between * F::all(sign);
        Self {
            attitude: (f + g * F::all(sign)) * F::all(scale),
            to_mean: (e * F::all(scale)).with_w(F::all(above * scale)),
            k: e * F::all(scale * scale),
        }
    }

    /// ½(a + b) + k×(a − b)
    #[inline(always)]
    fn mixed<T: Real>(&self, a: F, b: F) -> F
    where
        F: Four<T>,
    {
        (a + b) * F::all(T::from_f64(0.5)) + lanes::cross(self.k, a - b)
    }
}

impl<T: Real> Form<T> for TimeSymmetric {
    #[inline(always)]
    fn attitude(window: &Turns<T>, u: T) -> Quaternion<T> {
        let (turns, weights) = from_the_end(window, u, T::ONE);
        let f = attitude(&window.first, &window.steps, &Weights::cubic(u, T::ONE));
        let mean = Mean::of::<T>(f, attitude(&window.last, &turns, &weights));
        lanes::to_quaternion::<T>(mean.attitude)
    }

    #[inline(always)]
    fn attitude_and_rate(window: &Turns<T>, u: T, rate: T) -> (Quaternion<T>, Vector3<T>) {
        let (turns, weights) = from_the_end(window, u, rate);
        let (f, rate_f) = attitude_and_rate(&window.first, &window.steps, &Weights::cubic(u, rate));
        let (g, rate_g) = attitude_and_rate(&window.last, &turns, &weights);
        let mean = Mean::of::<T>(f, g);
        let a = lanes::rotate_back(mean.to_mean, rate_f);
        let b = lanes::rotate(mean.to_mean, rate_g);
        (lanes::to_quaternion::<T>(mean.attitude), lanes::to_vector(mean.mixed::<T>(a, b)))
    }

    #[inline(always)]
    fn full(window: &Turns<T>, u: T, rate: T) -> Attitude<T> {
        let (turns, weights) = from_the_end(window, u, rate);
        let f = full(&window.first, &window.steps, &Weights::cubic(u, rate));
        let g = full(&window.last, &turns, &weights);
        let mean = Mean::of::<T>(f.attitude, g.attitude);
        let a = lanes::rotate_back(mean.to_mean, f.rate);
        let b = lanes::rotate(mean.to_mean, g.rate);
        let rate = mean.mixed::<T>(a, b);
        let a_dot = lanes::rotate_back(mean.to_mean, f.acceleration) + lanes::cross(a, rate);
        let b_dot = lanes::rotate(mean.to_mean, g.acceleration) + lanes::cross(b, rate);
        let acceleration = mean.mixed::<T>(a_dot, b_dot);
        Attitude::of_lanes(Turning { attitude: mean.attitude, rate, acceleration })
    }
}
