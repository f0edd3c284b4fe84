//! How octaves of any mixture of noises scatter, and how neighbouring ones do so together.
//!
//! The sums of [`edf`](crate::allan::edf) and of [`correlation`](super::super::correlation), for four noises at
//! once. Both follow from the generalised covariance g of a noise's integral (Greenhall & Riley 2003): |x| (white),
//! |x|³ (random walk), x² ln|x| (flicker), and 1 at x = 0, else 0, for the error of a quantised integral, which is new
//! at every sample. Blocks start every quarter of τ at most, so g is wanted at quarters of a block only, and the
//! compiler makes the tables: no logarithm is left to compute. A flicker's correlation never ends, and is cut at 8
//! blocks, where it leaves 2e-4 of a variance.
//!
//! A random walk sampled once a step is one in continuous time with a little white noise (K²τ/6m², Hadamard the same),
//! and is passed here as those two. Cost: at most 31 terms an octave.

use super::super::Difference;

/// Variances of an octave by their noise: quantisation, white noise, flicker, random walk.
pub(super) type Shares = [f64; 4];

/// Lags of a quarter block that are summed.
const LAGS: usize = 32;
/// Lags of which g is tabulated: those of τ against 4τ, third differences, 8 blocks apart.
const TABLE: usize = 192;

/// Natural logarithm of x > 0, by halving and 2 artanh((f − 1)/(f + 1)): within 1e-15.
const fn ln(x: f64) -> f64 {
    let (mut f, mut twos) = (x, 0.0);
    while f > 1.5 {
        f *= 0.5;
        twos += 1.0;
    }
    while f < 0.75 {
        f *= 2.0;
        twos -= 1.0;
    }
    let z = (f - 1.0) / (f + 1.0);
    let (mut sum, mut power, mut k) = (0.0, z, 1.0);
    while k < 40.0 {
        sum += power / k;
        power *= z * z;
        k += 2.0;
    }
    twos * core::f64::consts::LN_2 + 2.0 * sum
}

/// g of the four noises at lags of a quarter block.
const fn generating() -> [[f64; TABLE]; 4] {
    let mut table = [[0.0; TABLE]; 4];
    table[0][0] = 1.0;
    let mut lag = 1;
    while lag < TABLE {
        let x = lag as f64 * 0.25;
        table[1][lag] = x;
        table[2][lag] = x * x * ln(x);
        table[3][lag] = x * x * x;
        lag += 1;
    }
    table
}

const G: [[f64; TABLE]; 4] = generating();

/// Weights of the phase difference, how many, and ⟨D²⟩ over the variance.
const fn operator(difference: Difference) -> ([f64; 4], i32, f64) {
    match difference {
        Difference::Allan => ([1.0, -2.0, 1.0, 0.0], 3, 2.0),
        Difference::Hadamard => ([1.0, -3.0, 3.0, -1.0], 4, 6.0),
    }
}

/// Σ_p Σ_q a_p a_q g(t + p − q r): covariance of the difference over τ with the one over rτ that starts
/// `quarters` of τ earlier, both of the phase and not scaled.
const fn covariance_of_phase(difference: Difference, noise: usize, quarters: i32, r: i32) -> f64 {
    let (weights, terms, _) = operator(difference);
    let mut sum = 0.0;
    let mut p = 0;
    while p < terms {
        let mut q = 0;
        while q < terms {
            let lag = (quarters + 4 * (p - q * r)).unsigned_abs() as usize;
            sum += weights[p as usize] * weights[q as usize] * G[noise][lag];
            q += 1;
        }
        p += 1;
    }
    sum
}

/// Correlation of two differences over τ, by noise and by lag.
type Correlations = [[f64; LAGS]; 4];

const fn correlations(difference: Difference) -> Correlations {
    let mut table = [[0.0; LAGS]; 4];
    let mut noise = 0;
    while noise < 4 {
        let zero = covariance_of_phase(difference, noise, 0, 1);
        let mut lag = 0;
        while lag < LAGS {
            table[noise][lag] = covariance_of_phase(difference, noise, lag as i32, 1) / zero;
            lag += 1;
        }
        noise += 1;
    }
    table
}

