//! A sensor's bandwidth: a one-pole low-pass between the noisy measurand and its samples.
//!
//! What is filtered is everything: motion, bias and white noise, after them in the physical order.
//! The continuous filter of cut-off f_c, its input held over a sampling interval dt, is exactly
//!
//! y_k = y_{k−1} + (1 − φ)(x_k − y_{k−1}),  φ = exp(−2π f_c dt),
//!
//! whose response to a step is 1 − φᵏ, the continuous one at the samples, and whose gain at zero
//! frequency is 1: the density N that long averages show stays what it is, and a random walk keeps
//! its K. White noise of standard deviation σ = N/√dt becomes an AR(1) process of variance
//! σ²(1 − φ)/(1 + φ), the law of a one-pole-filtered white noise at its samples. The memory starts
//! in that law about `start`, drawn from a stream of its own, so that the first sample is as any
//! other and no term's numbers change when the filter is switched.
//!
//! At 42 Hz and 200 samples a second a χ² fit of N and K over *all* octaves of such a signal reads
//! N 24 % too small and K 2.25 times (N/K = 300 s) too large, at 20 Hz thousands of times.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, Sensor, Stage, Term};
//! use imu_core::sensor::OnePole;
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let filter = OnePole { cutoff: 40.0, start: 0.0, noise_density: 0.0 }; // Hz
//! let mut filter = filter.prepare(0.005, x).unwrap();
//! let phi = (-std::f64::consts::TAU * 40.0 * 0.005).exp();
//! assert!((filter.step(1.0) - (1.0 - phi)).abs() < 1e-15);
//! assert!((filter.step(1.0) - (1.0 - phi * phi)).abs() < 1e-15);
//! ```

use crate::noise::{Channel, Normal, Stage, Term, TermId, density, finite, interval, positive};
use crate::{Error, Real};
use core::f64::consts::PI;

/// A one-pole low-pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnePole<T> {
    /// f_c, where the gain is 1/√2, in Hz; above zero.
    pub cutoff: T,
    /// What it has long seen before the first sample (true value and constant bias).
    pub start: T,
    /// N of the white noise that it has seen with it, in the sensor's unit per √Hz; not negative.
    pub noise_density: T,
}

impl<T: Normal> Term<T> for OnePole<T> {
    type Stage = OnePoleStage<T>;

    fn prepare(self, dt: T, channel: Channel) -> Result<OnePoleStage<T>, Error> {
        let white_sd = density("noise_density", self.noise_density)? / interval(dt)?.sqrt();
        let cutoff = positive("cutoff", self.cutoff)?.to_f64();
        let start = finite("start", self.start)?;
        let phi = libm::exp(-2.0 * PI * cutoff * dt.to_f64());
        let sd = white_sd * T::from_f64(libm::sqrt((1.0 - phi) / (1.0 + phi)));
        let mut rng: T::Generator = channel.stream(TermId::BANDWIDTH);
        let level = finite("noise_density", start + sd * T::standard_normal(&mut rng))?;
        Ok(OnePoleStage { gain: T::from_f64(1.0 - phi), level })
    }
}

/// A one-pole low-pass prepared for one sampling interval: 8 bytes in `f32`, 16 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnePoleStage<T> {
    /// 1 − φ.
    gain: T,
    /// y of the sample before.
    level: T,
}

impl<T: Normal> Stage<T> for OnePoleStage<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        self.level += self.gain * (truth - self.level);
        self.level
    }

    /// Zero: what it does to a bias is no bias of its own.
    #[inline(always)]
    fn bias(&self) -> T {
        <T as Real>::ZERO
    }
}
