use super::*;
use crate::delta::Delta;
use crate::integrate::{
    ConingSculling, Euler, Halves, Midpoint, PreviousIncrement, Rule, ThreeSample, TwoSample,
};
use crate::matrix::{Rows, add_scaled, matrix, skew};
use crate::sample::{Bias, Increment, Sample};
use crate::time::Step;
use crate::{Error, Real, so3};
use nalgebra::{Matrix3, SMatrix, Vector3};
use proptest::prelude::*;
use std::vec::Vec;

pub(super) type Matrix9 = SMatrix<f64, 9, 9>;

/// A body that turns by 2 rad/s and is shaken, `k` 200ths of a second after the beginning.
pub(super) fn felt(k: u32) -> (Vector3<f64>, Vector3<f64>) {
    let t = f64::from(k) / 200.0;
    let (slow, fast) = ((3.0 * t).sin(), (9.0 * t).cos());
    (
        Vector3::new(1.2 + 0.5 * fast, -0.8 * slow, 1.5),
        Vector3::new(4.0 * slow, 2.0, 9.81 + 3.0 * fast),
    )
}

pub(super) fn step_200_hz<T: Real>() -> Step<T> {
    Step::from_nanoseconds(5_000_000).unwrap()
}

pub(super) fn sample<T: Real>(k: u32) -> Sample<T> {
    let (rate, force) = felt(k);
    Sample::new(cast(rate), cast(force)).unwrap()
}

fn cast<T: Real>(v: Vector3<f64>) -> Vector3<T> {
    Vector3::from(<[f64; 3]>::from(v).map(T::from_f64))
}

/// Means over the step that ends at `k`, by Simpson's rule.
fn increment(k: u32, halves: u32, part: u32) -> Increment<f64> {
    let h = 0.005 / f64::from(halves);
    let at = |x: f64| {
        let t = f64::from(k - 1) + (f64::from(part) + x) / f64::from(halves);
        let (whole, rest) = (t.floor(), t - t.floor());
        let ((rate, force), (rate_1, force_1)) = (felt(whole as u32), felt(whole as u32 + 1));
        (rate * (1.0 - rest) + rate_1 * rest, force * (1.0 - rest) + force_1 * rest)
    };
    let (a, b, c) = (at(0.0), at(0.5), at(1.0 - 1e-9));
    let mean = |a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>| (a + b * 4.0 + c) * (h / 6.0);
    Increment::new(mean(a.0, b.0, c.0), mean(a.1, b.1, c.1)).unwrap()
}

pub(super) fn bias(gyro: [f64; 3], accel: [f64; 3]) -> Bias<f64> {
    Bias::new(gyro.into(), accel.into()).unwrap()
}

pub(super) fn densities<T: Real>() -> NoiseDensities<T> {
    NoiseDensities {
        gyro_noise_density: T::from_f64(2e-3),
        accel_noise_density: T::from_f64(2e-2),
        gyro_random_walk: T::from_f64(1e-5),
        accel_random_walk: T::from_f64(1e-4),
    }
}

/// (δθ, δv, δp) from one delta to the other.
pub(super) fn error(from: &Delta<f64>, to: &Delta<f64>) -> [Vector3<f64>; 3] {
    let turned = so3::log(&so3::product(&so3::inverse(&from.rotation()), &to.rotation()));
    [turned, to.velocity() - from.velocity(), to.position() - from.position()]
}

fn apart(a: &Delta<f64>, b: &Delta<f64>) -> f64 {
    error(a, b).iter().map(|v| v.abs().max()).fold(0.0, f64::max)
}

/// The delta of `n` steps at any bias; what `start` makes of the bias is the rule behind its first input.
fn mean<R: Rule<f64>>(
    start: impl Fn(&Bias<f64>) -> R,
    input: impl Fn(u32) -> R::Input,
    n: u32,
    bias: &Bias<f64>,
) -> Delta<f64>
where
    R::Input: Biased<f64>,
{
    let mut mean = Mean::new(start(bias), *bias);
    (1..=n).for_each(|k| mean.step(&input(k), &step_200_hz()));
    mean.delta()
}

