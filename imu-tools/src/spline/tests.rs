use imu_core::nalgebra::Vector3;
use imu_core::noise::{Normal as _, Xoshiro256PlusPlus};
use imu_core::spline::{SplitSpline, SymmetricSplitSpline};
use imu_core::trajectory::{Ellipse, Motion, Trajectory as _};
use rand_core::SeedableRng as _;

use super::*;

fn on_the_ellipse(stamp_ns: i64) -> TimedPose {
    let motion: Motion<f64> = Ellipse::default().at(stamp_ns);
    let pose = Pose::new(motion.attitude_wb, motion.position_w).unwrap();
    TimedPose { stamp_ns, pose }
}

fn every(step_ns: i64, count: i64) -> Vec<TimedPose> {
    (0..count).map(|k| on_the_ellipse(k * step_ns)).collect()
}

/// Poses with noise of these deviations.
fn jittered(poses: &[TimedPose], position_m: f64, rotation_rad: f64) -> Vec<TimedPose> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
    let mut noise = |sd| Vector3::from([(); 3].map(|()| sd * f64::standard_normal(&mut rng)));
    poses
        .iter()
        .map(|TimedPose { stamp_ns, pose }| {
            let turned = so3::product(&pose.rotation(), &so3::exp(noise(rotation_rad)));
            let pose = Pose::new(turned, pose.translation() + noise(position_m)).unwrap();
            TimedPose { stamp_ns: *stamp_ns, pose }
        })
        .collect()
}

fn options(form: FormName, spacing: Spacing) -> Options {
    Options { form: Some(form), spacing, smoothing_s: 0.0 }
}

#[test]
fn poses_at_equal_steps_are_interpolated() {
    let poses = every(50_000_000, 200);
    for form in [FormName::Plain, FormName::Symmetric] {
        let fit = fit(&poses, &options(form, Spacing::AsPoses)).unwrap();
        assert!(fit.interpolates && fit.control.len() == 202);
        // Roundings of places 25 m away and of quaternions.
        assert!(fit.error.largest_position_m < 2e-14, "{:?}", fit.error);
        assert!(fit.error.largest_rotation_rad < 4e-15, "{:?}", fit.error);
    }
}

#[test]
fn least_squares_find_a_curve_that_is_one() {
    // A curve of known control points, looked at at uneven instants, comes back.
    let coarse = fit(&every(200_000_000, 30), &options(FormName::Plain, Spacing::AsPoses)).unwrap();
    let curve =
        SplitSpline::from_control_points(-200_000_000, 200_000_000, &coarse.control).unwrap();
    // The last one where an interval ends: knots are equal parts of the whole.
    let poses: Vec<_> = (0..=580_i64)
        .map(|k| {
            let uneven_ns = if k < 580 { (k * k * 7919) % 9_000_000 } else { 0 };
            let stamp_ns = k * 10_000_000 + uneven_ns;
            TimedPose { stamp_ns, pose: curve.pose(stamp_ns).unwrap() }
        })
        .collect();
    let again = fit(&poses, &options(FormName::Plain, Spacing::Every(200_000_000))).unwrap();
    assert!(!again.interpolates);
    // Least smoothing, 10⁻¹⁰ of the 20 poses of an interval, of third differences of 0.25 m and 0.002 rad, times 20.
    assert!(again.error.largest_position_m < 1e-8, "{:?}", again.error);
    assert!(again.error.largest_rotation_rad < 1e-10, "{:?}", again.error);
}

#[test]
fn knots_are_as_far_apart_as_the_error_allows() {
    let poses = every(10_000_000, 2000);
    let mut last = u32::MAX;
    for (within, order) in [(1e-2, 4), (1e-4, 4), (1e-6, 4)].map(|(e, n)| (e, f64::from(n))) {
        let spacing = Spacing::Within { position_m: within, rotation_rad: 1.0 };
        let fit = fit(&poses, &options(FormName::Symmetric, spacing)).unwrap();
        assert!(fit.error.largest_position_m <= within);
        // The next candidate is 2^(1/4) further apart and 2 times as far off; least squares halve it at most.
        assert!(fit.error.largest_position_m > within / 8.0, "{within}: {:?}", fit.error);
        let step = fit.knots.step_ns();
        let ratio = f64::from(last) / f64::from(step);
        assert!(last == u32::MAX || (ratio / 100_f64.powf(1.0 / order)).ln().abs() < 0.4);
        last = step;
    }
}

