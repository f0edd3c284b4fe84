//! What both sensors feel, laid into blocks: by the cheapest of the ways that a scene allows.

use imu_core::trajectory::Motion;

use super::Scene;
use super::error_term::{Contributions, ErrorTerm};
use super::felt::{Arms, Felt, Played};
use super::mount::{Mount, Steps};
use crate::recording::{Block, Sample, SampleKind};

/// A scene's motion, seen by its sensors.
#[derive(Debug)]
pub(super) struct Layer {
    played: Played,
    arms: Arms,
    /// The interval of means, s; `None` at instants.
    mean_s: Option<f64>,
    gyroscope: Mount,
    accelerometer: Mount,
}

impl Layer {
    pub(super) fn new(scene: &Scene) -> Self {
        let mean = scene.samples != SampleKind::Instantaneous;
        Self {
            played: Played::new(scene),
            arms: Arms::new(scene.gyroscope.lever_arm_m, scene.accelerometer.lever_arm_m),
            mean_s: mean.then(|| scene.rate.interval_s()),
            gyroscope: Mount::new(&scene.gyroscope),
            accelerometer: Mount::new(&scene.accelerometer),
        }
    }

    /// What both sensors feel first.
    pub(super) fn first(&self) -> ([f64; 3], [f64; 3]) {
        self.read(0)
    }

    /// The motion of the accelerometer `t_ns` after the start.
    pub(super) fn motion(&self, t_ns: i64) -> Motion<f64> {
        self.played.motion_of_accelerometer(&self.arms, t_ns)
    }

    fn felt(&self, t_ns: i64) -> Felt {
        match self.mean_s {
            // At rest a mean is the instant, to the bit.
            Some(dt) if !self.played.is_still() => self.played.mean_felt(&self.arms, t_ns, dt),
            _ => self.played.felt(&self.arms, t_ns),
        }
    }

    /// What the axes of both sensors read of it.
    fn read(&self, t_ns: i64) -> ([f64; 3], [f64; 3]) {
        let felt = self.felt(t_ns);
        (self.gyroscope.rate(&felt).coupled, self.accelerometer.force(&felt).coupled)
    }

    /// Appends to `block` what is read at these offsets from the start.
    pub(super) fn lay(&self, start_ns: i64, offsets: impl Iterator<Item = i64>, block: &mut Block) {
        let mut push = |offset_ns: i64, (rate, force): ([f64; 3], [f64; 3])| {
            let stamp_ns = start_ns + offset_ns;
            block.gyroscope.push(Sample { stamp_ns, value: rate });
            block.accelerometer.push(Sample { stamp_ns, value: force });
        };
        let ideal = self.gyroscope.is_ideal() && self.accelerometer.is_ideal();
        if self.played.is_still() {
            let still = self.read(0);
            offsets.for_each(|offset_ns| push(offset_ns, still));
        } else if ideal && self.arms.are_zero() && self.mean_s.is_none() {
            offsets.for_each(|offset_ns| {
                let Motion { angular_rate, specific_force, .. } = self.motion(offset_ns);
                push(offset_ns, (angular_rate.into(), specific_force.into()));
            });
        } else {
            offsets.for_each(|offset_ns| push(offset_ns, self.read(offset_ns)));
        }
    }

    /// Begins the contributions of both sensors with the truth, and what place and axes add to it.
    pub(super) fn contributions(
        &self,
        start_ns: i64,
        times_ns: &[i64],
        gyroscope: &mut [Contributions; 3],
        accelerometer: &mut [Contributions; 3],
    ) {
        let felt: Vec<Felt> = times_ns.iter().map(|time| self.felt(time - start_ns)).collect();
        let rates: Vec<Steps> = felt.iter().map(|felt| self.gyroscope.rate(felt)).collect();
        let forces: Vec<Steps> = felt.iter().map(|felt| self.accelerometer.force(felt)).collect();
        begin(gyroscope, &rates, false, &self.gyroscope);
        begin(accelerometer, &forces, self.arms.of_accelerometer(), &self.accelerometer);
    }
}

fn begin(sensor: &mut [Contributions; 3], steps: &[Steps], arm: bool, mount: &Mount) {
    for (axis, contributions) in sensor.iter_mut().enumerate() {
        let added = |before: fn(&Steps) -> [f64; 3], after: fn(&Steps) -> [f64; 3]| {
            steps.iter().map(|s| after(s)[axis] - before(s)[axis]).collect::<Vec<f64>>()
        };
        let terms = &mut contributions.terms;
        terms.clear();
        terms.push((ErrorTerm::Truth, steps.iter().map(|s| s.truth[axis]).collect()));
        if arm {
            terms.push((ErrorTerm::LeverArm, added(|s| s.truth, |s| s.placed)));
        }
        if mount.has_axes() {
            terms.push((ErrorTerm::ScaleMisalignment, added(|s| s.placed, |s| s.mapped)));
        }
        if mount.has_coupling() {
            terms.push((ErrorTerm::GSensitivity, added(|s| s.mapped, |s| s.coupled)));
        }
    }
}
