//! The χ² distribution with any positive number of degrees of freedom: both tails and the quantile.
//!
//! Allan variances follow it with *equivalent* degrees of freedom, which are seldom whole numbers
//! and run from about 1 to 10¹²; confidence intervals need its quantiles.
//!
//! Up to 1000 degrees of freedom: the regularised incomplete gamma functions P(a, x), Q(a, x) with
//! a = ν/2, by their power series (Abramowitz & Stegun 1964, 6.5.29) or continued fraction (6.5.31,
//! in its contracted form, by Lentz's method), and Newton's method on ln P or ln Q as a function of
//! ln x. Both are concave there (the density of ln x is log-concave), so Newton's method started
//! from a bound of the quantile closes in on it from one side and cannot escape; the bounds are
//! P ≤ xᵃ/Γ(a+1) and those of Laurent & Massart (2000), lemma 1. Above 1000: Temme's (1992) uniform
//! asymptotic inversion, where the normal quantile it needs is a χ² quantile of one degree.
//!
//! Measured against 40-digit arithmetic for ν from 0.1 to 10¹²: quantiles to 9e-12 (worst at
//! ν = 0.1; 1e-14 from 7 on) up to ν = 1000 and 6e-10 beyond for tails down to 1e-30 (2e-8 at
//! 1e-300); at most 9 Newton steps of at most 202 terms.
//!
//! ```
//! use imu_core::allan::{chi_square_quantile, chi_square_tails};
//! let x = chi_square_quantile(0.95, 7.5);
//! assert!((x - 14.791_162_353_526).abs() < 1e-10);
//! let (lower, upper) = chi_square_tails(x, 7.5);
//! assert!((lower - 0.95).abs() < 1e-12 && (upper - 0.05).abs() < 1e-12);
//! ```

/// Above this many degrees of freedom the asymptotic forms serve.
const ASYMPTOTIC: f64 = 1000.0;
/// Probabilities below this are taken as this one.
const TINY: f64 = 1e-300;

/// Probabilities that a χ² variable with `degrees` of freedom is below and above `x`:
/// (lower, upper), each with full relative precision in its own tail.
///
/// Relative error of the smaller tail: 1e-11 up to 1000 degrees of freedom; beyond, 2e-7 for tails
/// down to 1e-30, and 0 stands for tails below 1e-300. NaN where `x` is NaN or `degrees` is not positive.
#[must_use]
pub fn chi_square_tails(x: f64, degrees: f64) -> (f64, f64) {
    if x.is_nan() || degrees.is_nan() || degrees <= 0.0 {
        (f64::NAN, f64::NAN)
    } else if x <= 0.0 {
        (0.0, 1.0)
    } else if x == f64::INFINITY {
        (1.0, 0.0)
    } else if degrees <= ASYMPTOTIC {
        let (lower, upper, _) = gamma_tails(0.5 * degrees, libm::log(0.5 * x));
        (lower, upper)
    } else {
        let a = 0.5 * degrees;
        let excess = (x - degrees) / degrees;
        let eta = deviance_root(excess);
        if eta * eta * a > 1400.0 {
            // Beyond 37 standard deviations: a tail below 1e-300.
            return if eta < 0.0 { (0.0, 1.0) } else { (1.0, 0.0) };
        }
        // Temme's η(η₀) = η₀ + ε(η₀)/a undone; ε changes by less than a/10⁴ of its argument.
        let mut normal = eta;
        for _ in 0..4 {
            normal = eta - temme_shift(normal, a);
        }
        let (_, beyond, _) = gamma_tails(0.5, libm::log(0.5 * a * normal * normal));
        let outer = 0.5 * beyond;
        if normal < 0.0 { (outer, 1.0 - outer) } else { (1.0 - outer, outer) }
    }
}

