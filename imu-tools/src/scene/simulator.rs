//! The simulator: a scene played block by block, axis by axis, one loop for each error present.
//!
//! The same core stages in the same order as a compiled composition, so the same bits; what the scene
//! leaves out has no loop, draws nothing and costs nothing (`chain.rs`, `felt.rs`, `stamps.rs`).

use imu_core::noise::Sensor;
use imu_core::trajectory::Motion;

use super::chain::Chain;
use super::clock::Ticks;
use super::error_term::{Contributions, Unwatched};
use super::lay::Layer;
use super::stamps::Clock;
use super::{Scene, SensorErrors, Temperature};
use crate::error::Error;
use crate::recording::{self, BLOCK_SAMPLES, Block, Note, Sample, SampleKind, Source, Stream};

/// What was true at each sample that was due in a block, also of those that were lost.
#[derive(Clone, Debug, Default)]
pub struct Truth {
    /// The true time of each sample, nanoseconds after the epoch.
    pub times_ns: Vec<i64>,
    /// Its stamp in the recording; `None` for a sample that was lost.
    pub stamps_ns: Vec<Option<i64>>,
    /// The motion of the accelerometer at that time.
    pub motions: Vec<Motion<f64>>,
    /// The temperature then, °C, where the scene has one.
    pub celsius: Vec<f64>,
    /// The bias that each sample of the gyroscope carries (before a low-pass), rad/s.
    pub gyroscope_bias: Vec<[f64; 3]>,
    /// The bias that each sample of the accelerometer carries (before a low-pass), m/s².
    pub accelerometer_bias: Vec<[f64; 3]>,
    /// What each error adds to x, y, z of the gyroscope, rad/s; empty unless
    /// [`Simulator::keep_terms`] was called. Their sum is the sample (of increments: divided by the
    /// interval), but for rounding.
    pub gyroscope_terms: [Contributions; 3],
    /// The same of the accelerometer, m/s².
    pub accelerometer_terms: [Contributions; 3],
}

/// A scene being played, from its first sample to its last, once.
#[derive(Debug)]
pub struct Simulator {
    layer: Layer,
    start_ns: i64,
    ticks: Ticks,
    left: u64,
    interval_s: f64,
    samples: SampleKind,
    temperature: Option<Temperature>,
    clock: Option<Clock>,
    gyroscope: [Chain; 3],
    accelerometer: [Chain; 3],
    keep_terms: bool,
    notes: Vec<Note>,
    truth: Truth,
    stamps: Vec<i64>,
    lost: Vec<bool>,
    axis: Vec<f64>,
}

