//! `imu_core::preintegrate`: deltas, Jacobians and covariances of several rules over many intervals, what is refused,
//! and what a step costs.

use crate::Report;
use crate::inputs::Integers;
use core::hint::black_box;
use imu_core::Real;
use imu_core::delta::Delta;
use imu_core::integrate::{Halves, Midpoint, PreviousIncrement, ThreeSample, TwoSample};
use imu_core::nalgebra::Vector3;
use imu_core::preintegrate::{
    BiasJacobian, Covariance, Mean, NoiseDensities, WithCovariance, WithJacobian, double, single,
};
use imu_core::sample::{Bias, Increment, Sample};
use imu_core::time::Step;

/// Intervals of each rule, and steps in each.
const INTERVALS: u32 = 12;
const STEPS: u32 = 20;

/// All three of the same samples by the midpoint rule: the bits of whatever comes out, interval by interval. The steps
/// are the concrete ones, each compiled once: in double precision on a device that has none it is a large thing.
macro_rules! bits {
    ($report:ident, $T:ty, $step:ident) => {
        let Some(first) = sample::<$T>(&mut Integers::new(5)) else { return $report.flag(false) };
        let (mut integers, rule) = (Integers::new(37), Midpoint::new(&first));
        let mut mean = Mean::new(rule, Bias::default());
        let mut linear = WithJacobian::new(rule, Bias::default());
        let Ok(mut whole) = WithCovariance::new(rule, Bias::default(), &densities()) else {
            return $report.flag(false);
        };
        for interval in 0..INTERVALS {
            for step in 0..STEPS {
                let (Some(input), Some(dt)) = (sample(&mut integers), length(step)) else {
                    return $report.flag(false);
                };
                $step::midpoint_mean(&mut mean, &input, &dt);
                $step::midpoint_with_jacobian(&mut linear, &input, &dt);
                $step::midpoint_with_covariance(&mut whole, &input, &dt);
            }
            $report.word(interval.into());
            let new = bias(&mut integers, 0.1);
            delta($report, &linear.corrected(&new));
            $report.flag(whole.delta() == mean.delta() && whole.jacobian() == linear.jacobian());
            all($report, &whole.delta(), &whole.jacobian(), &whole.covariance());
            $report.real(whole.gyro_bias_variance());
            $report.real(whole.accel_bias_variance());
            mean.restart(new);
            linear.restart(new);
            whole.restart(new);
        }
        increments::<$T>($report);
        pairs::<$T>($report);
        for bad in [f64::NAN, f64::INFINITY, -1e-30, 1e7, 0.0] {
            let bad = <$T>::from_f64(black_box(bad));
            let densities = NoiseDensities { accel_random_walk: bad, ..densities() };
            $report.flag(WithCovariance::new(rule, Bias::default(), &densities).is_ok());
        }
    };
}

/// In single precision.
pub fn case_in_single(report: &mut dyn Report) {
    bits!(report, f32, single);
}

/// In double precision.
pub fn case_in_double(report: &mut dyn Report) {
    bits!(report, f64, double);
}

/// Biases of increments.
fn increments<T: Real>(report: &mut dyn Report) {
    let mut integers = Integers::new(31);
    let mut mean = Mean::new(PreviousIncrement::new(), bias::<T>(&mut integers, 0.1));
    for step in 0..STEPS {
        let (Some(input), Some(dt)) = (increment(&mut integers), length(step)) else {
            return report.flag(false);
        };
        mean.step(&input, &dt);
        delta(report, &mean.delta());
    }
    mean.restart(bias(&mut integers, 0.1));
    delta(report, &mean.delta());
}

/// Biases of pairs of increments.
fn pairs<T: Real>(report: &mut dyn Report) {
    let mut integers = Integers::new(41);
    let mut mean = Mean::new(TwoSample, bias::<T>(&mut integers, 0.1));
    for step in 0..STEPS {
        let (Some(input), Some(dt)) = (halves(&mut integers), length(step)) else {
            return report.flag(false);
        };
        mean.step(&input, &dt);
        delta(report, &mean.delta());
    }
}

/// Now and then a step that turns far.
fn length<T: Real>(step: u32) -> Option<Step<T>> {
    Step::from_nanoseconds(if step % 16 == 11 { 60_000_000 } else { 1_000_000 }).ok()
}

