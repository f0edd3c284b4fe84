//! Data and baselines that the benchmarks share.
