//! A sensor's bandwidth: a two-pole Butterworth low-pass between the noisy measurand and its samples.
//!
//! ÿ + √2 ω₀ẏ + ω₀²(y − x) = 0, ω₀ = 2π f_c: flat to its cut-off, where the gain is 1/√2, and falling
//! by 40 dB a decade (Butterworth (1930)); what many MEMS chips and force-rebalance loops do. With the
//! input held over a sampling interval, the distance y − x and ẏ/ω₀ move by the exact transition
//! matrix of the damped oscillator, so the response to a step is the continuous one at the samples,
//! 1 − e^(−s)(cos s + sin s), s = ω₀t/√2, and the gain at zero frequency is 1. It starts at rest at
//! `start`.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, Sensor, Stage, Term};
//! use imu_core::sensor::TwoPole;
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let mut filter = TwoPole { cutoff: 40.0, start: 0.0 }.prepare(0.005, x).unwrap();
//! for k in 1..50 {
//!     let s = std::f64::consts::TAU * 40.0 * 0.005 * f64::from(k) / 2_f64.sqrt();
//!     assert!((filter.step(1.0) - (1.0 - (-s).exp() * (s.cos() + s.sin()))).abs() < 1e-14);
//! }
//! ```

use crate::noise::{Channel, Normal, Stage, Term, finite, interval, positive};
use crate::resonator::Transition;
use crate::{Error, Real};
use core::f64::consts::{FRAC_1_SQRT_2, TAU};

/// A two-pole Butterworth low-pass. It draws no random number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoPole<T> {
    /// f_c, where the gain is 1/√2, in Hz; above zero.
    pub cutoff: T,
    /// What it has long seen before the first sample.
    pub start: T,
}

impl<T: Normal> Term<T> for TwoPole<T> {
    type Stage = TwoPoleStage<T>;

    fn prepare(self, dt: T, _: Channel) -> Result<TwoPoleStage<T>, Error> {
        let cutoff = positive("cutoff", self.cutoff)?.to_f64();
        let angle = finite("cutoff * dt", TAU * cutoff * interval(dt)?.to_f64())?;
        let Transition { xx, xu, ux, uu } = Transition::new(angle, FRAC_1_SQRT_2);
        let level = finite("start", self.start)?;
        let transition = [xx, xu, ux, uu].map(T::from_f64);
        Ok(TwoPoleStage { level, slope: T::ZERO, transition })
    }
}

/// A two-pole low-pass prepared for one sampling interval: 24 bytes in `f32`, 48 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoPoleStage<T> {
    /// y.
    level: T,
    /// ẏ/ω₀.
    slope: T,
    /// Φ − 1, row by row.
    transition: [T; 4],
}

impl<T: Normal> Stage<T> for TwoPoleStage<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        let [xx, xu, ux, uu] = self.transition;
        let (distance, slope) = (self.level - truth, self.slope);
        self.level += xx * distance + xu * slope;
        self.slope += ux * distance + uu * slope;
        self.level
    }

    /// Zero: what it does to a bias is no bias of its own.
    #[inline(always)]
    fn bias(&self) -> T {
        <T as Real>::ZERO
    }
}
