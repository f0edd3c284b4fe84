//! `imu_core::noise`: every term beyond white noise, random walk and constant bias: its bits, what it
//! refuses, what a step of it costs, and that eleven terms left out cost nothing.

use crate::Report;
use crate::noise::{channel, composition, stage};
use core::hint::black_box;
use imu_core::noise::{
    BandVibration, Flicker, GaussMarkov, IncrementQuantisation, IntervalMean, Normal, Nth,
    Quantisation, RandomWalk, RateRamp, Sinusoid, Start, TemperatureRamp, Term, TurnOnBias, WarmUp,
    White,
};

/// The parameters of a case, hidden from the optimiser.
fn real<T: Normal>(value: f64) -> T {
    T::from_f64(black_box(value))
}

fn markov<T: Normal>(start: Start) -> GaussMarkov<T> {
    GaussMarkov { standard_deviation: real(0.02), correlation_time: real(300.0), start }
}

fn flicker<T: Normal>() -> Flicker<T, 5> {
    Flicker { bias_instability: real(0.03), shortest_tau: real(0.1), longest_tau: real(100.0) }
}

fn increments<T: Normal>() -> IncrementQuantisation<T> {
    IncrementQuantisation { quantisation_noise: real(1e-4) }
}

fn sinusoid<T: Normal>() -> Sinusoid<T> {
    Sinusoid { amplitude: real(0.5), frequency: real(37.3), phase: real(-1.0) }
}

fn band<T: Normal>() -> BandVibration<T> {
    BandVibration { standard_deviation: real(0.5), frequency: real(60.0), bandwidth: real(15.0) }
}

fn temperature<T: Normal>() -> TemperatureRamp<T> {
    TemperatureRamp { coefficient: real(1e-3), start: real(-5.0), rate: real(0.02) }
}

fn warm_up<T: Normal>() -> WarmUp<T> {
    let (start, rise) = (real(-5.0), real(25.0));
    WarmUp { coefficient: real(1e-3), start, rise, time_constant: real(180.0) }
}

/// Every term, alone and all together; refused parameters.
pub fn case<T: Normal>(report: &mut dyn Report) {
    let (dt, truth) = (real::<T>(0.005), real::<T>(9.81));
    let on = channel();
    stage(report, markov::<T>(Start::Stationary).prepare(dt, on), truth);
    stage(report, markov::<T>(Start::Zero).prepare(dt, on), truth);
    stage(report, Nth(black_box(1), markov::<T>(Start::Stationary)).prepare(dt, on), truth);
    stage(report, flicker::<T>().prepare(dt, on), truth);
    stage(report, Quantisation { step: real::<T>(0.0024) }.prepare(dt, on), truth);
    stage(report, increments::<T>().prepare(dt, on), truth);
    stage(report, RateRamp { rate_ramp: real::<T>(1e-3) }.prepare(dt, on), truth);
    stage(report, TurnOnBias { standard_deviation: real::<T>(0.1) }.prepare(dt, on), truth);
    stage(report, sinusoid::<T>().prepare(dt, on), truth);
    stage(report, band::<T>().prepare(dt, on), truth);
    stage(report, temperature::<T>().prepare(dt, on), truth);
    stage(report, warm_up::<T>().prepare(dt, on), truth);
    stage(report, all::<T>().prepare(dt, on), truth);
    means::<T>(report, dt, truth);
    for bad in [0.0, -1.0, 1e9, f64::NAN, f64::INFINITY] {
        let bad = real::<T>(bad);
        let flags = [
            GaussMarkov { standard_deviation: bad, ..markov(Start::Zero) }.prepare(dt, on).is_ok(),
            GaussMarkov { correlation_time: bad, ..markov(Start::Zero) }.prepare(dt, on).is_ok(),
            Flicker { shortest_tau: bad, ..flicker() }.prepare(dt, on).is_ok(),
            Flicker { longest_tau: bad, ..flicker() }.prepare(dt, on).is_ok(),
            Quantisation { step: bad }.prepare(dt, on).is_ok(),
            IncrementQuantisation { quantisation_noise: bad }.prepare(dt, on).is_ok(),
            RateRamp { rate_ramp: bad }.prepare(dt, on).is_ok(),
            TurnOnBias { standard_deviation: bad }.prepare(dt, on).is_ok(),
            Sinusoid { frequency: bad, ..sinusoid() }.prepare(dt, on).is_ok(),
            BandVibration { bandwidth: bad, ..band() }.prepare(dt, on).is_ok(),
            TemperatureRamp { rate: bad, ..temperature() }.prepare(dt, on).is_ok(),
            WarmUp { time_constant: bad, ..warm_up() }.prepare(dt, on).is_ok(),
            IntervalMean(RandomWalk { random_walk: bad }).prepare(dt, on).is_ok(),
            IntervalMean(GaussMarkov { correlation_time: bad, ..markov(Start::Zero) })
                .prepare(dt, on)
                .is_ok(),
            IntervalMean(BandVibration { frequency: bad, ..band() }).prepare(dt, on).is_ok(),
            IntervalMean(RateRamp { rate_ramp: bad }).prepare(dt, on).is_ok(),
            IntervalMean(TemperatureRamp { rate: bad, ..temperature() }).prepare(dt, on).is_ok(),
            IntervalMean(WarmUp { time_constant: bad, ..warm_up() }).prepare(dt, on).is_ok(),
            IntervalMean(Sinusoid { frequency: bad, ..sinusoid() }).prepare(dt, on).is_ok(),
        ];
        flags.into_iter().for_each(|flag| report.flag(flag));
    }
}

