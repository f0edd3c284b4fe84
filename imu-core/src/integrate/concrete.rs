//! One step of dead reckoning on a flat world, compiled here: for firmware built for size.
//!
//! Generic code is compiled by the crate that calls it, at *its* optimisation level; a step that takes 180 instructions
//! at `opt-level = 3` takes four times as many at `"s"`. These functions are compiled with `imu-core`, whose level is
//! set by two lines in the firmware's `Cargo.toml`:
//!
//! ```toml
//! [profile.release.package.imu-core]
//! opt-level = 3
//! ```

macro_rules! concrete {
    ($(#[$module:meta])* $scalar:ident, $T:ty) => {
        $(#[$module])*
        pub mod $scalar {
            use crate::integrate::{
                ConingSculling, Euler, Halves, Midpoint, PreviousIncrement, ThreeSample, TwoSample,
            };
            use crate::sample::{Increment, Sample};
            use crate::time::Step;
            use crate::world::Flat;
            use crate::{Compensated, State};

            concrete!(@ $T, State, "",
                euler: Euler, Sample<$T>;
                midpoint: Midpoint<$T>, Sample<$T>;
                coning_sculling: ConingSculling<$T>, Sample<$T>;
                three_sample: ThreeSample<$T>, Sample<$T>;
                two_sample: TwoSample, Halves<$T>;
                previous_increment: PreviousIncrement<$T>, Increment<$T>;
            );
            concrete!(@ $T, Compensated, ", on a compensated state",
                compensated_euler: Euler, Sample<$T>;
                compensated_midpoint: Midpoint<$T>, Sample<$T>;
                compensated_coning_sculling: ConingSculling<$T>, Sample<$T>;
                compensated_three_sample: ThreeSample<$T>, Sample<$T>;
                compensated_two_sample: TwoSample, Halves<$T>;
                compensated_previous_increment: PreviousIncrement<$T>, Increment<$T>;
            );
        }
    };
    (@ $T:ty, $State:ident, $on:literal, $($name:ident: $Rule:ty, $Input:ty;)*) => {$(
        #[doc = concat!("[`", stringify!($State), "::advance`] by [`", stringify!($Rule), "`]", $on, ".")]
        #[inline(never)]
        pub fn $name(
            state: &mut $State<$T>,
            rule: &mut $Rule,
            input: &$Input,
            dt: &Step<$T>,
            world: &Flat<$T>,
        ) {
            state.advance(rule, input, dt, world);
        }
    )*};
}

concrete!(
    /// Steps of dead reckoning in `f32`, compiled at this crate's own optimisation level.
    single, f32
);
concrete!(
    /// Steps of dead reckoning in `f64`, compiled at this crate's own optimisation level.
    double, f64
);
