//! The ladder where arithmetic is hard: large offsets, long records, glitches, losses.
//!
//! Noise is white and uniform, so its variance is known; n disjoint differences of white noise give
//! a variance with a relative standard deviation of at most √(3/n) (neighbouring differences share
//! a block: 2/n·(1 + 2·¼)). Bounds below are six of these.

use imu_core::Real;
use imu_core::allan::{AllanLadder, Octave};

/// Uniform noise of standard deviation 1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        let uniform = (self.0 >> 11) as f64 / (1_u64 << 53) as f64;
        (uniform - 0.5) * 12_f64.sqrt()
    }
}

/// Fills a ladder with `n` samples of `offset` + `sd`·noise, in slices.
fn fill<T: Real, const WINDOWS: usize>(
    ladder: &mut AllanLadder<T, 1, 28, WINDOWS>,
    noise: &mut Noise,
    n: usize,
    offset: f64,
    sd: f64,
) {
    let mut slice = [[T::ZERO]; 4096];
    let mut left = n;
    while left > 0 {
        let now = left.min(slice.len());
        for row in &mut slice[..now] {
            *row = [T::from_f64(offset + sd * noise.next())];
        }
        ladder.extend(&slice[..now]);
        left -= now;
    }
}

/// Six standard deviations of the variance that an octave shows of white noise.
fn six_sigma(octave: &Octave, windows: f64) -> f64 {
    6.0 * (3.0 * windows / octave.differences as f64).sqrt()
}

/// Each octave with many differences shows white noise of variance `sd`² as it should.
fn shows_white_noise<const LEVELS: usize>(octaves: [Octave; LEVELS], sd: f64, windows: f64) {
    let mut shown = 0;
    for octave in octaves.iter().filter(|octave| octave.differences as f64 >= 1000.0 * windows) {
        let expected = sd * sd / octave.samples as f64 * octave.white_gain;
        let error = octave.variance / expected - 1.0;
        assert!(error.abs() < six_sigma(octave, windows), "{error} in {octave:?}");
        shown += 1;
    }
    assert!(shown >= 5);
}

/// Noise of 1e-6 on 1e6, in double precision: what the offset leaves of the digits of a sample is
/// all that is lost. 4·10⁶ samples: six sigma are 0.52 % at τ = 1 and 0.74 % at 2.
#[test]
fn a_large_offset_costs_no_digits() {
    let (n, offset, sd) = (4_000_000, 1e6, 1e-6);
    let mut ladder = AllanLadder::<f64, 1, 28>::new();
    fill(&mut ladder, &mut Noise(1), n, offset, sd);
    let octaves = ladder.octaves(0);
    assert_eq!(ladder.rejected_samples(), 0);
    for octave in &octaves[..2] {
        assert!((octave.variance * octave.samples as f64 / (sd * sd) - 1.0).abs() < 0.01);
    }
    shows_white_noise(octaves, sd, 1.0);

    // The same samples without the offset (their difference to it is exact).
    let mut noise = Noise(1);
    let mut without = AllanLadder::<f64, 1, 28>::new();
    for _ in 0..n {
        without.push(&[offset + sd * noise.next() - offset]);
    }
    for (with, without) in octaves.iter().zip(without.octaves(0)) {
        // Rounding of at most 4·10⁶ terms ≥ 0: 4·10⁶·2⁻⁵³.
        assert!((with.variance - without.variance).abs() <= 1e-9 * without.variance);
    }
}

