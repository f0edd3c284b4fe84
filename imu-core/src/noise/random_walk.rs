//! Bias random walk: a bias that wanders by independent normal steps.
//!
//! A continuous random walk of density K (rad/s²/√Hz for a gyroscope, m/s³/√Hz for an
//! accelerometer; the rate random walk) moves by K√dt (standard deviation) in an interval `dt`, and
//! not by K·dt. Sample k carries the bias b_k, then b_{k+1} = b_k + K√dt·n; b_0 = 0 (add a
//! [`ConstantBias`](super::ConstantBias) for another start). Sampled so, its Allan variance is
//! (K²τ/3)(1 + 1/(2m²)) at τ = m·dt: K²τ/3 of IEEE Std 952 for all but the shortest τ.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, RandomWalk, Sensor, Stage, Term};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let mut walk = RandomWalk { random_walk: 5e-5 }.prepare(0.005, x).unwrap();
//! assert_eq!(walk.bias(), 0.0_f64);
//! walk.step(0.0);
//! let carried = walk.bias(); // by the next sample
//! assert_eq!(walk.step(0.5), 0.5 + carried);
//! ```

use super::{Channel, Normal, Stage, Term, TermId, density, interval};
use crate::Error;

/// Bias random walk of a continuous-time density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomWalk<T> {
    /// K, in the sensor's unit per second per √Hz; not negative.
    pub random_walk: T,
}

impl<T: Normal> Term<T> for RandomWalk<T> {
    type Stage = RandomWalkStage<T>;

    fn prepare(self, dt: T, channel: Channel) -> Result<RandomWalkStage<T>, Error> {
        let sd = density("random_walk", self.random_walk)? * interval(dt)?.sqrt();
        let sd = density("random_walk * sqrt(dt)", sd)?;
        Ok(RandomWalkStage { bias: T::ZERO, sd, rng: channel.stream(TermId::RANDOM_WALK) })
    }
}

/// Bias random walk prepared for one sampling interval: 24 bytes in `f32`, 48 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomWalkStage<T: Normal> {
    bias: T,
    sd: T,
    rng: T::Generator,
}

impl<T: Normal> Stage<T> for RandomWalkStage<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        let measured = truth + self.bias;
        self.bias += self.sd * T::standard_normal(&mut self.rng);
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
