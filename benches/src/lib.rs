//! Data and baselines that the benchmarks share.

pub mod contest;
pub mod matrices;
pub mod steps;
pub mod vins;
