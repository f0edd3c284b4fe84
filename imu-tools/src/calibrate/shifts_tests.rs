//! Means of windows, white noise of standard deviation 1 and a random walk, with a step in the middle.
//!
//! `cargo test --release -p imu-tools --lib shifts -- --ignored --nocapture` prints how often a record at
//! rest is cut, and how often steps are found.

use super::*;

const FOUR_HOURS: usize = 15_000;

/// Standard normal numbers (Box and Muller), of xorshift64*.
fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut uniform = move || {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        ((state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    let mut other = None;
    move || {
        other.take().unwrap_or_else(|| {
            let (radius, angle) =
                ((-2.0 * uniform().ln()).sqrt(), std::f64::consts::TAU * uniform());
            other = Some(radius * angle.sin());
            radius * angle.cos()
        })
    }
}

/// The shifts of a record with this N/K, whose first axis goes up by `step` in its middle.
fn shifts(seed: u64, windows: usize, ratio: f64, step: f64) -> Vec<(u64, u64)> {
    let mut normal = normals(seed);
    let mut bias = [0.0; 3];
    let means: Vec<[f64; 3]> = (0..windows)
        .map(|k| {
            bias = bias.map(|b| b + normal() / ratio);
            let mut mean = bias.map(|b| b + normal());
            mean[0] += if 2 * k >= windows { step } else { 0.0 };
            mean
        })
        .collect();
    // As the windows of `Stillness` say it: by the quartile of the last 512, which errs by a tenth.
    let usual = |until: usize| {
        let last = &means[until.saturating_sub(512)..until];
        [0, 1, 2].map(|axis| {
            let mut steps: Vec<f64> =
                last.windows(2).map(|pair| (pair[1][axis] - pair[0][axis]).abs()).collect();
            let quarter = steps.len() / 4;
            *steps.select_nth_unstable_by(quarter, f64::total_cmp).1 / 0.318_639
        })
    };
    let mut shifts = Shifts::default();
    let first = windows.min(256);
    let mut steps = usual(first);
    means[..first].iter().for_each(|mean| shifts.show(*mean, steps));
    shifts.learn(steps);
    let mut found = Vec::new();
    for (k, mean) in means.iter().enumerate() {
        if k >= first {
            if k % 64 == 0 {
                steps = usual(k);
            }
            shifts.show(*mean, steps);
        }
        found.extend(shifts.push(k as u64, *mean));
        assert!(shifts.sums.len() <= 2 * LONG + TRANSITION + PEAK + 1);
        assert!(
            shifts.holds().is_none_or(|held| k as u64 - held <= (LONG + TRANSITION + PEAK) as u64)
        );
    }
    found.extend(shifts.end_stretch());
    found
}

#[test]
fn rest_is_not_cut() {
    for ratio in [3.0, 30.0, 1000.0] {
        assert_eq!(shifts(1, FOUR_HOURS, ratio, 0.0), []);
    }
}

#[test]
fn a_step_is_found_in_its_place() {
    for (windows, step) in [(FOUR_HOURS, 5.0), (600, 12.0), (600, 30.0)] {
        let found = shifts(2, windows, 300.0, step);
        let [(from, to)] = found[..] else { panic!("{step}: {found:?}") };
        let middle = windows as u64 / 2;
        assert!(to - from == 3 && from <= middle + 2 && middle <= to + 3, "{step}: {from} to {to}");
    }
}

/// Eight windows before a break and after it are enough for a larger one.
#[test]
fn a_step_soon_after_a_break_is_found() {
    let mut normal = normals(3);
    let mut means: Vec<[f64; 3]> = (0..600).map(|_| [normal(), normal(), normal()]).collect();
    means[310..].iter_mut().for_each(|mean| mean[1] += 12.0);
    let mut shifts = Shifts::default();
    let step = [std::f64::consts::SQRT_2; 3];
    means.iter().for_each(|mean| shifts.show(*mean, step));
    shifts.learn(step);
    let mut found: Vec<_> = (0..300).filter_map(|k| shifts.push(k, means[k as usize])).collect();
    found.extend(shifts.end_stretch());
    assert_eq!(found, []);
    found.extend((300..323).filter_map(|k| shifts.push(k, means[k as usize])));
    found.extend(shifts.end_stretch());
    assert!(matches!(found[..], [(306..=311, 309..=314)]), "{found:?}");
}

#[test]
#[ignore = "minutes"]
fn how_often() {
    for (ratio, records) in [(30.0, 1000), (38.0, 1000), (300.0, 1000), (1000.0, 1000), (3.0, 1000)]
    {
        let cuts: usize = (0..records).map(|k| shifts(k, FOUR_HOURS, ratio, 0.0).len()).sum();
        println!("N/K = {ratio} s, 4 h at rest: {cuts} cuts in {records} records of three axes");
    }
    for (ratio, windows) in [(300.0, FOUR_HOURS), (38.0, FOUR_HOURS), (300.0, 600)] {
        for step in [2.0, 2.5, 3.0, 4.0, 6.0, 8.0, 10.0] {
            let found = (0..200).filter(|k| !shifts(*k, windows, ratio, step).is_empty()).count();
            println!(
                "N/K = {ratio} s, {windows} windows, a step of {step}: found in {found} of 200"
            );
        }
    }
}
