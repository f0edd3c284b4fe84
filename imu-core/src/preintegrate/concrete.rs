//! Steps of preintegration, compiled here: for firmware built for size, as those of [`crate::integrate::single`].

macro_rules! concrete {
    ($(#[$module:meta])* $scalar:ident, $T:ty) => {
        $(#[$module])*
        pub mod $scalar {
            use crate::integrate::{ConingSculling, Midpoint, ThreeSample};
            use crate::preintegrate::{Mean, WithCovariance, WithJacobian};
            use crate::sample::Sample;
            use crate::time::Step;

            concrete!(@ $T,
                midpoint_mean: Mean, Midpoint;
                midpoint_with_jacobian: WithJacobian, Midpoint;
                midpoint_with_covariance: WithCovariance, Midpoint;
                coning_sculling_mean: Mean, ConingSculling;
                coning_sculling_with_jacobian: WithJacobian, ConingSculling;
                coning_sculling_with_covariance: WithCovariance, ConingSculling;
                three_sample_mean: Mean, ThreeSample;
                three_sample_with_jacobian: WithJacobian, ThreeSample;
                three_sample_with_covariance: WithCovariance, ThreeSample;
            );
        }
    };
    (@ $T:ty, $($name:ident: $Kind:ident, $Rule:ident;)*) => {$(
        #[doc = concat!("[`", stringify!($Kind), "::step`] by [`", stringify!($Rule), "`].")]
        #[inline(never)]
        pub fn $name(
            preintegrated: &mut $Kind<$T, $Rule<$T>>,
            sample: &Sample<$T>,
            dt: &Step<$T>,
        ) {
            preintegrated.step(sample, dt);
        }
    )*};
}

concrete!(
    /// Steps of preintegration in `f32`, compiled at this crate's own optimisation level.
    single, f32
);
concrete!(
    /// Steps of preintegration in `f64`, compiled at this crate's own optimisation level.
    double, f64
);
