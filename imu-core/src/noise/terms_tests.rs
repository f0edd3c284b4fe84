//! What is said of every term: which parameter is at fault, how many bytes a stage takes, that what
//! is off is off, and that blocks equal steps.

use super::*;
use core::mem::size_of;

fn channel() -> Channel {
    Channel::new(7, Sensor::GYROSCOPE, Axis::X)
}

fn error<T: Normal>(term: impl Term<T>, dt: T) -> Option<Error> {
    term.prepare(dt, channel()).err()
}

fn markov<T>(standard_deviation: T, correlation_time: T) -> GaussMarkov<T> {
    GaussMarkov { standard_deviation, correlation_time, start: Start::Stationary }
}

fn flicker<T>(bias_instability: T, shortest_tau: T, longest_tau: T) -> Flicker<T, 3> {
    Flicker { bias_instability, shortest_tau, longest_tau }
}

const fn band<T>(standard_deviation: T, frequency: T, bandwidth: T) -> BandVibration<T> {
    BandVibration { standard_deviation, frequency, bandwidth }
}

const fn sinusoid<T>(amplitude: T, frequency: T, phase: T) -> Sinusoid<T> {
    Sinusoid { amplitude, frequency, phase }
}

const fn ramp<T>(coefficient: T, start: T, rate: T) -> TemperatureRamp<T> {
    TemperatureRamp { coefficient, start, rate }
}

const fn warm_up<T>(coefficient: T, start: T, rise: T, time_constant: T) -> WarmUp<T> {
    WarmUp { coefficient, start, rise, time_constant }
}

#[test]
fn the_parameter_at_fault_is_named() {
    let (nan, infinite) = (f64::NAN, f64::INFINITY);
    let range = |name| Some(Error::OutOfRange(name));
    let not_finite = |name| Some(Error::NonFinite(name));
    let dt = 0.01;
    assert_eq!(error(markov(1.0, 1.0), dt), None);
    assert_eq!(error(markov(-1.0, 1.0), dt), range("standard_deviation"));
    assert_eq!(error(markov(1.0, 0.0), dt), range("correlation_time"));
    assert_eq!(error(markov(1.0, infinite), dt), not_finite("correlation_time"));
    assert_eq!(error(flicker(1.0, 0.04, 0.4), dt), None);
    assert_eq!(error(flicker(-1.0, 0.04, 0.4), dt), range("bias_instability"));
    assert_eq!(error(flicker(1.0, 0.03, 0.4), dt), range("shortest_tau"));
    assert_eq!(error(flicker(1.0, nan, 0.4), dt), not_finite("shortest_tau"));
    assert_eq!(error(flicker(1.0, 0.04, 0.03), dt), range("longest_tau"));
    assert_eq!(error(flicker(1.0, 0.04, 0.5), dt), range("longest_tau"));
    let one = Flicker::<f64, 1> { bias_instability: 1.0, shortest_tau: 0.04, longest_tau: 0.04 };
    assert_eq!(error(one, dt), range("longest_tau"));
    let none = Flicker::<f64, 0> { bias_instability: 1.0, shortest_tau: 0.04, longest_tau: 0.04 };
    assert_eq!(error(none, dt), range("longest_tau"));
    assert_eq!(error(Quantisation { step: 0.0 }, dt), range("step"));
    assert_eq!(error(Quantisation { step: 1e-310 }, dt), not_finite("1 / step"));
    let increments = |quantisation_noise| IncrementQuantisation { quantisation_noise };
    assert_eq!(error(increments(0.0), dt), None);
    assert_eq!(error(increments(-1.0), dt), range("quantisation_noise"));
    assert_eq!(error(increments(f64::MAX), dt), not_finite("quantisation_noise / dt"));
    assert_eq!(error(RateRamp { rate_ramp: -1.0 }, dt), None);
    assert_eq!(error(RateRamp { rate_ramp: nan }, dt), not_finite("rate_ramp"));
    assert_eq!(error(RateRamp { rate_ramp: f64::MAX }, 2.0), not_finite("rate_ramp * dt"));
    let turn_on = |standard_deviation| TurnOnBias { standard_deviation };
    assert_eq!(error(turn_on(-1.0), dt), range("standard_deviation"));
    assert_eq!(error(sinusoid(1.0, 1.0, -9.0), dt), None);
    assert_eq!(error(sinusoid(-1.0, 1.0, 0.0), dt), range("amplitude"));
    assert_eq!(error(sinusoid(1.0, -1.0, 0.0), dt), range("frequency"));
    assert_eq!(error(sinusoid(1.0, 1.0, infinite), dt), not_finite("phase"));
    assert_eq!(error(band(1.0, 10.0, 19.9), dt), None);
    assert_eq!(error(band(nan, 10.0, 1.0), dt), not_finite("standard_deviation"));
    assert_eq!(error(band(1.0, 0.0, 1.0), dt), range("frequency"));
    assert_eq!(error(band(1.0, 10.0, 0.0), dt), range("bandwidth"));
    assert_eq!(error(band(1.0, 10.0, 20.0), dt), range("bandwidth"));
    assert_eq!(error(ramp(1.0, -5.0, 1.0), dt), None);
    assert_eq!(error(ramp(nan, 0.0, 1.0), dt), not_finite("coefficient"));
    assert_eq!(error(ramp(1.0, nan, 1.0), dt), not_finite("start"));
    assert_eq!(error(ramp(1.0, 0.0, nan), dt), not_finite("rate"));
    assert_eq!(error(warm_up(1.0, -5.0, 1.0, 9.0), dt), None);
    assert_eq!(error(warm_up(1.0, 0.0, nan, 9.0), dt), not_finite("rise"));
    assert_eq!(error(warm_up(1.0, 0.0, 1.0, 0.0), dt), range("time_constant"));
}