/// The largest difference of each block from central differences, as a part of the largest element of the block.
fn from_differences<R: Rule<f64>>(
    start: impl Fn(&Bias<f64>) -> R,
    input: impl Fn(u32) -> R::Input,
    n: u32,
) -> [f64; 5]
where
    R::Input: Biased<f64>,
{
    const H: f64 = 1e-4;
    let at = bias([0.02, -0.01, 0.03], [0.1, 0.2, -0.3]);
    let mut linear = WithJacobian::new(start(&at), at);
    (1..=n).for_each(|k| linear.step(&input(k), &step_200_hz()));
    let jacobian = linear.jacobian();
    // Columns of (θ, v, p) by axes of the gyroscope, then of the accelerometer.
    let mut columns = [[Matrix3::zeros(); 3]; 2];
    for (sensor, blocks) in columns.iter_mut().enumerate() {
        for axis in 0..3 {
            let moved = |by: f64| {
                let (mut rate, mut force) = (at.angular_rate(), at.specific_force());
                [&mut rate, &mut force][sensor][axis] += by;
                mean(&start, &input, n, &Bias::new(rate, force).unwrap())
            };
            for (block, change) in blocks.iter_mut().zip(error(&moved(-H), &moved(H))) {
                block.set_column(axis, &(change / (2.0 * H)));
            }
        }
    }
    let [[theta, velocity, position], [none, velocity_accel, position_accel]] = columns;
    assert!(none.abs().max() < 1e-12);
    [
        (jacobian.rotation_gyro, theta),
        (jacobian.velocity_gyro, velocity),
        (jacobian.velocity_accel, velocity_accel),
        (jacobian.position_gyro, position),
        (jacobian.position_accel, position_accel),
    ]
    .map(|(analytic, difference)| (analytic - difference).abs().max() / difference.abs().max())
}

/// Differences are off by h²/6 of the third derivative, about t²/6 of the first: 2e-9; rounding adds 1e-15/h = 1e-11.
#[test]
fn jacobians_are_the_derivatives_of_the_midpoint_rule() {
    let start = |bias: &Bias<f64>| Midpoint::new(&sample(0).minus(bias));
    for n in [1, 2, 20, 200] {
        for (block, off) in from_differences(start, sample, n).into_iter().enumerate() {
            assert!(off < 1e-8, "{n} steps, block {block}: {off:e}");
        }
    }
}

/// 20 steps of 0.01 rad. What a step adds beyond the first order is a part in 20 of the whole (Euler, which does not
/// turn the force within a step) or 0.01/20 of it, in ∂p/∂b_g twice to thrice as much: the figures in the documentation of
/// `BiasJacobian`, here with a half to spare.
#[test]
fn jacobians_are_right_to_first_order_for_every_rule() {
    let worst = |off: [f64; 5]| off.into_iter().fold(0.0, f64::max);
    let less = |bias: &Bias<f64>| sample(0).minus(bias);
    let n = 20;
    let all = [
        worst(from_differences(|_| Euler, sample, n)),
        worst(from_differences(|bias| ConingSculling::new(&less(bias)), sample, n)),
        worst(from_differences(|bias| ThreeSample::new(&less(bias)), sample, n)),
        worst(from_differences(|_| PreviousIncrement::new(), |k| increment(k, 1, 0), n)),
        worst(from_differences(
            |_| TwoSample,
            |k| Halves { first: increment(k, 2, 0), second: increment(k, 2, 1) },
            n,
        )),
    ];
    for (off, most) in all.into_iter().zip([0.12, 9e-4, 1.8e-3, 1.9e-3, 1.9e-3]) {
        assert!(off < most, "{all:?}");
    }
}

#[test]
fn a_corrected_delta_errs_by_the_square_of_the_change() {
    let start = |bias: &Bias<f64>| Midpoint::new(&sample(0).minus(bias));
    let mut linear = WithJacobian::new(start(&Bias::default()), Bias::default());
    (1..=100).for_each(|k| linear.step(&sample(k), &step_200_hz()));
    let off = |size: f64| {
        let changed = bias([0.1, -0.2, 0.3].map(|x| x * size), [0.5, 0.1, -0.4].map(|x| x * size));
        apart(&linear.corrected(&changed), &mean(start, sample, 100, &changed))
    };
    // A quarter, up to the third order: 0.3 rad/s times half a second.
    let ratio = off(0.1) / off(0.05);
    assert!((3.8..4.2).contains(&ratio), "{ratio}");
    assert!(off(0.1) < 5e-4, "{}", off(0.1));
    assert_eq!(linear.corrected(&Bias::default()).velocity(), linear.delta().velocity());
}

