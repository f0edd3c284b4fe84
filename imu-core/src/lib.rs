#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod allan;
mod error;
pub mod noise;
mod resonator;
mod scalar;
pub mod sensor;
pub mod so3;
pub mod trajectory;

pub use error::Error;
pub use nalgebra;
pub use scalar::Real;
