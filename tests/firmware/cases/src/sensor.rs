//! `imu_core::sensor`: every imperfection, alone and all together: its bits, what it refuses, what a
//! sample of three axes costs, and that what is left out costs nothing.

use crate::inputs::Integers;
use crate::noise::{channel, stage};
use crate::{Report, repeat};
use core::hint::black_box;
use imu_core::noise::{Normal, Quantisation, Sensor, Stage, Term, White};
use imu_core::sensor::{
    AxisMap, ForceCoupling, GSensitivity, Gyroscope, Imperfections, Kinematics, LeverArm, OnePole,
    Placement, Saturation, ScaleMisalignment, TwoPole,
};

/// Samples that a count averages.
const STEPS: u32 = 1024;

/// A parameter, hidden from the optimiser.
fn real<T: Normal>(value: f64) -> T {
    T::from_f64(black_box(value))
}

fn vector<T: Normal>([x, y, z]: [f64; 3]) -> [T; 3] {
    [real(x), real(y), real(z)]
}

fn lever_arm<T: Normal>() -> LeverArm<T> {
    LeverArm { arm: vector([0.03, -0.01, 0.02]) }
}

fn scale_misalignment<T: Normal>() -> ScaleMisalignment<T> {
    let angle = real(2e-3);
    ScaleMisalignment::new(vector([0.01, -0.02, 0.005]), [[angle, -angle]; 3])
}

fn g_sensitivity<T: Normal>() -> GSensitivity<T> {
    GSensitivity { matrix: [vector([1e-4, 2e-5, -3e-5]); 3] }
}

fn white<T: Normal>() -> White<T> {
    White { noise_density: real(0.019) }
}

fn one_pole<T: Normal>() -> OnePole<T> {
    OnePole { cutoff: real(42.0), start: real(0.5), noise_density: real(0.019) }
}

fn two_pole<T: Normal>() -> TwoPole<T> {
    TwoPole { cutoff: real(42.0), start: real(0.5) }
}

fn saturation<T: Normal>() -> Saturation<T> {
    Saturation { range: real(0.9) }
}

fn quantisation<T: Normal>() -> Quantisation<T> {
    Quantisation { step: real(1e-3) }
}

fn motions<T: Normal>() -> impl FnMut() -> Kinematics<T> {
    let mut integers = Integers::new(9);
    move || {
        let mut vector = || [integers.unit(), integers.unit(), integers.unit()];
        Kinematics {
            angular_rate: vector(),
            angular_acceleration: vector(),
            specific_force: vector(),
        }
    }
}

/// Every imperfection's bits; refused parameters.
pub fn case<T: Normal>(report: &mut dyn Report) {
    let (dt, truth) = (real::<T>(0.005), real::<T>(0.7));
    stage(report, one_pole::<T>().prepare(dt, channel()), truth);
    stage(report, two_pole::<T>().prepare(dt, channel()), truth);
    stage(report, saturation::<T>().prepare(dt, channel()), real::<T>(-2.0));
    let sensors = Imperfections {
        lever_arm: lever_arm::<T>(),
        scale_misalignment: scale_misalignment::<T>(),
        g_sensitivity: g_sensitivity::<T>(),
        noise: [white::<T>(); 3],
        bandwidth: [one_pole::<T>(); 3],
        saturation: saturation::<T>(),
        quantisation: quantisation::<T>(),
    };
    let gyroscope = sensors.gyroscope(dt, black_box(7), Sensor::GYROSCOPE);
    report.flag(gyroscope.is_ok());
    let accelerometer = Imperfections {
        lever_arm: lever_arm::<T>(),
        scale_misalignment: scale_misalignment::<T>(),
        g_sensitivity: (),
        noise: [white::<T>(); 3],
        bandwidth: [two_pole::<T>(); 3],
        saturation: saturation::<T>(),
        quantisation: quantisation::<T>(),
    }
    .accelerometer(dt, black_box(7), Sensor::ACCELEROMETER);
    report.flag(accelerometer.is_ok());
    if let (Ok(mut gyroscope), Ok(mut accelerometer)) = (gyroscope, accelerometer) {
        let mut motion = motions::<T>();
        for _ in 0..64 {
            let motion = motion();
            gyroscope.measure(&motion).into_iter().for_each(|x| report.real(x));
            accelerometer.measure(&motion).into_iter().for_each(|x| report.real(x));
        }
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let bad = real::<T>(bad);
        report.flag(OnePole { cutoff: bad, ..one_pole() }.prepare(dt, channel()).is_ok());
        report.flag(TwoPole { cutoff: bad, ..two_pole() }.prepare(dt, channel()).is_ok());
        report.flag(Saturation { range: bad }.prepare(dt, channel()).is_ok());
        report.flag(LeverArm { arm: [bad; 3] }.check().is_ok());
        report.flag(ScaleMisalignment { matrix: [[bad; 3]; 3] }.check().is_ok());
        report.flag(GSensitivity { matrix: [[bad; 3]; 3] }.check().is_ok());
    }
}

