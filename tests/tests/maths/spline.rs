//! Splines: their derivatives, how smooth and how close they are, what time reversed does, single precision, and what
//! is refused.

use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::se3::Pose;
use imu_core::spline::{
    Full, Knot, R3Spline, ScrewKnot, Se3Spline, So3Spline, SplitSpline, SymmetricSo3Spline,
    SymmetricSplitSpline, cache, cache_screws, quasi_interpolant, quasi_interpolant_on_screws,
};
use imu_core::trajectory::{Ellipse, Motion, Trajectory};
use imu_core::{Error, so3};
use proptest::prelude::*;

type V3 = Vector3<f64>;

fn any_pose() -> impl Strategy<Value = Pose<f64>> {
    [-0.4..0.4, -0.4..0.4, -0.4..0.4, -2.0..2.0, -2.0..2.0, -2.0..2.0_f64].prop_map(
        |[a, b, c, x, y, z]| {
            Pose::new(so3::exp(Vector3::new(a, b, c)), Vector3::new(x, y, z)).unwrap()
        },
    )
}

/// What a curve says of an instant.
type Evaluation<'a> = Box<dyn Fn(i64) -> Full<f64> + 'a>;

/// One curve of each kind through the same control poses, a second apart.
fn curves<'a>(
    poses: &'a [Pose<f64>],
    knots: &'a mut [Knot<f64>],
    screws: &'a mut [ScrewKnot<f64>],
) -> Vec<(&'static str, Evaluation<'a>)> {
    const H: u32 = 1_000_000_000;
    cache(poses, knots).unwrap();
    cache_screws(poses, screws).unwrap();
    let (knots, screws) = (&*knots, &*screws);
    let plain = SplitSpline::from_control_points(0, H, poses).unwrap();
    let cached = SplitSpline::from_control_points(0, H, knots).unwrap();
    let symmetric = SymmetricSplitSpline::from_control_points(0, H, poses).unwrap();
    let symmetric_cached = SymmetricSplitSpline::from_control_points(0, H, knots).unwrap();
    let coupled = Se3Spline::from_control_points(0, H, poses).unwrap();
    let coupled_cached = Se3Spline::from_control_points(0, H, screws).unwrap();
    vec![
        ("split", Box::new(move |t| plain.full(t).unwrap())),
        ("split, cached", Box::new(move |t| cached.full(t).unwrap())),
        ("symmetric", Box::new(move |t| symmetric.full(t).unwrap())),
        ("symmetric, cached", Box::new(move |t| symmetric_cached.full(t).unwrap())),
        ("SE(3)", Box::new(move |t| coupled.full(t).unwrap())),
        ("SE(3), cached", Box::new(move |t| coupled_cached.full(t).unwrap())),
    ]
}

fn turn(a: &Pose<f64>, b: &Pose<f64>) -> V3 {
    so3::log(&so3::product(&so3::inverse(&a.rotation()), &b.rotation()))
}

fn largest(v: V3) -> f64 {
    v.abs().max()
}

/// (8(f(h) − f(−h)) − (f(2h) − f(−2h)))/12h of values less the middle one.
fn difference(h: f64, values: [V3; 4]) -> V3 {
    let [far_before, before, after, far_after] = values;
    ((after - before) * 8.0 - (far_after - far_before)) / (12.0 * h)
}

