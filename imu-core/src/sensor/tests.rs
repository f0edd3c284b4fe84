use super::*;
use crate::noise::{Axis, Channel, Normal, Quantisation, Sensor, Stage, Term, White};
use core::mem::size_of;

const PERFECT: Imperfections = Imperfections {
    lever_arm: (),
    scale_misalignment: (),
    g_sensitivity: (),
    noise: [(); 3],
    bandwidth: [(); 3],
    saturation: (),
    quantisation: (),
};

fn motion<T: Real>(k: u32) -> Kinematics<T> {
    let t = T::from_u32(k);
    Kinematics {
        angular_rate: [t.sqrt(), -t, T::from_f64(-0.0)],
        angular_acceleration: [t, t, -t],
        specific_force: [t / T::from_u32(7), T::ZERO, T::from_f64(-9.81)],
    }
}

fn channel() -> Channel {
    Channel::new(7, Sensor::GYROSCOPE, Axis::X)
}

#[test]
fn all_off_is_the_truth_to_the_bit_and_takes_no_byte() {
    fn check<T: Normal>() {
        let dt = T::from_f64(0.005);
        let mut gyroscope = PERFECT.gyroscope(dt, 7, Sensor::GYROSCOPE).unwrap();
        let mut accelerometer = PERFECT.accelerometer(dt, 7, Sensor::ACCELEROMETER).unwrap();
        assert_eq!(size_of_val(&gyroscope) + size_of_val(&accelerometer), 0);
        for k in 1..1000 {
            let motion = motion::<T>(k);
            let bits = |v: [T; 3]| v.map(T::bits);
            assert_eq!(bits(gyroscope.measure(&motion)), bits(motion.angular_rate));
            assert_eq!(bits(accelerometer.measure(&motion)), bits(motion.specific_force));
        }
        assert_eq!(gyroscope.bias::<T>(), [T::ZERO; 3]);
    }
    check::<f32>();
    check::<f64>();
}

/// A motion for which the order decides: saturated before it is rounded, filtered before that, noise
/// not scaled.
#[test]
fn the_order_is_the_physical_one() {
    let white = White { noise_density: 0.1_f64 };
    let one_pole = OnePole { cutoff: 20.0, start: 0.0, noise_density: 0.0 };
    let map = ScaleMisalignment::new([0.1, 0.0, -0.1], [[0.01, 0.0], [0.0, 0.02], [0.0, 0.0]]);
    let coupling = GSensitivity { matrix: [[0.0, 0.0, 1e-2]; 3] };
    let arm = LeverArm { arm: [0.1, -0.2, 0.3] };
    let (saturation, quantisation) = (Saturation { range: 3.1 }, Quantisation { step: 0.25 });
    let (dt, seed) = (0.01, 7);
    let mut gyroscope = Imperfections {
        lever_arm: arm,
        scale_misalignment: map,
        g_sensitivity: coupling,
        noise: [white; 3],
        bandwidth: [one_pole; 3],
        saturation,
        quantisation,
    }
    .gyroscope(dt, seed, Sensor::GYROSCOPE)
    .unwrap();
    let on = |axis| Channel::new(seed, Sensor::GYROSCOPE, axis);
    let mut noise = Axis::ALL.map(|axis| white.prepare(dt, on(axis)).unwrap());
    let mut filter = Axis::ALL.map(|axis| one_pole.prepare(dt, on(axis)).unwrap());
    for k in 0..500 {
        let motion = motion(k % 17);
        let measured = gyroscope.measure(&motion);
        let rate = map.read(motion.angular_rate);
        let rate = coupling.couple(rate, arm.felt(&motion).specific_force);
        for axis in 0..3 {
            let clean = filter[axis].step(noise[axis].step(rate[axis]));
            let expected = (clean.clamp(-3.1, 3.1) / 0.25).round_ties_even() * 0.25;
            assert_eq!(measured[axis], expected);
        }
    }
}

/// Against the second difference of the position of a point on a body that spins up about z:
/// θ = ½αt², p = r (cos θ, sin θ, 0) at angle θ, turned into body axes.
#[test]
fn a_lever_arm_feels_what_its_path_says() {
    let (alpha, t, h, r) = (2.0_f64, 0.7_f64, 1e-4, 0.3);
    let place = |t: f64| {
        let angle = 0.5 * alpha * t * t;
        [r * libm::cos(angle), r * libm::sin(angle)]
    };
    let (before, now, after) = (place(t - h), place(t), place(t + h));
    let [ax, ay] = [0, 1].map(|i| (after[i] - 2.0 * now[i] + before[i]) / (h * h));
    let (cos, sin) = (now[0] / r, now[1] / r);
    let expected = [cos * ax + sin * ay, cos * ay - sin * ax, 0.0];
    let spin = Kinematics {
        angular_rate: [0.0, 0.0, alpha * t],
        angular_acceleration: [0.0, 0.0, alpha],
        specific_force: [0.0; 3],
    };
    let felt = LeverArm { arm: [r, 0.0, 0.0] }.felt(&spin).specific_force;
    for (felt, expected) in felt.into_iter().zip(expected) {
        assert!((felt - expected).abs() < 1e-6); // h², and rounding over h²
    }
}

