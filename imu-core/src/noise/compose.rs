//! Composition: a tuple of terms is a term, three axes are a sensor, and `()` is no noise at all.
//!
//! The measurement passes the stages of a tuple from left to right. What is left out costs no byte
//! and no instruction: the tuple is the sum of its members, known to the compiler.

use super::{Axis, Channel, Normal, Sensor, Stage, Term};
use crate::Error;

/// No error: a measurement is the truth.
impl<T: Normal> Term<T> for () {
    type Stage = Self;

    fn prepare(self, _: T, _: Channel) -> Result<(), Error> {
        Ok(())
    }
}

impl<T: Normal> Stage<T> for () {
    #[inline(always)]
    fn step(&mut self, truth: T) -> T {
        truth
    }

    #[inline(always)]
    fn bias(&self) -> T {
        T::ZERO
    }

    #[inline(always)]
    fn apply(&mut self, _: &mut [T]) {}
}

macro_rules! tuple {
    ($($member:ident $index:tt),+) => {
        impl<T: Normal, $($member: Term<T>),+> Term<T> for ($($member,)+) {
            type Stage = ($($member::Stage,)+);

            fn prepare(self, dt: T, channel: Channel) -> Result<Self::Stage, Error> {
                Ok(($(self.$index.prepare(dt, channel)?,)+))
            }
        }

        impl<T: Normal, $($member: Stage<T>),+> Stage<T> for ($($member,)+) {
            #[inline(always)]
            fn step(&mut self, truth: T) -> T {
                let measured = truth;
                $(let measured = self.$index.step(measured);)+
                measured
            }

            #[inline(always)]
            fn bias(&self) -> T {
                let bias = T::ZERO;
                $(let bias = bias + self.$index.bias();)+
                bias
            }

            /// A loop for each member: a member's loop holds its state in registers.
            #[inline]
            fn apply(&mut self, samples: &mut [T]) {
                $(self.$index.apply(samples);)+
            }
        }
    };
}

tuple!(A 0);
tuple!(A 0, B 1);
tuple!(A 0, B 1, C 2);
tuple!(A 0, B 1, C 2, D 3);
tuple!(A 0, B 1, C 2, D 3, E 4);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7, I 8);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7, I 8, J 9);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7, I 8, J 9, K 10);
tuple!(A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7, I 8, J 9, K 10, L 11);

/// The noise of a three-axis sensor: a stage for each of x, y, z.
///
/// ```
/// use imu_core::noise::{RandomWalk, Sensor, Stage, ThreeAxis, White};
/// let mid = (White { noise_density: 0.015 }, RandomWalk { random_walk: 5e-5 });
/// let mut gyroscope = ThreeAxis::prepare([mid; 3], 0.005_f32, 7, Sensor::GYROSCOPE).unwrap();
/// let bias = gyroscope.bias(); // what the next sample carries
/// let measured = gyroscope.step([0.0, 0.0, 0.1]);
/// assert_eq!(bias, [0.0; 3]);
/// assert_ne!(measured, [0.0, 0.0, 0.1]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ThreeAxis<S> {
    axes: [S; 3],
}

impl<S> ThreeAxis<S> {
    /// Prepares the terms of x, y, z for the interval `dt` in seconds, each on its own streams.
    ///
    /// # Errors
    /// Those of the terms: see [`Term::prepare`].
    pub fn prepare<T: Normal, P: Term<T, Stage = S>>(
        terms: [P; 3],
        dt: T,
        seed: u64,
        sensor: Sensor,
    ) -> Result<Self, Error> {
        let [x, y, z] = terms;
        let on = |axis| Channel::new(seed, sensor, axis);
        Ok(Self {
            axes: [
                x.prepare(dt, on(Axis::X))?,
                y.prepare(dt, on(Axis::Y))?,
                z.prepare(dt, on(Axis::Z))?,
            ],
        })
    }
}

impl<T: Normal, S: Stage<T>> Stage<[T; 3]> for ThreeAxis<S> {
    #[inline(always)]
    fn step(&mut self, truth: [T; 3]) -> [T; 3] {
        let ([a, b, c], [x, y, z]) = (&mut self.axes, truth);
        [a.step(x), b.step(y), c.step(z)]
    }

    #[inline(always)]
    fn bias(&self) -> [T; 3] {
        let [a, b, c] = &self.axes;
        [a.bias(), b.bias(), c.bias()]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ConstantBias, RandomWalk, White};
    use super::*;
    use core::mem::size_of;
    use proptest::prelude::*;

    type Full<T> = (White<T>, RandomWalk<T>, ConstantBias<T>);

    const fn full<T>(noise_density: T, random_walk: T, constant_bias: T) -> Full<T> {
        (White { noise_density }, RandomWalk { random_walk }, ConstantBias { constant_bias })
    }

    fn channel() -> Channel {
        Channel::new(7, Sensor::ACCELEROMETER, Axis::Y)
    }

