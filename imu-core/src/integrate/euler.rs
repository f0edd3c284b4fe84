//! Euler's rule: what the new sample says, held over the whole step.

use super::Rule;
use crate::delta::Delta;
use crate::sample::{Bias, Sample};
use crate::time::Step;
use crate::{Real, so3};

/// θ = ω₁dt, Δv = f₁dt, Δp = ½f₁dt²: first order. It needs no past.
///
/// The sample is that at the end of the step, as in the course program `vio_data_simulation` (He & Gao, 2019); the
/// force acts in the attitude at the beginning. [`TextbookEuler`](super::TextbookEuler) is that program's to the last
/// digit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Euler;

impl<T: Real> Rule<T> for Euler {
    type Input = Sample<T>;
    const TRAPEZOID: bool = true;

    #[inline(always)]
    fn step(&mut self, sample: &Sample<T>, dt: &Step<T>) -> Delta<T> {
        let half = dt.seconds() * T::from_f64(0.5);
        let rotation = so3::exp_of_half(sample.angular_rate * half);
        let velocity = sample.specific_force * dt.seconds();
        Delta::of_step(rotation, velocity, velocity * half, dt)
    }

    #[inline]
    fn rebias(&mut self, _: &Bias<T>) {}
}
