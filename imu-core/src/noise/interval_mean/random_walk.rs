//! The mean of a random walk over each interval.
//!
//! Over an interval the walk moves by Δ = K√dt·n₁, and its mean lies K√(dt/12)·n₂ from the middle of
//! its ends: the moments of a Wiener process and its integral (var ∫₀ʰW = h³/3, cov(W_h, ∫W) = h²/2;
//! Gelb (1974), Applied Optimal Estimation, section 3.8), n₁ and n₂ independent. The Allan variance of
//! such means is K²τ/3 exactly, at every τ.

use super::IntervalMean;
use crate::Error;
use crate::noise::{Channel, Normal, RandomWalk, Stage, Term, TermId, density, interval};

impl<T: Normal> Term<T> for IntervalMean<RandomWalk<T>> {
    type Stage = RandomWalkMean<T>;

    fn prepare(self, dt: T, channel: Channel) -> Result<RandomWalkMean<T>, Error> {
        let sd = density("random_walk", self.0.random_walk)? * interval(dt)?.sqrt();
        let sd = density("random_walk * sqrt(dt)", sd)?;
        let within = sd * T::from_f64(0.288_675_134_594_812_9); // 1/√12
        Ok(RandomWalkMean { bias: T::ZERO, sd, within, rng: channel.stream(TermId::RANDOM_WALK) })
    }
}

/// Means of a random walk, prepared for one sampling interval: 28 bytes in `f32`, 56 in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomWalkMean<T: Normal> {
    /// Where the interval begins.
    bias: T,
    /// K√dt.
    sd: T,
    /// K√(dt/12).
    within: T,
    rng: T::Generator,
}

impl<T: Normal> Stage<T> for RandomWalkMean<T> {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        let moved = self.sd * T::standard_normal(&mut self.rng);
        let within = self.within * T::standard_normal(&mut self.rng);
        let mean = self.bias + (T::from_f64(0.5) * moved + within);
        self.bias += moved;
        truth + mean
    }

    /// The mean over the interval of the next sample, drawn as its `step` will draw it.
    #[inline]
    fn bias(&self) -> T {
        let mut next = *self;
        next.step(T::ZERO)
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