#[test]
fn an_interval_of_zero_is_refused_by_all() {
    fn refused(term: impl Term<f64>) {
        assert_eq!(error(term, 0.0), Some(Error::OutOfRange("dt")));
    }
    refused(markov(1.0, 1.0));
    refused(flicker(1.0, 0.04, 0.4));
    refused(Quantisation { step: 1.0 });
    refused(IncrementQuantisation { quantisation_noise: 1.0 });
    refused(RateRamp { rate_ramp: 1.0 });
    refused(TurnOnBias { standard_deviation: 1.0 });
    refused(sinusoid(1.0, 1.0, 0.0));
    refused(band(1.0, 10.0, 1.0));
    refused(ramp(1.0, 0.0, 1.0));
    refused(warm_up(1.0, 0.0, 1.0, 1.0));
}

#[test]
fn stages_are_as_large_as_they_say() {
    fn size<T: Normal, P: Term<T>>() -> usize {
        size_of::<P::Stage>()
    }
    fn sizes<T: Normal>() -> [usize; 13] {
        [
            size::<T, GaussMarkov<T>>(),
            size::<T, Flicker<T, 5>>(),
            size::<T, Quantisation<T>>(),
            size::<T, IncrementQuantisation<T>>(),
            size::<T, RateRamp<T>>(),
            size::<T, TurnOnBias<T>>(),
            size::<T, Sinusoid<T>>(),
            size::<T, BandVibration<T>>(),
            size::<T, TemperatureRamp<T>>(),
            size::<T, WarmUp<T>>(),
            size::<T, IntervalMean<RandomWalk<T>>>(),
            size::<T, IntervalMean<GaussMarkov<T>>>(),
            size::<T, IntervalMean<BandVibration<T>>>(),
        ]
    }
    assert_eq!(sizes::<f32>(), [28, 16 + 12 * 5, 8, 24, 16, 4, 24, 52, 20, 16, 28, 40, 56]);
    assert_eq!(sizes::<f64>(), [56, 32 + 24 * 5, 16, 48, 24, 8, 24, 104, 32, 32, 56, 80, 112]);
}

/// Every term at zero but the rounding, in one tuple.
fn off<T: Normal>() -> impl Term<T> {
    let zero = T::ZERO;
    let one = T::ONE;
    (
        White { noise_density: zero },
        RandomWalk { random_walk: zero },
        markov(zero, one),
        flicker(zero, one, T::from_u32(10)),
        IncrementQuantisation { quantisation_noise: zero },
        RateRamp { rate_ramp: zero },
        TurnOnBias { standard_deviation: zero },
        sinusoid(zero, one, one),
        band(zero, one, one),
        ramp(zero, one, one),
        warm_up(zero, one, one, one),
        (),
    )
}

