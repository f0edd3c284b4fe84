//! The errors of a sensor by name, and what each of them puts into the samples.

use imu_core::noise::Stage;

/// An error of a sensor, in the order in which they act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorTerm {
    /// None: what an ideal sensor reads at the point that the motion describes.
    Truth,
    /// What the sensor's place adds.
    LeverArm,
    /// What its axes add.
    ScaleMisalignment,
    /// What a gyroscope reads of specific force.
    GSensitivity,
    /// White noise.
    White,
    /// Random walk of the bias.
    RandomWalk,
    /// The constant bias.
    ConstantBias,
    /// The bias of this run.
    TurnOnBias,
    /// The bias that forgets.
    GaussMarkov,
    /// Flicker.
    Flicker,
    /// The ramp of the bias.
    RateRamp,
    /// The bias of a temperature that is constant or a ramp.
    Temperature,
    /// The bias of a warm-up.
    WarmUp,
    /// Vibration of one frequency.
    Vibration,
    /// Vibration of a band.
    BandVibration,
    /// What a low-pass changes.
    Bandwidth,
    /// What saturation takes away.
    Saturation,
    /// Rounding of the integral.
    IncrementQuantisation,
    /// Rounding of the readings.
    Quantisation,
}

impl ErrorTerm {
    /// Its name in a file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Truth => "truth",
            Self::LeverArm => "lever_arm",
            Self::ScaleMisalignment => "scale_misalignment",
            Self::GSensitivity => "g_sensitivity",
            Self::White => "white_noise",
            Self::RandomWalk => "random_walk",
            Self::ConstantBias => "constant_bias",
            Self::TurnOnBias => "turn_on_bias",
            Self::GaussMarkov => "gauss_markov",
            Self::Flicker => "flicker",
            Self::RateRamp => "rate_ramp",
            Self::Temperature => "temperature",
            Self::WarmUp => "warm_up",
            Self::Vibration => "vibration",
            Self::BandVibration => "band_vibration",
            Self::Bandwidth => "bandwidth",
            Self::Saturation => "saturation",
            Self::IncrementQuantisation => "increment_quantisation",
            Self::Quantisation => "quantisation",
        }
    }

    /// Whether what it adds depends on what came before it.
    const fn shapes(self) -> bool {
        matches!(self, Self::Bandwidth | Self::Saturation | Self::Quantisation)
    }
}

/// What one error adds to the samples of one axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contributions {
    /// Each error that the axis has, the truth first, and what it adds to each sample of the block.
    pub terms: Vec<(ErrorTerm, Vec<f64>)>,
}

/// Takes samples through stages, one after the other.
pub(super) trait Pass {
    fn pass<S: Stage<f64> + Copy>(&mut self, term: ErrorTerm, stage: &mut S, column: &mut [f64]);
}

/// Does not look.
pub(super) struct Unwatched;

impl Pass for Unwatched {
    fn pass<S: Stage<f64> + Copy>(&mut self, _: ErrorTerm, stage: &mut S, column: &mut [f64]) {
        stage.apply(column);
    }
}

/// What a stage adds is what it makes of zeros, to the bit; where it depends on the samples, what it
/// makes of them less what they were.
impl Pass for Contributions {
    fn pass<S: Stage<f64> + Copy>(&mut self, term: ErrorTerm, stage: &mut S, column: &mut [f64]) {
        let added = if term.shapes() {
            let mut before = column.to_vec();
            stage.apply(column);
            before.iter_mut().zip(column).for_each(|(before, after)| *before = *after - *before);
            before
        } else {
            let mut zeros = vec![0.0; column.len()];
            let mut copy = *stage;
            copy.apply(&mut zeros);
            stage.apply(column);
            zeros
        };
        self.terms.push((term, added));
    }
}
