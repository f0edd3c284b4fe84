//! `imu_core::{sample, time, integrate, state, world, delta}`: thousands of steps of every rule on every kind of state,
//! what is refused, and what a step costs.

use crate::inputs::Integers;
use crate::{Report, repeat};
use core::hint::black_box;
use imu_core::delta::Delta;
use imu_core::integrate::{
    ConingSculling, Euler, Halves, Midpoint, PreviousIncrement, Rule, TextbookEuler,
    TextbookMidpoint, ThreeSample, TwoSample,
};
use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::sample::{Bias, Increment, Sample};
use imu_core::time::Step;
use imu_core::world::{Flat, RotatingEarth};
use imu_core::{Compensated, Real, State};

/// Steps of each rule on all kinds of state: a hash of all states is compared.
const STEPS: u32 = 1000;

/// Steps of each rule on a plain state: a hundred thousand where the environment says so while this is built.
const LONG: u32 = if option_env!("IMU_FIRMWARE_LONG").is_some() { 100_000 } else { 1000 };

macro_rules! price {
    ($report:ident, $T:ty, $step:ident) => {
        let mut integers = Integers::new(29);
        let (Some(sample), Some(increment), Some(halves), Some(begin), Ok(dt)) = (
            sample::<$T>(&mut integers),
            increment::<$T>(&mut integers),
            halves::<$T>(&mut integers),
            begin::<$T>(),
            Step::<$T>::from_nanoseconds(black_box(1_000_000)),
        ) else {
            return $report.flag(false);
        };
        let flat = flat::<$T>();
        let mut state = begin;
        let mut compensated = Compensated::from(begin);
        $report.state("plain", size_of_val(&state));
        $report.state("compensated", size_of_val(&compensated));
        price!(@ $report, state, flat, dt,
            "Euler", Euler, $step::euler, sample;
            "midpoint", Midpoint::new(&sample), $step::midpoint, sample;
            "coning and sculling", ConingSculling::new(&sample), $step::coning_sculling, sample;
            "three samples", ThreeSample::new(&sample), $step::three_sample, sample;
            "two samples", TwoSample, $step::two_sample, halves;
            "previous increment", PreviousIncrement::new(), $step::previous_increment, increment;
        );
        price!(@ $report, compensated, flat, dt,
            "compensated midpoint", Midpoint::new(&sample), $step::compensated_midpoint, sample;
            "compensated coning and sculling", ConingSculling::new(&sample),
                $step::compensated_coning_sculling, sample;
            "compensated three samples", ThreeSample::new(&sample),
                $step::compensated_three_sample, sample;
        );
        let (rate, force) = (sample.angular_rate(), sample.specific_force());
        $report.instructions("checking a sample", CALLS, &mut || {
            repeat(CALLS, || Sample::new(*black_box(&rate), *black_box(&force)));
        });
    };
    (@ $report:ident, $state:ident, $flat:ident, $dt:ident,
        $($what:literal, $rule:expr, $step:path, $input:ident;)*) => {$(
        let mut rule = $rule;
        $report.state(concat!($what, " rule"), size_of_val(&rule));
        $report.instructions($what, CALLS, &mut || {
            for _ in 0..CALLS {
                $step(black_box(&mut $state), &mut rule, black_box(&$input), &$dt, &$flat);
            }
        });
    )*};
}

/// The bits of every rule's every state, and what is refused.
pub fn case<T: Real>(report: &mut dyn Report) {
    let Some(first) = sample::<T>(&mut Integers::new(5)) else { return report.flag(false) };
    run(report, &mut Euler, sample::<T>);
    run(report, &mut Midpoint::new(&first), sample::<T>);
    run(report, &mut ConingSculling::new(&first), sample::<T>);
    run(report, &mut ThreeSample::new(&first), sample::<T>);
    run(report, &mut TextbookEuler, sample::<T>);
    run(report, &mut TextbookMidpoint::new(&first), sample::<T>);
    run(report, &mut TwoSample, halves::<T>);
    run(report, &mut PreviousIncrement::new(), increment::<T>);
    uneven_halves::<T>(report);
    refusals::<T>(report);
}

fn uneven_halves<T: Real>(report: &mut dyn Report) {
    let mut integers = Integers::new(23);
    for lengths in [[1, 1], [1_000_000, 3_000_000], [4_000_000_000, 4_000_000_000]] {
        let [Ok(first), Ok(second)] = lengths.map(|ns| Step::<T>::from_nanoseconds(black_box(ns)))
        else {
            return report.flag(false);
        };
        let Some(halves) = halves(&mut integers) else { return report.flag(false) };
        let delta = TwoSample::uneven(&halves, &first, &second);
        report.flag(delta.is_some());
        if let Some(delta) = delta {
            delta.rotation().coords.iter().for_each(|&x| report.real(x));
            delta.velocity().iter().chain(&delta.position()).for_each(|&x| report.real(x));
        }
    }
}

fn refusals<T: Real>(report: &mut dyn Report) {
    for nanoseconds in [0, -1, 1 << 32, i64::MAX, 1, 999_999_937] {
        let step = Step::<T>::from_nanoseconds(black_box(nanoseconds));
        report.flag(step.is_ok());
        report.real(step.map_or(T::ZERO, |step| step.seconds()));
    }
    let zero = Vector3::from([T::ZERO; 3]);
    for bad in [f64::NAN, f64::INFINITY, -1e30, 1e7, 1.0] {
        let bad = Vector3::new(T::ZERO, T::from_f64(black_box(bad)), T::ONE);
        report.flag(Sample::new(bad, zero).is_ok());
        report.flag(Increment::new(zero, bad).is_ok());
        report.flag(Bias::new(bad, zero).is_ok());
        report.flag(Flat::new(bad).is_ok());
        report
            .flag(State::new(Quaternion::new(bad.y, bad.y, T::ZERO, T::ZERO), zero, zero).is_ok());
        report.flag(RotatingEarth::<T>::new(bad.y.to_f64(), bad.y.to_f64()).is_ok());
    }
}

