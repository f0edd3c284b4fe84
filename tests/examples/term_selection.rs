//! The choice of terms by Monte Carlo: how often B, Q and R are added where they are not, and found where they are, how
//! far their values scatter, and whether the curve of all five lies within the bands.
//!
//! ```text
//! cargo run --release -p imu-tests --example term_selection -- [RECORDS] [PART]
//! ```
//!
//! 500 records, and all parts (`null`, `ratio`, `filter`, `flicker`, `quantisation`, `ramp`, `every`), unless told
//! otherwise. Records are of one axis, 4 h at 20 Hz: what is chosen knows K·T/N and, of quantisation, the number of
//! samples, but not the rate. A share p of n scatters by √(p(1 − p)/n), an rms error by 1/√(2n) of itself.

use imu_core::allan::{Parameter, Terms, TermsFit, likelihood_ratio, select_terms};
use imu_tests::monte_carlo::scatter;
use imu_tests::term_records::{
    ACCELEROMETER, GYROSCOPE, Truth, chosen, each, estimates, selections,
};
use statrs::distribution::{ChiSquared, ContinuousCDF};

const CASES: [(&str, Truth); 2] = [("N/K = 300 s", GYROSCOPE), ("N/K = 38 s", ACCELEROMETER)];

fn main() {
    let mut arguments = std::env::args().skip(1);
    let records = arguments.next().map_or(500, |n| n.parse().expect("a number of records"));
    let part = arguments.next();
    let wanted = |name: &str| part.as_deref().is_none_or(|part| part == name);
    for (name, truth) in CASES {
        if wanted("null") {
            added(&format!("{name}: white noise and random walk"), &truth, records);
        }
        if wanted("ratio") {
            ratio(name, &truth, records);
        }
        if wanted("filter") {
            for hz in [9.2, 4.2, 2.0] {
                let truth = Truth { lowpass_hz: hz, ..truth };
                added(
                    &format!("{name}, low-pass of {:.2} of the rate", hz / 20.0),
                    &truth,
                    records,
                );
            }
        }
        if wanted("flicker") {
            for times in [1.0, 2.0, 3.0] {
                let truth = truth.with_flicker(times);
                let fits =
                    added(&format!("{name}: flat at {times} × the minimum"), &truth, records);
                value("B", &fits, |f| f.bias_instability, truth.bias_instability);
                value("K", &fits, |f| Some(f.random_walk), truth.random_walk);
            }
        }
        if wanted("quantisation") {
            for share in [0.02, 0.1, 10.0] {
                let truth = truth.with_quantisation(share);
                let what = format!("{name}: Q of {share} × white noise's variance at one sample");
                let fits = added(&what, &truth, records);
                value("Q", &fits, |f| f.quantisation, truth.quantisation);
            }
        }
        if wanted("ramp") {
            for times in [5.0, 10.0, 30.0] {
                let truth = truth.with_ramp(times);
                let what = format!("{name}: R that goes {times} × as far as the walk");
                let fits = added(&what, &truth, records);
                value("R", &fits, |f| f.rate_ramp, truth.rate_ramp);
            }
        }
        if wanted("every") {
            every(name, &truth, records);
        }
    }
}

/// Prints how often each term is chosen.
fn added(what: &str, truth: &Truth, records: u64) -> Vec<TermsFit> {
    let fits = selections(truth, 1, records);
    let [q, b, r] = chosen(&fits);
    let misfits = fits.iter().filter(|fit| fit.misfit).count();
    println!("{what}: of {records} records Q in {q}, B in {b}, R in {r}; misfits {misfits}");
    fits
}

/// Prints how the estimates of a term scatter where it was chosen.
fn value(name: &str, fits: &[TermsFit], of: impl Fn(&TermsFit) -> Option<Parameter>, truth: f64) {
    let found = estimates(fits, of);
    let s = scatter(found.iter().copied(), truth);
    let near = found.iter().filter(|p| match p {
        Parameter::Observable { value, .. } => (value / truth - 1.0).abs() <= 0.15,
        Parameter::NotObservable { .. } => false,
    });
    println!(
        "  {name}: {} estimates, rms {:.1} %, median {:+.1} %, within 15 %: {:.1} %, interval holds {:.1} %, \
         not observable {}",
        s.count,
        100.0 * s.rms,
        100.0 * s.median,
        100.0 * near.count() as f64 / s.count.max(1) as f64,
        100.0 * s.coverage,
        s.not_observable
    );
}

/// Prints the law of the likelihood-ratio statistics where there is nothing but N and K.
fn ratio(name: &str, truth: &Truth, records: u64) {
    let none = Terms::default();
    println!(
        "{name}: −2 ln of the likelihood ratio; ½χ²₀ + ½χ²₁ has 99 % below 5.4, 99.9 % below 9.5"
    );
    for (letter, terms) in [
        ("Q", Terms { quantisation: true, ..none }),
        ("B", Terms { bias_instability: true, ..none }),
        ("R", Terms { rate_ramp: true, ..none }),
    ] {
        let mut all = each(truth, 1, records, |octaves| {
            likelihood_ratio(octaves, truth.sampling(), 0, none, terms)
        });
        all.sort_by(f64::total_cmp);
        let below = |part: f64| all[((part * all.len() as f64) as usize).min(all.len() - 1)];
        println!(
            "  {letter}: zero {:.0} %, 90 % below {:.1}, 99 % {:.1}, 99.8 % {:.1}, all {:.1}",
            100.0 * all.iter().filter(|x| **x < 0.01).count() as f64 / all.len() as f64,
            below(0.9),
            below(0.99),
            below(0.998),
            below(1.0)
        );
    }
}

/// Prints how often the fitted curve lies within the intervals of the octaves where there are all five terms.
fn every(name: &str, truth: &Truth, records: u64) {
    let truth = truth.with_flicker(3.0).with_quantisation(10.0).with_ramp(100.0);
    let outcomes = each(&truth, 1, records, |octaves| {
        let sampling = truth.sampling();
        let fit = select_terms(octaves, sampling);
        let usable = octaves.iter().filter(|o| o.differences >= 6);
        let inside: Vec<bool> = usable
            .map(|octave| {
                let edf = fit.degrees(octave, sampling);
                let law = ChiSquared::new(edf).expect("above zero");
                let ratio = octave.variance / fit.variance(octave, sampling);
                // 99.9 % of octaves of the true curve.
                let [low, high] = [0.0005, 0.9995].map(|p| law.inverse_cdf(p) / edf);
                low < ratio && ratio < high
            })
            .collect();
        (fit, inside)
    });
    let fits: Vec<TermsFit> = outcomes.iter().map(|(fit, _)| *fit).collect();
    let all = fits.iter().filter(|fit| fit.terms == Terms::ALL).count();
    let whole = outcomes.iter().filter(|(_, inside)| inside.iter().all(|inside| *inside)).count();
    let octaves: usize = outcomes.iter().map(|(_, inside)| inside.len()).sum();
    let inside = outcomes.iter().flat_map(|(_, inside)| inside).filter(|inside| **inside).count();
    println!(
        "{name}: Q, N, B, K and R together: all five chosen in {all} of {records} records; the curve within the \
         99.9 % bands at every τ in {whole}, at {inside} of {octaves} τ in all"
    );
    value("Q", &fits, |f| f.quantisation, truth.quantisation);
    value("B", &fits, |f| f.bias_instability, truth.bias_instability);
    value("R", &fits, |f| f.rate_ramp, truth.rate_ramp);
}
