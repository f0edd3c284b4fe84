//! From samples to noise parameters.

pub mod batch;
