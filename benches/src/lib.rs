//! Data and baselines that the benchmarks share.

pub mod contest;
pub mod steps;
pub mod vins;
