//! A record as it is in life: handled at both ends, bumped, with losses, a hole, a clock that is
//! set, and a warm-up. The noise under it is that of a scene, so its truth is known.

use imu_tools::error::Error;
use imu_tools::recording::{Block, Note, Sample, Source, Stream};
use imu_tools::scene::Simulator;

/// What happens to the record; all times in seconds after its start.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disturbances {
    /// A hand is on the sensor until then, and again for the last so many seconds.
    pub handled_s: f64,
    /// Somebody bumps into the table then, and the sensor stands a little otherwise afterwards.
    pub bump_at_s: Option<f64>,
    /// One sample of so many is lost.
    pub one_lost_of: Option<u64>,
    /// Nothing is recorded from then on for a minute.
    pub hole_at_s: Option<f64>,
    /// The clock is set ahead by a second then.
    pub clock_step_at_s: Option<f64>,
    /// The biases drift in a straight line until then.
    pub warm_up_s: f64,
    /// The biases drift all the time, by so much (rad/s an hour, and ten times
    /// as many m/s²).
    pub ramp_per_hour: f64,
}

impl Disturbances {
    /// All that may happen to a record of `length_s`.
    #[must_use]
    pub fn all(length_s: f64) -> Self {
        Self {
            handled_s: 25.0,
            bump_at_s: Some(0.55 * length_s),
            one_lost_of: Some(100),
            hole_at_s: Some(0.4 * length_s),
            clock_step_at_s: Some(0.7 * length_s),
            warm_up_s: 600.0,
            ramp_per_hour: 0.0,
        }
    }
}

/// The simulator of a scene, disturbed.
#[derive(Debug)]
pub struct Disturbed {
    simulator: Simulator,
    disturbances: Disturbances,
    length_s: f64,
    first_ns: Option<i64>,
    random: u64,
}

impl Disturbed {
    /// `length_s` is that of the simulated record.
    #[must_use]
    pub fn new(simulator: Simulator, disturbances: Disturbances, length_s: f64, seed: u64) -> Self {
        let random = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        Self { simulator, disturbances, length_s, first_ns: None, random }
    }

    /// Uniform in [0, 1): xorshift64*.
    fn uniform(&mut self) -> f64 {
        self.random ^= self.random >> 12;
        self.random ^= self.random << 25;
        self.random ^= self.random >> 27;
        (self.random.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn disturb(&mut self, samples: &mut Vec<Sample>, is_force: bool) {
        let what = self.disturbances;
        let first = self.first_ns.unwrap_or(0);
        let mut kept = Vec::with_capacity(samples.len());
        for mut sample in samples.drain(..) {
            let t = (sample.stamp_ns - first) as f64 * 1e-9;
            let lost = match what.one_lost_of {
                Some(n) => self.uniform() * (n as f64) < 1.0,
                None => false,
            };
            if lost || what.hole_at_s.is_some_and(|at| t >= at && t < at + 60.0) {
                continue;
            }
            let warm = if what.warm_up_s > 0.0 { (t / what.warm_up_s).min(1.0) } else { 0.0 };
            // Ten times as large for a force: its unit is.
            let gain = if is_force { 10.0 } else { 1.0 };
            let drift = gain * what.ramp_per_hour * t / 3600.0;
            let direction = [0.03, -0.02, 0.05];
            for (axis, value) in sample.value.iter_mut().enumerate() {
                *value += gain * direction[axis] * warm + drift;
                if t < what.handled_s || t > self.length_s - what.handled_s {
                    let frequency = [0.7, 1.1, 0.5][axis];
                    *value += gain * 0.4 * (std::f64::consts::TAU * frequency * t).sin();
                }
                if let Some(at) = what.bump_at_s
                    && t >= at
                {
                    let swing = (std::f64::consts::TAU * 11.0 * (t - at)).sin();
                    *value += gain * 0.5 * swing * (-(t - at) / 0.3).exp();
                    if is_force {
                        *value += [0.05, -0.03, 0.0][axis];
                    }
                }
            }
            if what.clock_step_at_s.is_some_and(|at| t >= at) {
                sample.stamp_ns += 1_000_000_000;
            }
            kept.push(sample);
        }
        *samples = kept;
    }
}

impl Source for Disturbed {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        // A block may lie in the hole as a whole.
        while self.simulator.next_block(block)? {
            if self.first_ns.is_none() {
                self.first_ns = block.gyroscope.first().map(|sample| sample.stamp_ns);
            }
            self.disturb(&mut block.gyroscope, false);
            self.disturb(&mut block.accelerometer, true);
            if !block.gyroscope.is_empty() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn streams(&self) -> Vec<Stream> {
        self.simulator.streams()
    }

    fn gyroscope(&self) -> &str {
        self.simulator.gyroscope()
    }

    fn accelerometer(&self) -> &str {
        self.simulator.accelerometer()
    }

    fn take_notes(&mut self) -> Vec<Note> {
        self.simulator.take_notes()
    }

    fn bytes_read(&self) -> u64 {
        0
    }

    fn bytes_total(&self) -> Option<u64> {
        None
    }
}