#[test]
fn the_mean_is_the_product_of_all_steps_to_the_bit() {
    let (mut rule, dt) = (ThreeSample::new(&sample::<f32>(0)), step_200_hz());
    let mut mean = Mean::new(rule, Bias::default());
    let mut product = Delta::identity();
    for k in 1..50 {
        mean.step(&sample(k), &dt);
        product = product.then(&rule.step(&sample(k), &dt));
    }
    assert_eq!(mean.delta(), product);
}

/// The same numbers added in the same order, of samples that differ by the rounding of a bias: 30 m/s² and 1 s, a few
/// units of 4e-15.
#[test]
fn the_next_interval_is_as_if_begun_there() {
    let (old, new) = (bias([0.01; 3], [0.1; 3]), bias([0.02, 0.0, -0.01], [0.3, 0.2, 0.1]));
    let dt = step_200_hz();
    let less = |k| sample(k).minus(&new);
    let mut began =
        WithCovariance::new(ThreeSample::new(&sample(0).minus(&old)), old, &densities()).unwrap();
    (1..=40).for_each(|k| began.step(&sample(k), &dt));
    began.restart(new);
    // A rule with the same past.
    let mut rule = ThreeSample::new(&less(38));
    rule.step(&less(39), &dt);
    rule.step(&less(40), &dt);
    let mut fresh = WithCovariance::new(rule, new, &densities()).unwrap();
    for k in 41..=80 {
        began.step(&sample(k), &dt);
        fresh.step(&sample(k), &dt);
    }
    assert_eq!(began.bias(), new);
    assert!(apart(&began.delta(), &fresh.delta()) < 1e-13);
    let same = |a: &Matrix3<f64>, b: &Matrix3<f64>| (a - b).abs().max() < 1e-12 * b.abs().max();
    assert!(same(&began.jacobian().position_gyro, &fresh.jacobian().position_gyro));
    assert!(same(&began.covariance().position, &fresh.covariance().position));
    assert_eq!(began.gyro_bias_variance(), 1e-5 * 1e-5 * 0.2);
    assert_eq!(began.accel_bias_variance(), 1e-4 * 1e-4 * 0.2);
}

#[test]
fn increments_forget_the_old_bias_too() {
    let (old, new) = (bias([0.01; 3], [0.1; 3]), bias([0.02, 0.0, -0.01], [0.3, 0.2, 0.1]));
    let dt = step_200_hz();
    let mut began = Mean::new(PreviousIncrement::new(), old);
    // Nothing to take a bias out of.
    began.restart(new);
    assert_eq!(began, Mean::new(PreviousIncrement::new(), new));
    began.restart(old);
    began.step(&increment(1, 1, 0), &dt);
    began.restart(new);
    let mut rule = PreviousIncrement::new();
    rule.step(&increment(1, 1, 0).minus(&new, &dt), &dt);
    let mut fresh = Mean::new(rule, new);
    began.step(&increment(2, 1, 0), &dt);
    fresh.step(&increment(2, 1, 0), &dt);
    assert!(apart(&began.delta(), &fresh.delta()) < 1e-16);
}

#[test]
fn what_is_no_density_is_refused_by_name() {
    let new = |densities| {
        WithCovariance::new(Midpoint::new(&sample(0)), Bias::default(), &densities).map(|_| ())
    };
    for bad in [-1e-30, f32::NAN, f32::INFINITY, 1.1e6] {
        let refused = |what| Err(Error::OutOfRange(what));
        let fine = densities();
        assert_eq!(
            new(NoiseDensities { gyro_noise_density: bad, ..fine }),
            refused("gyro_noise_density")
        );
        assert_eq!(
            new(NoiseDensities { accel_noise_density: bad, ..fine }),
            refused("accel_noise_density")
        );
        assert_eq!(
            new(NoiseDensities { gyro_random_walk: bad, ..fine }),
            refused("gyro_random_walk")
        );
        assert_eq!(
            new(NoiseDensities { accel_random_walk: bad, ..fine }),
            refused("accel_random_walk")
        );
    }
    let none = NoiseDensities {
        gyro_noise_density: 0.0,
        accel_noise_density: 0.0,
        gyro_random_walk: 0.0,
        accel_random_walk: 0.0,
    };
    assert!(new(none).is_ok());
}

