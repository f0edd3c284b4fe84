//! What accuracy costs: alternatives side by side, their error and their price measured on the machine
//! that runs this.
//!
//! Everything here is measured, nothing looked up: errors by simulating many records of known noise
//! ([`allan`]), the price by timing the same code on the same kind of data, all in turns, so that a busy
//! machine slows one as much as another; a plain sum of the same array is the baseline.

pub mod allan;
mod cost;
pub mod estimators;
mod parallel;
pub mod rules;
pub mod spline;

pub use cost::Cost;
