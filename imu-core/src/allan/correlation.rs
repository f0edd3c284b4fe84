//! How the variances at neighbouring octaves of τ are correlated.
//!
//! Block means of τ and of 2τ come from the same samples, so their Allan variances err together;
//! who fits a model to them must know by how much. For second differences D of the phase (third,
//! Hadamard) over τ and rτ, started t apart,
//!
//! cov(D, D') = Σ_p Σ_q a_p a_q G(t + pτ − qrτ) / rτ²,   a = (1, −2, 1) or (1, −3, 3, −1),
//!
//! with the generalised covariance G(x) = −N²|x|/2 + K²|x|³/12 of an integrated white noise and
//! random walk (the structure that Greenhall & Riley 2003 use for the variances themselves), and for
//! Gaussian noise cov(D², D'²) = 2 cov(D, D')². Averaged over all starts of a long record, the
//! covariance of the two variances is a quadratic form in the shares of white noise and walk at τ,
//! whose coefficients depend on nothing but r and the stride: they are worked out by the compiler.

use super::Difference;

/// Covariance of the variances at τ and at rτ, times the number of differences at τ, for variances
/// v = white + walk at τ: `ww·white² + 2·wk·white·walk + kk·walk²`.
#[derive(Clone, Copy, Debug)]
struct Form {
    ww: f64,
    wk: f64,
    kk: f64,
}

const fn cube(x: f64) -> f64 {
    x * x * x
}

const fn magnitude(x: f64) -> f64 {
    if x < 0.0 { -x } else { x }
}

/// The form for r = `ratio` and strides of τ/`per_block`.
const fn form(difference: Difference, per_block: i32, ratio: i32) -> Form {
    let (weights, terms, norm, walk_scale) = match difference {
        // Walk: v = K²τ/3, so K²/12 = v/4τ; Hadamard v = K²τ/6, so v/2τ.
        Difference::Allan => ([1.0, -2.0, 1.0, 0.0], 3, 2.0, 0.25),
        Difference::Hadamard => ([1.0, -3.0, 3.0, -1.0], 4, 6.0, 0.5),
    };
    let mut sums = Form { ww: 0.0, wk: 0.0, kk: 0.0 };
    // All starts t (in strides) at which the two spans overlap.
    let mut start = -(terms - 1) * per_block;
    while start <= (terms - 1) * ratio * per_block {
        let mut white = 0.0;
        let mut walk = 0.0;
        let mut p = 0;
        while p < terms {
            let mut q = 0;
            while q < terms {
                let x = magnitude(start as f64 / per_block as f64 + (p - q * ratio) as f64);
                let weight = weights[p as usize] * weights[q as usize];
                white += weight * x * -0.5;
                walk += weight * cube(x) * walk_scale;
                q += 1;
            }
            p += 1;
        }
        sums.ww += white * white;
        sums.wk += white * walk;
        sums.kk += walk * walk;
        start += 1;
    }
    let scale = 2.0 / (norm * norm * (ratio * ratio) as f64);
    Form { ww: sums.ww * scale, wk: sums.wk * scale, kk: sums.kk * scale }
}

/// `[strides of τ, τ/2, τ/4][r = 2, 4]`.
type Forms = [[Form; 2]; 3];

const fn forms(difference: Difference) -> Forms {
    [
        [form(difference, 1, 2), form(difference, 1, 4)],
        [form(difference, 2, 2), form(difference, 2, 4)],
        [form(difference, 4, 2), form(difference, 4, 4)],
    ]
}

static ALLAN: Forms = forms(Difference::Allan);
static HADAMARD: Forms = forms(Difference::Hadamard);

/// Covariance of the variance at τ with that at 2τ (`octaves` = 1) or 4τ (2), times the number of
/// differences at τ; zero further away. `white` and `walk` are their shares of the variance at τ,
/// `level` is log₂ of τ in samples.
pub(super) fn covariance(
    difference: Difference,
    windows: u8,
    level: usize,
    octaves: usize,
    white: f64,
    walk: f64,
) -> f64 {
    let forms = match difference {
        Difference::Allan => &ALLAN,
        Difference::Hadamard => &HADAMARD,
    };
    let per_block_log2 = if windows > 1 { level.min(2) } else { 0 };
    match forms.get(per_block_log2).and_then(|by_ratio| by_ratio.get(octaves.wrapping_sub(1))) {
        Some(form) => white * (white * form.ww + 2.0 * walk * form.wk) + walk * walk * form.kk,
        None => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::allan::{Mixture, edf};

    /// At r = 1 the form is the variance of the variance: 2v²/edf of a long record.
    #[test]
    fn with_itself_it_is_the_degrees_of_freedom() {
        for difference in [Difference::Allan, Difference::Hadamard] {
            for per_block in [1, 2, 4] {
                for (white, walk) in [(1.0, 0.0), (0.0, 1.0), (0.7, 0.3)] {
                    let f = form(difference, per_block, 1);
                    let ours =
                        white * white * f.ww + 2.0 * white * walk * f.wk + walk * walk * f.kk;
                    let m = 1 << 20; // continuous time
                    let n = 1_u64 << 40;
                    let mixture = Mixture { white, random_walk: walk, ..Mixture::default() };
                    let nu = edf(difference, m, m / per_block as u64, n, mixture);
                    // The end of the record changes edf by a few parts of 1/n.
                    assert!((ours * nu / (2.0 * n as f64) - 1.0).abs() < 1e-9);
                }
            }
        }
    }

    /// Two white octaves at stride τ/4 by hand: D over τ against D over 2τ, summed over all starts
    /// of a record of 2¹⁶ samples at τ = 64 (a direct sum of cov² over both grids), gives 2.0625
    /// and, over 4τ, 0.515625; for a walk 21.6645 and 46.6661 (its sampling adds 1e-4).
    #[test]
    fn direct_sums() {
        assert!((ALLAN[2][0].ww - 2.0625).abs() < 1e-12);
        assert!((ALLAN[2][1].ww - 0.515_625).abs() < 1e-12);
        assert!((ALLAN[2][0].kk / 21.6645 - 1.0).abs() < 1e-3);
        assert!((ALLAN[2][1].kk / 46.6661 - 1.0).abs() < 1e-3);
    }

    /// A correlation: below 1, and falling with the distance in τ.
    #[test]
    fn correlations_fall_with_distance() {
        for difference in [Difference::Allan, Difference::Hadamard] {
            for (k, per_block) in [1, 2, 4].into_iter().enumerate() {
                let own = |f: Form| (f.ww, f.kk);
                let (white, walk) = own(form(difference, per_block, 1));
                let mut last = (1.0, 1.0);
                let forms = if difference == Difference::Allan { &ALLAN } else { &HADAMARD };
                for (octave, f) in forms[k].iter().enumerate() {
                    // var at rτ: the same form, times r differences fewer, for a share scaled by
                    // 1/r (white) or r (walk).
                    let r = f64::from(2 << octave);
                    let rho_white = f.ww / (white * white * r).sqrt() * r;
                    let rho_walk = f.kk / (walk * walk * r).sqrt() / r;
                    assert!(rho_white > 0.0 && rho_white < last.0, "{difference:?} {rho_white}");
                    assert!(rho_walk > 0.0 && rho_walk < last.1, "{difference:?} {rho_walk}");
                    last = (rho_white, rho_walk);
                }
            }
        }
    }
}
