use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::vec::Vec;

/// ½⟨(ȳ₁ − ȳ₀)²⟩ or ⅙⟨(ȳ₂ − 2ȳ₁ + ȳ₀)²⟩ from its definition: blocks of m, one every `stride`.
fn by_definition(y: &[f64], m: usize, stride: usize, order: usize) -> (u64, f64) {
    let mean = |at: usize| y[at..at + m].iter().sum::<f64>() / m as f64;
    let span = (order + 1) * m;
    let mut n = 0;
    let mut sum = 0.0;
    let mut at = 0;
    while at + span <= y.len() {
        let d = if order == 1 {
            mean(at + m) - mean(at)
        } else {
            mean(at + 2 * m) - 2.0 * mean(at + m) + mean(at)
        };
        sum += d * d;
        n += 1;
        at += stride;
    }
    (n, if n == 0 { 0.0 } else { sum / (n as f64 * if order == 1 { 2.0 } else { 6.0 }) })
}

/// Deterministic noise: white plus a walk, values of order 1 about 9.
fn record(seed: u64, n: usize) -> Vec<f64> {
    let mut state = seed.wrapping_mul(2).wrapping_add(1);
    let mut uniform = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut walk = 9.0;
    (0..n)
        .map(|_| {
            walk += 0.1 * uniform();
            walk + uniform()
        })
        .collect()
}

fn agrees_with_definition<const WINDOWS: usize, const ORDER: usize>(y: &[f64]) {
    let mut ladder = Ladder::<f64, 1, 9, WINDOWS, ORDER>::new();
    y.iter().for_each(|&y| ladder.push(&[y]));
    ladder.finish_learning();
    for octave in ladder.octaves(0) {
        let m = octave.samples as usize;
        let (n, variance) = by_definition(y, m, (m / WINDOWS).max(1), ORDER);
        assert_eq!(octave.differences, n, "m = {m}");
        // n + m additions of rounding 2⁻⁵³ on values of order 10.
        assert!((octave.variance - variance).abs() <= 1e-12 * (variance + 1e-2), "m = {m}");
        assert_eq!(octave.white_gain, 1.0);
    }
}

fn extends_as_it_pushes<T: Real, const WINDOWS: usize, const ORDER: usize>(
    y: &[f64],
    cuts: &[usize],
    bad: &[usize],
) {
    let mut rows: Vec<[T; 2]> =
        y.iter().map(|&y| [T::from_f64(y), T::from_f64(9.81 - 1e-3 * y)]).collect();
    for &k in bad {
        if let Some(row) = rows.get_mut(k) {
            row[1] = T::from_f64(f64::NAN);
        }
    }
    let mut pushed = Ladder::<T, 2, 12, WINDOWS, ORDER>::new();
    rows.iter().for_each(|row| pushed.push(row));
    let mut extended = Ladder::<T, 2, 12, WINDOWS, ORDER>::new();
    let mut rest = &rows[..];
    for &cut in cuts {
        let (now, after) = rest.split_at(cut.min(rest.len()));
        extended.extend(now);
        rest = after;
    }
    extended.extend(rest);
    assert_eq!(pushed, extended);
}