/// One rule on a plain state, a compensated one, one in blocks, and one on the turning Earth.
fn run<T: Real, R: Rule<T>>(
    report: &mut dyn Report,
    rule: &mut R,
    mut input: impl FnMut(&mut Integers) -> Option<R::Input>,
) {
    long(report, rule, &mut input);
    let (mut integers, flat) = (Integers::new(17), flat::<T>());
    let Some(earth) = RotatingEarth::<T>::new(black_box(0.8), black_box(400.0)).ok() else {
        return;
    };
    let Some(mut plain) = begin::<T>() else { return };
    let (mut blocks, mut turning) = (plain, plain);
    let mut compensated = Compensated::from(plain);
    let mut compensated_turning = compensated;
    let mut block = Delta::identity();
    let mut hash = 0xcbf2_9ce4_8422_2325;
    for k in 0..STEPS {
        // Uneven now and then, and a hole.
        let nanoseconds = match k % 64 {
            20 => 2_000_000,
            40 => 1_300_000,
            60 => 400_000_000,
            _ => 1_000_000,
        };
        let (Some(input), Ok(dt)) = (input(&mut integers), Step::from_nanoseconds(nanoseconds))
        else {
            return report.flag(false);
        };
        let delta = rule.step(&input, &dt);
        plain.apply(&delta, &flat);
        compensated.apply(&delta, &flat);
        turning.apply(&delta, &earth);
        compensated_turning.apply(&delta, &earth);
        block = block.then(&delta);
        if k % 8 == 7 {
            blocks.apply(&block, &flat);
            block = block.then(&block.inverse());
        }
        for state in [&plain, &blocks, &turning, &compensated.state(), &compensated_turning.state()]
        {
            each(state, |x| hash = fold(hash, x));
        }
    }
    report.word(hash);
    each(&turning, |x| report.real(x));
    each(&compensated.state(), |x| report.real(x));
}

/// One rule for long on a plain state, as dead reckoning advances it.
fn long<T: Real, R: Rule<T>>(
    report: &mut dyn Report,
    rule: &mut R,
    input: &mut impl FnMut(&mut Integers) -> Option<R::Input>,
) {
    let (mut integers, flat) = (Integers::new(19), flat::<T>());
    let (Some(mut state), Ok(dt)) = (begin::<T>(), Step::from_nanoseconds(black_box(1_000_000)))
    else {
        return report.flag(false);
    };
    let mut hash = 0xcbf2_9ce4_8422_2325;
    for _ in 0..LONG {
        let Some(input) = input(&mut integers) else { return report.flag(false) };
        state.advance(rule, &input, &dt, &flat);
        each(&state, |x| hash = fold(hash, x));
    }
    report.word(hash);
    each(&state, |x| report.real(x));
}

/// Fowler, Noll and Vo's hash of the bits of a number; every NaN counts as the same.
fn fold<T: Real>(hash: u64, x: T) -> u64 {
    let bits = if x.to_f64().is_nan() { u64::MAX } else { x.bits() };
    (hash ^ bits).wrapping_mul(0x0100_0000_01b3)
}

fn each<T: Real>(state: &State<T>, mut look: impl FnMut(T)) {
    state.attitude_wb().coords.iter().for_each(|&x| look(x));
    state.velocity_w().iter().for_each(|&x| look(x));
    state.position_w().iter().for_each(|&x| look(x));
}

fn begin<T: Real>() -> Option<State<T>> {
    let real = |x: f64| T::from_f64(black_box(x));
    let zero = Vector3::from([T::ZERO; 3]);
    State::new(Quaternion::new(real(0.9), real(0.1), real(-0.2), real(0.3)), zero, zero).ok()
}

fn flat<T: Real>() -> Flat<T> {
    let gravity = Vector3::from([0.0, 0.0, -9.81].map(|x| T::from_f64(black_box(x))));
    Flat::new(gravity).unwrap_or_default()
}

fn vector<T: Real>(integers: &mut Integers, size: f64) -> Vector3<T> {
    let size = T::from_f64(size);
    Vector3::new(
        integers.unit::<T>() * size,
        integers.unit::<T>() * size,
        integers.unit::<T>() * size,
    )
}

fn sample<T: Real>(integers: &mut Integers) -> Option<Sample<T>> {
    Sample::new(vector(integers, 20.0), vector(integers, 40.0)).ok()
}

fn halves<T: Real>(integers: &mut Integers) -> Option<Halves<T>> {
    Some(Halves { first: increment(integers)?, second: increment(integers)? })
}

fn increment<T: Real>(integers: &mut Integers) -> Option<Increment<T>> {
    Increment::new(vector(integers, 0.02), vector(integers, 0.04)).ok()
}

/// Calls that a count averages.
const CALLS: u32 = 256;

/// Instructions of one whole call, on a flat world, and bytes of what is kept between calls.
pub fn cost_in_single(report: &mut dyn Report) {
    use imu_core::integrate::single as step;
    price!(report, f32, step);
}

/// As [`cost_in_single`].
pub fn cost_in_double(report: &mut dyn Report) {
    use imu_core::integrate::double as step;
    price!(report, f64, step);
}
