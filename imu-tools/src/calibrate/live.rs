//! A calibration while samples come: the pipelines of [`super::calibrate`], readable at any moment,
//! and as bytes for a checkpoint.
//!
//! The same samples give the same N and K to the bit, however they are divided into blocks, and
//! however often the whole went through bytes in between. Memory does not grow with time: some 12 MB
//! a sensor at most, and most of that only until it is known what is usual of the sensor (256 s).
//!
//! ```
//! use imu_tools::calibrate::{Options, live::Running};
//! use imu_tools::recording::{Block, Sample};
//!
//! let options = Options::default();
//! let mut running = Running::new(&options);
//! let mut block = Block::default();
//! block.gyroscope = (0..1000).map(|i| Sample { stamp_ns: i * 5_000_000, value: [0.1; 3] }).collect();
//! running.push(&block);
//! let bytes = running.to_bytes()?;
//! // … power is lost …
//! let mut running = Running::from_bytes(&bytes, &options)?;
//! assert_eq!(running.snapshot("sensor").calibration.gyroscope.unwrap().stamps.samples, 1000);
//! # Ok::<(), imu_tools::error::Error>(())
//! ```

use serde::{Deserialize, Serialize};

use super::sensor::Pipeline;
use super::{Calibration, Options, SensorKind, SensorNoise, judge};
use crate::error::Error;
use crate::recording::{Block, Sample};

/// Both sensors of an IMU, as their samples come.
#[derive(Clone, Deserialize, Serialize)]
pub struct Running {
    #[serde(skip)]
    options: Options,
    gyroscope: Counted,
    accelerometer: Counted,
}

/// A pipeline, and what went in.
#[derive(Clone, Deserialize, Serialize)]
struct Counted {
    pipeline: Pipeline,
    samples: u64,
    last_ns: Option<i64>,
}

impl Counted {
    fn new(kind: SensorKind, options: &Options) -> Self {
        Self { pipeline: Pipeline::new(kind, options), samples: 0, last_ns: None }
    }

    fn push(&mut self, samples: &[Sample]) {
        self.pipeline.push(samples);
        self.samples += samples.len() as u64;
        self.last_ns = samples.last().map(|s| s.stamp_ns).or(self.last_ns);
    }

    /// The noise up to now, on a copy.
    fn noise(&self) -> Option<SensorNoise> {
        self.pipeline.clone().finish()
    }

    fn with_options(self, options: &Options) -> Self {
        Self { pipeline: self.pipeline.with_options(options), ..self }
    }
}

/// What is known at one moment.
#[derive(Debug)]
pub struct Snapshot {
    /// The noise, for what it is worth by now.
    pub calibration: Calibration,
    /// Why nothing can be made of it, or not yet.
    pub refusal: Option<Error>,
}

impl Running {
    /// Nothing yet.
    #[must_use]
    pub fn new(options: &Options) -> Self {
        Self {
            options: *options,
            gyroscope: Counted::new(SensorKind::Gyroscope, options),
            accelerometer: Counted::new(SensorKind::Accelerometer, options),
        }
    }

    /// Takes the next samples.
    pub fn push(&mut self, block: &Block) {
        self.gyroscope.push(&block.gyroscope);
        self.accelerometer.push(&block.accelerometer);
    }

    /// The sensor was switched off and on, or is another one: no difference spans this.
    pub fn restart(&mut self) {
        self.gyroscope.pipeline.next_record();
        self.accelerometer.pipeline.next_record();
    }

    /// What is known up to now, as [`super::calibrate`] would say of the same samples; `path` names the
    /// sensor in messages. Nothing is disturbed by it. The two sensors are worked out on a thread each.
    #[must_use]
    pub fn snapshot(&self, path: &str) -> Snapshot {
        let (gyroscope, accelerometer) = std::thread::scope(|scope| {
            let other = scope.spawn(|| self.accelerometer.noise());
            (self.gyroscope.noise(), other.join().unwrap_or_default())
        });
        let named = |noise: Option<SensorNoise>| {
            noise.map(|noise| SensorNoise { topic: path.to_owned(), ..noise })
        };
        let (gyroscope, accelerometer) = (named(gyroscope), named(accelerometer));
        let (calibration, refusal) =
            judge(path, &self.options, gyroscope, accelerometer, &|_| None);
        Snapshot { calibration, refusal }
    }

    /// Samples taken of each sensor, gyroscope first.
    #[must_use]
    pub fn samples(&self) -> [u64; 2] {
        [self.gyroscope.samples, self.accelerometer.samples]
    }

    /// The stamps of the latest samples, gyroscope's first.
    #[must_use]
    pub fn last_ns(&self) -> [Option<i64>; 2] {
        [self.gyroscope.last_ns, self.accelerometer.last_ns]
    }

    /// Whether a sensor is being moved, by its last second; `None` in the first minutes, as long as it is
    /// not known what is usual of it.
    #[must_use]
    pub fn is_moving(&self) -> Option<bool> {
        let (g, a) = (self.gyroscope.pipeline.is_moving(), self.accelerometer.pipeline.is_moving());
        match (g, a) {
            (None, None) => None,
            (g, a) => Some(g.unwrap_or(false) || a.unwrap_or(false)),
        }
    }

    /// The whole state.
    ///
    /// # Errors
    /// Never, as far as is known: an encoder says that it can fail.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Error> {
        postcard::to_stdvec(self)
            .map_err(|e| Error::data(format!("the calibration cannot be kept: {e}")))
    }

    /// What [`to_bytes`](Self::to_bytes) made: it goes on as if nothing had happened. The options are those
    /// of now as far as they act at the end, and those of then as far as they acted before.
    ///
    /// # Errors
    /// When the bytes are not such.
    pub fn from_bytes(bytes: &[u8], options: &Options) -> Result<Self, Error> {
        let kept: Self = postcard::from_bytes(bytes)
            .map_err(|e| Error::data(format!("no calibration is in these bytes: {e}")))?;
        Ok(Self {
            options: *options,
            gyroscope: kept.gyroscope.with_options(options),
            accelerometer: kept.accelerometer.with_options(options),
        })
    }
}

#[cfg(test)]
#[path = "live_tests.rs"]
mod tests;
