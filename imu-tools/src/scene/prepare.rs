//! A scene's errors into the chain of each axis.

use imu_core::noise::{
    Axis, BandVibration, Channel, ConstantBias, Flicker, GaussMarkov, IncrementQuantisation,
    IntervalMean, Quantisation, RandomWalk, RateRamp, Sensor, Sinusoid, Start, Term, TurnOnBias,
    White,
};
use imu_core::sensor::{OnePole, Saturation, TwoPole};

use super::chain::{Biases, Chain, Either, FLICKER, OfKind};
use super::{Poles, Scene, SensorErrors};
use crate::error::Error;
use crate::recording::SampleKind;

impl Chain {
    /// `felt`: what the axis feels first, from which a low-pass starts.
    pub(super) fn new(
        scene: &Scene,
        sensor: Sensor,
        axis: usize,
        errors: &SensorErrors,
        felt: f64,
    ) -> Result<Self, Error> {
        let make = Make {
            dt: scene.rate.interval_s(),
            channel: Channel::new(scene.seed, sensor, Axis::ALL[axis]),
            means: scene.samples != SampleKind::Instantaneous,
            sensor: if sensor == Sensor::GYROSCOPE { "gyroscope" } else { "accelerometer" },
        };
        let at = |of: [f64; 3]| of[axis];
        let noise_density = at(errors.noise_density);
        let biases = biases(scene, errors, axis, make)?;
        let start = felt + biases.next();
        let (one, two) = match errors.lowpass_poles {
            Poles::One => (errors.lowpass_hz, None),
            Poles::Two => (None, errors.lowpass_hz),
        };
        Ok(Self {
            white: make.unless_zero(noise_density, |noise_density| White { noise_density })?,
            biases,
            vibration: make.of_kind(errors.vibration, |term| Sinusoid {
                amplitude: at(term.amplitude.0),
                frequency: term.frequency_hz,
                phase: 0.0,
            })?,
            band_vibration: make.of_kind(errors.band_vibration, |term| BandVibration {
                standard_deviation: at(term.standard_deviation.0),
                frequency: term.frequency_hz,
                bandwidth: term.bandwidth_hz,
            })?,
            one_pole: make.given(one, |cutoff| OnePole { cutoff, start, noise_density })?,
            two_pole: make.given(two, |cutoff| TwoPole { cutoff, start })?,
            saturation: make.given(errors.saturation, |range| Saturation { range })?,
            increments: make.given(errors.increment_quantisation, |count| {
                IncrementQuantisation { quantisation_noise: count / 12_f64.sqrt() }
            })?,
            quantisation: make.given(errors.quantisation, |step| Quantisation { step })?,
        })
    }
}

fn biases(scene: &Scene, errors: &SensorErrors, axis: usize, make: Make) -> Result<Biases, Error> {
    let at = |of: [f64; 3]| of[axis];
    let not_zero = |x: f64| (x != 0.0).then_some(x);
    let coefficient = at(errors.temperature_coefficient);
    let temperature = scene.temperature;
    Ok(Biases {
        walk: make
            .of_kind(not_zero(at(errors.random_walk)), |random_walk| RandomWalk { random_walk })?,
        constant: make.unless_zero(at(errors.constant_bias), |constant_bias| ConstantBias {
            constant_bias,
        })?,
        turn_on: make.unless_zero(at(errors.turn_on_bias), |standard_deviation| TurnOnBias {
            standard_deviation,
        })?,
        gauss_markov: make.of_kind(errors.gauss_markov, |term| GaussMarkov {
            standard_deviation: at(term.standard_deviation.0),
            correlation_time: term.correlation_time_s,
            start: Start::Stationary,
        })?,
        flicker: make.given(errors.flicker, |term| Flicker::<f64, FLICKER> {
            bias_instability: at(term.bias_instability.0),
            shortest_tau: term.shortest_tau_s,
            longest_tau: term.longest_tau_s,
        })?,
        ramp: make.of_kind(not_zero(at(errors.rate_ramp)), |rate_ramp| RateRamp { rate_ramp })?,
        temperature: make.of_kind(temperature.and_then(|t| t.ramp(coefficient)), |ramp| ramp)?,
        warm_up: make.of_kind(temperature.and_then(|t| t.warm_up(coefficient)), |term| term)?,
    })
}

/// Makes stages for one axis.
#[derive(Clone, Copy)]
struct Make {
    dt: f64,
    channel: Channel,
    means: bool,
    sensor: &'static str,
}

impl Make {
    /// The stage of a term, unless its parameter is zero.
    fn unless_zero<P: Term<f64>>(
        self,
        parameter: f64,
        term: impl FnOnce(f64) -> P,
    ) -> Result<Option<P::Stage>, Error> {
        self.given((parameter != 0.0).then_some(parameter), term)
    }

