//! `imu_core::spline`, `imu_core::se3` and the Jacobians of `imu_core::so3`: curves of every kind, cached and not, of
//! control poses near and far apart; what is refused; and what an evaluation costs.

use crate::inputs::Integers;
use crate::{Report, repeat};
use core::hint::black_box;
use imu_core::nalgebra::{Matrix3, Quaternion, Vector3};
use imu_core::sample::Sample;
use imu_core::se3::{self, Pose, Twist};
use imu_core::spline::{
    Full, Knot, PoseAndVelocity, R3Spline, ScrewKnot, Se3Spline, So3Spline, SplitSpline, Stream,
    SymmetricSo3Spline, SymmetricSplitSpline, cache, cache_screws, double, quasi_interpolant,
    quasi_interpolant_on_screws, single,
};
use imu_core::trajectory::{AlongSpline, Motion, Trajectory};
use imu_core::{Error, Real, so3};

/// Control poses of a curve.
const COUNT: usize = 9;
/// The time between them, ns.
const STEP: u32 = 10_000_000;
/// The first of them, ns.
const START: i64 = -7_777_777_777;

/// Rotations of up to these many radians an axis.
const SIZES: [f64; 6] = [0.0, 1e-40, 1e-3, 0.3, 1.0, 1.8];

fn vector<T: Real>(integers: &mut Integers, size: f64) -> Vector3<T> {
    let size = T::from_f64(size);
    Vector3::from([(); 3].map(|()| integers.unit::<T>() * size))
}

/// Each turned a little from the one before.
fn poses<T: Real>(size: f64) -> [Pose<T>; COUNT] {
    let mut integers = Integers::new(43);
    let mut pose = Pose::identity();
    [(); COUNT].map(|()| {
        let angular = vector(&mut integers, size);
        pose = pose.then(&se3::exp(&Twist { linear: vector(&mut integers, 2.0), angular }));
        pose
    })
}

/// Every evaluation of every curve, by the entry points of one scalar.
macro_rules! bits {
    ($report:ident, $T:ty, $of:ident) => {
        for size in [1e-3, 0.05, 0.9] {
            let poses = poses::<$T>(black_box(size));
            let (mut knots, mut screws) = ([Knot::default(); COUNT], [ScrewKnot::default(); COUNT]);
            $report.flag(cache(&poses, &mut knots).is_ok());
            $report.flag(cache_screws(&poses, &mut screws).is_ok());
            knots.reverse();
            screws.reverse();
            $report.flag(SplitSpline::from_control_points(START, STEP, &knots).is_ok());
            $report.flag(Se3Spline::from_control_points(START, STEP, &screws).is_ok());
            knots.reverse();
            screws.reverse();
            let (Ok(split), Ok(symmetric), Ok(se3)) = (
                SplitSpline::from_control_points(START, STEP, &poses),
                SymmetricSplitSpline::from_control_points(START, STEP, &poses),
                Se3Spline::from_control_points(START, STEP, &poses),
            ) else {
                return $report.flag(false);
            };
            let (Ok(cached), Ok(cached_symmetric), Ok(cached_se3)) = (
                SplitSpline::from_control_points(START, STEP, &knots),
                SymmetricSplitSpline::from_control_points(START, STEP, &knots),
                Se3Spline::from_control_points(START, STEP, &screws),
            ) else {
                return $report.flag(false);
            };
            let gravity = Vector3::new(0.0, 0.0, -9.81);
            for k in 0..12 {
                let t = START + 3_000_000 + black_box(k) * 7_654_321;
                pose($report, $of::pose(&cached, t));
                velocity($report, $of::pose_and_velocity(&cached, t));
                full($report, $of::full(&cached, t));
                felt($report, $of::imu(&cached, t, &gravity));
                pose($report, $of::uncached_pose(&split, t));
                velocity($report, $of::uncached_pose_and_velocity(&split, t));
                full($report, $of::uncached_full(&split, t));
                felt($report, $of::uncached_imu(&split, t, &gravity));
                pose($report, $of::symmetric_pose(&cached_symmetric, t));
                velocity($report, $of::symmetric_pose_and_velocity(&cached_symmetric, t));
                full($report, $of::symmetric_full(&cached_symmetric, t));
                felt($report, $of::symmetric_imu(&cached_symmetric, t, &gravity));
                pose($report, $of::uncached_symmetric_pose(&symmetric, t));
                velocity($report, $of::uncached_symmetric_pose_and_velocity(&symmetric, t));
                full($report, $of::uncached_symmetric_full(&symmetric, t));
                felt($report, $of::uncached_symmetric_imu(&symmetric, t, &gravity));
                pose($report, $of::se3_pose(&cached_se3, t));
                velocity($report, $of::se3_pose_and_velocity(&cached_se3, t));
                full($report, $of::se3_full(&cached_se3, t));
                felt($report, $of::se3_imu(&cached_se3, t, &gravity));
                pose($report, $of::uncached_se3_pose(&se3, t));
                velocity($report, $of::uncached_se3_pose_and_velocity(&se3, t));
                full($report, $of::uncached_se3_full(&se3, t));
                felt($report, $of::uncached_se3_imu(&se3, t, &gravity));
            }
        }
        apart::<$T>($report);
        streamed::<$T>($report);
        groups::<$T>($report);
    };
}