/// Feeds a record in which some samples are missing, one announcement at a time or all at once.
fn with_holes<const WINDOWS: usize, const ORDER: usize>(
    y: &[f64],
    holes: &[(usize, usize)],
    at_once: bool,
) -> Ladder<f64, 1, 12, WINDOWS, ORDER> {
    let mut ladder = Ladder::with_reference([9.0], [1e3]).unwrap();
    let mut at = 0;
    for &(start, length) in holes {
        let start = start.clamp(at, y.len());
        y[at..start].iter().for_each(|&y| ladder.push(&[y]));
        if at_once {
            ladder.missing(length as u64);
        } else {
            (0..length).for_each(|_| ladder.missing(1));
        }
        at = (start + length).min(y.len());
    }
    y[at..].iter().for_each(|&y| ladder.push(&[y]));
    ladder
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 48,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn ladder_is_the_definition(seed in 0_u64..1000, n in 0_usize..1500) {
        let y = record(seed, n);
        agrees_with_definition::<1, 1>(&y);
        agrees_with_definition::<4, 1>(&y);
        agrees_with_definition::<1, 2>(&y);
        agrees_with_definition::<4, 2>(&y);
    }

    #[test]
    fn extend_is_push_to_the_bit(
        seed in 0_u64..1000,
        n in 0_usize..20_000,
        cuts in prop::collection::vec(0_usize..700, 0..20),
        bad in prop::collection::vec(0_usize..20_000, 0..6),
    ) {
        let y = record(seed, n);
        extends_as_it_pushes::<f64, 1, 1>(&y, &cuts, &bad);
        extends_as_it_pushes::<f64, 4, 1>(&y, &cuts, &bad);
        extends_as_it_pushes::<f64, 4, 2>(&y, &cuts, &bad);
        extends_as_it_pushes::<f32, 1, 1>(&y, &cuts, &bad);
        extends_as_it_pushes::<f32, 1, 2>(&y, &cuts, &bad);
        extends_as_it_pushes::<f32, 4, 2>(&y, &cuts, &bad);
    }

    #[test]
    fn a_hole_at_once_is_a_hole_step_by_step(
        seed in 0_u64..1000,
        holes in prop::collection::vec((0_usize..3000, 0_usize..400), 0..8),
    ) {
        let mut holes = holes;
        holes.sort_unstable();
        let y = record(seed, 3000);
        prop_assert_eq!(with_holes::<1, 1>(&y, &holes, true), with_holes::<1, 1>(&y, &holes, false));
        prop_assert_eq!(with_holes::<4, 1>(&y, &holes, true), with_holes::<4, 1>(&y, &holes, false));
        prop_assert_eq!(with_holes::<4, 2>(&y, &holes, true), with_holes::<4, 2>(&y, &holes, false));
    }

    #[test]
    fn pooling_commutes_and_appending_keeps_all_differences(
        seed in 0_u64..1000,
        left in 0_usize..2000,
        right in 0_usize..2000,
    ) {
        let fill = |y: &[f64]| {
            let mut ladder = AllanLadder::<f64, 1, 10, 4>::new();
            y.iter().for_each(|&y| ladder.push(&[y]));
            ladder
        };
        let (a, b) = (fill(&record(seed, left)), fill(&record(seed + 1, right)));
        let (mut ab, mut ba, mut appended) = (a.clone(), b.clone(), a.clone());
        ab.pool(&b);
        ba.pool(&a);
        appended.append(&b);
        ab.finish_learning();
        ba.finish_learning();
        appended.finish_learning();
        prop_assert_eq!(ab.octaves(0), ba.octaves(0));
        prop_assert_eq!(ab.octaves(0), appended.octaves(0));

        // The appended ladder goes on as the right one would have.
        let more = record(seed + 2, 500);
        let mut alone = b.clone();
        alone.finish_learning();
        more.iter().for_each(|&y| {
            appended.push(&[y]);
            alone.push(&[y]);
        });
        let mut a = a;
        a.restart();
        for ((both, one), was) in
            appended.octaves(0).iter().zip(alone.octaves(0)).zip(a.octaves(0))
        {
            prop_assert_eq!(both.differences, one.differences + was.differences);
        }
    }
}

#[test]
fn a_level_that_cannot_be_filled_shows_nothing() {
    let ladder = AllanLadder::<f64, 2, 32, 4>::new();
    assert!(ladder.octaves(0).iter().all(|o| o.differences == 0 && o.variance == 0.0));
    assert!(ladder.octaves(2).iter().all(|o| o.differences == 0));
}

#[test]
fn no_difference_spans_a_restart() {
    let mut ladder = AllanLadder::<f64, 1, 4>::with_reference([0.0], [1e9]).unwrap();
    (0..8).for_each(|_| ladder.push(&[1.0]));
    ladder.restart();
    (0..8).for_each(|_| ladder.push(&[1000.0]));
    assert!(ladder.octaves(0).iter().all(|o| o.variance == 0.0));
    assert_eq!(ladder.octaves(0).map(|o| o.differences), [14, 6, 2, 0]);
}