#[test]
fn all_off_is_the_truth_to_the_bit() {
    fn check<T: Normal>() {
        let mut stage = off::<T>().prepare(T::from_f64(0.01), channel()).unwrap();
        for k in 1..1000 {
            let truth = T::from_u32(k).sqrt();
            assert_eq!(stage.step(truth).bits(), truth.bits());
            assert_eq!(stage.bias(), T::ZERO);
        }
    }
    check::<f32>();
    check::<f64>();
}

/// A block gives the bits of its samples taken one by one, and a bias is what the next sample shows.
#[test]
fn blocks_equal_steps_and_bias_is_what_comes_next() {
    fn check<T: Normal, S: Stage<T> + Copy>(name: &str, stage: Result<S, Error>, is_bias: bool) {
        let mut one = stage.unwrap();
        let mut two = one;
        let mut block = [T::ZERO; 300];
        two.apply(&mut block[..7]);
        two.apply(&mut block[7..]);
        let mut moved = false;
        for value in block {
            let bias = one.bias();
            let measured = one.step(T::ZERO);
            assert_eq!(measured.bits(), value.bits(), "{name}");
            assert_eq!(bias, if is_bias { measured } else { T::ZERO }, "{name}");
            moved |= measured != T::ZERO;
        }
        assert!(moved, "{name}");
    }
    fn all<T: Normal>() {
        let t = T::from_f64;
        let (dt, on) = (t(0.01), channel());
        check("markov", markov(t(0.1), t(1.0)).prepare(dt, on), true);
        check("flicker", flicker(t(0.1), t(0.1), t(1.0)).prepare(dt, on), true);
        let increments = IncrementQuantisation { quantisation_noise: t(0.1) };
        check("increments", increments.prepare(dt, on), false);
        check("ramp", RateRamp { rate_ramp: t(0.1) }.prepare(dt, on), true);
        check("turn-on", TurnOnBias { standard_deviation: t(0.1) }.prepare(dt, on), true);
        check("sinusoid", sinusoid(t(0.1), t(3.0), t(1.0)).prepare(dt, on), false);
        check("band", band(t(0.1), t(3.0), t(1.0)).prepare(dt, on), false);
        check("temperature", ramp(t(0.1), t(3.0), t(1.0)).prepare(dt, on), true);
        check("warm-up", warm_up(t(0.1), t(3.0), t(1.0), t(1.0)).prepare(dt, on), true);
        let mean = IntervalMean(RandomWalk { random_walk: t(0.1) });
        check("mean of a walk", mean.prepare(dt, on), true);
        check("mean of markov", IntervalMean(markov(t(0.1), t(1.0))).prepare(dt, on), true);
        let mean = IntervalMean(RateRamp { rate_ramp: t(0.1) });
        check("mean of a ramp", mean.prepare(dt, on), true);
        let mean = IntervalMean(band(t(0.1), t(3.0), t(1.0)));
        check("mean of a band", mean.prepare(dt, on), false);
    }
    all::<f32>();
    all::<f64>();
}

#[test]
fn a_process_may_start_at_zero() {
    let term = GaussMarkov { start: Start::Zero, ..markov(1.0_f64, 1.0) };
    let stage = term.prepare(0.01, channel()).unwrap();
    assert_eq!(stage.bias(), 0.0);
}

#[test]
fn the_nth_of_a_kind_has_numbers_of_its_own() {
    let term = markov(1.0_f64, 1.0);
    let bias = |nth| Nth(nth, term).prepare(0.01, channel()).unwrap().bias();
    assert_eq!(bias(0), term.prepare(0.01, channel()).unwrap().bias());
    assert!(bias(0) != bias(1) && bias(1) != bias(2));
}

/// The damped oscillator's step is exact: two half steps are one whole, for weak and strong damping.
#[test]
fn the_resonator_composes() {
    use crate::resonator::Transition;
    for (angle, damping) in [(1e-6, 0.01), (0.3, 0.5), (2.0, 0.7), (20.0, 0.99)] {
        let full = |angle| {
            let Transition { xx, xu, ux, uu } = Transition::new(angle, damping);
            [[1.0 + xx, xu], [ux, 1.0 + uu]]
        };
        let (half, whole) = (full(0.5 * angle), full(angle));
        for i in 0..2 {
            for j in 0..2 {
                let product = half[i][0] * half[0][j] + half[i][1] * half[1][j];
                assert!((product - whole[i][j]).abs() < 1e-14);
            }
        }
    }
}