pub(super) fn dense(covariance: &Covariance<f64>) -> Matrix9 {
    let mut dense = Matrix9::zeros();
    let Covariance { rotation, rotation_velocity, rotation_position, .. } = covariance;
    let Covariance { velocity, velocity_position, position, .. } = covariance;
    for (row, column, block) in [
        (0, 0, rotation),
        (0, 3, rotation_velocity),
        (0, 6, rotation_position),
        (3, 3, velocity),
        (3, 6, velocity_position),
        (6, 6, position),
    ] {
        dense.fixed_view_mut::<3, 3>(column, row).copy_from(&block.transpose());
        dense.fixed_view_mut::<3, 3>(row, column).copy_from(block);
    }
    dense
}

/// The errors behind two deltas, (δθ, δv, δp) of the first and of the second.
fn composed(first: &Delta<f64>, second: &Delta<f64>) -> (Matrix9, Matrix9) {
    let turn = |q| matrix(&crate::matrix::rotation(&q));
    let (r1, r2) = (turn(first.rotation()), turn(second.rotation()));
    let cross = |v: &Vector3<f64>| matrix(&skew(v));
    let mut of_first = Matrix9::identity();
    let mut of_second = Matrix9::zeros();
    let t = second.nanoseconds() as f64 / 1e9;
    of_first.fixed_view_mut::<3, 3>(0, 0).copy_from(&r2.transpose());
    of_first.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-r1 * cross(&second.velocity())));
    of_first.fixed_view_mut::<3, 3>(6, 0).copy_from(&(-r1 * cross(&second.position())));
    of_first.fixed_view_mut::<3, 3>(6, 3).copy_from(&(Matrix3::identity() * t));
    of_second.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
    of_second.fixed_view_mut::<3, 3>(3, 3).copy_from(&r1);
    of_second.fixed_view_mut::<3, 3>(6, 6).copy_from(&r1);
    (of_first, of_second)
}

/// Whether elements agree to a part of what their rows' and columns' deviations allow.
fn agree(a: &Matrix9, b: &Matrix9, part: f64) -> bool {
    (0..81).all(|i| {
        let (row, column) = (i % 9, i / 9);
        let scale = (b[(row, row)] * b[(column, column)]).sqrt();
        (a[(row, column)] - b[(row, column)]).abs() <= part * scale
    })
}

/// By the recursion in (δθ, δv, δp) of dense matrices: another way to the same numbers, through some hundred
/// operations a step, and differences of things up to ten times larger.
#[test]
fn the_covariance_is_that_of_the_dense_recursion() {
    let dt = step_200_hz();
    let mut ours =
        WithCovariance::new(Midpoint::new(&sample(0)), Bias::default(), &densities()).unwrap();
    let mut rule = Midpoint::new(&sample(0));
    let (mut moved, mut dense_form) = (Delta::identity(), Matrix9::zeros());
    let (g, n, h) = (2e-3 * 2e-3 * 0.005, 2e-2 * 2e-2 * 0.005, 0.005);
    for k in 1..=200 {
        ours.step(&sample(k), &dt);
        let step = rule.step(&sample(k), &dt);
        let (of_past, of_step) = composed(&moved, &step);
        let axes = matrix(&crate::matrix::rotation(&step.rotation()));
        // What the noise of the step's turn does to its velocity: ∂Δv/∂θ = −½dt E[f₁]×.
        let by_turn = -axes * matrix(&skew(&felt(k).1)) * (0.5 * h);
        let mut by = SMatrix::<f64, 9, 3>::zeros();
        by.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
        by.fixed_view_mut::<3, 3>(3, 0).copy_from(&by_turn);
        by.fixed_view_mut::<3, 3>(6, 0).copy_from(&(by_turn * (0.5 * h)));
        let mut noise = by * by.transpose() * g;
        for axis in 0..3 {
            noise[(3 + axis, 3 + axis)] += n;
            noise[(3 + axis, 6 + axis)] += 0.5 * n * h;
            noise[(6 + axis, 3 + axis)] += 0.5 * n * h;
            noise[(6 + axis, 6 + axis)] += n * h * h / 3.0;
        }
        dense_form =
            of_past * dense_form * of_past.transpose() + of_step * noise * of_step.transpose();
        moved = moved.then(&step);
        assert!(agree(&dense(&ours.covariance()), &dense_form, 1e-12), "{k}");
    }
}

