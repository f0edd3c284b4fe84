#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod allan;
pub mod delta;
mod error;
pub mod frame;
pub mod integrate;
mod lanes;
mod matrix;
pub mod noise;
pub mod preintegrate;
mod resonator;
pub mod sample;
mod scalar;
pub mod se3;
pub mod sensor;
pub mod so3;
pub mod spline;
pub mod state;
pub mod time;
pub mod trajectory;
mod vector;
pub mod world;

pub use error::Error;
pub use nalgebra;
pub use scalar::Real;
pub use state::{Compensated, State};