/// In single precision.
pub fn case_in_single(report: &mut dyn Report) {
    bits!(report, f32, single);
}

/// In double precision, and the motion along a curve.
pub fn case_in_double(report: &mut dyn Report) {
    bits!(report, f64, double);
    let poses = poses::<f64>(black_box(0.05));
    let Ok(curve) = SymmetricSplitSpline::from_control_points(START, STEP, &poses) else {
        return report.flag(false);
    };
    let along = AlongSpline::new(curve);
    for k in 0..12 {
        let t = START + 3_000_000 + black_box(k) * 7_654_321;
        let motion: Motion<f32> = along.at(t);
        motion.position_w.iter().for_each(|&x| report.real(x));
        motion.specific_force.iter().for_each(|&x| report.real(x));
        let felt = Trajectory::<f64>::kinematics(&along, t, black_box(1.25e-9));
        felt.angular_acceleration.iter().for_each(|&x| report.real(x));
    }
}

/// Positions alone, and attitudes alone, and what is refused.
fn apart<T: Real>(report: &mut dyn Report) {
    let poses = poses::<T>(black_box(0.1));
    let points = poses.map(|pose| pose.translation());
    // The control poses' own rotations are products; constructors want them right to rounding.
    let attitudes = poses
        .map(|pose| Pose::new(pose.rotation(), pose.translation()).unwrap_or_default().rotation());
    let (Ok(r3), Ok(plain), Ok(symmetric)) = (
        R3Spline::from_control_points(START, STEP, &points),
        So3Spline::from_control_points(START, STEP, &attitudes),
        SymmetricSo3Spline::from_control_points(START, STEP, &attitudes),
    ) else {
        return report.flag(false);
    };
    for k in 0..8 {
        let t = START + 3_000_000 + black_box(k) * 9_654_321;
        if let (Ok(position), Ok((also, velocity)), Ok(whole)) =
            (r3.position(t), r3.position_and_velocity(t), r3.full(t))
        {
            for v in [position, also, velocity, whole.velocity_w, whole.acceleration_w] {
                three(report, &v);
            }
        }
        for (first, second, whole) in [
            (plain.attitude(t), plain.attitude_and_rate(t), plain.full(t)),
            (symmetric.attitude(t), symmetric.attitude_and_rate(t), symmetric.full(t)),
        ] {
            if let (Ok(attitude), Ok((_, rate)), Ok(whole)) = (first, second, whole) {
                four(report, &attitude);
                three(report, &rate);
                three(report, &whole.angular_acceleration);
            }
        }
    }
    for bad in [f64::NAN, f64::INFINITY, 1.01, 0.0] {
        let w = T::from_f64(black_box(bad));
        let q = Quaternion::new(w, T::ZERO, T::ZERO, T::ZERO);
        report.flag(Pose::new(q, Vector3::from([T::ZERO; 3])).is_ok());
        report.flag(So3Spline::from_control_points(START, STEP, &[q; 4]).is_ok());
        report
            .flag(R3Spline::from_control_points(START, STEP, &[Vector3::from([w; 3]); 4]).is_ok());
    }
    let half_turn = Quaternion::new(T::ZERO, T::ONE, T::ZERO, T::ZERO);
    let level = Quaternion::new(T::ONE, T::ZERO, T::ZERO, T::ZERO);
    report.flag(
        So3Spline::from_control_points(START, STEP, &[level, half_turn, level, level]).is_ok(),
    );
    report.flag(R3Spline::from_control_points(black_box(i64::MAX), STEP, &points).is_ok());
    report.flag(R3Spline::from_control_points(START, black_box(0), &points).is_ok());
}

/// Pose by pose, of double precision.
fn streamed<T: Real>(report: &mut dyn Report) {
    let poses = poses::<f64>(black_box(0.1));
    let Ok(mut stream) = Stream::<f64, T>::new(START, STEP) else { return report.flag(false) };
    for next in &poses {
        report.flag(stream.push(next).is_ok());
        if let Some(curve) = stream.time_symmetric() {
            full(report, curve.full(curve.knots().span().0 + 1_234_567));
        }
        if let Some(curve) = stream.one_sided() {
            full(report, curve.full(curve.knots().span().1));
        }
    }
    stream.restart(0);
    report.flag(stream.one_sided().is_some());
    let [first, second, third, ..] = poses;
    pose(report, quasi_interpolant(&first, &second, &third));
    pose(report, quasi_interpolant_on_screws(&first, &second, &third));
}