/// f32 against f64: 200 steps of half a unit of 6e-8 each, at random, and ten times that by differences.
#[test]
fn single_precision_loses_few_digits() {
    fn run<T: Real>() -> ([Matrix3<f64>; 6], Rows<f64>) {
        let mut it =
            WithCovariance::new(Midpoint::new(&sample(0)), Bias::default(), &densities::<T>())
                .unwrap();
        (1..=200).for_each(|k| it.step(&sample(k), &step_200_hz()));
        let (c, j) = (it.covariance(), it.jacobian());
        let double = |m: Matrix3<T>| {
            Matrix3::from(<[[T; 3]; 3]>::from(m).map(|column| column.map(T::to_f64)))
        };
        let blocks = [
            c.rotation,
            c.velocity,
            c.velocity_position,
            c.position,
            j.position_gyro,
            j.position_accel,
        ];
        let delta = it.delta();
        let widened = |v: Vector3<T>| Vector3::from(<[T; 3]>::from(v).map(T::to_f64));
        let rows = [so3::log(&delta.rotation()), delta.velocity(), delta.position()].map(widened);
        (blocks.map(double), rows)
    }
    let ((double, exact), (single, rows)) = (run::<f64>(), run::<f32>());
    for (a, b) in single.iter().zip(double) {
        assert!((a - b).abs().max() < 1e-5 * b.abs().max(), "{a} {b}");
    }
    for row in add_scaled(&rows, -1.0, &exact) {
        assert!(row.abs().max() < 3e-5);
    }
}

proptest! {
    // As above: a hundred operations a step and differences, of intervals of up to two seconds.
    #[test]
    fn two_intervals_make_one(a in 1_u32..200, b in 1_u32..200, wrong in [-0.1..0.1, -0.1..0.1, -0.1..0.1]) {
        let (at, dt) = (bias(wrong, wrong), step_200_hz());
        let begin = || {
            let rule = Midpoint::new(&sample(0).minus(&at));
            WithCovariance::new(rule, at, &densities()).unwrap()
        };
        let (mut whole, mut parts) = (begin(), begin());
        let steps: Vec<u32> = (1..=a + b).collect();
        let mut of_first = None;
        for k in steps {
            whole.step(&sample(k), &dt);
            parts.step(&sample(k), &dt);
            if k == a {
                of_first = Some(parts);
                parts.restart(at);
            }
        }
        let first = of_first.unwrap();
        prop_assert!(apart(&first.delta().then(&parts.delta()), &whole.delta()) < 1e-12);
        let (one, two) = composed(&first.delta(), &parts.delta());
        let sum = one * dense(&first.covariance()) * one.transpose()
            + two * dense(&parts.covariance()) * two.transpose();
        prop_assert!(agree(&dense(&whole.covariance()), &sum, 1e-10));
        // And the Jacobians: by the same maps.
        let stacked = |j: BiasJacobian<f64>| {
            let mut stack = SMatrix::<f64, 9, 6>::zeros();
            for (row, column, block) in [
                (0, 0, j.rotation_gyro), (3, 0, j.velocity_gyro), (3, 3, j.velocity_accel),
                (6, 0, j.position_gyro), (6, 3, j.position_accel),
            ] {
                stack.fixed_view_mut::<3, 3>(row, column).copy_from(&block);
            }
            stack
        };
        let sum = one * stacked(first.jacobian()) + two * stacked(parts.jacobian());
        let off = (sum - stacked(whole.jacobian())).abs().max();
        prop_assert!(off < 1e-12 * sum.abs().max(), "{}", off);
    }
}
