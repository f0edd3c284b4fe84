//! A bias that follows the warming of the sensor after it is switched on.
//!
//! The temperature settles exponentially (Newton's law of cooling): T(t) − T₀ = ΔT + ΔT_rise
//! (1 − e^(−t/t_c)), and the bias is c·(T(t) − T₀), with c the temperature coefficient of a data sheet
//! and T₀ the temperature at which the sensor was calibrated. t_c is a few minutes for a MEMS chip in
//! its housing. For τ well below t_c the Allan variance is that of a ramp that dies away.
//!
//! What is left to go, y = c ΔT_rise e^(−t/t_c), falls by y(1 − e^(−dt/t_c)) a sample. The rounding of
//! each difference is carried over to the next (Kahan (1965)), so that in `f32` a decay of 10⁻⁸ a
//! sample, which plain arithmetic would not notice, still arrives.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, Sensor, Stage, Term, WarmUp};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let warm_up = WarmUp { coefficient: 2e-4, start: 0.0, rise: 20.0, time_constant: 180.0 };
//! let mut warm_up = warm_up.prepare(0.005, x).unwrap(); // rad/s/K, K, K, s
//! for _ in 0..36_000 {
//!     warm_up.step(0.0_f64); // three minutes
//! }
//! assert!((warm_up.bias() - 4e-3 * (1.0 - (-1.0_f64).exp())).abs() < 1e-15);
//! ```

use super::{Channel, Normal, Stage, Term, finite, interval, positive};
use crate::Error;

/// A bias proportional to a temperature that settles. It draws no random number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmUp<T> {
    /// c, in the sensor's unit per kelvin, of either sign.
    pub coefficient: T,
    /// ΔT = T(0) − T₀, in kelvin.
    pub start: T,
    /// ΔT_rise = T(∞) − T(0), in kelvin.
    pub rise: T,
    /// t_c, in seconds; above zero.
    pub time_constant: T,
}

impl<T: Normal> Term<T> for WarmUp<T> {
    type Stage = WarmUpStage<T>;

    fn prepare(self, dt: T, _: Channel) -> Result<WarmUpStage<T>, Error> {
        finite("coefficient", self.coefficient)?;
        let start = finite("coefficient * start", self.coefficient * finite("start", self.start)?)?;
        let left = finite("coefficient * rise", self.coefficient * finite("rise", self.rise)?)?;
        let x = interval(dt)? / positive("time_constant", self.time_constant)?;
        let settled = finite("coefficient * (start + rise)", start + left)?;
        Ok(WarmUpStage { settled, left, carry: T::ZERO, decay: -(-x).exp_m1() })
    }
}

/// Warm-up prepared for one sampling interval: 16 bytes in `f32`, 32 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmUpStage<T> {
    settled: T,
    left: T,
    carry: T,
    decay: T,
}

impl<T: Normal> Stage<T> for WarmUpStage<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        let measured = truth + (self.settled - self.left);
        let fall = self.decay * self.left + self.carry;
        let left = self.left - fall;
        self.carry = fall - (self.left - left);
        self.left = left;
        measured
    }

    #[inline(always)]
    fn bias(&self) -> T {
        self.settled - self.left
    }
}
