//! The statistics of the noise fit, by Monte Carlo: rms error against the limit, median, coverage.
//!
//! `cargo run --release -p imu-tests --example statistics -- [SEEDS] [RATE_HZ]` (200 seeds at 200 Hz
//! are 200 × 5 cases × 4 h: some minutes). Three axes a seed; an rms error of n independent
//! estimates itself scatters by 1/√(2n).

use imu_tests::monte_carlo::{Case, Loss, Scatter, records, scatter};

fn row(name: &str, s: Scatter, limit: f64) {
    println!(
        "  {name:<26} rms {:7.3} % ± {:4.1} %  = {:5.3} × limit   median {:+7.3} %   interval holds {:5.1} % (above {:4.1} %)   not observable {}",
        100.0 * s.rms,
        100.0 / (2.0 * s.count as f64).sqrt(),
        s.rms / limit,
        100.0 * s.median,
        100.0 * s.coverage,
        100.0 * s.above,
        s.not_observable
    );
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<f64>().expect("a number"));
    let seeds = arguments.next().unwrap_or(200.0) as u64;
    let rate_hz = arguments.next().unwrap_or(200.0);
    let gyro = Case {
        noise_density: 0.015,
        random_walk: 5e-5,
        rate_hz,
        duration_s: 4.0 * 3600.0,
        lowpass_hz: None,
        loss: Loss::default(),
    };
    let accel = Case { noise_density: 0.019, random_walk: 5e-4, ..gyro };
    let loss = |probability, hole_s| Loss { probability, hole_s };
    let mut cases = vec![("clean".to_string(), None, Loss::default())];
    for hz in [92.0, 42.0, 20.0] {
        cases.push((
            format!("low-pass {hz} Hz of 200"),
            Some(hz * rate_hz / 200.0),
            Loss::default(),
        ));
    }
    cases.push(("1 % lost".into(), None, loss(0.01, 0.0)));
    cases.push(("60 s hole".into(), None, loss(0.0, 60.0)));
    cases.push(("1 % lost and 60 s hole".into(), None, loss(0.01, 60.0)));
    cases.truncate(arguments.next().map_or(cases.len(), |n| n as usize));
    for (sensor, case) in [("N/K = 300 s", gyro), ("N/K = 38 s", accel)] {
        for (name, lowpass_hz, loss) in &cases {
            let case = Case { lowpass_hz: *lowpass_hz, loss: *loss, ..case };
            let outcomes = records(&case, 1, seeds);
            println!("{sensor}, {name}: {seeds} records of 4 h at {rate_hz} Hz");
            let used = outcomes.iter().flat_map(|o| o.axes).map(|f| f.used.map_or(0, |u| u.0));
            let cut: Vec<usize> = used.collect();
            println!(
                "  shortest octave used: {} to {}, mean {:.2}",
                cut.iter().min().unwrap_or(&0),
                cut.iter().max().unwrap_or(&0),
                cut.iter().sum::<usize>() as f64 / cut.len().max(1) as f64
            );
            let limit_n = 1.0 / (2.0 * case.duration_s * case.rate_hz).sqrt();
            let (n, k) = (case.noise_density, case.random_walk);
            row(
                "K, 4 windows f64",
                scatter(outcomes.iter().flat_map(|o| o.axes).map(|f| f.random_walk), k),
                case.limit(),
            );
            row(
                "K, disjoint f32",
                scatter(outcomes.iter().flat_map(|o| o.small).map(|f| f.random_walk), k),
                case.limit(),
            );
            row(
                "K, three axes pooled",
                scatter(outcomes.iter().map(|o| o.pooled.random_walk), k),
                case.limit() / 3_f64.sqrt(),
            );
            row(
                "N, 4 windows f64",
                scatter(outcomes.iter().flat_map(|o| o.axes).map(|f| f.noise_density), n),
                limit_n,
            );
            row(
                "N, disjoint f32",
                scatter(outcomes.iter().flat_map(|o| o.small).map(|f| f.noise_density), n),
                limit_n,
            );
            row(
                "N, three axes pooled",
                scatter(outcomes.iter().map(|o| o.pooled.noise_density), n),
                limit_n / 3_f64.sqrt(),
            );
        }
    }
}