proptest! {
    /// Central differences of fourth order over h = 1 ms of a second: off by h⁴/30 of fifth derivatives below 1e3, that
    /// is 3e-11, and by roundings of 1e-15 over h, 2e-12. Relative to the size of the derivative, or 1.
    #[test]
    fn derivatives_are_derivatives(
        poses in proptest::collection::vec(any_pose(), 5), at in 1.01..2.99_f64
    ) {
        const H: i64 = 1_000_000;
        // Not across a knot, where third derivatives jump.
        prop_assume!((at - 2.0).abs() > 0.01);
        let t = (at * 1e9) as i64;
        for (name, full) in curves(&poses, &mut [Knot::default(); 5], &mut [ScrewKnot::default(); 5]) {
            let now = full(t);
            let around = [-2, -1, 1, 2].map(|k| full(t + k * H));
            let by = |of: &dyn Fn(&Full<f64>) -> V3| difference(1e-3, [0, 1, 2, 3].map(|k| of(&around[k])));
            let near = |a: V3, b: V3, limit: f64| largest(a - b) <= limit * (1.0 + largest(b));
            let velocity = by(&|f| f.pose.translation() - now.pose.translation());
            prop_assert!(near(velocity, now.velocity_w, 1e-8), "{name}");
            // Log of R(t)ᵀR(t + s) is ωs + …, its slope at s = 0 is ω.
            prop_assert!(near(by(&|f| turn(&now.pose, &f.pose)), now.angular_rate, 1e-8), "{name}");
            prop_assert!(near(by(&|f| f.velocity_w), now.acceleration_w, 1e-6), "{name}");
            prop_assert!(near(by(&|f| f.angular_rate), now.angular_acceleration, 1e-6), "{name}");
        }
    }

    /// From either side of a knot: everything up to the second derivative agrees to a nanosecond's change of it, and
    /// third derivatives of up to 100 per second make 1e-7 of one: so taken at the knot itself, as the end of a shorter
    /// curve and within a longer one.
    #[test]
    fn second_derivatives_do_not_jump_at_knots(poses in proptest::collection::vec(any_pose(), 5)) {
        let (shorter, longer) = (&poses[..4], &poses[..]);
        let (mut a, mut b) = ([Knot::default(); 4], [ScrewKnot::default(); 4]);
        let (mut c, mut d) = ([Knot::default(); 5], [ScrewKnot::default(); 5]);
        let (before, after) = (curves(shorter, &mut a, &mut b), curves(longer, &mut c, &mut d));
        for ((name, before), (_, after)) in before.iter().zip(&after) {
            let (x, y) = (before(2_000_000_000), after(2_000_000_000));
            prop_assert!(largest(turn(&x.pose, &y.pose)) < 1e-12, "{name}");
            for (x, y) in [
                (x.pose.translation(), y.pose.translation()),
                (x.velocity_w, y.velocity_w),
                (x.acceleration_w, y.acceleration_w),
                (x.angular_rate, y.angular_rate),
                (x.angular_acceleration, y.angular_acceleration),
            ] {
                prop_assert!(largest(x - y) < 1e-12, "{name}: {:e}", largest(x - y));
            }
        }
    }

    /// Reversed control points are the reversed curve; the one-sided one is another, by commutators.
    #[test]
    fn the_symmetric_curve_runs_either_way(poses in proptest::collection::vec(any_pose(), 4), at in 0..=1_000_000_000_i64) {
        let reversed: Vec<_> = poses.iter().rev().copied().collect();
        let (there, back) = (1_000_000_000 + at, 2_000_000_000 - at);
        let forwards = SymmetricSplitSpline::from_control_points(0, 1_000_000_000, &poses).unwrap();
        let backwards = SymmetricSplitSpline::from_control_points(0, 1_000_000_000, &reversed).unwrap();
        let (a, b) = (forwards.full(there).unwrap(), backwards.full(back).unwrap());
        // Of numbers up to 2 and 12: a few roundings.
        let off = |q: Quaternion<f64>, r: Quaternion<f64>| (q.coords - r.coords).abs().max();
        prop_assert!(off(a.pose.rotation(), b.pose.rotation()) <= 1e-15);
        prop_assert!(largest(a.pose.translation() - b.pose.translation()) <= 2e-15);
        prop_assert!(largest(a.velocity_w + b.velocity_w) <= 2e-15);
        prop_assert!(largest(a.acceleration_w - b.acceleration_w) <= 1e-14);
        prop_assert!(largest(a.angular_rate + b.angular_rate) <= 2e-15);
        prop_assert!(largest(a.angular_acceleration - b.angular_acceleration) <= 1e-14);
    }

    /// A control point of them all is the curve, and a rigid motion of them all is one of the curve: roundings of 10 m.
    #[test]
    fn curves_move_with_their_control_points(
        poses in proptest::collection::vec(any_pose(), 5), by in any_pose(), at in 1.0..3.0_f64
    ) {
        let t = (at * 1e9) as i64;
        let moved: Vec<_> = poses.iter().map(|pose| by.then(pose)).collect();
        let (mut a, mut b) = ([Knot::default(); 5], [ScrewKnot::default(); 5]);
        let (mut c, mut d) = ([Knot::default(); 5], [ScrewKnot::default(); 5]);
        let same = curves(&poses, &mut a, &mut b);
        for ((name, one), (_, other)) in same.iter().zip(&curves(&moved, &mut c, &mut d)) {
            let (one, other) = (one(t), other(t));
            prop_assert!(largest(turn(&by.then(&one.pose), &other.pose)) < 2e-15, "{name}");
            let there = by.then(&one.pose).translation();
            prop_assert!(largest(there - other.pose.translation()) < 3e-14, "{name}");
            prop_assert!(largest(one.angular_rate - other.angular_rate) < 1e-14, "{name}");
            let turned = so3::rotate(&by.rotation(), &one.acceleration_w);
            prop_assert!(largest(turned - other.acceleration_w) < 2e-13, "{name}");
        }
        let still = [by; 5];
        for (name, full) in curves(&still, &mut [Knot::default(); 5], &mut [ScrewKnot::default(); 5]) {
            let full = full(t);
            prop_assert!(largest(turn(&full.pose, &by)) < 1e-15, "{name}");
            prop_assert!(largest(full.pose.translation() - by.translation()) < 1e-15, "{name}");
            prop_assert!(largest(full.acceleration_w) < 1e-14 && largest(full.angular_acceleration) < 1e-14);
        }
    }

    /// Sign flips of quaternions change nothing.
    #[test]
    fn signs_do_not_matter(poses in proptest::collection::vec(any_pose(), 5), flips in [any::<bool>(); 5]) {
        let points: Vec<_> = poses.iter().map(Pose::rotation).collect();
        let flip = |(q, flip): (&Quaternion<f64>, bool)| if flip { Quaternion::from(-q.coords) } else { *q };
        let flipped: Vec<_> = points.iter().zip(flips).map(flip).collect();
        let t = 1_400_000_000;
        let h = 1_000_000_000;
        let a = So3Spline::from_control_points(0, h, &points).unwrap().full(t).unwrap();
        let b = So3Spline::from_control_points(0, h, &flipped).unwrap().full(t).unwrap();
        prop_assert_eq!((a.angular_rate, a.angular_acceleration), (b.angular_rate, b.angular_acceleration));
        let a = SymmetricSo3Spline::from_control_points(0, h, &points).unwrap().full(t).unwrap();
        let b = SymmetricSo3Spline::from_control_points(0, h, &flipped).unwrap().full(t).unwrap();
        prop_assert_eq!((a.angular_rate, a.angular_acceleration), (b.angular_rate, b.angular_acceleration));
    }
}