    /// The stage of a term that the scene has.
    fn given<G, P: Term<f64>>(
        self,
        given: Option<G>,
        term: impl FnOnce(G) -> P,
    ) -> Result<Option<P::Stage>, Error> {
        let stage = given.map(|given| term(given).prepare(self.dt, self.channel)).transpose();
        stage.map_err(|error| {
            Error::usage(format!("the {} cannot be simulated at this rate: {error}", self.sensor))
        })
    }

    /// The stage of a term that the scene has, for its kind of samples.
    fn of_kind<G, P: Term<f64>>(
        self,
        given: Option<G>,
        term: impl FnOnce(G) -> P,
    ) -> Result<Option<Either<P>>, Error>
    where
        IntervalMean<P>: Term<f64>,
    {
        Ok(if self.means {
            self.given(given, |given| IntervalMean(term(given)))?.map(OfKind::Means)
        } else {
            self.given(given, term)?.map(OfKind::Instants)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::error_term::Unwatched;
    use crate::scene::{
        Axes, BandVibrationTerm, FlickerTerm, GaussMarkovTerm, Rate, VibrationTerm,
    };
    use imu_core::noise::Stage as _;

    /// A scene's terms, put together while it runs, give the bits of the same terms put together by
    /// the compiler; and what they add is what the truth tells of the bias.
    #[test]
    fn a_scene_is_a_composition() {
        let errors = SensorErrors {
            noise_density: [0.01; 3],
            random_walk: [1e-3; 3],
            constant_bias: [0.1; 3],
            turn_on_bias: [0.2; 3],
            rate_ramp: [1e-3; 3],
            gauss_markov: Some(GaussMarkovTerm {
                standard_deviation: Axes([0.05; 3]),
                correlation_time_s: 3.0,
            }),
            flicker: Some(FlickerTerm {
                bias_instability: Axes([0.02; 3]),
                shortest_tau_s: 0.1,
                longest_tau_s: 1e4,
            }),
            vibration: Some(VibrationTerm { amplitude: Axes([0.3; 3]), frequency_hz: 17.0 }),
            band_vibration: Some(BandVibrationTerm {
                standard_deviation: Axes([0.1; 3]),
                frequency_hz: 30.0,
                bandwidth_hz: 10.0,
            }),
            lowpass_hz: Some(40.0),
            saturation: Some(0.9),
            quantisation: Some(1.0 / 1024.0),
            ..SensorErrors::default()
        };
        let scene = Scene { rate: Rate::from_hz(200.0).unwrap(), ..Scene::default() };
        let mut chain = Chain::new(&scene, Sensor::GYROSCOPE, 1, &errors, 0.0).unwrap();
        let channel = Channel::new(scene.seed, Sensor::GYROSCOPE, Axis::Y);
        let biases = (
            RandomWalk { random_walk: 1e-3 },
            ConstantBias { constant_bias: 0.1 },
            TurnOnBias { standard_deviation: 0.2 },
            GaussMarkov {
                standard_deviation: 0.05,
                correlation_time: 3.0,
                start: Start::Stationary,
            },
            Flicker::<f64, FLICKER> { bias_instability: 0.02, shortest_tau: 0.1, longest_tau: 1e4 },
            RateRamp { rate_ramp: 1e-3 },
        );
        let first = biases.prepare(0.005, channel).unwrap().step(0.0);
        let terms = (
            White { noise_density: 0.01 },
            biases,
            Sinusoid { amplitude: 0.3, frequency: 17.0, phase: 0.0 },
            BandVibration { standard_deviation: 0.1, frequency: 30.0, bandwidth: 10.0 },
            OnePole { cutoff: 40.0, start: first, noise_density: 0.01 },
            Saturation { range: 0.9 },
            Quantisation { step: 1.0 / 1024.0 },
        );
        let mut composed = terms.prepare(0.005, channel).unwrap();
        let mut told = biases.prepare(0.005, channel).unwrap();
        for _ in 0..3 {
            let mut bias = vec![0.0; 500];
            chain.biases(&mut bias);
            let mut column = vec![0.0; 500];
            chain.apply(&mut Unwatched, &mut column);
            for (measured, bias) in column.iter().zip(&bias) {
                assert_eq!(measured.to_bits(), composed.step(0.0).to_bits());
                assert_eq!(bias.to_bits(), told.step(0.0).to_bits());
                assert!(measured.abs() <= 922.0 / 1024.0 && (measured * 1024.0).fract() == 0.0);
            }
        }
    }
}
