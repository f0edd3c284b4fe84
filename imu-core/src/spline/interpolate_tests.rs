use super::*;
use crate::spline::{OneSided, SplitCurve, TimeSymmetric};
use crate::trajectory::{Ellipse, Motion, Trajectory};
use proptest::prelude::*;
use std::vec::Vec;

const STEP_NS: u32 = 50_000_000;

fn ellipse<T: Real>(count: i64) -> Vec<Pose<T>> {
    (0..count)
        .map(|k| {
            let motion: Motion<f64> = Ellipse::default().at(k * i64::from(STEP_NS));
            Pose::new(motion.attitude_wb, motion.position_w).unwrap().cast()
        })
        .collect()
}

fn interpolated<T: Real, F: Form<T>>(poses: &[Pose<T>]) -> (Vec<Pose<T>>, Interpolated<T>) {
    let mut control = std::vec![Pose::identity(); poses.len() + 2];
    let mut scratch = std::vec![Vector3::from([T::ZERO; 3]); poses.len()];
    let found = interpolate::<T, F>(poses, &mut control, &mut scratch).unwrap();
    (control, found)
}

/// The largest distances of the poses from the curve, m and rad.
fn distance<T: Real, F: Form<T>>(poses: &[Pose<T>], control: &[Pose<T>]) -> (T, T) {
    let step = i64::from(STEP_NS);
    let curve = SplitCurve::<_, _, F>::from_control_points(-step, STEP_NS, control).unwrap();
    let mut largest = (T::ZERO, T::ZERO);
    for (k, pose) in (0..).zip(poses) {
        let there = curve.pose(k * step).unwrap();
        let off = there.translation() - pose.translation();
        let turn = so3::log(&so3::product(&so3::inverse(&there.rotation()), &pose.rotation()));
        let (off, turn) = (dot(&off, &off).sqrt(), dot(&turn, &turn).sqrt());
        largest = (
            if off > largest.0 { off } else { largest.0 },
            if turn > largest.1 { turn } else { largest.1 },
        );
    }
    largest
}

/// From the fewest poses on: roundings of 25 m (a control point takes six times a place) and of unit quaternions.
#[test]
fn the_curve_goes_through_the_poses() {
    fn check<T: Real, F: Form<T>>() {
        for count in [4, 5, 6, 7, 8, 40, 400] {
            let poses = ellipse::<T>(count);
            let (control, found) = interpolated::<T, F>(&poses);
            let (off, turn) = distance::<T, F>(&poses, &control);
            assert!(off <= T::from_f64(300.0) * T::EPSILON, "{count} {off}");
            assert!(turn <= T::from_f64(8.0) * T::EPSILON, "{count} {turn} {found:?}");
            assert!(found.sweeps <= 6, "{count} {found:?}");
        }
    }
    check::<f64, OneSided>();
    check::<f64, TimeSymmetric>();
    check::<f32, OneSided>();
    check::<f32, TimeSymmetric>();
}

/// A cubic is its own interpolant, and so is a steady turn: the conditions at both ends hold for them.
#[test]
fn cubics_and_steady_turns_come_back() {
    for count in [4, 5, 6, 9, 30] {
        let at = |t: f64| {
            let place = Vector3::new(t * t * t - 2.0 * t, 1.0 - t * t, 0.5 * t);
            Pose::new(so3::exp(Vector3::new(0.3, -0.2, 0.5) * t), place).unwrap()
        };
        let poses: Vec<_> = (0..count).map(|k| at(0.05 * f64::from(k))).collect();
        let (control, _) = interpolated::<f64, OneSided>(&poses);
        let curve =
            SplitCurve::<_, _, OneSided>::from_control_points(-50_000_000, STEP_NS, &control)
                .unwrap();
        for part in 0..=97 {
            let t_ns = i64::from(count - 1) * 50_000_000 * part / 97;
            let (there, truth) = (curve.pose(t_ns).unwrap(), at(t_ns as f64 / 1e9));
            assert!((there.translation() - truth.translation()).abs().max() < 1e-14);
            let turn = so3::product(&so3::inverse(&there.rotation()), &truth.rotation());
            assert!(so3::log(&turn).abs().max() < 1e-14);
        }
    }
}

/// Poses, each turned against the one before.
fn turned_by(turns: &[[f64; 3]]) -> Vec<Pose<f64>> {
    let mut poses = std::vec![Pose::identity()];
    for turn in turns {
        let last = poses[poses.len() - 1].rotation();
        let next = so3::product(&last, &so3::exp(Vector3::from(*turn)));
        poses.push(Pose::new(next, Vector3::from(*turn)).unwrap());
    }
    poses
}

proptest! {
    /// Turns of up to 0.087 rad between neighbours, in any direction: a factor of 0.2 a sweep, or better.
    #[test]
    fn turns_settle(turns in prop::collection::vec(prop::array::uniform3(-0.05..0.05), 3..30)) {
        let poses = turned_by(&turns);
        let (control, found) = interpolated::<f64, OneSided>(&poses);
        let (_, off) = distance::<f64, OneSided>(&poses, &control);
        prop_assert!(off < 1e-14 && found.sweeps < 40, "{off} {found:?}");
    }

    /// Turns of up to a radian: what is said of them is true.
    #[test]
    fn large_turns_settle_or_are_told_of(turns in prop::collection::vec(prop::array::uniform3(-0.5..0.5), 3..30)) {
        let poses = turned_by(&turns);
        let (mut control, mut scratch) =
            (std::vec![Pose::identity(); poses.len() + 2], std::vec![Vector3::zeros(); poses.len()]);
        // Ends are extrapolated: of turns that change at random, by more than half a turn at times.
        match interpolate::<f64, TimeSymmetric>(&poses, &mut control, &mut scratch) {
            Ok(found) => {
                let (_, turn) = distance::<f64, TimeSymmetric>(&poses, &control);
                prop_assert!((turn - found.rotation_error).abs() < 1e-14);
            }
            Err(error) => prop_assert_eq!(error, Error::OutOfRange("turn between neighbours")),
        }
    }
}

#[test]
fn what_cannot_be_interpolated_is_refused() {
    let poses = ellipse::<f64>(6);
    let (mut control, mut scratch) = ([Pose::identity(); 8], [Vector3::zeros(); 6]);
    let mut tried = |poses: &[_], controls: usize, scratches: usize| {
        interpolate::<f64, OneSided>(poses, &mut control[..controls], &mut scratch[..scratches])
    };
    assert_eq!(tried(&poses[..3], 5, 3), Err(Error::OutOfRange("poses")));
    assert_eq!(tried(&poses, 7, 6), Err(Error::OutOfRange("control")));
    assert_eq!(tried(&poses, 8, 5), Err(Error::OutOfRange("scratch")));
    let mut jumps = poses.clone();
    let half_turn = so3::exp(Vector3::new(0.0, core::f64::consts::PI, 0.0));
    jumps[3] = Pose::new(so3::product(&jumps[2].rotation(), &half_turn), Vector3::zeros()).unwrap();
    assert_eq!(tried(&jumps, 8, 6), Err(Error::OutOfRange("turn between neighbours")));
}