/// The cheaper questions have the same answers.
#[test]
fn every_question_has_one_answer() {
    let poses: Vec<_> = ellipse(100_000_000, 12);
    let (points, places): (Vec<_>, Vec<_>) =
        poses.iter().map(|pose| (pose.rotation(), pose.translation())).unzip();
    let h = 100_000_000;
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let split = SplitSpline::from_control_points(0, h, &poses).unwrap();
    let symmetric = SymmetricSplitSpline::from_control_points(0, h, &poses).unwrap();
    let (so3_plain, so3_symmetric) = (
        So3Spline::from_control_points(0, h, &points).unwrap(),
        SymmetricSo3Spline::from_control_points(0, h, &points).unwrap(),
    );
    let r3 = R3Spline::from_control_points(0, h, &places).unwrap();
    for k in 0..=100 {
        let t = 100_000_000 + k * 9_000_000;
        macro_rules! same {
            ($curve:ident, $attitude:ident) => {
                let full = $curve.full(t).unwrap();
                let part = $curve.pose_and_velocity(t).unwrap();
                assert_eq!($curve.pose(t).unwrap(), full.pose);
                assert_eq!((part.pose, part.velocity_w), (full.pose, full.velocity_w));
                assert_eq!(part.angular_rate, full.angular_rate);
                let sample = $curve.imu(t, &gravity).unwrap();
                assert_eq!(sample.angular_rate(), full.angular_rate);
                let back = so3::inverse(&full.pose.rotation());
                let felt = so3::rotate(&back, &(full.acceleration_w - gravity));
                assert_eq!(sample.specific_force(), felt);
                let alone = $attitude.full(t).unwrap();
                let with_rate = $attitude.attitude_and_rate(t).unwrap();
                assert_eq!(alone.attitude_wb, full.pose.rotation());
                assert_eq!($attitude.attitude(t).unwrap(), alone.attitude_wb);
                assert_eq!(with_rate, (alone.attitude_wb, alone.angular_rate));
                assert_eq!(alone.angular_acceleration, full.angular_acceleration);
                let place = r3.full(t).unwrap();
                assert_eq!(place.position_w, full.pose.translation());
                assert_eq!(place.acceleration_w, full.acceleration_w);
                assert_eq!(r3.position(t).unwrap(), place.position_w);
                let with_velocity = r3.position_and_velocity(t).unwrap();
                assert_eq!(with_velocity, (place.position_w, place.velocity_w));
            };
        }
        same!(split, so3_plain);
        same!(symmetric, so3_symmetric);
    }
}