fn walk<T: Normal>() -> RandomWalk<T> {
    RandomWalk { random_walk: real(5e-4) }
}

/// The means over the interval.
fn means<T: Normal>(report: &mut dyn Report, dt: T, truth: T) {
    let on = channel();
    stage(report, IntervalMean(walk::<T>()).prepare(dt, on), truth);
    stage(report, IntervalMean(markov::<T>(Start::Stationary)).prepare(dt, on), truth);
    let short = GaussMarkov { correlation_time: real::<T>(0.004), ..markov(Start::Zero) };
    stage(report, IntervalMean(short).prepare(dt, on), truth);
    stage(report, IntervalMean(band::<T>()).prepare(dt, on), truth);
    stage(report, IntervalMean(RateRamp { rate_ramp: real::<T>(1e-3) }).prepare(dt, on), truth);
    stage(report, IntervalMean(temperature::<T>()).prepare(dt, on), truth);
    stage(report, IntervalMean(warm_up::<T>()).prepare(dt, on), truth);
    stage(report, IntervalMean(sinusoid::<T>()).prepare(dt, on), truth);
}

fn white<T: Normal>() -> White<T> {
    White { noise_density: real(0.019) }
}

fn all<T: Normal>() -> impl Term<T> {
    (
        white(),
        walk(),
        markov(Start::Stationary),
        flicker(),
        increments(),
        RateRamp { rate_ramp: real(1e-3) },
        TurnOnBias { standard_deviation: real(0.1) },
        sinusoid(),
        band(),
        temperature(),
        warm_up(),
        Quantisation { step: real(0.0024) },
    )
}

/// Instructions of a step, and bytes of state.
pub fn cost<T: Normal>(report: &mut dyn Report) {
    let dt = real::<T>(0.005);
    composition(report, "Gauss-Markov", markov::<T>(Start::Stationary), dt);
    composition(report, "flicker of 5", flicker::<T>(), dt);
    composition(report, "quantisation of readings", Quantisation { step: real::<T>(0.0024) }, dt);
    composition(report, "quantisation of increments", increments::<T>(), dt);
    composition(report, "rate ramp", RateRamp { rate_ramp: real::<T>(1e-3) }, dt);
    composition(report, "turn-on bias", TurnOnBias { standard_deviation: real::<T>(0.1) }, dt);
    composition(report, "sinusoid", sinusoid::<T>(), dt);
    composition(report, "band vibration", band::<T>(), dt);
    composition(report, "temperature ramp", temperature::<T>(), dt);
    composition(report, "warm-up", warm_up::<T>(), dt);
    composition(report, "random walk mean", IntervalMean(walk::<T>()), dt);
    let mean = IntervalMean(markov::<T>(Start::Stationary));
    composition(report, "Gauss-Markov mean", mean, dt);
    composition(report, "band vibration mean", IntervalMean(band::<T>()), dt);
    composition(report, "all twelve", all::<T>(), dt);
    let none = ((), (), (), (), (), (), (), (), (), (), (), ());
    composition(report, "twelve left out", none, dt);
    let one = ((), (), (), (), (), white::<T>(), (), (), (), (), (), ());
    composition(report, "white and eleven left out", one, dt);
}
