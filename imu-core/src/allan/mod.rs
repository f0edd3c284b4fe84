//! Allan and Hadamard variance, streaming, over octaves of the averaging time τ; the noise that
//! explains them.

mod bytes;
mod carry;
mod extend;
mod ladder;
mod learn;
mod reading;
mod total;

pub use ladder::{AllanLadder, HadamardLadder, Ladder};
pub use reading::Octave;
pub use total::{Total, TwoStage};

mod chi_square;
mod edf;

pub use chi_square::{chi_square_quantile, chi_square_tails};
pub use edf::{Difference, Mixture, edf, interval};