static ALLAN: Correlations = correlations(Difference::Allan);
static HADAMARD: Correlations = correlations(Difference::Hadamard);

/// Covariance of the variance at τ with that at rτ, times the number of differences at τ: a quadratic form in
/// the shares at τ.
type Form = [[f64; 4]; 4];

const fn form(difference: Difference, per_block: i32, r: i32) -> Form {
    let (_, terms, norm) = operator(difference);
    let mut scales = [0.0; 4];
    let mut noise = 0;
    while noise < 4 {
        scales[noise] = norm / covariance_of_phase(difference, noise, 0, 1);
        noise += 1;
    }
    let mut sums = [[0.0; 4]; 4];
    let step = 4 / per_block;
    let mut start = -4 * (terms - 1 + 8 * r);
    while start <= 4 * (terms - 1 + 8) * r {
        let mut at = [0.0; 4];
        let mut noise = 0;
        while noise < 4 {
            at[noise] = scales[noise] * covariance_of_phase(difference, noise, start, r);
            noise += 1;
        }
        let mut a = 0;
        while a < 4 {
            let mut b = 0;
            while b < 4 {
                sums[a][b] += 2.0 / (norm * norm * (r * r) as f64) * at[a] * at[b];
                b += 1;
            }
            a += 1;
        }
        start += step;
    }
    sums
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

static ALLAN_FORMS: Forms = forms(Difference::Allan);
static HADAMARD_FORMS: Forms = forms(Difference::Hadamard);

/// Strides of a block that a ladder of so many windows has at 2^`level` samples, log₂.
const fn strides_log2(windows: u8, level: usize) -> usize {
    match (windows, level) {
        (0 | 1, _) | (_, 0) => 0,
        (_, 1) => 1,
        _ => 2,
    }
}

/// How an octave scatters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spread {
    /// Variance of the octave's variance that is of noise alone.
    pub noise: f64,
    /// That which a ramp adds by what the noise does to its two ends. It is nearly the same motion at every τ.
    pub ramp: f64,
}

/// The scatter of an octave of 2^`level` samples and `differences` differences, of which noises have `shares` and a
/// ramp has `ramp`, in one record.
pub(super) fn spread(
    difference: Difference,
    windows: u8,
    level: usize,
    differences: u64,
    shares: &Shares,
    ramp: f64,
) -> Spread {
    let table = match difference {
        Difference::Allan => &ALLAN,
        Difference::Hadamard => &HADAMARD,
    };
    let [quantisation, white, flicker, walk] = table;
    let total: f64 = shares.iter().sum();
    let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
    let [of_q, of_n, of_b, of_k] = shares.map(|share| share * scale);
    // Lags of one stride: 4, 2 or 1 quarters of a block.
    let shift = 2 - strides_log2(windows, level).min(2);
    // Beyond 2 blocks (3, Hadamard) only a flicker is correlated.
    let reach = if of_b > 0.0 { LAGS } else { 4 * difference.blocks() as usize + 1 };
    let count = differences.max(1) as f64;
    let (mut squares, mut sum) = (0.5, 0.5);
    let rows = quantisation.iter().zip(white).zip(flicker).zip(walk).take(reach);
    for (lag, (((q, n), b), k)) in rows.enumerate().skip(1) {
        let j = lag >> shift;
        if j << shift != lag {
            continue;
        }
        let weight = 1.0 - j as f64 / count;
        if weight <= 0.0 {
            break;
        }
        let r = of_q * q + of_n * n + of_b * b + of_k * k;
        squares += weight * r * r;
        sum += weight * r;
    }
    let edf = (0.5 * count / squares).clamp(1.0, count);
    // ⟨(μ + d)²⟩ of the mean difference μ: 4μ² times the variance of ⟨d⟩, which cannot be below that of a sum
    // of which nothing but the ends is left.
    let mean = (2.0 * sum / count).max(1.0 / (count * count));
    Spread { noise: 2.0 * total * total / edf, ramp: 4.0 * ramp * total * mean }
}