/// The value that a χ² variable with `degrees` of freedom stays below with probability
/// `probability`.
///
/// Relative error below 1e-11 from 0.1 to 1000 degrees of freedom and 1e-9 beyond, for tails down to
/// 1e-30 (beyond 1000 degrees 3e-8 at 1e-300; smaller tails are taken as 1e-300). 0 at probability 0, and where the value is
/// below the smallest floating-point number (few degrees of freedom); infinite at probability 1.
/// NaN where `probability` is outside 0…1 or `degrees` is not positive.
#[must_use]
pub fn chi_square_quantile(probability: f64, degrees: f64) -> f64 {
    let valid = (0.0..=1.0).contains(&probability) && degrees > 0.0;
    if !valid {
        f64::NAN
    } else if probability == 0.0 {
        0.0
    } else if probability == 1.0 || degrees == f64::INFINITY {
        f64::INFINITY
    } else if degrees <= ASYMPTOTIC {
        2.0 * gamma_quantile(0.5 * degrees, probability, 1.0 - probability)
    } else {
        let a = 0.5 * degrees;
        let outer = probability.min(1.0 - probability);
        let squared = 2.0 * gamma_quantile(0.5, 1.0 - 2.0 * outer, 2.0 * outer);
        let normal = libm::copysign(libm::sqrt(squared), probability - 0.5) / libm::sqrt(a);
        degrees * (1.0 + excess_at(normal + temme_shift(normal, a)))
    }
}

/// ln Γ(a + 1) for a > 0: Stirling's series after a shift by ten; absolute error 4e-13 + 2e-16·|lnΓ|.
fn ln_gamma_1p(a: f64) -> f64 {
    let mut product = 1.0;
    let mut b = a + 1.0;
    for _ in 0..10 {
        product *= b;
        b += 1.0;
    }
    let z = 1.0 / (b * b);
    let series = (1.0 / 12.0 - z * (1.0 / 360.0 - z * (1.0 / 1260.0 - z / 1680.0))) / b;
    const HALF_LN_2PI: f64 = 0.918_938_533_204_672_8;
    (b - 0.5) * libm::log(b) - b + HALF_LN_2PI + series - libm::log(product)
}

/// P(a, x), Q(a, x) and x·dP/dx at x = exp(`ln_x`), for 0 < a ≤ 500.
fn gamma_tails(a: f64, ln_x: f64) -> (f64, f64, f64) {
    let x = libm::exp(ln_x);
    // xᵃ e⁻ˣ / Γ(a + 1)
    let head = libm::exp(a * ln_x - x - ln_gamma_1p(a));
    let slope = a * head;
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0, 1.0, a);
        for _ in 0..300 {
            n += 1.0;
            term *= x / n;
            sum += term;
            if term < 1e-17 * sum {
                break;
            }
        }
        let lower = (head * sum).min(1.0);
        (lower, 1.0 - lower, slope)
    } else {
        // 1/(x+1−a − 1(1−a)/(x+3−a − 2(2−a)/(x+5−a − …)))
        let mut b = x + 1.0 - a;
        let mut d = 1.0 / b;
        let mut c = f64::INFINITY;
        let mut fraction = d;
        let mut i = 0.0;
        for _ in 0..300 {
            i += 1.0;
            let numerator = -i * (i - a);
            b += 2.0;
            d = 1.0 / (numerator * d + b);
            c = b + numerator / c;
            let factor = c * d;
            fraction *= factor;
            if (factor - 1.0).abs() < 1e-16 {
                break;
            }
        }
        let upper = (slope * fraction).min(1.0);
        (1.0 - upper, upper, slope)
    }
}

/// x with P(a, x) = `lower` and Q(a, x) = `upper`, which add up to 1, for 0 < a ≤ 500.
fn gamma_quantile(a: f64, lower: f64, upper: f64) -> f64 {
    let by_lower = lower < upper;
    let tail = lower.min(upper).max(TINY);
    let ln_tail = libm::log(tail);
    let spread = libm::sqrt(-2.0 * a * ln_tail);
    let mut ln_x = if by_lower {
        let power = (ln_tail + ln_gamma_1p(a)) / a;
        let chernoff = a - spread;
        if chernoff > 0.0 { libm::log(chernoff).max(power) } else { power }
    } else {
        libm::log(a + spread - ln_tail)
    };
    for _ in 0..20 {
        let (p, q, slope) = gamma_tails(a, ln_x);
        let step = if by_lower {
            (ln_tail - libm::log(p)) * p / slope
        } else {
            (libm::log(q) - ln_tail) * q / slope
        };
        // A tail that has left the range of numbers ends the search where it stands.
        if !step.is_finite() {
            break;
        }
        ln_x += step;
        // Convergence is quadratic: the error left is of the order of a·step².
        if step.abs() < 1e-9 {
            break;
        }
    }
    libm::exp(ln_x)
}

