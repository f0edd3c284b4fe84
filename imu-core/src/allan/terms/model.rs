//! What each term makes of the variance at τ (IEEE Std 952-1997, annex C; Hadamard: the same spectra through ⅙⟨third
//! difference²⟩).
//!
//! | term | Allan | Hadamard |
//! | --- | --- | --- |
//! | quantisation of the integral, Q | 3Q²/τ² | (10/3)Q²/τ² |
//! | white noise N | N²/τ | N²/τ |
//! | flicker, B | (2 ln 2/π)B² | (ln(256/27)/2π)B² |
//! | random walk K, sampled | (K²τ/3)(1 + 1/2m²) | (K²τ/6)(1 + 1/m²) |
//! | ramp R | R²τ²/2 | 0 |

use super::super::{Difference, Octave, Sampling};
use super::spread::Shares;

/// Terms of the model, in the order of powers of τ.
pub(super) const TERMS: usize = 5;
pub(super) const QUANTISATION: usize = 0;
pub(super) const WHITE: usize = 1;
pub(super) const FLICKER: usize = 2;
pub(super) const WALK: usize = 3;
pub(super) const RAMP: usize = 4;

/// Something of each term: Q², N², B², K², R², or what they make of a variance.
pub(super) type PerTerm = [f64; TERMS];

/// (2 ln 2)/π and ln(256/27)/2π.
const FLICKER_ALLAN: f64 = 0.441_271_200_305_303_16;
const FLICKER_HADAMARD: f64 = 0.357_993_671_761_516_7;

/// The variance of an octave where each of Q, N, B, K, R is 1.
pub(super) fn of_ones(octave: &Octave, sampling: &Sampling) -> PerTerm {
    let m = octave.samples as f64;
    let tau = m * sampling.tau0_s;
    let inverse = 1.0 / tau;
    let (quantisation, flicker, walk, sampled, ramp) = match sampling.difference {
        Difference::Allan => (3.0, FLICKER_ALLAN, 1.0 / 3.0, 0.5, 0.5),
        Difference::Hadamard => (10.0 / 3.0, FLICKER_HADAMARD, 1.0 / 6.0, 1.0, 0.0),
    };
    [
        quantisation * inverse * inverse,
        octave.white_gain * inverse,
        flicker,
        walk * tau * (1.0 + sampled / (m * m)),
        ramp * tau * tau,
    ]
}

/// The variances of noises as [`super::spread`] wants them: a walk's sampled part is white.
pub(super) fn noises(octave: &Octave, sampling: &Sampling, variances: &PerTerm) -> Shares {
    let m = octave.samples as f64;
    let part = match sampling.difference {
        Difference::Allan => 0.5 / (m * m),
        Difference::Hadamard => 1.0 / (m * m),
    };
    let [quantisation, white, flicker, walk, _] = *variances;
    let sampled = walk * part / (1.0 + part);
    [quantisation, white + sampled, flicker, walk - sampled]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_of_flicker() {
        let pi = core::f64::consts::PI;
        assert!((FLICKER_ALLAN - 2.0 * 2_f64.ln() / pi).abs() < 1e-15);
        assert!((FLICKER_HADAMARD - (256.0_f64 / 27.0).ln() / (2.0 * pi)).abs() < 1e-15);
    }

    /// The marks of the log-log plot: N at 1 s, K at 3 s, Q at √3 s, R at √2 s, B over 0.664 anywhere.
    #[test]
    fn marks() {
        let at = |tau: f64| {
            let octave =
                Octave { samples: 1 << 20, differences: 1, variance: 1.0, white_gain: 1.0 };
            let tau0_s = tau / f64::from(1 << 20);
            let sampling =
                Sampling { tau0_s, difference: Difference::Allan, windows: 4, records: 1 };
            of_ones(&octave, &sampling)
        };
        assert!((at(3_f64.sqrt())[QUANTISATION] - 1.0).abs() < 1e-9);
        assert!((at(1.0)[WHITE] - 1.0).abs() < 1e-9);
        assert!((at(7.0)[FLICKER].sqrt() - 0.664_283).abs() < 1e-6);
        assert!((at(3.0)[WALK] - 1.0).abs() < 1e-9);
        assert!((at(2_f64.sqrt())[RAMP] - 1.0).abs() < 1e-9);
    }
}