/// Gravity with noise of 1e-3 over 10⁸ samples, in single precision: white as it should be within
/// 1 %, and at every τ what double precision makes of the same samples.
#[test]
fn a_long_record_in_single_precision() {
    let (n, offset, sd) = (100_000_000, 9.81, 1e-3);
    let mut single = AllanLadder::<f32, 1, 28>::new();
    let mut double = AllanLadder::<f64, 1, 28>::new();
    let mut noise = Noise(2);
    let mut slice = [[0.0_f32]; 4096];
    let mut exact = [[0.0_f64]; 4096];
    let mut left = n;
    while left > 0 {
        let now = left.min(slice.len());
        for (row, exact) in slice.iter_mut().zip(&mut exact) {
            *row = [(offset + sd * noise.next()) as f32];
            *exact = row.map(f64::from);
        }
        single.extend(&slice[..now]);
        double.extend(&exact[..now]);
        left -= now;
    }
    assert_eq!(single.rejected_samples(), 0);
    let octaves = single.octaves(0);
    // Six sigma at τ = 16 are 0.42 %; the grid of f32 near 9.81 adds 2e-13 to 1e-6.
    for octave in &octaves[..5] {
        assert!((octave.variance * octave.samples as f64 / (sd * sd) - 1.0).abs() < 0.01);
    }
    shows_white_noise(octaves, sd, 1.0);
    for (single, double) in octaves.iter().zip(double.octaves(0)) {
        // At worst 4096 additions to the total's first stage and 10⁸/4096 to its second, half an
        // ulp (2⁻²⁵) each: 0.85e-3; a level's roundings of a sum: 28·2⁻²⁴, twice in a square.
        assert_eq!(single.differences, double.differences);
        assert!((single.variance - double.variance).abs() <= 1e-3 * double.variance);
    }
}

/// The reference survives a first sample of 1e4, and what cannot be a sample counts as missing.
fn survives_glitches<T: Real, const WINDOWS: usize>() {
    let (offset, sd) = (9.81, 1e-2);
    let mut noise = Noise(3);
    let mut ladder = AllanLadder::<T, 1, 28, WINDOWS>::new();
    ladder.push(&[T::from_f64(1e4)]);
    fill(&mut ladder, &mut noise, 20_000, offset, sd);
    assert_eq!(ladder.rejected_samples(), 1);
    assert!((ladder.reference().unwrap()[0].to_f64() - offset).abs() < 1.8 * sd);
    for glitch in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e30, -1e30, 1e4] {
        ladder.push(&[T::from_f64(glitch)]);
        fill(&mut ladder, &mut noise, 10_000, offset, sd);
        ladder.extend(&[[T::from_f64(glitch)]; 3]);
    }
    assert_eq!(ladder.rejected_samples(), 1 + 6 * 4);
    assert_eq!(ladder.position(), 1 + 20_000 + 6 * 10_004);
    shows_white_noise(ladder.octaves(0), sd, WINDOWS as f64);
}

#[test]
fn glitches_are_missing_samples() {
    survives_glitches::<f32, 1>();
    survives_glitches::<f32, 4>();
    survives_glitches::<f64, 1>();
    survives_glitches::<f64, 4>();
}

/// Of 10⁶ samples 1 % are lost at random, and 12 000 at once (a minute at 200 Hz): the variance of
/// white noise is right at every τ once divided by its gain, and no τ is lost.
fn survives_losses<T: Real, const WINDOWS: usize>() {
    let (offset, sd) = (9.81, 1e-2);
    let mut noise = Noise(4);
    let mut dice = Noise(5);
    let mut ladder = AllanLadder::<T, 1, 28, WINDOWS>::new();
    let mut lost = 0;
    for k in 0..1_000_000 {
        let sample = [T::from_f64(offset + sd * noise.next())];
        // Uniform on ±√3: the lowest hundredth.
        if dice.next() < (0.01 - 0.5) * 12_f64.sqrt() {
            ladder.missing(1);
            lost += 1;
        } else {
            ladder.push(&sample);
        }
        if k == 400_000 {
            ladder.missing(12_000);
        }
    }
    assert_eq!(ladder.missing_samples(), lost + 12_000);
    let octaves = ladder.octaves(0);
    shows_white_noise(octaves, sd, WINDOWS as f64);
    for octave in &octaves[5..12] {
        // 1/(1 − p) = 1.0101 and a hole's edges, where half of a block may be missing.
        assert!((1.009..1.02).contains(&octave.white_gain), "{octave:?}");
    }
    // Two blocks of 2¹⁸ fit into 1 012 000 samples, two of 2¹⁹ do not.
    assert!(octaves[..19].iter().all(|octave| octave.differences > 0));
}

#[test]
fn losses_leave_every_tau_unbiased() {
    survives_losses::<f32, 1>();
    survives_losses::<f32, 4>();
    survives_losses::<f64, 1>();
    survives_losses::<f64, 4>();
}
