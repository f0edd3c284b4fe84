//! `imu_core::spline::interpolate`: control points of both forms, from the fewest poses on, and what is refused.

use crate::Report;
use core::hint::black_box;
use imu_core::nalgebra::Vector3;
use imu_core::se3::Pose;
use imu_core::spline::{Form, OneSided, TimeSymmetric, interpolate};
use imu_core::{Real, so3};

/// Poses at most.
const MOST: usize = 12;

/// On a helix, turned by so many radians from one to the next.
fn poses<T: Real>(turn: f64) -> [Pose<T>; MOST] {
    let mut k = 0;
    [(); MOST].map(|()| {
        k += 1;
        let angle = T::from_f64(turn) * T::from_u32(k);
        let attitude = so3::exp(Vector3::new(angle * T::from_f64(0.3), angle * angle, angle));
        let place = so3::rotate(&attitude, &Vector3::new(T::from_u32(20), angle, T::ONE));
        Pose::new(attitude, place).unwrap_or_default()
    })
}

/// In one scalar.
pub fn case<T: Real>(report: &mut dyn Report) {
    for turn in [0.0, 0.01, 0.1] {
        let poses = poses::<T>(black_box(turn));
        for count in [3, 4, 5, 6, MOST] {
            let poses = poses.get(..count).unwrap_or_default();
            through::<T, OneSided>(report, poses);
            through::<T, TimeSymmetric>(report, poses);
        }
    }
    through::<T, OneSided>(report, &poses(black_box(3.1)));
}

fn through<T: Real, F: Form<T>>(report: &mut dyn Report, poses: &[Pose<T>]) {
    let mut control = [Pose::identity(); MOST + 2];
    let mut scratch = [Vector3::from([T::ZERO; 3]); MOST];
    let (Some(control), Some(scratch)) =
        (control.get_mut(..poses.len() + 2), scratch.get_mut(..poses.len()))
    else {
        return report.flag(false);
    };
    match interpolate::<T, F>(poses, control, scratch) {
        Ok(found) => {
            report.real(found.rotation_error);
            report.word(found.sweeps.into());
            for pose in control {
                pose.rotation().coords.iter().for_each(|&x| report.real(x));
                pose.translation().iter().for_each(|&x| report.real(x));
            }
        }
        Err(_) => report.flag(false),
    }
}
