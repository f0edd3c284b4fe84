//! Published Allan and Hadamard deviations, to every digit printed.
//!
//! Source: W. J. Riley, "Handbook of Frequency Stability Analysis", NIST Special Publication 1065
//! (2008), pp. 107-108: the "NBS14" set of 10 phase points (9 frequencies), and the set of 1000
//! frequencies from a prime-modulus generator. Printed to 7 digits, of which the last may be one off:
//! 2e-7.

use imu_core::allan::Difference::{self, Allan, Hadamard};
use imu_tools::calibrate::batch::Batch;

/// Printed digits are good to this part.
const PRINTED: f64 = 2e-7;

/// The deviation's name, its difference, whether windows overlap, and its values at each τ.
type Row<const N: usize> = (&'static str, Difference, bool, [f64; N]);

/// Nine frequencies, one a second.
const NINE: [f64; 9] = [892.0, 809.0, 823.0, 798.0, 671.0, 644.0, 883.0, 903.0, 677.0];

const NINE_TAU: [usize; 2] = [1, 2];
const NINE_DEVIATIONS: [Row<2>; 4] = [
    ("ADEV", Allan, false, [91.22945, 115.8082]),
    ("OADEV", Allan, true, [91.22945, 85.95287]),
    ("HDEV", Hadamard, false, [70.80608, 116.7980]),
    ("OHDEV", Hadamard, true, [70.80607, 85.61487]),
];

const THOUSAND_TAU: [usize; 3] = [1, 10, 100];
const THOUSAND_DEVIATIONS: [Row<3>; 4] = [
    ("ADEV", Allan, false, [0.2922319, 0.09965736, 0.03897804]),
    ("OADEV", Allan, true, [0.2922319, 0.09159953, 0.03241343]),
    ("HDEV", Hadamard, false, [0.2943883, 0.1052754, 0.03910860]),
    ("OHDEV", Hadamard, true, [0.2943883, 0.09581083, 0.03237638]),
];

/// A thousand frequencies: n ← 16807 n mod (2³¹ − 1), y = n/(2³¹ − 1), from n = 1234567890.
fn thousand() -> Vec<f64> {
    let mut n = 1_234_567_890_u64;
    (0..1000)
        .map(|_| {
            let y = n as f64 / 2_147_483_647.0;
            n = 16_807 * n % 2_147_483_647;
            y
        })
        .collect()
}

fn check_batch<const N: usize>(values: &[f64], taus: [usize; N], table: &[Row<N>]) {
    let batch = Batch::new(values).unwrap();
    for (name, difference, overlapped, printed) in table {
        for (m, want) in taus.into_iter().zip(printed) {
            let stride = if *overlapped { 1 } else { m };
            let got = batch.reading(*difference, m, stride).unwrap().deviation();
            assert!((got / want - 1.0).abs() < PRINTED, "{name} at {m}: {got}, printed {want}");
        }
    }
}

#[test]
fn batch_prints_the_nine_frequencies_deviations() {
    check_batch(&NINE, NINE_TAU, &NINE_DEVIATIONS);
}

#[test]
fn batch_prints_the_thousand_frequencies_deviations() {
    check_batch(&thousand(), THOUSAND_TAU, &THOUSAND_DEVIATIONS);
}

/// Over 2^k samples, Allan variances over disjoint *pairs* of blocks are the energies of the Haar
/// wavelet transform (m·AVAR·n/m squares of unit wavelets): they sum to twice the record's variance.
#[test]
fn octaves_of_disjoint_pairs_sum_to_twice_the_variance() {
    for n in [2, 4, 64, 512] {
        let values = &thousand()[..n];
        let batch = Batch::new(values).unwrap();
        let sum: f64 =
            batch.octaves(Allan).map(|m| batch.reading(Allan, m, 2 * m).unwrap().variance).sum();
        let mean = values.iter().sum::<f64>() / n as f64;
        let variance = values.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n as f64;
        // n roundings of 1.1e-16 in the oracle's sums.
        assert!((sum / (2.0 * variance) - 1.0).abs() < 1e-13, "{n}: {sum}, {variance}");
    }
}
