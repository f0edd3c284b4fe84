//! `imu_core::so3`: small, large and impossible rotations, there and back.

use crate::inputs::Integers;
use crate::{Report, repeat};
use core::hint::black_box;
use imu_core::Real;
use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::so3;

/// Rotations of up to these many radians an axis.
const SIZES: [f64; 9] = [0.0, 1e-300, 1e-40, 1e-9, 1e-3, 0.1, 0.6, 3.0, 40.0];

/// Every function on rotations of every size.
pub fn case<T: Real>(report: &mut dyn Report) {
    let mut integers = Integers::new(31);
    let mut attitude = Quaternion::new(T::ONE, T::ZERO, T::ZERO, T::ZERO);
    for size in SIZES {
        for _ in 0..8 {
            let mut part = || T::from_f64(integers.unit::<f64>() * size);
            let rotation = Vector3::new(part(), part(), part());
            let step = so3::exp(black_box(rotation));
            attitude = so3::renormalised(&so3::product(&attitude, &step));
            quaternion(report, &step);
            quaternion(report, &attitude);
            vector(report, &so3::log(&step));
            vector(report, &so3::rotate(&so3::inverse(&attitude), &rotation));
        }
    }
    for bad in [f64::NAN, f64::INFINITY, -1e30, 1e200] {
        let rotation = Vector3::new(T::ZERO, T::from_f64(black_box(bad)), T::ONE);
        quaternion(report, &so3::exp(rotation));
        let q = Quaternion::new(T::from_f64(black_box(bad)), T::ONE, T::ZERO, T::ZERO);
        vector(report, &so3::log(&q));
        quaternion(report, &so3::renormalised(&q));
    }
    vector(report, &so3::log(&Quaternion::new(T::ZERO, T::ZERO, T::ZERO, T::ZERO)));

    let small = Vector3::new(T::from_f64(1e-3), T::from_f64(-2e-3), T::from_f64(3e-3));
    let large = small * T::from_f64(500.0);
    for (what, rotation) in [("exp of a small angle", small), ("exp of a large angle", large)] {
        report.instructions(what, 64, &mut || repeat(64, || so3::exp(black_box(rotation))));
    }
    let q = so3::exp(large);
    report.instructions("log", 64, &mut || repeat(64, || so3::log(black_box(&q))));
    report.instructions("rotate", 64, &mut || {
        repeat(64, || so3::rotate(black_box(&q), black_box(&small)));
    });
}

fn quaternion<T: Real>(report: &mut dyn Report, q: &Quaternion<T>) {
    q.coords.iter().for_each(|&x| report.real(x));
}

fn vector<T: Real>(report: &mut dyn Report, v: &Vector3<T>) {
    v.iter().for_each(|&x| report.real(x));
}