#[test]
fn jitter_is_found_and_what_it_makes() {
    let (position_m, rotation_rad) = (1e-3, 2e-3);
    let clean = every(20_000_000, 12_000);
    let noisy = jittered(&clean, position_m, rotation_rad);
    let fit = fit(&noisy, &options(FormName::Symmetric, Spacing::Every(40_000_000))).unwrap();
    let jitter = fit.jitter.unwrap();
    // 36 000 sizes, seven of which share a pose: the median scatters by 1 %.
    let (found_m, found_rad) =
        (jitter.poses.position_m / position_m, jitter.poses.rotation_rad / rotation_rad);
    assert!((found_m - 1.0).abs() < 0.06 && (found_rad - 1.0).abs() < 0.06, "{jitter:?}");
    let curve = SymmetricSplitSpline::from_control_points(
        fit.knots.start_ns(),
        fit.knots.step_ns(),
        &fit.control,
    );
    let curve = curve.unwrap();
    let (mut acceleration, mut rate, mut count) = (0.0, 0.0, 0.0);
    for k in 100..23_900_i64 {
        let t_ns = k * 10_000_000;
        let full = curve.full(t_ns).unwrap();
        let truth: Motion<f64> = Ellipse::default().at(t_ns);
        let felt = so3::rotate(&truth.attitude_wb, &truth.specific_force);
        let off = full.acceleration_w - felt + Vector3::new(0.0, 0.0, 9.81);
        let turn = full.angular_rate - truth.angular_rate;
        acceleration += off.iter().map(|x| x * x).sum::<f64>() / 3.0;
        rate += turn.iter().map(|x| x * x).sum::<f64>() / 3.0;
        count += 1.0;
    }
    // 6000 intervals of three axes, every two alike: a root mean square scatters by 1/√(2·9000) = 0.75 %. How much
    // jitter was found is no matter here.
    let (acceleration, rate) = (f64::sqrt(acceleration / count), f64::sqrt(rate / count));
    let near = |said: f64, seen: f64, found: f64| (said / (seen * found) - 1.0).abs() < 0.045;
    assert!(near(jitter.acceleration, acceleration, found_m), "{jitter:?} {acceleration}");
    assert!(near(jitter.angular_rate, rate, found_rad), "{jitter:?} {rate}");
}

#[test]
fn smoothing_passes_what_it_says() {
    // One axis swings with 1 Hz: at the half-power frequency half of it is left, at half of that 64 of 65 parts.
    for (hertz, left) in [(1.0, 0.5), (2.0, 64.0 / 65.0)] {
        let poses: Vec<_> = (0..4000_i64)
            .map(|k| {
                let x = (core::f64::consts::TAU * 0.01 * k as f64).sin();
                let place = Vector3::new(x, 0.0, 0.0);
                let pose = Pose::new(so3::exp(place * 0.1), place).unwrap();
                TimedPose { stamp_ns: k * 10_000_000, pose }
            })
            .collect();
        let smoothing_s = 1.0 / (core::f64::consts::TAU * hertz);
        let spacing = Spacing::Every(40_000_000);
        let fit = fit(&poses, &Options { form: Some(FormName::Symmetric), spacing, smoothing_s })
            .unwrap();
        let curve = SymmetricSplitSpline::from_control_points(
            fit.knots.start_ns(),
            40_000_000,
            &fit.control,
        )
        .unwrap();
        let peak = curve.pose(20_250_000_000).unwrap();
        assert!((peak.translation().x - left).abs() < 2e-3, "{hertz} {}", peak.translation().x);
        let turn = so3::log(&peak.rotation()).x / 0.1;
        assert!((turn - left).abs() < 2e-3, "{hertz} {turn}");
    }
}

#[test]
fn a_hole_is_crossed_smoothly() {
    let mut poses = every(20_000_000, 500);
    poses.drain(200..225);
    let fit = fit(&poses, &options(FormName::Symmetric, Spacing::Every(50_000_000))).unwrap();
    let curve =
        SymmetricSplitSpline::from_control_points(fit.knots.start_ns(), 50_000_000, &fit.control)
            .unwrap();
    let middle = 4_250_000_000;
    let (there, truth) = (curve.pose(middle).unwrap(), on_the_ellipse(middle).pose);
    // Half a second across: what a parabola from both sides misses, a few centimetres of a bobbing of 1 m and π rad/s.
    assert!((there.translation() - truth.translation()).abs().max() < 0.05);
}

