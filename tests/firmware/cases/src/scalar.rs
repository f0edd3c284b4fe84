//! `imu_core::Real`: square root, exponential, sine and cosine, rounding, absolute value, conversions.

use crate::inputs::Integers;
use crate::{Report, repeat};
use core::hint::black_box;
use imu_core::Real;

/// Every operation over a spread of magnitudes, and at the values where definitions part.
pub fn case<T: Real>(report: &mut dyn Report) {
    let edges = [
        T::ZERO,
        -T::ZERO,
        T::ONE,
        -T::ONE,
        T::MAX,
        T::EPSILON,
        T::ONE / T::MAX,
        T::ONE / T::ZERO,
        T::from_f64(f64::NAN),
    ];
    for edge in edges {
        operations(report, black_box(edge));
    }
    let mut integers = Integers::new(1);
    let mut scale = T::from_f64(1e-12);
    for _ in 0..24 {
        for _ in 0..8 {
            operations(report, integers.unit::<T>() * scale);
        }
        scale *= T::from_u32(10);
    }
    let x = T::from_f64(black_box(0.7));
    report.instructions("sqrt", 64, &mut || repeat(64, || Real::sqrt(black_box(x))));
    report.instructions("sin_cos", 64, &mut || repeat(64, || Real::sin_cos(black_box(x))));
}

fn operations<T: Real>(report: &mut dyn Report, x: T) {
    report.real(Real::sqrt(x));
    report.real(Real::abs(x));
    let (sin, cos) = Real::sin_cos(x);
    report.real(sin);
    report.real(cos);
    report.real(Real::exp_m1(x));
    report.real(Real::round_ties_even(x));
    report.real(T::from_f64(x.to_f64() * 1.1));
    report.flag(Real::is_finite(x));
}
