#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

pub mod allan;
mod error;
pub mod noise;
mod scalar;

pub use error::Error;
pub use nalgebra;
pub use scalar::Real;