    #[test]
    fn a_term_left_out_takes_no_byte() {
        type Of<P> = <P as Term<f32>>::Stage;
        assert_eq!(size_of::<Of<()>>(), 0);
        assert_eq!(size_of::<Of<(ConstantBias<f32>,)>>(), 4);
        assert_eq!(size_of::<Of<(White<f32>,)>>(), 20);
        assert_eq!(size_of::<Of<(White<f32>, RandomWalk<f32>)>>(), 20 + 24);
        assert_eq!(size_of::<Of<Full<f32>>>(), 20 + 24 + 4);
        assert_eq!(size_of::<ThreeAxis<Of<Full<f32>>>>(), 3 * (20 + 24 + 4));
        assert_eq!(size_of::<ThreeAxis<()>>(), 0);
    }

    #[test]
    fn no_term_is_the_identity() {
        let mut none: () = ().prepare(0.005_f64, channel()).unwrap();
        assert_eq!(none.step(1.5), 1.5);
        assert_eq!(Stage::<f64>::bias(&none), 0.0);
        let mut block = [1.0, 2.0];
        none.apply(&mut block);
        assert_eq!(block, [1.0, 2.0]);
    }

    #[test]
    fn switching_one_term_never_changes_anothers_numbers() {
        let (white, walk, _) = full(0.01, 1e-3, 0.0);
        let mut both = (white, walk).prepare(0.005, channel()).unwrap();
        let mut alone = walk.prepare(0.005, channel()).unwrap();
        let mut noise = white.prepare(0.005, channel()).unwrap();
        for _ in 0..1000 {
            assert_eq!(both.bias(), alone.bias());
            assert_eq!(both.step(0.0), alone.step(noise.step(0.0)));
        }
    }

    #[test]
    fn the_measurement_less_its_bias_is_the_truth_without_white_noise() {
        let (_, walk, constant) = full(0.0, 0.5, 0.25);
        let mut stages = (walk, constant).prepare(0.01_f32, channel()).unwrap();
        for _ in 0..100 {
            let bias = stages.bias();
            assert_eq!(stages.step(0.0), bias);
        }
        assert_ne!(stages.bias(), 0.25);
    }

    #[test]
    fn axes_and_sensors_draw_different_numbers() {
        let prepare = |sensor| ThreeAxis::prepare([full(1.0, 0.0, 0.0); 3], 1.0_f32, 7, sensor);
        let mut gyroscope = prepare(Sensor::GYROSCOPE).unwrap();
        let mut accelerometer = prepare(Sensor::ACCELEROMETER).unwrap();
        let [a, b, c] = gyroscope.step([0.0; 3]);
        let [d, e, f] = accelerometer.step([0.0; 3]);
        let all = [a, b, c, d, e, f];
        for (i, x) in all.iter().enumerate() {
            assert!(all.iter().skip(i + 1).all(|y| x != y));
        }
    }

    #[test]
    fn parameters_outside_their_range_are_refused() {
        let prepare = |n, k, b, dt| full::<f64>(n, k, b).prepare(dt, channel()).map(|_| ());
        assert_eq!(prepare(0.0, 0.0, 0.0, 0.005), Ok(()));
        assert_eq!(prepare(-1.0, 0.0, 0.0, 0.005), Err(Error::OutOfRange("noise_density")));
        assert_eq!(prepare(0.0, f64::NAN, 0.0, 0.005), Err(Error::NonFinite("random_walk")));
        let infinite = f64::INFINITY;
        assert_eq!(prepare(0.0, 0.0, infinite, 0.005), Err(Error::NonFinite("constant_bias")));
        for dt in [0.0, -0.005] {
            assert_eq!(prepare(0.0, 0.0, 0.0, dt), Err(Error::OutOfRange("dt")));
        }
        assert_eq!(prepare(0.0, 0.0, 0.0, f64::NAN), Err(Error::NonFinite("dt")));
        let overflow = Err(Error::NonFinite("noise_density / sqrt(dt)"));
        assert_eq!(prepare(f64::MAX, 0.0, 0.0, 1e-6), overflow);
    }

    proptest! {
        /// A block gives the bits of its samples taken one by one, wherever it is cut.
        #[test]
        fn blocks_equal_steps(cut in 0_usize..64, seed: u64, truth in -10.0_f32..10.0) {
            let channel = Channel::new(seed, Sensor::GYROSCOPE, Axis::X);
            let mut one = full(0.3, 0.2, 0.1).prepare(0.01, channel).unwrap();
            let mut two = one;
            let mut block = [truth; 64];
            let (left, right) = block.split_at_mut(cut);
            two.apply(left);
            two.apply(right);
            for sample in block {
                prop_assert_eq!(one.step(truth).to_bits(), sample.to_bits());
            }
            prop_assert_eq!(one, two);
        }
    }
}
