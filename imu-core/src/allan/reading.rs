//! What a ladder shows of one signal at one averaging time, and how that came about.

use super::Difference;

/// The variance at one averaging time τ, and how much stands behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octave {
    /// τ in samples: 2ᴸ.
    pub samples: u64,
    /// How many differences of block means were averaged; 0: `variance` is no number yet (0).
    pub differences: u64,
    /// Allan variance ½⟨(ȳ₁ − ȳ₀)²⟩, or Hadamard variance ⅙⟨(ȳ₂ − 2ȳ₁ + ȳ₀)²⟩, in the signal's
    /// unit squared.
    pub variance: f64,
    /// By how much white noise is larger in `variance` for samples that were missing: 1 with none
    /// missing, about 1/(1 − p) with a fraction p lost.
    pub white_gain: f64,
}

impl Octave {
    /// Allan (or Hadamard) deviation: the square root of the variance.
    pub fn deviation(&self) -> f64 {
        libm::sqrt(self.variance)
    }
}

/// How the octaves of a fit came about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Time between samples, s.
    pub tau0_s: f64,
    /// Allan or Hadamard.
    pub difference: Difference,
    /// Windows per τ of the ladder: 1 or 4.
    pub windows: u8,
    /// How many independent records of the same noise are averaged in the octaves
    /// ([`average_octaves`](super::average_octaves)); 1 for a single axis.
    pub records: u32,
}
