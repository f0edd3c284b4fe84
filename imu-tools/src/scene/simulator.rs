//! The simulator: a scene played block by block, axis by axis, one loop for each term present.
//!
//! The same core stages in the same order as a compiled composition, so the same bits; a term that
//! the scene leaves out has no loop, draws nothing and costs nothing (`chain.rs`).

use imu_core::nalgebra::Vector3;
use imu_core::noise::Sensor;
use imu_core::trajectory::Motion;

use super::chain::Chain;
use super::clock::Ticks;
use super::{Path, Scene, SensorErrors};
use crate::error::Error;
use crate::recording::{BLOCK_SAMPLES, Block, Note, Sample, Source, Stream};

/// What was true at each sample of a block.
#[derive(Clone, Debug, Default)]
pub struct Truth {
    /// Stamp of each sample, as in the block.
    pub stamps_ns: Vec<i64>,
    /// The motion at each sample.
    pub motions: Vec<Motion<f64>>,
    /// The bias that each sample of the gyroscope carries (before a low-pass), rad/s.
    pub gyroscope_bias: Vec<[f64; 3]>,
    /// The bias that each sample of the accelerometer carries (before a low-pass), m/s².
    pub accelerometer_bias: Vec<[f64; 3]>,
}

/// A scene being played, from its first sample to its last, once.
#[derive(Debug)]
pub struct Simulator {
    path: Path,
    gravity: f64,
    start_ns: i64,
    ticks: Ticks,
    left: u64,
    gyroscope: [Chain; 3],
    accelerometer: [Chain; 3],
    truth: Truth,
    axis: Vec<f64>,
}

impl Simulator {
    /// The simulation of `scene`, at its start.
    ///
    /// # Errors
    /// When the scene cannot be: see [`Scene::check`].
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        scene.check()?;
        let first = scene.motion.at(scene.gravity, 0);
        let chains = |sensor, errors: &SensorErrors, truth: [f64; 3]| {
            let mut chains = [Chain::default(); 3];
            for (i, chain) in chains.iter_mut().enumerate() {
                *chain = Chain::new(scene, sensor, i, errors, truth[i])?;
            }
            Ok::<_, Error>(chains)
        };
        Ok(Self {
            path: scene.motion,
            gravity: scene.gravity,
            start_ns: scene.start_ns,
            ticks: Ticks::new(scene.rate),
            left: scene.rate.samples_in(scene.duration_ns),
            gyroscope: chains(Sensor::GYROSCOPE, &scene.gyroscope, first.angular_rate.into())?,
            accelerometer: chains(
                Sensor::ACCELEROMETER,
                &scene.accelerometer,
                first.specific_force.into(),
            )?,
            truth: Truth::default(),
            axis: Vec::new(),
        })
    }

    /// Samples of each sensor still to come.
    #[must_use]
    pub const fn samples_left(&self) -> u64 {
        self.left
    }

    /// Fills `block` with the next samples, at most [`BLOCK_SAMPLES`] of each sensor; `false`, and
    /// an empty block, at the end.
    pub fn advance(&mut self, block: &mut Block) -> bool {
        self.play(block, false)
    }

    /// The same samples, and what was true at each of them.
    pub fn advance_with_truth(&mut self, block: &mut Block) -> Option<&Truth> {
        self.play(block, true).then_some(&self.truth)
    }

    fn play(&mut self, block: &mut Block, with_bias: bool) -> bool {
        let count = usize::try_from(self.left).unwrap_or(usize::MAX).min(BLOCK_SAMPLES);
        self.left -= count as u64;
        self.lay_truth(count, block, with_bias);
        let truth = &mut self.truth;
        let bias = with_bias.then_some(&mut truth.gyroscope_bias);
        measure(&mut self.gyroscope, &mut block.gyroscope, bias, &mut self.axis);
        let bias = with_bias.then_some(&mut truth.accelerometer_bias);
        measure(&mut self.accelerometer, &mut block.accelerometer, bias, &mut self.axis);
        count > 0
    }

    /// Puts the next stamps and true values into `block`, and the motions aside if asked to.
    fn lay_truth(&mut self, count: usize, block: &mut Block, keep: bool) {
        block.clear();
        self.truth.stamps_ns.clear();
        self.truth.motions.clear();
        let still = (self.path == Path::Rest).then(|| self.path.at(self.gravity, 0));
        for offset_ns in self.ticks.by_ref().take(count) {
            let motion = still.unwrap_or_else(|| self.path.at(self.gravity, offset_ns));
            let stamp_ns = self.start_ns + offset_ns;
            let sample = |value: Vector3<f64>| Sample { stamp_ns, value: value.into() };
            block.gyroscope.push(sample(motion.angular_rate));
            block.accelerometer.push(sample(motion.specific_force));
            if keep {
                self.truth.stamps_ns.push(stamp_ns);
                self.truth.motions.push(motion);
            }
        }
    }
}

/// Turns the true values of one sensor into measurements, axis by axis over `column`.
fn measure(
    chains: &mut [Chain; 3],
    samples: &mut [Sample],
    mut bias: Option<&mut Vec<[f64; 3]>>,
    column: &mut Vec<f64>,
) {
    if let Some(bias) = &mut bias {
        bias.clear();
        bias.resize(samples.len(), [0.0; 3]);
    }
    for (axis, chain) in chains.iter_mut().enumerate() {
        if let Some(bias) = &mut bias {
            column.clear();
            column.resize(samples.len(), 0.0);
            chain.biases(column);
            bias.iter_mut().zip(column.iter()).for_each(|(bias, x)| bias[axis] = *x);
        }
        column.clear();
        column.extend(samples.iter().map(|sample| sample.value[axis]));
        chain.apply(column);
        samples.iter_mut().zip(column.iter()).for_each(|(sample, x)| sample.value[axis] = *x);
    }
}

impl Source for Simulator {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        Ok(self.advance(block))
    }

    fn streams(&self) -> Vec<Stream> {
        Vec::new()
    }

    fn gyroscope(&self) -> &str {
        "simulated"
    }

    fn accelerometer(&self) -> &str {
        "simulated"
    }

    fn take_notes(&mut self) -> Vec<Note> {
        Vec::new()
    }

    /// Zero: a simulation reads no file.
    fn bytes_read(&self) -> u64 {
        0
    }

    fn bytes_total(&self) -> Option<u64> {
        None
    }
}
