//! What one axis of a sensor passes, in the order in which it acts: noise, biases, vibration, then
//! bandwidth, saturation and rounding. Each is there or not, while the program runs; what is not there
//! is no loop.

use imu_core::noise::{
    BandVibration, ConstantBias, FlickerStage, GaussMarkov, IncrementQuantisationStage,
    IntervalMean, QuantisationStage, RandomWalk, RateRamp, Sinusoid, Stage, TemperatureRamp, Term,
    WarmUp, WhiteStage,
};
use imu_core::sensor::{OnePoleStage, Saturation, TwoPoleStage};

use super::error_term::{ErrorTerm, Pass, Unwatched};

/// Processes of a flicker: enough for six decades of averaging times.
pub(super) const FLICKER: usize = 8;

/// A stage for samples at instants, or for means over intervals.
#[derive(Clone, Copy, Debug)]
pub(super) enum OfKind<I, M> {
    Instants(I),
    Means(M),
}

/// Both stages of a term.
pub(super) type Either<P> = OfKind<<P as Term<f64>>::Stage, <IntervalMean<P> as Term<f64>>::Stage>;

impl<I: Stage<f64>, M: Stage<f64>> Stage<f64> for OfKind<I, M> {
    fn step(&mut self, truth: f64) -> f64 {
        match self {
            Self::Instants(stage) => stage.step(truth),
            Self::Means(stage) => stage.step(truth),
        }
    }

    fn bias(&self) -> f64 {
        match self {
            Self::Instants(stage) => stage.bias(),
            Self::Means(stage) => stage.bias(),
        }
    }

    fn apply(&mut self, samples: &mut [f64]) {
        match self {
            Self::Instants(stage) => stage.apply(samples),
            Self::Means(stage) => stage.apply(samples),
        }
    }
}

/// The errors present on one axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Chain {
    pub(super) white: Option<WhiteStage<f64>>,
    pub(super) biases: Biases,
    pub(super) vibration: Option<Either<Sinusoid<f64>>>,
    pub(super) band_vibration: Option<Either<BandVibration<f64>>>,
    pub(super) one_pole: Option<OnePoleStage<f64>>,
    pub(super) two_pole: Option<TwoPoleStage<f64>>,
    pub(super) saturation: Option<Saturation<f64>>,
    pub(super) increments: Option<IncrementQuantisationStage<f64>>,
    pub(super) quantisation: Option<QuantisationStage<f64>>,
}

/// What adds up to the bias of a sample.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Biases {
    pub(super) walk: Option<Either<RandomWalk<f64>>>,
    pub(super) constant: Option<ConstantBias<f64>>,
    pub(super) turn_on: Option<ConstantBias<f64>>,
    pub(super) gauss_markov: Option<Either<GaussMarkov<f64>>>,
    pub(super) flicker: Option<FlickerStage<f64, FLICKER>>,
    pub(super) ramp: Option<Either<RateRamp<f64>>>,
    pub(super) temperature: Option<Either<TemperatureRamp<f64>>>,
    pub(super) warm_up: Option<Either<WarmUp<f64>>>,
}

/// Takes a column through the stages that are there, one after the other.
macro_rules! pass {
    ($pass:expr, $column:expr, $($term:ident: $stage:expr),* $(,)?) => {
        $(if let Some(stage) = &mut $stage {
            $pass.pass(ErrorTerm::$term, stage, $column);
        })*
    };
}

impl Biases {
    fn apply(&mut self, pass: &mut impl Pass, column: &mut [f64]) {
        pass!(
            pass,
            column,
            RandomWalk: self.walk,
            ConstantBias: self.constant,
            TurnOnBias: self.turn_on,
            GaussMarkov: self.gauss_markov,
            Flicker: self.flicker,
            RateRamp: self.ramp,
            Temperature: self.temperature,
            WarmUp: self.warm_up,
        );
    }

    /// The bias of the next sample.
    pub(super) fn next(&self) -> f64 {
        let mut column = [0.0];
        let mut copy = *self;
        copy.apply(&mut Unwatched, &mut column);
        let [bias] = column;
        bias
    }
}

impl Chain {
    /// Turns what the axis feels into measurements.
    pub(super) fn apply(&mut self, pass: &mut impl Pass, column: &mut [f64]) {
        pass!(pass, column, White: self.white);
        self.biases.apply(pass, column);
        pass!(
            pass,
            column,
            Vibration: self.vibration,
            BandVibration: self.band_vibration,
            Bandwidth: self.one_pole,
            Bandwidth: self.two_pole,
            Saturation: self.saturation,
            IncrementQuantisation: self.increments,
            Quantisation: self.quantisation,
        );
    }

    /// Adds the biases of the next samples, which are then still to come: the samples keep the bits
    /// they have where nobody asks for the truth.
    pub(super) fn biases(&self, column: &mut [f64]) {
        let mut copy = self.biases;
        copy.apply(&mut Unwatched, column);
    }
}