fn at(t_ns: i64) -> Motion<f64> {
    Ellipse::default().at(t_ns)
}

fn pose_at(t_ns: i64) -> Pose<f64> {
    let motion = at(t_ns);
    Pose::new(motion.attitude_wb, motion.position_w).unwrap()
}

fn ellipse(step_ns: i64, count: i64) -> Vec<Pose<f64>> {
    (0..count).map(|k| pose_at(k * step_ns)).collect()
}

/// The slope of log error over log step, by least squares.
pub(super) fn order(errors: impl Iterator<Item = (f64, f64)>) -> f64 {
    let points: Vec<_> = errors.map(|(h, error)| (h.ln(), error.ln())).collect();
    let mean = points.iter().map(|(x, _)| x).sum::<f64>() / points.len() as f64;
    let spread: f64 = points.iter().map(|(x, _)| (x - mean).powi(2)).sum();
    points.iter().map(|(x, y)| (x - mean) * y).sum::<f64>() / spread
}

/// A control point of three poses.
type OfThree = fn(&Pose<f64>, &Pose<f64>, &Pose<f64>) -> Result<Pose<f64>, Error>;

/// Control points every step of 20 s of the ellipse and a little more.
fn controls(step_ns: i64, of_three: OfThree) -> Vec<Pose<f64>> {
    (0..20_000_000_000 / step_ns + 5)
        .map(|k| {
            let near = [-1, 0, 1].map(|side| pose_at((k + side) * step_ns));
            of_three(&near[0], &near[1], &near[2]).unwrap()
        })
        .collect()
}

/// Largest errors of attitude, ω, position and acceleration of a curve from `step_ns` on over 20 s of the ellipse.
fn errors(step_ns: i64, curve: impl Fn(i64) -> Result<Full<f64>, Error>) -> [f64; 4] {
    let mut worst = [0.0_f64; 4];
    for k in 0..4000 {
        let t = step_ns + k * 5_000_000 + 1_234_567;
        let full = curve(t).unwrap();
        let truth = at(t);
        let acceleration =
            so3::rotate(&truth.attitude_wb, &truth.specific_force) - Vector3::new(0.0, 0.0, 9.81);
        let off = [
            turn(&pose_at(t), &full.pose),
            full.angular_rate - truth.angular_rate,
            full.pose.translation() - truth.position_w,
            full.acceleration_w - acceleration,
        ];
        for (worst, off) in worst.iter_mut().zip(off) {
            *worst = worst.max(largest(off));
        }
    }
    worst
}

/// Orders of [`errors`] over steps of 100 to 12 ms.
fn orders(errors: impl Fn(i64) -> [f64; 4]) -> [f64; 4] {
    let errors = [100, 50, 25, 12].map(|ms| (f64::from(ms), errors(i64::from(ms) * 1_000_000)));
    [0, 1, 2, 3].map(|k| order(errors.iter().map(|(h, e)| (*h, e[k]))))
}

/// The local quasi-interpolant on the classic trajectory, to ±0.15.
#[test]
fn orders_are_those_of_the_formulas() {
    let split = |step_ns: i64, symmetric: bool| {
        let points = controls(step_ns, quasi_interpolant);
        let plain = SplitSpline::from_control_points(0, step_ns as u32, &points).unwrap();
        let mean = SymmetricSplitSpline::from_control_points(0, step_ns as u32, &points).unwrap();
        errors(step_ns, |t| if symmetric { mean.full(t) } else { plain.full(t) })
    };
    let coupled = |step_ns: i64, of_three: OfThree| {
        let points = controls(step_ns, of_three);
        let curve = Se3Spline::from_control_points(0, step_ns as u32, &points).unwrap();
        errors(step_ns, |t| curve.full(t))
    };
    for (name, measured, wanted) in [
        ("plain", orders(|step| split(step, false)), [3.0, 2.0, 4.0, 2.0]),
        ("symmetric", orders(|step| split(step, true)), [4.0, 3.0, 4.0, 2.0]),
    ] {
        for (measured, wanted) in measured.iter().zip(wanted) {
            assert!((measured - wanted).abs() < 0.15, "{name}: {measured} of {wanted}");
        }
    }
    // On screws what attitudes lack in order (3, and 2 of ω) comes to show in positions as steps become short.
    let [rotation, rate, position, _] = orders(|step| coupled(step, quasi_interpolant_on_screws));
    assert!((rotation - 3.0).abs() < 0.15 && (rate - 2.0).abs() < 0.15, "{rotation} {rate}");
    assert!((2.85..4.15).contains(&position), "{position}");
    // Made for positions beside attitudes, control points give them order 2.
    let [_, _, position, _] = orders(|step| coupled(step, quasi_interpolant));
    assert!((position - 2.0).abs() < 0.15, "{position}");
}

