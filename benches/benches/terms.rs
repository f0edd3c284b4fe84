//! Every noise term and every stage of a sensor, in `f64`, a sample of one axis each: `white` is the
//! baseline. `mean` is a term's mean over the interval.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use imu_core::noise::{
    Axis, BandVibration, Channel, ConstantBias, Flicker, GaussMarkov, IncrementQuantisation,
    IntervalMean, Quantisation, RandomWalk, RateRamp, Sensor, Sinusoid, Stage, Start,
    TemperatureRamp, Term, WarmUp, White,
};
use imu_core::sensor::{OnePole, Saturation, TwoPole};

const N: usize = 4096;

fn terms(c: &mut Criterion) {
    let mut group = c.benchmark_group("term");
    group.throughput(Throughput::Elements(N as u64));
    let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
    let mut values = vec![0.0; N];
    macro_rules! bench {
        ($($name:literal: $term:expr),* $(,)?) => {
            $(let mut stage = $term.prepare(0.005, x).expect("valid");
            group.bench_function($name, |b| b.iter(|| {
                values.fill(0.0);
                stage.apply(black_box(&mut values));
            }));)*
        };
    }
    let walk = RandomWalk { random_walk: 5e-5 };
    let markov =
        GaussMarkov { standard_deviation: 1e-3, correlation_time: 300.0, start: Start::Stationary };
    let band = BandVibration { standard_deviation: 0.5, frequency: 60.0, bandwidth: 15.0 };
    bench! {
        "white": White { noise_density: 0.015 },
        "random_walk": walk,
        "random_walk_mean": IntervalMean(walk),
        "gauss_markov": markov,
        "gauss_markov_mean": IntervalMean(markov),
        "flicker_of_5": Flicker::<f64, 5> {
            bias_instability: 1e-3, shortest_tau: 1.0, longest_tau: 1e3,
        },
        "constant_bias": ConstantBias { constant_bias: 0.1 },
        "rate_ramp": RateRamp { rate_ramp: 1e-6 },
        "temperature_ramp": TemperatureRamp { coefficient: 1e-3, start: -5.0, rate: 0.02 },
        // So slow that it does not decay into subnormal numbers, on which processors take longer, while it is timed.
        "warm_up": WarmUp { coefficient: 1e-3, start: -5.0, rise: 25.0, time_constant: 1e7 },
        "sinusoid": Sinusoid { amplitude: 0.5, frequency: 37.3, phase: 0.0 },
        "band_vibration": band,
        "band_vibration_mean": IntervalMean(band),
        "one_pole": OnePole { cutoff: 42.0, start: 0.0, noise_density: 0.015 },
        "two_pole": TwoPole { cutoff: 42.0, start: 0.0 },
        "saturation": Saturation { range: 34.9 },
        "increment_quantisation": IncrementQuantisation { quantisation_noise: 1e-7 },
        "quantisation": Quantisation { step: 1e-3 },
    }
    group.finish();
}

criterion_group!(benches, terms);
criterion_main!(benches);