/// The largest error of acceleration and of ω in the first and the last two intervals.
fn off_at_the_ends(fit: &Fit) -> (f64, f64) {
    let curve = SymmetricSplitSpline::from_control_points(
        fit.knots.start_ns(),
        fit.knots.step_ns(),
        &fit.control,
    )
    .unwrap();
    let (first, last) = fit.span_ns;
    let step = i64::from(fit.knots.step_ns()) / 10;
    let instants = (0..20).flat_map(|k| [first + k * step, last - k * step]);
    instants.fold((0.0, 0.0), |(a, w), t_ns| {
        let (full, truth): (_, Motion<f64>) =
            (curve.full(t_ns).unwrap(), Ellipse::default().at(t_ns));
        let felt = so3::rotate(&truth.attitude_wb, &truth.specific_force);
        let off = full.acceleration_w - felt + Vector3::new(0.0, 0.0, 9.81);
        let turn = full.angular_rate - truth.angular_rate;
        (off.abs().max().max(a), turn.abs().max().max(w))
    })
}

#[test]
fn rounded_stamps_cost_nothing_at_the_ends() {
    let exact: Vec<_> = (0..600_i64).map(|k| on_the_ellipse(k * 1_000_000_000 / 30)).collect();
    let exact = fit(&exact, &options(FormName::Symmetric, Spacing::AsPoses)).unwrap();
    for rounding in [1_000, 1_000_000] {
        let stamps = (0..600_i64).map(|k| (k * 1_000_000_000 / 30 + rounding / 2) / rounding);
        let poses: Vec<_> = stamps.map(|k| on_the_ellipse(k * rounding)).collect();
        let rounded = fit(&poses, &options(FormName::Symmetric, Spacing::AsPoses)).unwrap();
        assert!(rounded.interpolates && rounded.control.len() == 602);
        assert!(rounded.error.largest_position_m < 1e-12, "{:?}", rounded.error);
        assert!(rounded.error.largest_rotation_rad < 1e-13, "{:?}", rounded.error);
        assert_eq!(rounded.span_ns, (poses[0].stamp_ns, poses[599].stamp_ns));
        let ((a, w), (exact_a, exact_w)) = (off_at_the_ends(&rounded), off_at_the_ends(&exact));
        // Half a millisecond of 33 moves every weight by 4 % of what it is.
        assert!(a < 1.5 * exact_a && w < 1.5 * exact_w, "{rounding}: {a} {exact_a}, {w} {exact_w}");
    }
}

#[test]
fn a_spacing_that_does_not_divide_costs_nothing_at_the_end() {
    // 20.01 s in steps of 0.2 s: of an interval more than a hundred, one pose would decide.
    let poses = every(10_000_000, 2002);
    let divided =
        fit(&every(10_000_000, 2001), &options(FormName::Symmetric, Spacing::Every(200_000_000)));
    let fit = fit(&poses, &options(FormName::Symmetric, Spacing::Every(200_000_000))).unwrap();
    assert_eq!((fit.knots.count(), fit.knots.step_ns()), (103, 200_100_000));
    let ((a, _), (divided_a, _)) = (off_at_the_ends(&fit), off_at_the_ends(&divided.unwrap()));
    assert!(a < 1.1 * divided_a, "{a} {divided_a}");
}

#[test]
fn far_from_home_nothing_is_lost() {
    // Stamps with jitter and a hole: intervals that hardly a pose decides.
    let mut far: Vec<_> = (0..1500_i64)
        .map(|k| on_the_ellipse(k * 10_000_000 + (k * k * 7919) % 2_000_000))
        .collect();
    far.drain(700..705);
    let home = Vector3::new(5e5, 5e6, 0.0);
    let moved = |pose: &Pose<f64>, by| Pose::new(pose.rotation(), pose.translation() + by).unwrap();
    for pose in &mut far {
        pose.pose = moved(&pose.pose, home);
    }
    // Back again: of places rounded there, differences are exact.
    let near: Vec<_> = far
        .iter()
        .map(|TimedPose { stamp_ns, pose }| TimedPose {
            stamp_ns: *stamp_ns,
            pose: moved(pose, -home),
        })
        .collect();
    let options = options(FormName::Symmetric, Spacing::Every(10_000_000));
    let (near, far) = (fit(&near, &options).unwrap(), fit(&far, &options).unwrap());
    let acceleration = |fit: &Fit, t_ns: i64| {
        let curve = SymmetricSplitSpline::from_control_points(
            fit.knots.start_ns(),
            10_000_000,
            &fit.control,
        );
        curve.unwrap().full(t_ns).unwrap().acceleration_w
    };
    for t_ns in (near.span_ns.0..near.span_ns.1).step_by(3_000_000) {
        let off = acceleration(&near, t_ns) - acceleration(&far, t_ns);
        // Control points there are rounded by half of 2⁻³⁰ m: 4·2⁻³¹·10⁴ = 1.9e-5 m/s² of a second difference.
        assert!(off.abs().max() < 2e-5, "{t_ns}: {off}");
    }
}