impl Simulator {
    /// The simulation of `scene`, at its start.
    ///
    /// # Errors
    /// When the scene cannot be: see [`Scene::check`].
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        scene.check()?;
        let layer = Layer::new(scene);
        let (rate, force) = layer.first();
        let chains = |sensor, errors: &SensorErrors, felt: [f64; 3]| {
            let mut chains = [Chain::default(); 3];
            for (i, chain) in chains.iter_mut().enumerate() {
                *chain = Chain::new(scene, sensor, i, errors, felt[i])?;
            }
            Ok::<_, Error>(chains)
        };
        Ok(Self {
            layer,
            start_ns: scene.start_ns,
            ticks: Ticks::new(scene.rate),
            left: scene.samples_due(),
            interval_s: scene.rate.interval_s(),
            samples: scene.samples,
            temperature: scene.temperature,
            clock: Clock::new(&scene.clock, scene.seed),
            gyroscope: chains(Sensor::GYROSCOPE, &scene.gyroscope, rate)?,
            accelerometer: chains(Sensor::ACCELEROMETER, &scene.accelerometer, force)?,
            keep_terms: false,
            notes: scene.motion.notes().to_vec(),
            truth: Truth::default(),
            stamps: Vec::new(),
            lost: Vec::new(),
            axis: Vec::new(),
        })
    }

    /// Samples of each sensor that are still due, those that will be lost among them.
    #[must_use]
    pub const fn samples_left(&self) -> u64 {
        self.left
    }

    /// From now on the truth holds what each error adds; no sample changes by that.
    pub fn keep_terms(&mut self) {
        self.keep_terms = true;
    }

    /// Fills `block` with the samples due next, at most [`BLOCK_SAMPLES`] of each sensor, of the scene's
    /// kind (increments are rad and m/s, in the place of rad/s and m/s²); `false`, and an empty block,
    /// at the end.
    pub fn advance(&mut self, block: &mut Block) -> bool {
        let more = self.play(block, false);
        self.to_increments(block);
        more
    }

    /// The same samples, and what was true at each of them.
    pub fn advance_with_truth(&mut self, block: &mut Block) -> Option<&Truth> {
        let more = self.play(block, true);
        self.to_increments(block);
        more.then_some(&self.truth)
    }

    /// Rates and forces into increments, where the scene asks for them.
    fn to_increments(&self, block: &mut Block) {
        if self.samples == SampleKind::Increments {
            for sample in block.gyroscope.iter_mut().chain(&mut block.accelerometer) {
                sample.value = sample.value.map(|x| x * self.interval_s);
            }
        }
    }

    fn play(&mut self, block: &mut Block, with_truth: bool) -> bool {
        let count = usize::try_from(self.left).unwrap_or(usize::MAX).min(BLOCK_SAMPLES);
        self.left -= count as u64;
        self.lay_truth(count, block, with_truth);
        let terms = with_truth && self.keep_terms;
        let truth = &mut self.truth;
        measure(
            &mut self.gyroscope,
            &mut block.gyroscope,
            with_truth.then_some(&mut truth.gyroscope_bias),
            terms.then_some(&mut truth.gyroscope_terms),
            &mut self.axis,
        );
        measure(
            &mut self.accelerometer,
            &mut block.accelerometer,
            with_truth.then_some(&mut truth.accelerometer_bias),
            terms.then_some(&mut truth.accelerometer_terms),
            &mut self.axis,
        );
        self.stamp(block, with_truth);
        count > 0
    }

    /// Puts the next times and what is felt then into `block`, and the truth aside if asked to.
    fn lay_truth(&mut self, count: usize, block: &mut Block, keep: bool) {
        block.clear();
        let (start_ns, truth) = (self.start_ns, &mut self.truth);
        self.layer.lay(start_ns, self.ticks.by_ref().take(count), block);
        truth.times_ns.clear();
        truth.motions.clear();
        truth.celsius.clear();
        let times = block.gyroscope.iter().map(|sample| sample.stamp_ns);
        if let Some(temperature) = &self.temperature {
            let celsius = |t_ns: i64| temperature.at((t_ns - start_ns) as f64 / 1e9);
            block.temperature.extend(
                times.clone().map(|stamp_ns| recording::Temperature {
                    stamp_ns,
                    celsius: celsius(stamp_ns),
                }),
            );
        }
        if keep {
            truth.motions.extend(times.clone().map(|t_ns| self.layer.motion(t_ns - start_ns)));
            truth.celsius.extend(block.temperature.iter().map(|t| t.celsius));
            truth.times_ns.extend(times);
        }
        if keep && self.keep_terms {
            let (gyroscope, accelerometer) =
                (&mut truth.gyroscope_terms, &mut truth.accelerometer_terms);
            self.layer.contributions(start_ns, &truth.times_ns, gyroscope, accelerometer);
        }
    }

    /// True times into stamps, and what is lost out of the block.
    fn stamp(&mut self, block: &mut Block, keep: bool) {
        let Some(clock) = &mut self.clock else {
            if keep {
                self.truth.stamps_ns.clear();
                self.truth.stamps_ns.extend(self.truth.times_ns.iter().copied().map(Some));
            }
            return;
        };
        let (stamps, lost) = (&mut self.stamps, &mut self.lost);
        stamps.clear();
        stamps.extend(block.gyroscope.iter().map(|sample| sample.stamp_ns));
        clock.stamp(self.start_ns, stamps);
        for list in [&mut block.gyroscope, &mut block.accelerometer] {
            list.iter_mut().zip(&*stamps).for_each(|(sample, stamp)| sample.stamp_ns = *stamp);
        }
        block.temperature.iter_mut().zip(&*stamps).for_each(|(t, stamp)| t.stamp_ns = *stamp);
        lost.clear();
        clock.lose(stamps.len(), lost);
        if !lost.is_empty() {
            drop_lost(&mut block.gyroscope, lost);
            drop_lost(&mut block.accelerometer, lost);
            drop_lost(&mut block.temperature, lost);
        }
        if keep {
            let stamps = stamps.iter().enumerate();
            let came = |i: usize| !lost.get(i).copied().unwrap_or(false);
            self.truth.stamps_ns.clear();
            self.truth.stamps_ns.extend(stamps.map(|(i, stamp)| came(i).then_some(*stamp)));
        }
    }
}

fn drop_lost<T>(list: &mut Vec<T>, lost: &[bool]) {
    let mut lost = lost.iter();
    list.retain(|_| !lost.next().copied().unwrap_or(false));
}

/// Turns what one sensor feels into measurements, axis by axis over `column`.
fn measure(
    chains: &mut [Chain; 3],
    samples: &mut [Sample],
    mut bias: Option<&mut Vec<[f64; 3]>>,
    mut terms: Option<&mut [Contributions; 3]>,
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
        match &mut terms {
            Some(terms) => chain.apply(&mut terms[axis], column),
            None => chain.apply(&mut Unwatched, column),
        }
        samples.iter_mut().zip(column.iter()).for_each(|(sample, x)| sample.value[axis] = *x);
    }
}

/// Samples come as rates and forces, increments divided by their interval.
impl Source for Simulator {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        Ok(self.play(block, false))
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
        std::mem::take(&mut self.notes)
    }

    /// Zero: a simulation reads no file.
    fn bytes_read(&self) -> u64 {
        0
    }

    fn bytes_total(&self) -> Option<u64> {
        None
    }
}
