//! What the firmware images and the host both compute: one list of cases, one list of inputs.
//!
//! A case calls functions of `imu_core` on inputs made from integers and reports every result as a
//! 64-bit word. The runner calls the same cases on the host: word for word, both must agree. A
//! case may also have its work counted in instructions, or its stack measured; the host does that
//! work too, so that both go through the same states, and reports no figure.
#![no_std]
#![forbid(unsafe_code)]

use core::hint::black_box;
use imu_core::Real;

mod edf;
mod fit;
mod frame;
pub mod inputs;
mod integrate;
mod interpolate;
mod ladder;
mod noise;
mod preintegrate;
mod scalar;
mod sensor;
pub mod single;
mod so3;
mod spline;
mod term_fit;
mod terms;
mod trajectory;

/// Where a case leaves its results.
pub trait Report {
    /// A result that must be the same 64 bits on every target.
    fn word(&mut self, bits: u64);
    /// Does `work` once, and counts the instructions it takes, per one of the `calls` it makes.
    fn instructions(&mut self, what: &'static str, calls: u32, work: &mut dyn FnMut());
    /// Does `work` once, and measures how many bytes of stack it takes below its caller's.
    fn stack(&mut self, what: &'static str, work: &mut dyn FnMut());
    /// States how many bytes a value takes on this target.
    fn state(&mut self, what: &'static str, bytes: usize);
}

impl dyn Report + '_ {
    /// Reports the bits of a number; every NaN counts as the same.
    pub fn real<T: Real>(&mut self, value: T) {
        let value = value.to_f64();
        self.word(if value.is_nan() { u64::MAX } else { value.to_bits() });
    }

    /// Reports a yes or a no.
    pub fn flag(&mut self, value: bool) {
        self.word(u64::from(value));
    }
}

/// A named case.
pub struct Case {
    /// Its name: the first column of the table of ceilings.
    pub name: &'static str,
    /// Runs it.
    pub run: fn(&mut dyn Report),
}

/// Every case, in the order in which they run.
pub const CASES: &[Case] = &[
    Case { name: "scalar f32", run: scalar::case::<f32> },
    Case { name: "scalar f64", run: scalar::case::<f64> },
    Case { name: "chi square", run: edf::chi_square },
    Case { name: "edf", run: edf::degrees_of_freedom },
    Case { name: "noise f32", run: noise::case::<f32> },
    Case { name: "noise f64", run: noise::case::<f64> },
    Case { name: "noise steps f32", run: noise::absent_terms::<f32> },
    Case { name: "noise steps f64", run: noise::absent_terms::<f64> },
    Case { name: "terms f32", run: terms::case::<f32> },
    Case { name: "terms f64", run: terms::case::<f64> },
    Case { name: "term steps f32", run: terms::cost::<f32> },
    Case { name: "term steps f64", run: terms::cost::<f64> },
    Case { name: "sensor f32", run: sensor::case::<f32> },
    Case { name: "sensor f64", run: sensor::case::<f64> },
    Case { name: "sensor steps f32", run: sensor::cost::<f32> },
    Case { name: "sensor steps f64", run: sensor::cost::<f64> },
    Case { name: "so3 f32", run: so3::case::<f32> },
    Case { name: "so3 f64", run: so3::case::<f64> },
    Case { name: "integrate f32", run: integrate::case::<f32> },
    Case { name: "integrate f64", run: integrate::case::<f64> },
    Case { name: "integrate steps f32", run: integrate::cost_in_single },
    Case { name: "integrate steps f64", run: integrate::cost_in_double },
    Case { name: "interpolate f32", run: interpolate::case::<f32> },
    Case { name: "interpolate f64", run: interpolate::case::<f64> },
    Case { name: "preintegrate f32", run: preintegrate::case_in_single },
    Case { name: "preintegrate f64", run: preintegrate::case_in_double },
    Case { name: "preintegrate steps f32", run: preintegrate::cost },
    Case { name: "trajectory f32", run: trajectory::case::<f32> },
    Case { name: "trajectory f64", run: trajectory::case::<f64> },
    Case { name: "spline f32", run: spline::case_in_single },
    Case { name: "spline f64", run: spline::case_in_double },
    Case { name: "spline evaluations f32", run: spline::cost_in_single },
    Case { name: "spline evaluations f64", run: spline::cost_in_double },
    Case { name: "Allan f32 1", run: ladder::bits::<f32, 1, 1> },
    Case { name: "Allan f32 4", run: ladder::bits::<f32, 4, 1> },
    Case { name: "Hadamard f32 1", run: ladder::bits::<f32, 1, 2> },
    Case { name: "Hadamard f32 4", run: ladder::bits::<f32, 4, 2> },
    Case { name: "Allan f64 1", run: ladder::bits::<f64, 1, 1> },
    Case { name: "Allan f64 4", run: ladder::bits::<f64, 4, 1> },
    Case { name: "Hadamard f64 1", run: ladder::bits::<f64, 1, 2> },
    Case { name: "Hadamard f64 4", run: ladder::bits::<f64, 4, 2> },
    Case { name: "Allan f32 1 cost", run: ladder::cost::<f32, 1, 1> },
    Case { name: "Allan f32 4 cost", run: ladder::cost::<f32, 4, 1> },
    Case { name: "Hadamard f32 1 cost", run: ladder::cost::<f32, 1, 2> },
    Case { name: "Hadamard f32 4 cost", run: ladder::cost::<f32, 4, 2> },
    Case { name: "Allan f64 1 cost", run: ladder::cost::<f64, 1, 1> },
    Case { name: "Allan f64 4 cost", run: ladder::cost::<f64, 4, 1> },
    Case { name: "Hadamard f64 1 cost", run: ladder::cost::<f64, 1, 2> },
    Case { name: "Hadamard f64 4 cost", run: ladder::cost::<f64, 4, 2> },
    Case { name: "frame", run: frame::case },
    Case { name: "fit", run: fit::bits },
    Case { name: "fit cost", run: fit::cost },
    Case { name: "term fit", run: term_fit::bits },
    Case { name: "term fit cost", run: term_fit::cost },
    Case { name: "Allan f32 1 worst", run: ladder::worst_push },
];

/// Does `work` `times` times and hides the results from the optimiser.
fn repeat<R>(times: u32, mut work: impl FnMut() -> R) {
    for _ in 0..times {
        black_box(work());
    }
}
