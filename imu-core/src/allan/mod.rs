//! Allan and Hadamard variance, streaming, over octaves of the averaging time τ; the noise that
//! explains them.

mod bytes;
mod carry;
mod chi_square;
mod correlation;
mod edf;
mod extend;
mod fit;
mod ladder;
mod learn;
mod likelihood;
mod reading;
mod scan;
mod search;
mod terms;
mod total;

pub use chi_square::{chi_square_quantile, chi_square_tails};
pub use edf::{Difference, Mixture, edf, interval};
pub use fit::{NoiseFit, Parameter, average_octaves, fit_noise, fit_noise_from, fitted_edf};
pub use ladder::{AllanLadder, HadamardLadder, Ladder};
pub use reading::{Octave, Sampling};
pub use scan::Contradiction;
pub use terms::{
    Terms, TermsFit, fit_terms, fit_terms_from, likelihood_ratio, select_terms, select_terms_from,
};
pub use total::{Total, TwoStage};