/// η of λ = 1 + `excess`: ½η² = λ − 1 − ln λ, with the sign of `excess` (Temme 1992).
fn deviance_root(excess: f64) -> f64 {
    let half_square = excess - libm::log1p(excess);
    libm::copysign(libm::sqrt((2.0 * half_square).max(0.0)), excess)
}

/// λ − 1 at η: the inverse of [`deviance_root`].
fn excess_at(eta: f64) -> f64 {
    let mut t = eta
        * (1.0
            + eta * (1.0 / 3.0 + eta * (1.0 / 36.0 - eta * (1.0 / 270.0 - eta * (1.0 / 4320.0)))));
    if eta.abs() < 0.02 {
        return t;
    }
    // Newton on t − ln(1 + t) = ½η²; the function is convex, so only the first step can overshoot.
    // No |η| above 1.7 comes here, so the series starts close to the root and far from −1.
    for _ in 0..6 {
        t -= (t - libm::log1p(t) - 0.5 * eta * eta) * (1.0 + t) / t;
    }
    t
}

/// ε₁(η)/a + ε₂(η)/a²: from the normal quantile over √a to Temme's η; series of 1992, checked against
/// 60-digit quantiles.
fn temme_shift(eta: f64, a: f64) -> f64 {
    let first = if eta.abs() < 0.02 {
        -1.0 / 3.0 + eta * (1.0 / 36.0 + eta * (1.0 / 1620.0 - eta * (7.0 / 6480.0)))
    } else {
        libm::log(eta / excess_at(eta)) / eta
    };
    let second = -7.0 / 405.0 - eta * (7.0 / 2592.0 - eta * (533.0 / 204_120.0));
    (first + second / a) / a
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (probability, degrees, quantile) by 40-digit arithmetic, each line from
    /// python3 -c "from mpmath import *; mp.dps=40; p,v=mpf(P),mpf(V);
    /// print(nstr(findroot(lambda x: gammainc(v/2,0,x/2,regularized=True)-p, X), 17))"
    /// with X = scipy.stats.chi2.ppf(P, V); those above 1000 degrees with the integral by quadrature.
    const QUANTILES: &[(f64, f64, f64)] = &[
        (0.05, 0.1, 1.114_775_096_375_756_4e-26),
        (0.95, 0.1, 0.531_864_604_851_682),
        (1e-10, 1.0, 1.570_796_326_794_896_8e-20),
        (0.05, 1.0, 0.003_932_140_000_019_523),
        (0.95, 1.0, 3.841_458_820_694_124_5),
        (0.05, 2.7, 0.263_588_574_957_926_65),
        (0.5, 2.7, 2.070_302_460_548_43),
        (0.999_999_9, 2.7, 34.498_920_249_468_85),
        (0.025, 7.5, 1.930_588_620_610_998_8),
        (0.95, 7.5, 14.791_162_353_525_857),
        (1e-30, 31.4, 0.165_046_162_509_305_34),
        (0.05, 31.4, 19.596_703_388_676),
        (0.95, 31.4, 45.469_314_957_149_15),
        (0.05, 250.25, 214.623_168_098_262_85),
        (0.95, 250.25, 288.149_903_950_846_75),
        (1e-10, 1000.0, 741.268_071_719_353),
        (0.3, 1000.0, 976.073_591_257_774_2),
        (0.9999, 1000.0, 1_174.933_496_584_160_4),
        (1e-10, 1000.5, 741.697_104_143_772_3),
        (0.05, 1000.5, 928.075_970_974_078_4),
        (0.95, 1000.5, 1_075.197_840_973_438),
        (0.05, 20_000.0, 19_672.170_221_710_385),
        (0.999, 20_000.0, 20_623.750_449_079_074),
        (1e-10, 1e9, 999_715_538.496_859_9),
        (0.05, 1e9, 999_926_441.046_588_5),
        (0.95, 1e9, 1_000_073_561.227_469_4),
        (0.05, 1e12, 999_997_673_826.829_7),
        (0.5, 1e12, 999_999_999_999.333_4),
        (0.9999, 1e12, 1_000_005_259_492.106_4),
    ];

    #[test]
    fn quantiles_equal_those_of_multiple_precision_arithmetic() {
        for &(p, degrees, x) in QUANTILES {
            let got = chi_square_quantile(p, degrees);
            // As documented; what follows from rounding the probability itself is far below.
            let allowed = if degrees <= 1000.0 { 1e-11 } else { 1e-9 };
            assert!((got / x - 1.0).abs() < allowed, "p = {p}, ν = {degrees}: {got}, not {x}");
        }
    }

    #[test]
    fn two_degrees_of_freedom_are_an_exponential_law() {
        for p in [1e-300, 1e-30, 1e-9, 0.02, 0.5, 0.77, 0.999_999, 1.0 - 1e-14] {
            let x = -2.0 * libm::log1p(-p);
            assert!((chi_square_quantile(p, 2.0) / x - 1.0).abs() < 1e-11);
            let (lower, upper) = chi_square_tails(x, 2.0);
            assert!((lower / p - 1.0).abs() < 1e-11);
            assert!((upper / (1.0 - p) - 1.0).abs() < 1e-11);
        }
    }

    #[test]
    fn tails_undo_quantiles_over_the_whole_range() {
        let mut degrees = 0.1;
        while degrees < 1.1e12 {
            for p in [1e-30, 1e-12, 1e-3, 0.05, 0.4999, 0.5, 0.5001, 0.95, 0.999, 1.0 - 1e-12] {
                let x = chi_square_quantile(p, degrees);
                if x < f64::MIN_POSITIVE {
                    // Subnormal: digits are gone.
                    continue;
                }
                let (lower, upper) = chi_square_tails(x, degrees);
                // A relative error e of x is √(ν/2) e standard deviations, and a tail changes by
                // at most 12 of its parts per standard deviation (at 1e-30).
                let rounding = 12.0 * libm::sqrt(0.5 * degrees) * 4e-16;
                let stated = if degrees <= 1000.0 { 1e-11 } else { 2e-7 };
                let allowed = 3.0 * stated + rounding;
                let (tail, want) = if p < 0.5 { (lower, p) } else { (upper, 1.0 - p) };
                assert!((tail / want - 1.0).abs() < allowed, "p = {p}, ν = {degrees}: {tail}");
                assert!((lower + upper - 1.0).abs() < 1e-15);
            }
            degrees *= 1.9;
        }
    }

    #[test]
    fn quantile_grows_with_probability_across_the_asymptotic_border() {
        for degrees in [0.1, 1.0, 999.9, 1000.0, 1000.1, 1e6] {
            let mut last = 0.0;
            for k in 1..2000 {
                let x = chi_square_quantile(f64::from(k) / 2000.0, degrees);
                assert!(x > last);
                last = x;
            }
        }
        let step = chi_square_quantile(0.05, 1_000.000_001) - chi_square_quantile(0.05, 1000.0);
        // The slope of the quantile in ν is below 1; 1e-9 of 930 is allowed on the upper side.
        assert!(step.abs() < 1e-6 + 1e-6);
    }

    #[test]
    fn edges_and_arguments_out_of_range() {
        assert_eq!(chi_square_quantile(0.0, 3.0), 0.0);
        assert_eq!(chi_square_quantile(1.0, 3.0), f64::INFINITY);
        assert_eq!(chi_square_quantile(1e-300, 0.1), 0.0);
        assert!(chi_square_quantile(f64::MIN_POSITIVE, 7.0) > 0.0);
        assert!(chi_square_quantile(f64::from_bits(1), 1e7).is_finite());
        assert_eq!(chi_square_quantile(0.3, f64::INFINITY), f64::INFINITY);
        for (p, degrees) in [(-0.1, 1.0), (1.1, 1.0), (f64::NAN, 1.0), (0.5, 0.0), (0.5, f64::NAN)]
        {
            assert!(chi_square_quantile(p, degrees).is_nan());
        }
        for degrees in [0.1, 5.0, 1e7] {
            assert_eq!(chi_square_tails(0.0, degrees), (0.0, 1.0));
            assert_eq!(chi_square_tails(-1.0, degrees), (0.0, 1.0));
            assert_eq!(chi_square_tails(f64::INFINITY, degrees), (1.0, 0.0));
            assert_eq!(chi_square_tails(1e300, degrees).1, 0.0);
            assert!(chi_square_tails(f64::NAN, degrees).0.is_nan());
        }
        assert!(chi_square_tails(1.0, -1.0).0.is_nan());
    }
}
