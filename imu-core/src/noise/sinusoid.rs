//! Vibration of one frequency: an engine's or a rotor's line in the measurement.
//!
//! Sample k carries A sin(2π f k dt + φ). The phase is an integer, in units of 2⁻⁶⁴ turns, that
//! wraps round: neither amplitude nor phase drifts, and after 10⁹ samples the phase is off by less
//! than 10⁻⁶ rad of A sin(2π f t + φ). A frequency above half the sampling rate appears where the
//! sampling folds it, as in a sensor without a filter. The sine is its Taylor polynomial over a
//! quarter turn, without `libm`: within 3·10⁻⁷ A in `f32`, 10⁻¹⁵ A in `f64`.
//!
//! Sampled, the Allan variance at τ = m·dt is A² sin⁴(πfτ)/(m sin πf dt)² (IEEE Std 952, annex C,
//! gives the continuous form A² (sin²(πfτ)/(πfτ))²): a first peak at τ = 0.371/f, then lobes that
//! fall as 1/τ.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, Sensor, Sinusoid, Stage, Term};
//! let z = Channel::new(7, Sensor::ACCELEROMETER, Axis::Z);
//! let rotor = Sinusoid { amplitude: 2.0, frequency: 50.0, phase: 0.0 }; // m/s², Hz, rad
//! let mut rotor = rotor.prepare(0.001, z).unwrap();
//! for k in 0..1000 {
//!     let expected = 2.0 * (std::f64::consts::TAU * 0.05 * f64::from(k)).sin();
//!     assert!((rotor.step(9.81_f64) - 9.81 - expected).abs() < 1e-12);
//! }
//! ```

use super::{Channel, Normal, Stage, Term, density, finite, interval};
use crate::Error;
use core::f64::consts::TAU;

/// Vibration of one frequency. It draws no random number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sinusoid<T> {
    /// A, the peak, in the sensor's unit; not negative.
    pub amplitude: T,
    /// f, in Hz; not negative.
    pub frequency: T,
    /// φ, the phase of the first sample, in radians.
    pub phase: T,
}

impl<T: Normal> Term<T> for Sinusoid<T> {
    type Stage = SinusoidStage<T>;

    fn prepare(self, dt: T, _: Channel) -> Result<SinusoidStage<T>, Error> {
        let amplitude = density("amplitude", self.amplitude)?;
        let frequency = density("frequency", self.frequency)?.to_f64();
        let phase = finite("phase", self.phase)?.to_f64();
        let advance = finite("frequency * dt", frequency * interval(dt)?.to_f64())?;
        Ok(SinusoidStage { amplitude, phase: turns(phase / TAU), advance: turns(advance) })
    }
}

/// The fraction of `x` turns, in units of 2⁻⁶⁴.
fn turns(x: f64) -> u64 {
    ((x - libm::floor(x)) * 18_446_744_073_709_551_616.0) as u64
}

/// A sinusoid prepared for one sampling interval: 24 bytes in `f32` and `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SinusoidStage<T> {
    phase: u64,
    advance: u64,
    amplitude: T,
}

/// (−1)ⁿ (2π)²ⁿ⁺¹/(2n + 1)!, of sin 2πx.
const COEFFICIENTS: [f64; 11] = coefficients();

const fn coefficients() -> [f64; 11] {
    let mut all = [0.0; 11];
    let (mut n, mut term) = (0, TAU);
    while n < 11 {
        all[n] = term;
        n += 1;
        term *= -TAU * TAU / ((2 * n) * (2 * n + 1)) as f64;
    }
    all
}

/// sin of `phase` · 2⁻⁶⁴ turns.
#[inline(always)]
fn sine<T: Normal>(phase: u64) -> T {
    // The upper half as a signed number of 2⁻³² turns, folded into ± a quarter turn.
    let (mut high, mut low) = ((phase >> 32) as u32 as i32, phase as u32);
    if high.wrapping_add(1 << 30) < 0 {
        // sin(π − x) = sin x, to the last bit of the 64.
        high = i32::MIN.wrapping_sub(high).wrapping_sub(i32::from(low != 0));
        low = low.wrapping_neg();
    }
    let mut x = T::from_i32(high) * T::from_f64(1.0 / 4_294_967_296.0);
    // f32 ends at x¹³, and has no use for the lower half.
    let single = T::EPSILON > T::from_f64(1e-10);
    if !single {
        x += T::from_u32(low) * T::from_f64(1.0 / 18_446_744_073_709_551_616.0);
    }
    let square = x * x;
    let mut sum = T::ZERO;
    for &coefficient in COEFFICIENTS.iter().take(if single { 7 } else { 11 }).rev() {
        sum = sum * square + T::from_f64(coefficient);
    }
    sum * x
}

impl<T: Normal> Stage<T> for SinusoidStage<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        let measured = truth + self.amplitude * sine(self.phase);
        self.phase = self.phase.wrapping_add(self.advance);
        measured
    }

    /// Zero: vibration is no bias.
    #[inline(always)]
    fn bias(&self) -> T {
        T::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sine_is_right_all_round() {
        for k in 0..200_000_u64 {
            let phase = k.wrapping_mul(0x0000_5432_1fed_cba9_u64 << 8);
            let exact = libm::sin(TAU * (phase as i64 as f64 / 18_446_744_073_709_551_616.0));
            // libm's argument is itself rounded: up to 6e-16 rad.
            assert!((sine::<f64>(phase) - exact).abs() < 1e-15, "{phase:x}");
            assert!((f64::from(sine::<f32>(phase)) - exact).abs() < 3e-7, "{phase:x}");
        }
        let quarter = 1_u64 << 62;
        for (phase, value) in [(0, 0.0), (quarter, 1.0), (2 * quarter, 0.0), (3 * quarter, -1.0)] {
            assert!((sine::<f64>(phase) - value).abs() < 5e-16);
        }
    }

    #[test]
    fn neither_amplitude_nor_phase_drifts_over_a_thousand_million_samples() {
        let channel = Channel::new(7, super::super::Sensor::GYROSCOPE, super::super::Axis::X);
        let (frequency, dt) = (0.1_f32, 1e-3_f32);
        let term = Sinusoid { amplitude: 1.0_f32, frequency, phase: 0.3 };
        let mut stage = term.prepare(dt, channel).unwrap();
        let n = 1_000_000_000_u64;
        stage.phase = stage.phase.wrapping_add(stage.advance.wrapping_mul(n)); // n steps
        for k in n..n + 20_000 {
            let turns = f64::from(frequency) * f64::from(dt) * k as f64;
            let exact = libm::sin(TAU * (turns - libm::floor(turns)) + f64::from(0.3_f32));
            assert!((f64::from(stage.step(0.0)) - exact).abs() < 1.3e-6);
        }
    }
}
