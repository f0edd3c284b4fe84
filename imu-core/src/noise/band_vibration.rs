//! Vibration in a band: random vibration of a structure about its resonance.
//!
//! A frame, an engine mount or a propeller shakes the sensor with noise about one frequency: white
//! noise through a resonator, ẍ + 2ζω₀ẋ + ω₀²x = w. The vibration is the velocity u = ẋ/ω₀ of it,
//! which has no power at frequency zero (a structure that shakes does not leave): a band about
//! f₀ = ω₀/2π whose half-power width is exactly 2ζf₀. Its autocorrelation is
//! σ² e^(−ζω₀t) (cos ω_d t − (ζω₀/ω_d) sin ω_d t), ω_d = ω₀√(1 − ζ²) (Crandall & Mark (1963), Random
//! Vibration in Mechanical Systems, section 2.2).
//!
//! At the samples it is exact for any `dt`: (x, u) moves by Φ = exp(A dt) and takes noise of
//! covariance σ²(1 − ΦΦᵀ), because both have the stationary variance σ² and no correlation (Van Loan
//! (1978) gives the general case). It starts in that law. Two normal numbers a sample.
//!
//! Behind its peak near τ = 0.37/f₀ the Allan variance falls as 3σ²/(2πf₀τ)², to what sampling folds
//! down of the band's skirts: white noise of N² = (π/3)σ²Δf dt², small where the band is well below
//! the sampling rate.
//!
//! ```
//! use imu_core::noise::{Axis, BandVibration, Channel, Sensor, Stage, Term};
//! let z = Channel::new(7, Sensor::ACCELEROMETER, Axis::Z);
//! let frame = BandVibration { standard_deviation: 0.5, frequency: 80.0, bandwidth: 10.0 };
//! let mut frame = frame.prepare(0.001, z).unwrap(); // m/s², Hz, Hz
//! let n = 100_000;
//! let power: f64 = (0..n).map(|_| frame.step(0.0_f64).powi(2)).sum::<f64>() / f64::from(n);
//! assert!((power.sqrt() / 0.5 - 1.0).abs() < 0.1);
//! ```

use super::{Channel, Normal, Stage, Term, TermId, density, finite, interval, positive};
use crate::Error;
use crate::resonator::Transition;
use core::f64::consts::TAU;

/// Random vibration about a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandVibration<T> {
    /// σ, root mean square, in the sensor's unit; not negative.
    pub standard_deviation: T,
    /// f₀, the middle of the band, in Hz; above zero.
    pub frequency: T,
    /// 2ζf₀, the width of the band at half power, in Hz; above zero and below 2f₀.
    pub bandwidth: T,
}

impl<T: Normal> Term<T> for BandVibration<T> {
    type Stage = BandVibrationStage<T>;

    fn prepare(self, dt: T, channel: Channel) -> Result<BandVibrationStage<T>, Error> {
        let sigma = density("standard_deviation", self.standard_deviation)?;
        let frequency = positive("frequency", self.frequency)?.to_f64();
        let damping = 0.5 * positive("bandwidth", self.bandwidth)?.to_f64() / frequency;
        if damping >= 1.0 {
            return Err(Error::OutOfRange("bandwidth"));
        }
        let angle = finite("frequency * dt", TAU * frequency * interval(dt)?.to_f64())?;
        let Transition { xx, xu, ux, uu } = Transition::new(angle, damping);
        // 1 − ΦΦᵀ with Φ = 1 + P is −(P + Pᵀ + PPᵀ); its Cholesky factor, the larger row first.
        let variance_u = -(uu + uu + ux * ux + uu * uu);
        let variance_x = -(xx + xx + xx * xx + xu * xu);
        let covariance = -(xu + ux + xx * ux + xu * uu);
        let drive_u = libm::sqrt(variance_u.max(0.0));
        let shared = if drive_u > 0.0 { covariance / drive_u } else { 0.0 };
        let drive_x = libm::sqrt((variance_x - shared * shared).max(0.0));
        let mut rng: T::Generator = channel.stream(TermId::BAND_VIBRATION);
        let mut start = || finite("standard_deviation", sigma * T::standard_normal(&mut rng));
        let (x, u) = (start()?, start()?);
        let real = T::from_f64;
        Ok(BandVibrationStage {
            x,
            u,
            transition: [xx, xu, ux, uu].map(real),
            drive: [sigma * real(drive_x), sigma * real(shared), sigma * real(drive_u)],
            rng,
        })
    }
}

/// Band vibration prepared for one sampling interval: 52 bytes in `f32`, 104 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandVibrationStage<T: Normal> {
    x: T,
    u: T,
    /// Φ − 1, row by row.
    transition: [T; 4],
    /// What x takes of the first number, x of the second, u of the second.
    drive: [T; 3],
    rng: T::Generator,
}

impl<T: Normal> BandVibrationStage<T> {
    /// Goes on to the next sample; how far x moved.
    #[inline(always)]
    pub(super) fn advance(&mut self) -> T {
        let (x, u) = (self.x, self.u);
        let [xx, xu, ux, uu] = self.transition;
        let [drive_x, shared, drive_u] = self.drive;
        let n = T::standard_normal(&mut self.rng);
        let common = T::standard_normal(&mut self.rng);
        let moved = (xx * x + xu * u) + (drive_x * n + shared * common);
        self.x += moved;
        self.u += (ux * x + uu * u) + drive_u * common;
        moved
    }
}

impl<T: Normal> Stage<T> for BandVibrationStage<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        let u = self.u;
        self.advance();
        truth + u
    }

    /// Zero: vibration is no bias.
    #[inline(always)]
    fn bias(&self) -> T {
        T::ZERO
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