/// Instructions of a sample of three axes, and bytes of state, with one imperfection and with all.
pub fn cost<T: Normal>(report: &mut dyn Report) {
    count(report, "nothing by hand", |motion: &Kinematics<T>| motion.angular_rate);
    let (l, m, g) = (lever_arm::<T>(), scale_misalignment::<T>(), g_sensitivity::<T>());
    let (b, s, q) = (one_pole::<T>(), saturation::<T>(), quantisation::<T>());
    let n = white::<T>();
    gyroscope::<T, _, _, _, _, _, _, _>(report, "nothing wrong", parts((), (), (), (), (), (), ()));
    gyroscope::<T, _, _, _, _, _, _, _>(
        report,
        "scale and misalignment",
        parts((), m, (), (), (), (), ()),
    );
    gyroscope::<T, _, _, _, _, _, _, _>(report, "g-sensitivity", parts((), (), g, (), (), (), ()));
    gyroscope::<T, _, _, _, _, _, _, _>(
        report,
        "lever arm and g-sensitivity",
        parts(l, (), g, (), (), (), ()),
    );
    gyroscope::<T, _, _, _, _, _, _, _>(report, "white noise", parts((), (), (), n, (), (), ()));
    gyroscope::<T, _, _, _, _, _, _, _>(report, "one pole", parts((), (), (), (), b, (), ()));
    gyroscope::<T, _, _, _, _, _, _, _>(
        report,
        "two poles",
        parts((), (), (), (), two_pole::<T>(), (), ()),
    );
    gyroscope::<T, _, _, _, _, _, _, _>(report, "saturation", parts((), (), (), (), (), s, ()));
    gyroscope::<T, _, _, _, _, _, _, _>(report, "quantisation", parts((), (), (), (), (), (), q));
    gyroscope::<T, _, _, _, _, _, _, _>(report, "everything", parts(l, m, g, n, b, s, q));
}

fn parts<L, M, G, N: Copy, B: Copy, S, Q>(
    lever_arm: L,
    scale_misalignment: M,
    g_sensitivity: G,
    noise: N,
    bandwidth: B,
    saturation: S,
    quantisation: Q,
) -> Imperfections<L, M, G, N, B, S, Q> {
    Imperfections {
        lever_arm,
        scale_misalignment,
        g_sensitivity,
        noise: [noise; 3],
        bandwidth: [bandwidth; 3],
        saturation,
        quantisation,
    }
}

fn gyroscope<T, L, M, G, N, B, S, Q>(
    report: &mut dyn Report,
    what: &'static str,
    imperfections: Imperfections<L, M, G, N, B, S, Q>,
) where
    T: Normal,
    L: Placement<T>,
    M: AxisMap<T>,
    G: ForceCoupling<T>,
    N: Term<T>,
    B: Term<T>,
    S: Term<T> + Copy,
    Q: Term<T> + Copy,
{
    let made = imperfections.gyroscope(real::<T>(0.005), black_box(7), Sensor::GYROSCOPE);
    if let Ok(mut gyroscope) = made {
        report.state(what, size_of_val(&gyroscope));
        run(report, what, &mut gyroscope);
    }
}

fn run<T: Normal, L, M, G, A>(
    report: &mut dyn Report,
    what: &'static str,
    gyroscope: &mut Gyroscope<L, M, G, A>,
) where
    L: Placement<T>,
    M: AxisMap<T>,
    G: ForceCoupling<T>,
    A: Stage<T>,
{
    count(report, what, |motion: &Kinematics<T>| gyroscope.measure(motion));
}

/// One loop for all, compiled for each: what differs is the measurement alone.
#[inline(never)]
fn count<T: Normal>(
    report: &mut dyn Report,
    what: &'static str,
    mut measure: impl FnMut(&Kinematics<T>) -> [T; 3],
) {
    let motion = motions::<T>()();
    report.instructions(what, STEPS, &mut || repeat(STEPS, || measure(&black_box(motion))));
}
