//! `imu_core::frame`: what firmware sends, its bytes, what of damaged bytes is refused, and the cost of a frame.

use crate::inputs::Integers;
use crate::{Report, repeat};
use core::hint::black_box;
use imu_core::frame::{Check, Frame, LONGEST, View, check};

/// Frames of every kind, whole, cut and damaged.
pub fn case(report: &mut dyn Report) {
    let mut integers = Integers::new(77);
    for kind in 0..16_u32 {
        let frame = frame(&mut integers, kind);
        let mut bytes = [0; LONGEST];
        let sent = black_box(&frame).encode(&mut bytes);
        report.word(sent.len() as u64);
        sent.iter().for_each(|byte| report.word(u64::from(*byte)));
        report.flag(View::of(sent).is_some_and(|view| view.frame() == frame));
        for length in 0..LONGEST {
            found(report, check(sent.get(..length).unwrap_or_default()));
        }
        for _ in 0..8 {
            let place = integers.integer() as usize % LONGEST;
            let change = (integers.integer() >> 24) as u8;
            bytes.iter_mut().skip(place).take(1).for_each(|byte| *byte ^= change);
            found(report, check(black_box(&bytes)));
        }
    }

    let full = frame(&mut integers, 7);
    let mut bytes = [0; LONGEST];
    report.instructions("encode", 16, &mut || {
        repeat(16, || black_box(&full).encode(&mut bytes).len());
    });
    report.instructions("check", 16, &mut || repeat(16, || check(black_box(&bytes))));
    report.stack("encode", &mut || {
        black_box(black_box(&full).encode(&mut bytes).len());
    });
}

fn frame(integers: &mut Integers, kind: u32) -> Frame {
    let has = |bit: u32| kind >> bit & 1 == 1;
    let mut number = || integers.unit::<f32>();
    let gyroscope = [number(), number(), number()];
    let accelerometer = [number(), number(), number()];
    let celsius = number();
    Frame {
        number: integers.integer() as u16,
        time_ns: u64::from(integers.integer()) << 20,
        gyroscope: has(0).then_some(gyroscope),
        accelerometer: has(1).then_some(accelerometer),
        celsius: has(2).then_some(celsius),
        increments: has(3),
    }
}

fn found(report: &mut dyn Report, check: Check) {
    report.word(match check {
        Check::Short => 0,
        Check::Not => 1,
        Check::Damaged => 2,
        Check::Whole(length) => length as u64,
    });
}