/// 100 knots a second over 20 m, in f32: differences are rounded to half a unit of at most 0.1 m, 3.7e-9 m, so second
/// differences to 7.5e-9 m, and that times 10⁴ s⁻² is 7.5e-5; the rest are roundings of 10 m/s².
#[test]
fn acceleration_in_single_precision() {
    let poses = ellipse(10_000_000, 2003);
    let mut knots = vec![Knot::<f32>::default(); poses.len()];
    cache(&poses, &mut knots).unwrap();
    let mut screws = vec![ScrewKnot::<f32>::default(); poses.len()];
    cache_screws(&poses, &mut screws).unwrap();
    let rounded: Vec<Pose<f32>> = poses.iter().map(Pose::cast).collect();
    // The largest errors of a, ω and α of one curve in the two precisions.
    macro_rules! errors {
        ($Curve:ident, $single:expr) => {{
            let single = $Curve::from_control_points(0, 10_000_000, $single).unwrap();
            let double = $Curve::from_control_points(0, 10_000_000, &poses).unwrap();
            let mut worst = [0.0_f64; 3];
            for k in 0..20_000 {
                let t = 10_000_000 + k * 999_983;
                let (exact, here) = (double.full(t).unwrap(), single.full(t).unwrap());
                let off = [
                    here.acceleration_w.map(f64::from) - exact.acceleration_w,
                    here.angular_rate.map(f64::from) - exact.angular_rate,
                    here.angular_acceleration.map(f64::from) - exact.angular_acceleration,
                ];
                for (worst, off) in worst.iter_mut().zip(off) {
                    *worst = worst.max(largest(off));
                }
            }
            println!(
                "{} f32: a {:e}, ω {:e}, α {:e}",
                stringify!($Curve),
                worst[0],
                worst[1],
                worst[2]
            );
            worst
        }};
    }
    for [a, rate, angular] in [errors!(SplitSpline, &knots), errors!(SymmetricSplitSpline, &knots)]
    {
        assert!(a <= 1e-4, "{a:e}");
        // Half a unit of turns of 0.004 rad, 2.3e-10, times 10⁴ s⁻² and two of them; and of ω times 10² s⁻¹.
        assert!(rate <= 2e-7 && angular <= 1e-5, "{rate:e} {angular:e}");
    }
    // On screws velocities turn, too: 10 m/s by roundings of ω, and ω × v, twice.
    let [a, rate, angular] = errors!(Se3Spline, &screws);
    assert!(a <= 2e-4 && rate <= 2e-7 && angular <= 1e-5, "{a:e} {rate:e} {angular:e}");
    // Of absolute positions.
    let [careless, ..] = errors!(SplitSpline, &rounded);
    assert!(careless > 3e-3);
}