/// Exponentials, logarithms, Jacobians and adjoints.
fn groups<T: Real>(report: &mut dyn Report) {
    let mut integers = Integers::new(47);
    for size in SIZES {
        let angular = vector::<T>(&mut integers, size);
        for jacobian in [
            so3::left_jacobian(&angular),
            so3::right_jacobian(&angular),
            so3::inverse_left_jacobian(&angular),
            so3::inverse_right_jacobian(&angular),
        ] {
            nine(report, &jacobian);
        }
        let twist = Twist { linear: vector(&mut integers, 3.0), angular };
        let end = se3::exp(&twist);
        pose(report, Ok(end));
        let back = se3::log(&end.inverse());
        three(report, &back.linear);
        three(report, &back.angular);
        three(report, &end.twist_inside(&twist).bracket(&back).linear);
        for blocks in [
            se3::left_jacobian(&twist),
            se3::right_jacobian(&twist),
            se3::inverse_left_jacobian(&twist),
            se3::inverse_right_jacobian(&twist),
            se3::adjoint(&end),
            se3::small_adjoint(&twist),
        ] {
            nine(report, &blocks.diagonal);
            nine(report, &blocks.corner);
            three(report, &blocks.times(&back).linear);
        }
        let whole = se3::left_jacobian(&twist).matrix();
        whole.iter().for_each(|&x| report.real(x));
    }
}

fn nine<T: Real>(report: &mut dyn Report, m: &Matrix3<T>) {
    m.iter().for_each(|&x| report.real(x));
}

fn three<T: Real>(report: &mut dyn Report, v: &Vector3<T>) {
    v.iter().for_each(|&x| report.real(x));
}

fn four<T: Real>(report: &mut dyn Report, q: &Quaternion<T>) {
    q.coords.iter().for_each(|&x| report.real(x));
}

fn pose<T: Real>(report: &mut dyn Report, pose: Result<Pose<T>, Error>) {
    match pose {
        Ok(pose) => {
            four(report, &pose.rotation());
            three(report, &pose.translation());
        }
        Err(_) => report.flag(false),
    }
}

fn velocity<T: Real>(report: &mut dyn Report, at: Result<PoseAndVelocity<T>, Error>) {
    match at {
        Ok(at) => {
            pose(report, Ok(at.pose));
            three(report, &at.velocity_w);
            three(report, &at.angular_rate);
        }
        Err(_) => report.flag(false),
    }
}

fn full<T: Real>(report: &mut dyn Report, at: Result<Full<T>, Error>) {
    match at {
        Ok(Full { pose: at, velocity_w, acceleration_w, angular_rate, angular_acceleration }) => {
            pose(report, Ok(at));
            for v in [velocity_w, acceleration_w, angular_rate, angular_acceleration] {
                three(report, &v);
            }
        }
        Err(_) => report.flag(false),
    }
}

fn felt<T: Real>(report: &mut dyn Report, sample: Result<Sample<T>, Error>) {
    match sample {
        Ok(sample) => {
            three(report, &sample.angular_rate());
            three(report, &sample.specific_force());
        }
        Err(_) => report.flag(false),
    }
}

macro_rules! cost {
    ($(#[$doc:meta])* $name:ident, $T:ty, $of:ident) => {
        $(#[$doc])*
        pub fn $name(report: &mut dyn Report) {
            let poses = poses::<$T>(black_box(0.05));
            let (mut knots, mut screws) = ([Knot::default(); COUNT], [ScrewKnot::default(); COUNT]);
            report.flag(cache(&poses, &mut knots).is_ok());
            report.flag(cache_screws(&poses, &mut screws).is_ok());
            let (Ok(cached), Ok(uncached), Ok(symmetric), Ok(se3)) = (
                SplitSpline::from_control_points(START, STEP, &knots),
                SplitSpline::from_control_points(START, STEP, &poses),
                SymmetricSplitSpline::from_control_points(START, STEP, &knots),
                Se3Spline::from_control_points(START, STEP, &screws),
            ) else {
                return report.flag(false);
            };
            report.state("knot", size_of::<Knot<$T>>());
            let (t, gravity) = (START + 34_567_890, Vector3::new(0.0, 0.0, -9.81));
            let mut count = |what, work: &mut dyn FnMut()| report.instructions(what, 64, work);
            count("pose", &mut || repeat(64, || $of::pose(black_box(&cached), black_box(t))));
            count("pose and velocity", &mut || {
                repeat(64, || $of::pose_and_velocity(black_box(&cached), black_box(t)));
            });
            count("full", &mut || repeat(64, || $of::full(black_box(&cached), black_box(t))));
            count("IMU", &mut || {
                repeat(64, || $of::imu(black_box(&cached), black_box(t), &gravity));
            });
            count("full uncached", &mut || {
                repeat(64, || $of::uncached_full(black_box(&uncached), black_box(t)));
            });
            count("full symmetric", &mut || {
                repeat(64, || $of::symmetric_full(black_box(&symmetric), black_box(t)));
            });
            count("full SE(3)", &mut || {
                repeat(64, || $of::se3_full(black_box(&se3), black_box(t)));
            });
            report.stack("full", &mut || {
                let _ = black_box($of::full(black_box(&cached), black_box(t)));
            });
        }
    };
}

cost!(
    /// Instructions of one evaluation in single precision, and bytes of one knot.
    cost_in_single,
    f32,
    single
);
cost!(
    /// Instructions of one evaluation in double precision, and bytes of one knot.
    cost_in_double,
    f64,
    double
);
