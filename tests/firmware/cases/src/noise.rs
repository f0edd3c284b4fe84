//! `imu_core::noise`: normal numbers, the first three terms and their compositions; what a term left
//! out costs. The other terms: `terms`.

use crate::{Report, repeat};
use core::hint::black_box;
use imu_core::noise::{
    Axis, Channel, ConstantBias, Normal, RandomWalk, Sensor, Stage, Term, TermId, ThreeAxis, White,
};

/// Enough numbers for every branch of the ziggurat, its tail (3 in 10 000) included.
const DRAWS: u32 = 8192;
/// Steps that a count averages.
const STEPS: u32 = 1024;

/// The composition of the three.
type Terms<T> = (White<T>, RandomWalk<T>, ConstantBias<T>);

fn terms<T: Normal>() -> Terms<T> {
    let [noise_density, random_walk, constant_bias] =
        [0.019, 5e-4, 0.05].map(|x| T::from_f64(black_box(x)));
    (White { noise_density }, RandomWalk { random_walk }, ConstantBias { constant_bias })
}

pub(crate) fn channel() -> Channel {
    Channel::new(black_box(7), Sensor::ACCELEROMETER, Axis::Y)
}

/// Normals, every term alone and composed, three axes, blocks; refused parameters.
pub fn case<T: Normal>(report: &mut dyn Report) {
    let dt = T::from_f64(black_box(0.005));
    let truth = T::from_f64(black_box(9.81));

    let mut rng: T::Generator = channel().stream(TermId::WHITE);
    for _ in 0..DRAWS / 8 {
        let mut sum = T::ZERO;
        for _ in 0..7 {
            sum += T::standard_normal(&mut rng);
        }
        report.real(sum);
        report.real(T::standard_normal(&mut rng));
    }

    let (white, walk, constant) = terms::<T>();
    stage(report, white.prepare(dt, channel()), truth);
    stage(report, walk.prepare(dt, channel()), truth);
    stage(report, constant.prepare(dt, channel()), truth);
    stage(report, terms::<T>().prepare(dt, channel()), truth);
    let three = ThreeAxis::prepare([terms::<T>(); 3], dt, black_box(7), Sensor::GYROSCOPE);
    report.flag(three.is_ok());
    if let Ok(mut three) = three {
        for _ in 0..64 {
            for value in three.bias().into_iter().chain(three.step([truth, -truth, T::ZERO])) {
                report.real(value);
            }
        }
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let bad = T::from_f64(black_box(bad));
        report.flag(white.prepare(bad, channel()).is_ok());
        report.flag(White { noise_density: bad }.prepare(dt, channel()).is_ok());
        report.flag(RandomWalk { random_walk: bad }.prepare(dt, channel()).is_ok());
        report.flag(ConstantBias { constant_bias: bad }.prepare(dt, channel()).is_ok());
    }
}

/// Steps one by one, then a block.
pub(crate) fn stage<T: Normal, S: Stage<T>, E>(
    report: &mut dyn Report,
    stage: Result<S, E>,
    truth: T,
) {
    report.flag(stage.is_ok());
    if let Ok(mut stage) = stage {
        for _ in 0..64 {
            report.real(stage.bias());
            report.real(stage.step(truth));
        }
        let mut block = [truth; 64];
        stage.apply(&mut block);
        for value in block {
            report.real(value);
        }
    }
}

/// Instructions a step of compositions with and without each term, beside loops by hand.
pub fn absent_terms<T: Normal>(report: &mut dyn Report) {
    let dt = T::from_f64(black_box(0.005));
    let (white, walk, constant) = terms::<T>();
    let sd = white.noise_density / dt.sqrt();
    let walk_sd = walk.random_walk * dt.sqrt();

    count(report, "nothing by hand", |truth: T| truth);
    composition(report, "no term", ((), (), ()), dt);

    let bias = constant.constant_bias;
    count(report, "constant by hand", |truth: T| truth + bias);
    composition(report, "constant", ((), (), constant), dt);

    let mut rng: T::Generator = channel().stream(TermId::WHITE);
    count(report, "white by hand", |truth: T| truth + sd * T::standard_normal(&mut rng));
    composition(report, "white", (white, (), ()), dt);

    let mut rng: T::Generator = channel().stream(TermId::RANDOM_WALK);
    let mut bias = T::ZERO;
    count(report, "walk by hand", |truth: T| {
        let measured = truth + bias;
        bias += walk_sd * T::standard_normal(&mut rng);
        measured
    });
    composition(report, "walk", ((), walk, ()), dt);

    composition(report, "white and constant", (white, (), constant), dt);
    composition(report, "white and walk", (white, walk, ()), dt);
    composition(report, "white and walk and constant", (white, walk, constant), dt);
}

pub(crate) fn composition<T: Normal, P: Term<T>>(
    report: &mut dyn Report,
    what: &'static str,
    terms: P,
    dt: T,
) {
    report.state(what, size_of::<P::Stage>());
    if let Ok(mut stage) = terms.prepare(dt, channel()) {
        count(report, what, |truth| stage.step(truth));
    }
}

/// One loop for all, compiled for each: what differs is the step alone.
#[inline(never)]
fn count<T: Normal>(report: &mut dyn Report, what: &'static str, mut step: impl FnMut(T) -> T) {
    let truth = T::from_f64(9.81);
    report.instructions(what, STEPS, &mut || repeat(STEPS, || step(black_box(truth))));
}
