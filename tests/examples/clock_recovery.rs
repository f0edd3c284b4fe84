//! How well sample times are recovered from the arrivals of a live sensor's messages.
//!
//! `cargo run --release -p imu-tests --example clock_recovery -- [RUNS]` (200 runs, a tenth of them at 8 kHz and a
//! quarter with losses, take a quarter of an hour):
//! sensors whose clocks are ∓200 ppm off and drift by 3 ppm, on adapters of 16 ms and 1 ms, with stalls of
//! 50 to 300 ms every 30 s. Errors are of stamps, without their mean, between 200 s and 500 s after the
//! start, in per cent of a period. ± is the standard deviation of an rms, by its scatter over runs. Beats are
//! the times that the phase of sensor and adapter went round in a run: with few of them little is known.

use imu_tests::arrivals::{Line, Outcome, clock_ppm};
use imu_tools::live::clock::Source;

const SETTLE_S: f64 = 200.0;
const RUN_S: f64 = 500.0;

/// Beats of a run: none, few, and many.
const BEATS: [(&str, u64, u64); 4] =
    [("0", 0, 0), ("1-3", 1, 3), ("> 3", 4, u64::MAX), ("all", 0, u64::MAX)];

fn outcomes(line: Line, runs: u64) -> Vec<Outcome> {
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    let part = |first: u64| {
        let seeds = (first..runs).step_by(threads as usize);
        let ppm = |seed| clock_ppm(seed, runs);
        let run = |seed| Line { clock_ppm: ppm(seed), ..line }.run(seed, SETTLE_S, RUN_S);
        seeds.map(run).collect::<Vec<_>>()
    };
    std::thread::scope(|scope| {
        let parts: Vec<_> = (0..threads).map(|first| scope.spawn(move || part(first))).collect();
        parts.into_iter().flat_map(|part| part.join().expect("a run")).collect()
    })
}

/// Root mean square, and its standard deviation.
fn rms(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().map(|v| v * v).sum::<f64>() / n;
    let variance = values.iter().map(|v| (v * v - mean).powi(2)).sum::<f64>() / n;
    (mean.sqrt(), 0.5 * (variance / n / mean).sqrt())
}

fn errors(line: Line, runs: u64) {
    let all = outcomes(line, runs);
    for (name, least, most) in BEATS {
        let some: Vec<&Outcome> =
            all.iter().filter(|o| (least..=most).contains(&o.beats)).collect();
        if some.is_empty() {
            continue;
        }
        let percent = |of: fn(&Outcome) -> f64| -> Vec<f64> {
            some.iter().map(|o| 100.0 * of(o) * line.rate_hz).collect()
        };
        let mut each = percent(|o| o.error_s);
        let spacing = percent(|o| o.spacing_s);
        let (error, error_sd) = rms(&each);
        each.sort_by(f64::total_cmp);
        let at = |part: f64| each[((each.len() - 1) as f64 * part) as usize];
        let covered = some.iter().filter(|o| o.rate_z.abs() <= 3.0).count();
        let z: Vec<f64> = some.iter().map(|o| o.rate_z).collect();
        let rate_sd: Vec<f64> =
            some.iter().map(|o| 1e6 * o.status.rate_sd_hz / line.rate_hz).collect();
        println!(
            "| {:?} | {} | {} | {name} | {} | {:.2} | {:.2} | {error:.2} ± {error_sd:.2} | {:.5} | {:.3} | {:.2} | {:.1} | {} |",
            line.source,
            line.rate_hz,
            line.frame_s * 1e3,
            some.len(),
            at(0.5),
            at(0.9),
            rms(&spacing).0,
            rms(&rate_sd).0,
            rms(&z).0,
            100.0 * covered as f64 / some.len() as f64,
            some.iter().filter(|o| o.lost.1 > 0).count(),
        );
    }
}

fn losses(line: Line, runs: u64) {
    let all = outcomes(line, runs);
    let sum = |of: fn(&Outcome) -> u64| all.iter().map(of).sum::<u64>();
    println!(
        "| {:?} | {} | {} | {} | {} | {:.3} | {} | {} | {:.2} |",
        line.source,
        line.rate_hz,
        line.frame_s * 1e3,
        100.0 * line.lost,
        sum(|o| o.gaps.0),
        100.0 * sum(|o| o.gaps.1) as f64 / sum(|o| o.gaps.0) as f64,
        sum(|o| o.lost.0),
        sum(|o| o.lost.1),
        sum(|o| o.lost.1) as f64 / sum(|o| o.lost.0) as f64,
    );
}

fn main() {
    let runs: u64 = std::env::args().nth(1).map_or(200, |a| a.parse().expect("a number of runs"));
    let line = Line {
        rate_hz: 100.0,
        frame_s: 0.016,
        clock_ppm: 0.0,
        drift_ppm: 3.0,
        stalls_s: 30.0,
        lost: 0.0,
        source: Source::Ticks,
        ticks_hz: 1_000_000,
    };
    println!("error of stamps in % of a period\n");
    println!(
        "| source | Hz | frame ms | beats | runs | median | 90 % of runs | rms | spacing, rms | sd of rate, ppm | z of rate, rms | within 3 sd, % | runs with false losses |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    let frames = [0.016, 0.001];
    for source in [Source::Ticks, Source::Count, Source::Arrival] {
        for frame_s in frames {
            for rate_hz in [100.0, 200.0, 1000.0, 8000.0] {
                // 8 kHz costs as much as all the others.
                let runs = if rate_hz > 1000.0 { runs.div_ceil(10) } else { runs };
                errors(Line { rate_hz, frame_s, source, ..line }, runs);
            }
        }
    }
    println!(
        "\n| source | Hz | frame ms | lost % | gaps | found where and as long as they are, % | messages lost | reported | ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (source, lost) in [
        (Source::Ticks, 0.01),
        (Source::Count, 0.01),
        (Source::Arrival, 1e-4),
        (Source::Arrival, 0.01),
    ] {
        for frame_s in frames {
            for rate_hz in [100.0, 1000.0] {
                losses(Line { rate_hz, frame_s, lost, source, ..line }, runs.div_ceil(4));
            }
        }
    }
}
