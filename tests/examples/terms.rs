//! How many of twenty records of each noise term lie in the 99.9 % band of its Allan variance, at
//! every octave, in `f64` and `f32`:
//!
//! ```text
//! cargo run --release -p imu-tests --example terms
//! ```
//!
//! The band is that of χ² with the equivalent degrees of freedom of the term's own correlations
//! (`imu_tests::allan_bands`): exact for white noise, close for the rest.

use imu_core::noise::Normal;
use imu_tests::allan_bands::{DT, OCTAVES, SEEDS, allan, bands, cases};
use statrs::distribution::{ChiSquared, ContinuousCDF};

fn main() {
    println!("Records of {SEEDS} within the 99.9 % band; τ in seconds.\n");
    let (inside, all) = [scalar::<f64>("f64"), scalar::<f32>("f32")]
        .into_iter()
        .fold((0, 0), |(a, b), (c, d)| (a + c, b + d));
    let share = 100.0 * inside as f64 / all as f64;
    println!("{inside} of {all}, {share:.2} %; expected 99.9 %");
}

/// Prints a scalar's table; how many lie within, and of how many.
fn scalar<T: Normal>(name: &str) -> (u64, u64) {
    print!("{name:31}");
    for octave in 0..OCTAVES {
        print!(" {:>5.4}", format!("{:.2}", f64::from(1 << octave) * DT));
    }
    println!();
    let (mut total, mut count) = (0, 0);
    for case in cases::<T>() {
        let mut inside = [0; OCTAVES];
        let bounds: Vec<(f64, f64)> = bands(&case.autocovariance)
            .into_iter()
            .map(|band| {
                let law = ChiSquared::new(band.edf).expect("above zero");
                let at = |chance| law.inverse_cdf(chance) / band.edf * band.variance;
                (at(0.0005), at(0.9995))
            })
            .collect();
        for seed in 0..SEEDS {
            let variances = allan(&(case.record)(seed));
            for ((inside, (low, high)), v) in inside.iter_mut().zip(&bounds).zip(variances) {
                *inside += u64::from(*low < v && v < *high);
            }
        }
        print!("{:31}", case.name);
        for inside in inside {
            print!(" {inside:>5}");
            total += inside;
            count += SEEDS;
        }
        println!();
    }
    println!();
    (total, count)
}