#[inline(never)]
fn all<T: Real>(
    report: &mut dyn Report,
    moved: &Delta<T>,
    jacobian: &BiasJacobian<T>,
    covariance: &Covariance<T>,
) {
    delta(report, moved);
    for block in [
        &jacobian.rotation_gyro,
        &jacobian.velocity_gyro,
        &jacobian.velocity_accel,
        &jacobian.position_gyro,
        &jacobian.position_accel,
        &covariance.rotation,
        &covariance.rotation_velocity,
        &covariance.rotation_position,
        &covariance.velocity,
        &covariance.velocity_position,
        &covariance.position,
    ] {
        block.iter().for_each(|&x| report.real(x));
    }
}

#[inline(never)]
fn delta<T: Real>(report: &mut dyn Report, delta: &Delta<T>) {
    delta.rotation().coords.iter().for_each(|&x| report.real(x));
    delta.velocity().iter().chain(&delta.position()).for_each(|&x| report.real(x));
}

fn densities<T: Real>() -> NoiseDensities<T> {
    let [gyro_noise_density, accel_noise_density, gyro_random_walk, accel_random_walk] =
        [2e-3, 2e-2, 1e-5, 1e-4].map(|x| T::from_f64(black_box(x)));
    NoiseDensities { gyro_noise_density, accel_noise_density, gyro_random_walk, accel_random_walk }
}

fn vector<T: Real>(integers: &mut Integers, size: f64) -> Vector3<T> {
    let size = T::from_f64(size);
    Vector3::from([(); 3].map(|()| integers.unit::<T>() * size))
}

fn bias<T: Real>(integers: &mut Integers, size: f64) -> Bias<T> {
    Bias::new(vector(integers, size), vector(integers, size)).unwrap_or_default()
}

fn sample<T: Real>(integers: &mut Integers) -> Option<Sample<T>> {
    Sample::new(vector(integers, 20.0), vector(integers, 40.0)).ok()
}

fn increment<T: Real>(integers: &mut Integers) -> Option<Increment<T>> {
    Increment::new(vector(integers, 0.02), vector(integers, 0.04)).ok()
}

fn halves<T: Real>(integers: &mut Integers) -> Option<Halves<T>> {
    Some(Halves { first: increment(integers)?, second: increment(integers)? })
}

/// Calls that a count averages.
const CALLS: u32 = 256;

macro_rules! price {
    ($report:ident, $sample:ident, $dt:ident, $($what:literal, $new:expr, $step:path;)*) => {$(
        let mut it = $new;
        $report.state($what, size_of_val(&it));
        $report.instructions($what, CALLS, &mut || {
            for _ in 0..CALLS {
                $step(black_box(&mut it), black_box(&$sample), &$dt);
            }
        });
    )*};
}

/// Instructions of one whole step, and bytes of what is kept between steps.
pub fn cost(report: &mut dyn Report) {
    let (Some(sample), Ok(dt)) = (
        sample::<f32>(&mut Integers::new(29)),
        Step::<f32>::from_nanoseconds(black_box(1_000_000)),
    ) else {
        return report.flag(false);
    };
    let none = Bias::default();
    let (midpoint, three) = (Midpoint::new(&sample), ThreeSample::new(&sample));
    let (Ok(whole), Ok(whole_of_three)) = (
        WithCovariance::new(midpoint, none, &densities()),
        WithCovariance::new(three, none, &densities()),
    ) else {
        return report.flag(false);
    };
    price!(report, sample, dt,
        "mean", Mean::new(midpoint, none), single::midpoint_mean;
        "with Jacobian", WithJacobian::new(midpoint, none), single::midpoint_with_jacobian;
        "with covariance", whole, single::midpoint_with_covariance;
        "three samples with covariance", whole_of_three, single::three_sample_with_covariance;
    );
    let mut whole = whole;
    report.instructions("reading Jacobian and covariance", 1, &mut || {
        black_box((black_box(&mut whole).jacobian(), whole.covariance()));
    });
    report.stack("with covariance", &mut || {
        single::midpoint_with_covariance(black_box(&mut whole), black_box(&sample), &dt);
    });
}
