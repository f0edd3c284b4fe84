//! Flicker noise: the bias instability B of a data sheet, flat in the Allan deviation.
//!
//! Electronics and MEMS structures show noise of density ∝ 1/f, whose Allan deviation is
//! B√(2 ln 2/π) = 0.664 B whatever τ (IEEE Std 952, annex C). No finite state makes it at every τ; a
//! sum of N Gauss-Markov processes ([`GaussMarkov`](super::GaussMarkov)) does over a range
//! τ₁ … τ₂ (Keshner (1982), "1/f noise", Proceedings of the IEEE 70(3)):
//!
//! T_i = (τ₁/4) rⁱ, i = 0 … N − 1, r = (16 τ₂/τ₁)^(1/(N−1)), σ_i² = B² (ln r/π)·g_i·e_i.
//!
//! g_i = (2T/dt) tanh(dt/2T) gives a sampled process the density of the continuous one at low
//! frequencies. e_i is 1, but r/(r − 1) for the first and the last, which stand for the geometric
//! series of processes left out on their side. So the deviation is within −4 … +2 % of 0.664 B over
//! all of τ₁ … τ₂ (worked out for 0 to 6 decades, N = 3 … 12), for τ₁ ≥ 4 dt and r ≤ 13: N is the number
//! of decades from τ₁ to τ₂, and 2.
//! (A ratio of 2, an octave, takes 3.3 times the processes, and is no flatter at the ends.)
//! Below τ₁ the deviation falls as √τ, above τ₂ as 1/√τ.
//!
//! It starts in its stationary law, and each of the N processes takes a normal number a sample.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, Flicker, Sensor, Stage, Term};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! // 10 °/h from 1 s to 1000 s: three decades, five processes.
//! let flicker = Flicker::<f64, 5> { bias_instability: 4.8e-5, shortest_tau: 1.0, longest_tau: 1e3 };
//! let mut flicker = flicker.prepare(0.005, x).unwrap();
//! let carried = flicker.bias();
//! assert_eq!(flicker.step(0.5), 0.5 + carried);
//! ```

use super::{Channel, Normal, Stage, Term, TermId, density, interval, positive};
use crate::Error;
use core::f64::consts::PI;

/// Correlation times reach this factor beyond τ₁ and τ₂.
const MARGIN: f64 = 4.0;
/// Neighbouring correlation times are at most this factor apart.
const WIDEST_RATIO: f64 = 13.0;

/// Flicker of a bias instability, over a range of averaging times, by `N` processes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flicker<T, const N: usize> {
    /// B, in the sensor's unit; not negative. The flat of the Allan deviation is 0.664 B.
    pub bias_instability: T,
    /// τ₁, the shortest averaging time of the flat, in seconds; at least 4 sampling intervals.
    pub shortest_tau: T,
    /// τ₂, the longest, in seconds; at least `shortest_tau`, at most so much that `N` processes
    /// reach: 10^(N−2)·`shortest_tau`, and a little more; so `N` is at least 3.
    pub longest_tau: T,
}

impl<T: Normal, const N: usize> Term<T> for Flicker<T, N> {
    type Stage = FlickerStage<T, N>;

    fn prepare(self, dt: T, channel: Channel) -> Result<FlickerStage<T, N>, Error> {
        let instability = density("bias_instability", self.bias_instability)?;
        let dt = interval(dt)?.to_f64();
        let shortest = positive("shortest_tau", self.shortest_tau)?.to_f64();
        let longest = positive("longest_tau", self.longest_tau)?.to_f64();
        // Half a rounding of f32 must not refuse 4 dt.
        if shortest < 3.999_999 * dt {
            return Err(Error::OutOfRange("shortest_tau"));
        }
        let log_span = libm::log(MARGIN * MARGIN * longest / shortest);
        let log_ratio = log_span / (N.max(2) - 1) as f64;
        if N < 2 || longest < shortest || log_ratio > libm::log(WIDEST_RATIO) {
            return Err(Error::OutOfRange("longest_tau"));
        }
        let mut stage = FlickerStage {
            biases: [T::ZERO; N],
            decays: [T::ZERO; N],
            sds: [T::ZERO; N],
            rng: channel.stream(TermId::FLICKER),
        };
        let ratio = libm::exp(log_ratio);
        let mut time = shortest / MARGIN;
        let members =
            stage.biases.iter_mut().zip(stage.decays.iter_mut().zip(stage.sds.iter_mut()));
        for (i, (bias, (decay, sd))) in members.enumerate() {
            let x = dt / time;
            let end = if i == 0 || i == N - 1 { ratio / (ratio - 1.0) } else { 1.0 };
            let variance = log_ratio / PI * end * libm::tanh(0.5 * x) / (0.5 * x);
            let sigma = instability * T::from_f64(libm::sqrt(variance));
            *bias = sigma * T::standard_normal(&mut stage.rng);
            *decay = T::from_f64(-libm::expm1(-x));
            *sd = sigma * T::from_f64(libm::sqrt(-libm::expm1(-2.0 * x)));
            super::finite("bias_instability", *bias)?;
            time *= ratio;
        }
        Ok(stage)
    }
}

/// Flicker prepared for one sampling interval: 16 + 12 N bytes in `f32`, 32 + 24 N in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlickerStage<T: Normal, const N: usize> {
    biases: [T; N],
    /// 1 − exp(−dt/T_i).
    decays: [T; N],
    /// σ_i √(1 − exp(−2dt/T_i)).
    sds: [T; N],
    rng: T::Generator,
}

impl<T: Normal, const N: usize> Stage<T> for FlickerStage<T, N> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        let mut sum = T::ZERO;
        for (bias, (&decay, &sd)) in self.biases.iter_mut().zip(self.decays.iter().zip(&self.sds)) {
            sum += *bias;
            *bias += sd * T::standard_normal(&mut self.rng) - decay * *bias;
        }
        truth + sum
    }

    #[inline(always)]
    fn bias(&self) -> T {
        let mut sum = T::ZERO;
        for &bias in &self.biases {
            sum += bias;
        }
        sum
    }

    #[inline]
    fn apply(&mut self, samples: &mut [T]) {
        // A copy of the generator stays in registers over the loop.
        let mut stage = *self;
        for sample in samples {
            *sample = stage.step(*sample);
        }
        *self = stage;
    }
}