/// The continuous response to a step at every sample, at rates from a hundredth to ten of the cut-off.
fn step_responses<T: Normal>(tolerance: f64) {
    for cutoff in [1.0, 30.0, 1000.0] {
        let (dt, zero, real) = (0.01, T::ZERO, T::from_f64(cutoff));
        let one = OnePole { cutoff: real, start: zero, noise_density: zero };
        let two = TwoPole { cutoff: real, start: zero };
        let mut one = one.prepare(T::from_f64(dt), channel()).unwrap();
        let mut two = two.prepare(T::from_f64(dt), channel()).unwrap();
        for k in 1..400 {
            let x = core::f64::consts::TAU * cutoff * dt * f64::from(k);
            let expected = -libm::expm1(-x);
            assert!((one.step(T::ONE).to_f64() - expected).abs() < tolerance, "{cutoff} Hz");
            let s = x * core::f64::consts::FRAC_1_SQRT_2;
            let expected = 1.0 - libm::exp(-s) * (libm::cos(s) + libm::sin(s));
            assert!((two.step(T::ONE).to_f64() - expected).abs() < tolerance, "{cutoff} Hz");
        }
    }
}

/// A rounding a step, of which a filter of 16 steps' memory remembers as many.
#[test]
fn filters_answer_a_step_exactly() {
    step_responses::<f32>(2e-6);
    step_responses::<f64>(4e-15);
}

#[test]
fn filters_start_settled() {
    let mut one = OnePole { cutoff: 5.0, start: 9.81, noise_density: 0.0 };
    assert_eq!(one.prepare(0.005, channel()).unwrap().step(9.81), 9.81);
    let mut two = TwoPole { cutoff: 5.0, start: 9.81 }.prepare(0.005, channel()).unwrap();
    assert_eq!([(); 9].map(|()| two.step(9.81)), [9.81; 9]);
    // With noise in its memory, another number.
    one.noise_density = 1.0;
    assert_ne!(one.prepare(0.005, channel()).unwrap().step(9.81), 9.81);
}

/// Gain at the cut-off 1/√2, at a cut-off of a hundredth of the sampling rate, where holding the input
/// costs 1.6e-4 of gain.
#[test]
fn the_cut_off_is_at_half_the_power() {
    fn gain(mut stage: impl Stage<f64>) -> f64 {
        let angle = |k: i32| core::f64::consts::TAU * 0.01 * f64::from(k);
        (0..2000).for_each(|k| _ = stage.step(libm::sin(angle(k))));
        let (mut sin, mut cos) = (0.0, 0.0);
        for k in 2000..3000 {
            let y = stage.step(libm::sin(angle(k)));
            sin += y * libm::sin(angle(k)) / 500.0;
            cos += y * libm::cos(angle(k)) / 500.0;
        }
        libm::hypot(sin, cos)
    }
    let one = OnePole { cutoff: 1.0, start: 0.0, noise_density: 0.0 };
    let two = TwoPole { cutoff: 1.0, start: 0.0 };
    for gain in
        [gain(one.prepare(0.01, channel()).unwrap()), gain(two.prepare(0.01, channel()).unwrap())]
    {
        assert!((gain - core::f64::consts::FRAC_1_SQRT_2).abs() < 5e-4, "{gain}");
    }
}

#[test]
fn the_parameter_at_fault_is_named() {
    let nan = f64::NAN;
    let (dt, sensor) = (0.005, Sensor::GYROSCOPE);
    let arm = Imperfections {
        lever_arm: LeverArm { arm: [0.0, nan, 0.0] },
        scale_misalignment: (),
        g_sensitivity: (),
        noise: [(); 3],
        bandwidth: [(); 3],
        saturation: (),
        quantisation: (),
    };
    assert_eq!(arm.accelerometer(dt, 7, sensor).err(), Some(Error::NonFinite("arm")));
    let map = ScaleMisalignment::scale([nan, 0.0, 0.0]);
    assert_eq!(map.check(), Err(Error::NonFinite("scale_misalignment")));
    let coupling = GSensitivity { matrix: [[f64::INFINITY; 3]; 3] };
    assert_eq!(coupling.check(), Err(Error::NonFinite("g_sensitivity")));
    fn error(term: impl Term<f64>) -> Option<Error> {
        term.prepare(0.005, channel()).err()
    }
    let one = |cutoff, start, noise_density| error(OnePole { cutoff, start, noise_density });
    assert_eq!(one(0.0, 0.0, 0.0), Some(Error::OutOfRange("cutoff")));
    assert_eq!(one(1.0, nan, 0.0), Some(Error::NonFinite("start")));
    assert_eq!(one(1.0, 0.0, -1.0), Some(Error::OutOfRange("noise_density")));
    let two = |cutoff, start| error(TwoPole { cutoff, start });
    assert_eq!(two(-1.0, 0.0), Some(Error::OutOfRange("cutoff")));
    assert_eq!(two(1.0, nan), Some(Error::NonFinite("start")));
    assert_eq!(error(Saturation { range: 0.0 }), Some(Error::OutOfRange("range")));
    assert_eq!(error(Saturation { range: nan }), Some(Error::NonFinite("range")));
}

#[test]
fn stages_are_as_large_as_they_say() {
    fn size<T: Normal, P: Term<T>>() -> usize {
        size_of::<P::Stage>()
    }
    fn sizes<T: Normal>() -> [usize; 5] {
        [
            size_of::<LeverArm<T>>(),
            size_of::<ScaleMisalignment<T>>(),
            size::<T, OnePole<T>>(),
            size::<T, TwoPole<T>>(),
            size::<T, Saturation<T>>(),
        ]
    }
    assert_eq!(sizes::<f32>(), [12, 36, 8, 24, 4]);
    assert_eq!(sizes::<f64>(), [24, 72, 16, 48, 8]);
}
