//! `imu_core::allan::Ladder`: every operation and its byte form, in both scalars, orders and numbers
//! of windows; what a sample costs.

use crate::Report;
use crate::inputs::Integers;
use core::hint::black_box;
use imu_core::Real;
use imu_core::allan::Ladder;

/// Axes and levels of the ladders whose bits are compared.
type Small<T, const WINDOWS: usize, const ORDER: usize> = Ladder<T, 2, 10, WINDOWS, ORDER>;
/// Axes and levels of the ladders whose cost is counted: six axes, τ up to 2.9 h at 200 Hz.
type Large<T, const WINDOWS: usize, const ORDER: usize> = Ladder<T, 6, 22, WINDOWS, ORDER>;

/// Samples around an offset.
fn samples<T: Real, const AXES: usize, const N: usize>(integers: &mut Integers) -> [[T; AXES]; N] {
    [(); N].map(|()| [(); AXES].map(|()| T::from_f64(9.8125) + integers.unit::<T>()))
}

/// Pushes, blocks, losses, restarts, merges, and what they leave.
pub fn bits<T: Real, const WINDOWS: usize, const ORDER: usize>(report: &mut dyn Report) {
    let mut integers = Integers::new(11);
    let mut ladder = Small::<T, WINDOWS, ORDER>::new();
    readings(report, &ladder);
    ladder.missing(3);
    stored(report, &ladder);
    ladder.push(&[T::from_f64(1e4), T::from_f64(-1e4)]); // a glitch before all else
    for sample in samples::<T, 2, 40>(&mut integers) {
        ladder.push(&sample);
    }
    readings(report, &ladder);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e30] {
        ladder.push(&[T::from_f64(9.75), T::from_f64(black_box(bad))]);
        ladder.extend(&samples::<T, 2, 200>(&mut integers));
    }
    ladder.missing(1);
    ladder.extend(&samples::<T, 2, 100>(&mut integers));
    ladder.missing(700);
    for sample in samples::<T, 2, 300>(&mut integers) {
        ladder.push(&sample);
    }
    readings(report, &ladder);
    stored(report, &ladder);

    let mut other = Small::<T, WINDOWS, ORDER>::new();
    other.extend(&samples::<T, 2, 333>(&mut integers));
    let mut appended = ladder.clone();
    appended.append(&other);
    appended.extend(&samples::<T, 2, 70>(&mut integers));
    readings(report, &appended);
    let mut pooled = ladder.clone();
    pooled.pool(&other);
    pooled.pool(&Small::new());
    readings(report, &pooled);
    ladder.restart();
    ladder.extend(&samples::<T, 2, 400>(&mut integers));
    readings(report, &ladder);

    let near = [T::from_f64(9.8); 2];
    for bound in [0.5, 0.0, -1.0, f64::NAN, f64::INFINITY] {
        let given = Small::<T, WINDOWS, ORDER>::with_reference(near, [T::from_f64(bound); 2]);
        report.flag(given.is_ok());
        if let Ok(mut given) = given {
            given.extend(&samples::<T, 2, 130>(&mut integers));
            readings(report, &given);
        }
    }
}

/// The byte form, and whether it reads back as the same ladder.
fn stored<T: Real, const WINDOWS: usize, const ORDER: usize>(
    report: &mut dyn Report,
    ladder: &Small<T, WINDOWS, ORDER>,
) {
    let mut bytes = [0_u8; 4096];
    report.word(ladder.write_to(&mut bytes).map_or(0, |n| n as u64));
    for word in bytes.as_chunks().0 {
        report.word(u64::from_le_bytes(*word));
    }
    let written = bytes.get(..Small::<T, WINDOWS, ORDER>::BYTES).unwrap_or_default();
    report.flag(Small::<T, WINDOWS, ORDER>::read_from(black_box(written)).as_ref() == Ok(ladder));
    report.flag(Small::<T, WINDOWS, ORDER>::read_from(black_box(&bytes)).is_err());
}

fn readings<T: Real, const WINDOWS: usize, const ORDER: usize>(
    report: &mut dyn Report,
    ladder: &Small<T, WINDOWS, ORDER>,
) {
    report.word(ladder.position());
    report.word(ladder.missing_samples());
    report.word(ladder.rejected_samples());
    if let Some(reference) = ladder.reference() {
        reference.iter().for_each(|&x| report.real(x));
    }
    for axis in [0, 1, 2] {
        for octave in ladder.octaves(axis) {
            report.word(octave.samples);
            report.word(octave.differences);
            report.real(octave.variance);
            report.real(octave.deviation());
            report.real(octave.white_gain);
        }
    }
}

/// Instructions a sample, stack and state of six axes and 22 octaves.
pub fn cost<T: Real, const WINDOWS: usize, const ORDER: usize>(report: &mut dyn Report) {
    let samples: [[T; 6]; 64] = samples(&mut Integers::new(5));
    let mut ladder = Large::<T, WINDOWS, ORDER>::new();
    report.state("ladder", size_of_val(&ladder));
    for sample in samples.iter().take(6) {
        ladder.push(sample);
    }
    // One call alone: within a tick, which is 40 or 62.5 instructions.
    report.instructions("the push that ends learning", 1, &mut || ladder.push(&samples[6]));
    for sample in samples.iter().skip(7) {
        ladder.push(sample);
    }
    report.instructions("push", 4096, &mut || {
        for _ in 0..64 {
            black_box(&samples).iter().for_each(|sample| ladder.push(sample));
        }
    });
    report.instructions("extend", 4096, &mut || {
        for _ in 0..64 {
            ladder.extend(black_box(&samples));
        }
    });
    report.instructions("octaves of an axis", 1, &mut || {
        black_box(ladder.octaves(black_box(3)));
    });
    report.stack("push", &mut || ladder.push(black_box(&samples[0])));
    report.stack("extend", &mut || ladder.extend(black_box(&samples)));
    ladder.restart();
    report.instructions("missing(a million) after a restart", 1, &mut || {
        ladder.missing(black_box(1_000_000));
    });
}

/// The dearest push: every one of 22 levels completes a block that has a neighbour.
pub fn worst_push(report: &mut dyn Report) {
    // Four million samples take the M0's emulator too long, and it has no limit to keep.
    if cfg!(target_abi = "eabihf") {
        let samples: [[f32; 6]; 64] = samples(&mut Integers::new(5));
        let mut ladder = Large::<f32, 1, 1>::new();
        for _ in 1..(1 << 22) / 64 {
            ladder.extend(black_box(&samples));
        }
        let (last, most) = (&samples[63], &samples[..63]);
        ladder.extend(most);
        report.instructions("dearest push", 1, &mut || ladder.push(black_box(last)));
    }
}