/// Covariance of the variance at 2^`level` samples with that `octaves` above (1 or 2), times the number of
/// differences at the shorter one, of whose variance noises have `shares`.
pub(super) fn covariance(
    difference: Difference,
    windows: u8,
    level: usize,
    octaves: usize,
    shares: &Shares,
) -> f64 {
    let forms = match difference {
        Difference::Allan => &ALLAN_FORMS,
        Difference::Hadamard => &HADAMARD_FORMS,
    };
    let of_stride = forms.get(strides_log2(windows, level));
    let Some(form) = of_stride.and_then(|f| f.get(octaves.wrapping_sub(1))) else { return 0.0 };
    let row = |row: &[f64; 4]| row.iter().zip(shares).map(|(f, share)| f * share).sum::<f64>();
    form.iter().zip(shares).map(|(f, share)| row(f) * share).sum()
}

#[cfg(test)]
mod tests {
    use super::super::super::{Mixture, edf};
    use super::*;

    #[test]
    fn logarithms() {
        for x in [0.25, 0.5, 0.75, 1.0, 1.25, 3.0, 7.75, 47.75] {
            assert!((ln(x) - x.ln()).abs() <= 2e-15 * x.ln().abs().max(1.0), "{x}");
        }
    }

    /// The tables give the degrees of freedom that `edf` works out, for all that it knows.
    #[test]
    fn as_edf_has_it() {
        for difference in [Difference::Allan, Difference::Hadamard] {
            for (windows, level) in [(1, 0), (1, 9), (4, 0), (4, 1), (4, 2), (4, 12)] {
                for differences in [1, 2, 6, 11, 31, 40, 1000, 1 << 40] {
                    for [white, flicker, walk] in
                        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.2, 0.3]]
                    {
                        let m = 1_u64 << level;
                        let m2 = (m * m) as f64;
                        let stride = (m / windows).max(1);
                        let mixture = Mixture { white, flicker, random_walk: walk };
                        let expected = edf(difference, m, stride, differences, mixture);
                        // The walk's sampled part.
                        let part = match difference {
                            Difference::Allan => 0.5 / m2,
                            Difference::Hadamard => 1.0 / m2,
                        };
                        let extra = walk * part / (1.0 + part);
                        let shares = [0.0, white + extra, flicker, walk - extra];
                        let found =
                            spread(difference, windows as u8, level, differences, &shares, 0.0);
                        let found = 2.0 * (white + flicker + walk).powi(2) / found.noise;
                        let off = (found / expected - 1.0).abs();
                        assert!(off < 1e-9, "{difference:?} {windows} {level} {differences} {off}");
                    }
                }
            }
        }
    }

    /// White noise and walk, as the quadratic forms of the fit of N and K have them.
    #[test]
    fn as_the_correlation_of_octaves_has_it() {
        for difference in [Difference::Allan, Difference::Hadamard] {
            for (windows, level) in [(1, 5), (4, 0), (4, 1), (4, 5)] {
                for octaves in [1, 2, 3] {
                    for (white, walk) in [(1.0, 0.0), (0.0, 1.0), (0.4, 0.6)] {
                        let theirs = super::super::super::correlation::covariance(
                            difference, windows, level, octaves, white, walk,
                        );
                        let ours = covariance(
                            difference,
                            windows,
                            level,
                            octaves,
                            &[0.0, white, 0.0, walk],
                        );
                        assert!((ours - theirs).abs() <= 1e-9 * theirs.abs(), "{ours} {theirs}");
                    }
                }
            }
        }
    }

    /// Quantisation by hand: e₀ − 2e₁ + e₂ and its neighbours in disjoint blocks have correlations 1, −2/3, 1/6,
    /// so edf = M/(1 + 2(4/9 + 1/36)) of a long record; at stride τ/4 four such grids side by side.
    #[test]
    fn quantisation() {
        let shares = [1.0, 0.0, 0.0, 0.0];
        let n = 1 << 40;
        for (windows, level) in [(1, 3), (4, 3)] {
            let found = spread(Difference::Allan, windows, level, n, &shares, 0.0);
            let edf = 2.0 / found.noise / n as f64;
            assert!((edf * (1.0 + 17.0 / 18.0) - 1.0).abs() < 1e-9, "{edf}");
        }
    }
}