#[test]
fn what_makes_no_curve_is_refused_by_name() {
    let pose = Pose::<f64>::identity();
    let three = [pose; 3];
    assert_eq!(
        SplitSpline::from_control_points(0, 1000, &three).unwrap_err(),
        Error::OutOfRange("count")
    );
    assert_eq!(
        Se3Spline::from_control_points(0, 1000, &three).unwrap_err(),
        Error::OutOfRange("count")
    );
    assert_eq!(
        SplitSpline::from_control_points(0, 0, &[pose; 4]).unwrap_err(),
        Error::OutOfRange("step_ns")
    );
    let four = [pose; 4];
    let late = SplitSpline::from_control_points(i64::MAX - 1000, 1000, &four);
    assert_eq!(late.unwrap_err(), Error::OutOfRange("count"));

    let apart = Error::OutOfRange("turn between neighbours");
    for (beyond, refused) in [(-1.1e-3, false), (-0.6e-3, true), (0.5e-3, true), (1.1e-3, false)] {
        let angle = core::f64::consts::PI + beyond;
        let turned = Pose::new(so3::exp(Vector3::new(0.0, angle, 0.0)), Vector3::zeros()).unwrap();
        let four = [pose, pose, turned, pose];
        assert_eq!(SplitSpline::from_control_points(0, 1000, &four).is_err(), refused, "{angle}");
        if refused {
            assert_eq!(Se3Spline::from_control_points(0, 1000, &four).unwrap_err(), apart);
            assert_eq!(cache(&four, &mut [Knot::<f32>::default(); 4]).unwrap_err(), apart);
            assert_eq!(quasi_interpolant(&pose, &turned, &pose).unwrap_err(), apart);
            let attitudes = four.map(|pose| pose.rotation());
            assert_eq!(
                SymmetricSo3Spline::from_control_points(0, 1000, &attitudes).unwrap_err(),
                apart
            );
        }
    }
    // Knots not filled, reversed, or of two curves; and those that are one.
    let poses = ellipse(10_000_000, 8);
    let (mut knots, mut screws) = ([Knot::<f32>::default(); 8], [ScrewKnot::<f32>::default(); 8]);
    let points = Error::OutOfRange("points");
    for filled in [0, 5, 7, 8] {
        cache(&poses[..filled], &mut knots[..filled]).unwrap();
        cache_screws(&poses[..filled], &mut screws[..filled]).unwrap();
        let whole = filled == 8;
        assert_eq!(SplitSpline::from_control_points(0, 1000, &knots).is_ok(), whole, "{filled}");
        assert_eq!(Se3Spline::from_control_points(0, 1000, &screws).is_ok(), whole, "{filled}");
    }
    assert_eq!((knots[3].pose(), screws[3].pose()), (poses[3].cast(), poses[3].cast()));
    knots.reverse();
    screws.reverse();
    assert_eq!(SymmetricSplitSpline::from_control_points(0, 1000, &knots).unwrap_err(), points);
    assert_eq!(Se3Spline::from_control_points(0, 1000, &screws).unwrap_err(), points);

    let mut few = [Knot::<f64>::default(); 3];
    assert_eq!(cache(&[pose; 4], &mut few).unwrap_err(), Error::OutOfRange("knots"));

    let fine = Quaternion::new(1.0, 0.0, 0.0, 0.0);
    for w in [f64::NAN, 0.0, 1.0 + 1e-12, f64::INFINITY] {
        let four = [fine, Quaternion::new(w, 0.0, 0.0, 0.0), fine, fine];
        assert_eq!(So3Spline::from_control_points(0, 1000, &four).unwrap_err(), points);
    }
    for x in [f64::NAN, f64::NEG_INFINITY, 2e9] {
        let four =
            [Vector3::zeros(), Vector3::new(0.0, x, 0.0), Vector3::zeros(), Vector3::zeros()];
        assert_eq!(R3Spline::from_control_points(0, 1000, &four).unwrap_err(), points);
    }
}

#[test]
fn there_is_no_curve_outside_its_span() {
    let poses = [Pose::<f32>::identity(); 6];
    let curve = SplitSpline::from_control_points(-5000, 1000, &poses).unwrap();
    assert_eq!(curve.knots().span(), (-4000, -1000));
    for t in [i64::MIN, -5000, -4001, -999, 0, i64::MAX] {
        assert_eq!(curve.pose(t), Err(Error::OutOfRange("t_ns")));
        assert_eq!(curve.full(t).unwrap_err(), Error::OutOfRange("t_ns"));
    }
    assert!(curve.pose(-4000).is_ok() && curve.full(-1000).is_ok());
    // What no sensor reads: a metre within a nanosecond.
    let jump = [0.0, 0.0, 1.0, 0.0].map(|x| {
        Pose::new(Quaternion::new(1.0, 0.0, 0.0, 0.0), Vector3::new(x, 0.0, 0.0)).unwrap()
    });
    let curve = SplitSpline::from_control_points(0, 1, &jump).unwrap();
    let felt = curve.imu(1, &Vector3::zeros());
    assert_eq!(felt.unwrap_err(), Error::OutOfRange("specific_force"));
}