#[test]
fn slow_smoothing_keeps_its_digits() {
    // A parabola passes any smoothing: its third differences are none.
    let poses: Vec<_> = (0..2000_i64)
        .map(|k| {
            let t = 0.01 * k as f64;
            let place = Vector3::new(3.0 * t, 0.5 * t * t, -t);
            TimedPose {
                stamp_ns: k * 10_000_000,
                pose: Pose::new(so3::exp(place * 0.0), place).unwrap(),
            }
        })
        .collect();
    for hertz in [1.0, 0.3, 0.1, 0.05] {
        let smoothing_s = 1.0 / (core::f64::consts::TAU * hertz);
        let spacing = Spacing::Every(10_000_000);
        let fit = fit(&poses, &Options { form: Some(FormName::Plain), spacing, smoothing_s });
        match fit {
            // Roundings of 200 m.
            Ok(fit) => assert!(fit.error.largest_position_m < 1e-9, "{hertz}: {:?}", fit.error),
            Err(error) => {
                assert!(hertz < 0.1 && matches!(error, FitError::Undecided(_)), "{hertz}: {error}")
            }
        }
    }
}

#[test]
fn attitudes_go_the_short_way_across_long_holes() {
    for hole in [100, 400, 2000] {
        let mut poses = every(50_000_000, 3000);
        let ends = (poses[599], poses[600 + hole]);
        poses.drain(600..600 + hole);
        let turn = so3::product(&so3::inverse(&ends.0.pose.rotation()), &ends.1.pose.rotation());
        let turn: [f64; 3] = so3::log(&turn).into();
        let even = turn[0].hypot(turn[1]).hypot(turn[2]) / (0.05 * (hole as f64 + 1.0));
        for form in [FormName::Plain, FormName::Symmetric] {
            let fit = fit(&poses, &options(form, Spacing::AsPoses)).unwrap();
            assert!(fit.error.largest_rotation_rad < 1e-3, "{:?}", fit.error);
            assert_eq!(fit.bridged, 1);
            let curve = fit.route().unwrap();
            let (begin, end) = (ends.0.stamp_ns, ends.1.stamp_ns);
            for t_ns in (begin..=end).step_by(10_000_000) {
                let rate = curve.full(t_ns).unwrap().angular_rate;
                // At the edges it still turns as the ellipse does, by less than 1.5 rad/s in any axis.
                let calm = (t_ns - begin).min(end - t_ns) > 1_000_000_000;
                let most = if calm { 1.1 * even + 0.05 } else { 4.0 };
                assert!(rate.abs().max() < most, "{hole} {form:?} {t_ns}: {rate:?} {even}");
            }
        }
    }
}

#[test]
fn what_makes_no_curve_is_refused() {
    let poses = every(50_000_000, 20);
    let plain = |spacing| options(FormName::Plain, spacing);
    assert_eq!(fit(&poses[..3], &plain(Spacing::AsPoses)), Err(FitError::TooFew(3)));
    let mut swapped = poses.clone();
    swapped.swap(4, 5);
    assert_eq!(fit(&swapped, &plain(Spacing::AsPoses)), Err(FitError::Backwards(6)));
    let refused =
        |poses: &[TimedPose], spacing| fit(poses, &plain(spacing)).unwrap_err().to_string();
    assert!(refused(&poses, Spacing::Every(2_000_000_000)).contains("further apart"));
    assert!(refused(&poses, Spacing::Every(0)).contains("further apart"));
    assert!(refused(&poses, Spacing::Every(1)).contains("control points"));
    assert!(refused(&every(6_000_000_000, 20), Spacing::AsPoses).contains("4.29 s apart at most"));
    let early: Vec<_> = poses
        .iter()
        .map(|pose| TimedPose { stamp_ns: i64::MIN + pose.stamp_ns, pose: pose.pose })
        .collect();
    assert!(refused(&early, Spacing::AsPoses).contains("take an epoch nearer"));
    let none = Spacing::Within { position_m: 0.0, rotation_rad: 0.0 };
    assert!(refused(&jittered(&poses, 1.0, 0.1), none).contains("no curve stays"));
    let mut jumps = poses.clone();
    let half_turn = so3::exp(Vector3::new(0.0, 0.0, core::f64::consts::PI));
    let turned = so3::product(&jumps[9].pose.rotation(), &half_turn);
    jumps[10].pose = Pose::new(turned, jumps[10].pose.translation()).unwrap();
    assert_eq!(fit(&jumps, &plain(Spacing::AsPoses)), Err(FitError::Turn));
}
