//! The axes of both sensors: how they read what is felt, before anything is added.

use imu_core::sensor::{AxisMap, ForceCoupling, GSensitivity, ScaleMisalignment};

use super::SensorErrors;
use super::felt::Felt;

/// Scale, misalignment and g-sensitivity of one sensor, as far as it has them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mount {
    axes: Option<ScaleMisalignment<f64>>,
    coupling: Option<GSensitivity<f64>>,
}

/// What each step makes of a reading.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    pub(super) truth: [f64; 3],
    pub(super) placed: [f64; 3],
    pub(super) mapped: [f64; 3],
    pub(super) coupled: [f64; 3],
}

impl Mount {
    pub(super) fn new(errors: &SensorErrors) -> Self {
        let matrix = errors.scale_misalignment.map(|matrix| ScaleMisalignment { matrix });
        let (scale, angles) = (errors.scale_error, errors.misalignment_rad);
        let given = scale != [0.0; 3] || angles != [[0.0; 2]; 3];
        let parts = given.then(|| ScaleMisalignment::new(scale, angles));
        let matrix_of = errors.g_sensitivity;
        let coupling = (matrix_of != [[0.0; 3]; 3]).then_some(GSensitivity { matrix: matrix_of });
        Self { axes: matrix.or(parts), coupling }
    }

    /// Whether a reading is what is felt.
    pub(super) fn is_ideal(&self) -> bool {
        self.axes.is_none() && self.coupling.is_none()
    }

    pub(super) fn has_axes(&self) -> bool {
        self.axes.is_some()
    }

    pub(super) fn has_coupling(&self) -> bool {
        self.coupling.is_some()
    }

    /// What a gyroscope reads.
    pub(super) fn rate(&self, felt: &Felt) -> Steps {
        self.steps(felt.rate, felt.rate, felt.at_gyroscope)
    }

    /// What an accelerometer reads.
    pub(super) fn force(&self, felt: &Felt) -> Steps {
        self.steps(felt.force, felt.at_accelerometer, felt.at_accelerometer)
    }

    fn steps(&self, truth: [f64; 3], placed: [f64; 3], force: [f64; 3]) -> Steps {
        let mapped = self.axes.map_or(placed, |axes| axes.read(placed));
        let coupled = self.coupling.map_or(mapped, |coupling| coupling.couple(mapped, force));
        Steps { truth, placed, mapped, coupled }
    }
}
