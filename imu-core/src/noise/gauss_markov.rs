//! First-order Gauss-Markov bias: a bias that wanders, and forgets after a correlation time.
//!
//! For a bias that stays bounded however long the run: temperature control, slow mechanical
//! relaxation, the in-run bias of a MEMS sensor as filters model it. ḃ = −b/T + w, with w white, has
//! the stationary standard deviation σ and the autocorrelation σ² exp(−|t|/T). At samples `dt` apart
//! it is, exactly and for any `dt`,
//!
//! b_{k+1} = b_k − (1 − e^(−dt/T)) b_k + σ√(1 − e^(−2dt/T))·n
//!
//! (Gelb (1974), Applied Optimal Estimation, section 3.8; Brown & Hwang (2012), section 4.2). Both
//! brackets are formed by `expm1`, and the decay is applied as an increment, so T may be 10⁹
//! intervals in `f32`. The Allan variance at τ = x·T is (2σ²/x)[1 − (3 − 4e⁻ˣ + e⁻²ˣ)/(2x)] (IEEE
//! Std 952, annex C): a hump of 0.617σ at τ = 1.893 T, slope +½ before it and −½ behind.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, GaussMarkov, Sensor, Stage, Start, Term};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let bias = GaussMarkov {
//!     standard_deviation: 1e-4, // rad/s
//!     correlation_time: 300.0,  // s
//!     start: Start::Stationary,
//! };
//! let mut bias = bias.prepare(0.005, x).unwrap();
//! let carried: f64 = bias.bias();
//! assert!(carried.abs() < 5e-4);
//! assert_eq!(bias.step(0.5), 0.5 + carried);
//! ```

use super::{Channel, Normal, Stage, Term, TermId, density, interval, positive};
use crate::Error;

/// Where a correlated process begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Start {
    /// In its stationary law: one number is drawn, and the first sample is as any other.
    #[default]
    Stationary,
    /// At zero: as after a calibration. The standard deviation is reached after some
    /// correlation times.
    Zero,
}

/// First-order Gauss-Markov bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussMarkov<T> {
    /// σ of the stationary process, in the sensor's unit; not negative.
    pub standard_deviation: T,
    /// T, after which the autocorrelation has fallen to 1/e, in seconds; above zero.
    pub correlation_time: T,
    /// How it begins.
    pub start: Start,
}

impl<T: Normal> Term<T> for GaussMarkov<T> {
    type Stage = GaussMarkovStage<T>;

    fn prepare(self, dt: T, channel: Channel) -> Result<GaussMarkovStage<T>, Error> {
        let sigma = density("standard_deviation", self.standard_deviation)?;
        let x = interval(dt)? / positive("correlation_time", self.correlation_time)?;
        let mut rng = channel.stream(TermId::GAUSS_MARKOV);
        let bias = match self.start {
            Start::Stationary => sigma * T::standard_normal(&mut rng),
            Start::Zero => T::ZERO,
        };
        let bias = super::finite("standard_deviation", bias)?;
        Ok(GaussMarkovStage {
            bias,
            decay: -(-x).exp_m1(),
            sd: sigma * (-(-(x + x)).exp_m1()).sqrt(),
            rng,
        })
    }
}

/// A Gauss-Markov bias prepared for one sampling interval: 28 bytes in `f32`, 56 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussMarkovStage<T: Normal> {
    bias: T,
    /// 1 − exp(−dt/T).
    decay: T,
    /// σ√(1 − exp(−2dt/T)).
    sd: T,
    rng: T::Generator,
}

impl<T: Normal> Stage<T> for GaussMarkovStage<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        let measured = truth + self.bias;
        self.bias += self.sd * T::standard_normal(&mut self.rng) - self.decay * self.bias;
        measured
    }

    #[inline(always)]
    fn bias(&self) -> T {
        self.bias
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
