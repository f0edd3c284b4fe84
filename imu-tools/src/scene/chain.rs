//! The terms of one axis of a sensor, in the order in which they act: noise, biases, vibration, then
//! bandwidth, saturation and rounding.

use imu_core::noise::{
    Axis, BandVibration, BandVibrationStage, Channel, ConstantBias, Flicker, FlickerStage,
    GaussMarkov, GaussMarkovStage, Quantisation, QuantisationStage, RandomWalk, RandomWalkStage,
    RateRamp, RateRampStage, Sensor, Sinusoid, SinusoidStage, Stage, Start, Term, TurnOnBias,
    White, WhiteStage,
};
use imu_core::sensor::{OnePole, OnePoleStage, Saturation};

use super::{Scene, SensorErrors};
use crate::error::Error;

/// Processes of a flicker: enough for six decades of averaging times.
const FLICKER: usize = 8;

/// The terms present on one axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Chain {
    white: Option<WhiteStage<f64>>,
    biases: Biases,
    vibration: Option<SinusoidStage<f64>>,
    band_vibration: Option<BandVibrationStage<f64>>,
    low_pass: Option<OnePoleStage<f64>>,
    saturation: Option<Saturation<f64>>,
    quantisation: Option<QuantisationStage<f64>>,
}

/// What adds up to the bias of a sample.
#[derive(Clone, Copy, Debug, Default)]
struct Biases {
    walk: Option<RandomWalkStage<f64>>,
    constant: Option<ConstantBias<f64>>,
    turn_on: Option<ConstantBias<f64>>,
    gauss_markov: Option<GaussMarkovStage<f64>>,
    flicker: Option<FlickerStage<f64, FLICKER>>,
    ramp: Option<RateRampStage<f64>>,
}

/// Applies the stages that are there, one after the other.
macro_rules! apply {
    ($column:expr, $($stage:expr),*) => {
        $(if let Some(stage) = &mut $stage { stage.apply($column); })*
    };
}

impl Biases {
    fn apply(&mut self, column: &mut [f64]) {
        apply!(
            column,
            self.walk,
            self.constant,
            self.turn_on,
            self.gauss_markov,
            self.flicker,
            self.ramp
        );
    }
}

impl Chain {
    /// `truth`: the first true value, from which a low-pass starts.
    pub(super) fn new(
        scene: &Scene,
        sensor: Sensor,
        axis: usize,
        errors: &SensorErrors,
        truth: f64,
    ) -> Result<Self, Error> {
        let make = Make {
            dt: scene.rate.interval_s(),
            channel: Channel::new(scene.seed, sensor, Axis::ALL[axis]),
        };
        let at = |of: [f64; 3]| of[axis];
        let noise_density = at(errors.noise_density);
        let constant_bias = at(errors.constant_bias);
        let biases = Biases {
            walk: make
                .unless_zero(at(errors.random_walk), |random_walk| RandomWalk { random_walk })?,
            constant: make
                .unless_zero(constant_bias, |constant_bias| ConstantBias { constant_bias })?,
            turn_on: make.unless_zero(at(errors.turn_on_bias), |standard_deviation| {
                TurnOnBias { standard_deviation }
            })?,
            gauss_markov: make.given(errors.gauss_markov, |term| GaussMarkov {
                standard_deviation: at(term.standard_deviation.0),
                correlation_time: term.correlation_time_s,
                start: Start::Stationary,
            })?,
            flicker: make.given(errors.flicker, |term| Flicker::<f64, FLICKER> {
                bias_instability: at(term.bias_instability.0),
                shortest_tau: term.shortest_tau_s,
                longest_tau: term.longest_tau_s,
            })?,
            ramp: make.unless_zero(at(errors.rate_ramp), |rate_ramp| RateRamp { rate_ramp })?,
        };
        Ok(Self {
            white: make.unless_zero(noise_density, |noise_density| White { noise_density })?,
            biases,
            vibration: make.given(errors.vibration, |term| Sinusoid {
                amplitude: at(term.amplitude.0),
                frequency: term.frequency_hz,
                phase: 0.0,
            })?,
            band_vibration: make.given(errors.band_vibration, |term| BandVibration {
                standard_deviation: at(term.standard_deviation.0),
                frequency: term.frequency_hz,
                bandwidth: term.bandwidth_hz,
            })?,
            low_pass: make.given(errors.lowpass_hz, |cutoff| OnePole {
                cutoff,
                start: truth + constant_bias,
                noise_density,
            })?,
            saturation: make.given(errors.saturation, |range| Saturation { range })?,
            quantisation: make.given(errors.quantisation, |step| Quantisation { step })?,
        })
    }

    /// Turns true values into measurements.
    pub(super) fn apply(&mut self, column: &mut [f64]) {
        apply!(column, self.white);
        self.biases.apply(column);
        apply!(
            column,
            self.vibration,
            self.band_vibration,
            self.low_pass,
            self.saturation,
            self.quantisation
        );
    }

    /// Adds the biases of the next samples, which are then still to come: the samples keep the bits
    /// they have where nobody asks for the truth.
    pub(super) fn biases(&self, column: &mut [f64]) {
        let mut copy = self.biases;
        copy.apply(column);
    }
}

/// Makes stages for one axis.
#[derive(Clone, Copy)]
struct Make {
    dt: f64,
    channel: Channel,
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
            Error::usage(format!("this noise cannot be simulated at this rate: {error}"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{
        Axes, BandVibrationTerm, FlickerTerm, GaussMarkovTerm, Rate, VibrationTerm,
    };

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
        let terms = (
            White { noise_density: 0.01 },
            biases,
            Sinusoid { amplitude: 0.3, frequency: 17.0, phase: 0.0 },
            BandVibration { standard_deviation: 0.1, frequency: 30.0, bandwidth: 10.0 },
            OnePole { cutoff: 40.0, start: 0.1, noise_density: 0.01 },
            Saturation { range: 0.9 },
            Quantisation { step: 1.0 / 1024.0 },
        );
        let mut composed = terms.prepare(0.005, channel).unwrap();
        let mut told = biases.prepare(0.005, channel).unwrap();
        for _ in 0..3 {
            let mut bias = vec![0.0; 500];
            chain.biases(&mut bias);
            let mut column = vec![0.0; 500];
            chain.apply(&mut column);
            for (measured, bias) in column.iter().zip(&bias) {
                assert_eq!(measured.to_bits(), composed.step(0.0).to_bits());
                assert_eq!(bias.to_bits(), told.step(0.0).to_bits());
                assert!(measured.abs() <= 922.0 / 1024.0 && (measured * 1024.0).fract() == 0.0);
            }
        }
    }
}