#[test]
fn a_hole_of_any_length_passes_at_once() {
    let mut ladder = AllanLadder::<f64, 1, 32, 4>::with_reference([0.0], [10.0]).unwrap();
    (0..1000).for_each(|k| ladder.push(&[f64::from(k % 7)]));
    ladder.missing(u64::MAX - 5000);
    (0..1000).for_each(|k| ladder.push(&[f64::from(k % 7)]));
    assert_eq!(ladder.octaves(0)[0].differences, 2 * 999);
    assert_eq!(ladder.missing_samples(), u64::MAX - 5000);
}

/// Samples lost at random: the gain is what the definition says for the blocks that are left.
#[test]
fn gain_counts_what_is_missing() {
    let mut ladder = AllanLadder::<f64, 1, 3>::with_reference([0.0], [10.0]).unwrap();
    // Blocks of 4: three samples, all four, one (less than half: no difference).
    for present in [true, true, false, true, true, true, true, true, true, false, false, false] {
        if present {
            ladder.push(&[2.0]);
        } else {
            ladder.missing(1);
        }
    }
    let octaves = ladder.octaves(0);
    assert_eq!(octaves[0].white_gain, 1.0);
    assert_eq!(octaves[2].differences, 1);
    // ½(4/3 + 4/4) = 7/6
    assert!((octaves[2].white_gain - 7.0 / 6.0).abs() < 1e-15);
    assert_eq!(octaves[2].variance, 0.0);
    // Blocks of 2: 2, 1, 2, 2, 1, 0 samples: four differences, gains 3/2, 3/2, 1, 3/2.
    assert_eq!(octaves[1].differences, 4);
    assert!((octaves[1].white_gain - 5.5 / 4.0).abs() < 1e-15);
}

#[test]
fn glitches_at_the_start_become_neither_reference_nor_variance() {
    for glitch in [1e4, -1e30, f64::INFINITY, f64::NAN] {
        let mut ladder = AllanLadder::<f64, 1, 8>::new();
        ladder.push(&[glitch]);
        record(1, 5000).iter().for_each(|&y| ladder.push(&[y]));
        let mut clean = AllanLadder::<f64, 1, 8>::new();
        record(1, 5000).iter().for_each(|&y| clean.push(&[y]));
        assert_eq!(ladder.rejected_samples(), 1);
        let (a, b) = (ladder.octaves(0), clean.octaves(0));
        assert!((a[0].variance / b[0].variance - 1.0).abs() < 1e-9);
        assert!((ladder.reference().unwrap()[0] - clean.reference().unwrap()[0]).abs() < 1.0);
    }
}

#[test]
fn a_constant_signal_has_no_bound_and_no_variance() {
    let mut ladder = AllanLadder::<f32, 1, 8>::new();
    (0..100).for_each(|_| ladder.push(&[9.81]));
    ladder.push(&[-9.81]);
    assert_eq!(ladder.rejected_samples(), 0);
    assert!(ladder.octaves(0)[0].variance > 0.0);
}

#[test]
fn references_and_bounds_are_validated() {
    type One = AllanLadder<f32, 1, 4>;
    assert_eq!(One::with_reference([f32::NAN], [1.0]).err(), Some(Error::NonFinite("reference")));
    assert_eq!(One::with_reference([0.0], [f32::INFINITY]).err(), Some(Error::NonFinite("bound")));
    assert_eq!(One::with_reference([0.0], [0.0]).err(), Some(Error::OutOfRange("bound")));
    assert_eq!(One::with_reference([0.0], [1e13]).err(), Some(Error::OutOfRange("bound")));
}

/// The budget of the design: bytes of state for 6 axes and 22 octaves.
#[test]
fn state_is_within_its_budget() {
    assert!(size_of::<AllanLadder<f64, 6, 22>>() <= 4096);
    assert!(size_of::<AllanLadder<f32, 6, 22>>() <= 2304);
    assert!(size_of::<HadamardLadder<f64, 6, 22>>() <= 5120);
    assert!(size_of::<HadamardLadder<f32, 6, 22>>() <= 2816);
    assert!(size_of::<AllanLadder<f64, 6, 22, 4>>() <= 18 * 1024);
}
