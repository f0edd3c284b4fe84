//! `imu_core::allan`: χ² tails and quantiles, equivalent degrees of freedom, intervals.

use crate::{Report, repeat};
use core::hint::black_box;
use imu_core::allan::{Difference, Mixture, chi_square_quantile, chi_square_tails, edf, interval};

/// Degrees of freedom from fewer than one to more than the series are for.
const DEGREES: [f64; 9] = [0.1, 0.5, 1.0, 2.7, 9.0, 40.0, 999.0, 1001.0, 1e6];

/// Tails and quantiles over degrees and probabilities, the ends of the range included.
pub fn chi_square(report: &mut dyn Report) {
    for degrees in DEGREES {
        let degrees = black_box(degrees);
        for ratio in [0.0, 0.01, 0.5, 1.0, 1.3, 4.0, 50.0] {
            let (lower, upper) = chi_square_tails(ratio * degrees, degrees);
            report.real(lower);
            report.real(upper);
        }
        for probability in [0.0, 1e-30, 0.01, 0.05, 0.5, 0.95, 0.99, 1.0 - 1e-12, 1.0] {
            report.real(chi_square_quantile(probability, degrees));
        }
    }
    for bad in [f64::NAN, -1.0, 2.0, f64::INFINITY] {
        report.real(chi_square_quantile(black_box(bad), 3.0));
        report.real(chi_square_quantile(0.5, black_box(-bad)));
    }
    let degrees = black_box(9.0);
    report.instructions("χ² quantile", 16, &mut || {
        repeat(16, || chi_square_quantile(black_box(0.05), degrees));
    });
}

/// Degrees of freedom of both differences over strides, blocks and mixtures; intervals.
pub fn degrees_of_freedom(report: &mut dyn Report) {
    let mixtures = [
        Mixture { white: 1.0, flicker: 0.0, random_walk: 0.0 },
        Mixture { white: 0.0, flicker: 1.0, random_walk: 0.0 },
        Mixture { white: 0.0, flicker: 0.0, random_walk: 1.0 },
        Mixture { white: 1.0, flicker: 0.3, random_walk: 1e-3 },
        Mixture { white: -1.0, flicker: f64::NAN, random_walk: f64::INFINITY },
    ];
    for difference in [Difference::Allan, Difference::Hadamard] {
        for mixture in mixtures {
            for (block, stride) in [(1, 1), (2, 1), (2, 2), (64, 16), (64, 64), (1 << 20, 1 << 18)]
            {
                for differences in [0, 1, 2, 7, 100, 1 << 40] {
                    report.real(edf(difference, block, stride, differences, black_box(mixture)));
                }
            }
        }
    }
    for degrees in DEGREES {
        let (low, high) = interval(black_box(2.5), degrees, 0.9);
        report.real(low);
        report.real(high);
    }
    let mixture = black_box(Mixture { white: 1.0, flicker: 0.0, random_walk: 0.5 });
    report.instructions("edf at stride m/4", 4, &mut || {
        repeat(4, || edf(Difference::Allan, 1024, 256, black_box(1000), mixture));
    });
}
