//! `imu_core::trajectory`: every trajectory, in both scalars.

use crate::{Report, repeat};
use core::hint::black_box;
use imu_core::Real;
use imu_core::sensor::Kinematics;
use imu_core::trajectory::{Coning, Ellipse, Gait, Motion, Rest, Spin, Trajectory};

/// Motions at spread instants, negative and far ones included.
pub fn case<T: Real>(report: &mut dyn Report) {
    let ellipse = black_box(Ellipse::default());
    follow::<T>(report, &ellipse);
    follow::<T>(report, &black_box(Rest::default()));
    follow::<T>(report, &black_box(Gait::default()));
    follow::<T>(report, &black_box(Coning::default()));
    follow::<T>(report, &black_box(Spin::default()));
    for k in 0..64 {
        motion::<T>(report, ellipse.at(k * 312_345_678));
    }
    report.instructions("ellipse", 16, &mut || {
        repeat(16, || -> Motion<T> { ellipse.at(black_box(7_000_000_000)) });
    });
}

fn follow<T: Real>(report: &mut dyn Report, trajectory: &impl Trajectory<T>) {
    for t_ns in [i64::MIN, -1, 0, 1, 5_000_000, 1_000_000_007, 86_400_000_000_000, i64::MAX] {
        motion::<T>(report, trajectory.at(black_box(t_ns)));
        for offset_s in [0.0, -1e-3, 2.5e-10, f64::INFINITY] {
            kinematics::<T>(report, trajectory.kinematics(black_box(t_ns), black_box(offset_s)));
        }
    }
}

fn kinematics<T: Real>(report: &mut dyn Report, felt: Kinematics<T>) {
    let vectors = [felt.angular_rate, felt.angular_acceleration, felt.specific_force];
    vectors.as_flattened().iter().for_each(|&x| report.real(x));
}

fn motion<T: Real>(report: &mut dyn Report, motion: Motion<T>) {
    for vector in [motion.position_w, motion.velocity_w, motion.angular_rate, motion.specific_force]
    {
        vector.iter().for_each(|&x| report.real(x));
    }
    motion.attitude_wb.coords.iter().for_each(|&x| report.real(x));
}
