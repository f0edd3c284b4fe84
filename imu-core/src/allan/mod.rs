//! Allan and Hadamard variance, streaming, over octaves of the averaging time τ.

mod chi_square;
mod edf;

pub use chi_square::{chi_square_quantile, chi_square_tails};
pub use edf::{Difference, Mixture, edf, interval};
