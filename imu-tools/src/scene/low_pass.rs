//! A sensor's bandwidth: a one-pole low-pass between the noisy measurand and its samples.
//!
//! What is filtered is everything: motion, bias and white noise, after them in the physical order.
//! The continuous filter of cut-off f_c, its input held over a sampling interval dt, is exactly
//!
//! y_k = y_{k−1} + (1 − φ)(x_k − y_{k−1}),  φ = exp(−2π f_c dt),
//!
//! whose gain at zero frequency is 1: the density N that long averages show stays what the scene
//! says, and a random walk keeps its K. White noise of standard deviation σ = N/√dt becomes an
//! AR(1) process of variance σ²(1 − φ)/(1 + φ), the law of a one-pole-filtered white noise at its
//! samples. The memory starts in that law, drawn from a stream of its own, so that the first sample
//! is as any other and no term's numbers change when the filter is switched.
//!
//! At 42 Hz and 200 samples a second a χ² fit of N and K over *all* octaves of such a signal reads
//! N 24 % too small and K 2.25 times (N/K = 300 s) too large, at 20 Hz thousands of times.

use std::f64::consts::PI;

use imu_core::noise::{Channel, Normal, Stage, TermId};

/// The filter at work on one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LowPass {
    /// 1 − φ.
    gain: f64,
    /// y of the sample before.
    level: f64,
}

impl LowPass {
    /// The filter of cut-off `hz` for samples `dt` seconds apart, in the state of one that has long
    /// seen `level` with white noise of standard deviation `white_sd`.
    pub(super) fn settled(hz: f64, dt: f64, level: f64, white_sd: f64, channel: Channel) -> Self {
        // The libm crate's exponential: the same bytes on every machine.
        let phi = libm::exp(-2.0 * PI * hz * dt);
        let sd = white_sd * ((1.0 - phi) / (1.0 + phi)).sqrt();
        let mut rng: <f64 as Normal>::Generator = channel.stream(TermId::BANDWIDTH);
        Self { gain: 1.0 - phi, level: level + sd * f64::standard_normal(&mut rng) }
    }
}

impl Stage<f64> for LowPass {
    #[inline]
    fn step(&mut self, truth: f64) -> f64 {
        self.level += self.gain * (truth - self.level);
        self.level
    }

    /// Zero: what it does to a bias is no bias of its own.
    fn bias(&self) -> f64 {
        0.0
    }
}
