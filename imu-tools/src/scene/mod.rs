//! Scenes: which motion, which sensor errors, how long; and the simulator that plays them.
//!
//! A [`Scene`] is a preset or a TOML file ([`Scene::from_toml`]); a [`Simulator`] is a
//! [`Source`](crate::recording::Source) of its samples, so that what reads a recording can take a
//! simulation instead, with no file between. Same scene and seed, same samples, on every machine.
//!
//! ```
//! use imu_tools::recording::{Block, Source};
//! use imu_tools::scene::{Preset, Rate, Simulator};
//!
//! let mut scene = Preset::Mid.scene();
//! scene.rate = Rate::from_hz(100.0)?;
//! scene.duration_ns = 2_000_000_000;
//! let mut simulator = Simulator::new(&scene)?;
//! let mut block = Block::default();
//! assert!(simulator.next_block(&mut block)?);
//! assert_eq!(block.gyroscope.len(), 200);
//! # Ok::<(), imu_tools::error::Error>(())
//! ```

mod axes;
mod chain;
mod check;
mod clock;
mod duration;
mod error_term;
mod errors;
mod felt;
mod file;
mod lay;
mod located;
mod mount;
mod prepare;
mod simulator;
mod stamps;
mod temperature;
mod terms_file;
mod trajectory;
mod truth;

pub use axes::Axes;
pub use clock::Rate;
pub use duration::{display_duration, parse_duration};
pub use error_term::{Contributions, ErrorTerm};
pub use errors::{
    BandVibrationTerm, FlickerTerm, GaussMarkovTerm, Poles, SensorErrors, VibrationTerm,
};
pub use simulator::{Simulator, Truth};
pub use stamps::ClockErrors;
pub use temperature::Temperature;
pub use terms_file::TermsWriter;
pub use trajectory::Instead;
pub use truth::TruthWriter;

use std::sync::Arc;

use imu_core::trajectory::GRAVITY;
use serde::Deserialize;

use crate::recording::SampleKind;
use crate::spline::Route;

/// The stamp of the first sample if nothing else is asked for: 1 600 000 000 s after the Unix epoch
/// (13 September 2020, 12:26:40 UTC), a constant so that the same scene gives the same bytes.
pub const DEFAULT_START_NS: i64 = 1_600_000_000_000_000_000;

/// Four hours, the length of the classic recordings for a noise calibration.
pub const DEFAULT_DURATION_NS: u64 = 4 * 3_600_000_000_000;

/// Everything that a simulation depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The true motion.
    pub motion: Path,
    /// g, m/s².
    pub gravity: f64,
    /// Samples a second, of both sensors.
    pub rate: Rate,
    /// Length; samples are due in `[0, duration)`.
    pub duration_ns: u64,
    /// The seed of every random stream.
    pub seed: u64,
    /// The stamp of the first sample, nanoseconds after the epoch; not negative.
    pub start_ns: i64,
    /// What a sample says of its interval.
    pub samples: SampleKind,
    /// The temperature of both sensors; `None`: constant, and of no effect.
    pub temperature: Option<Temperature>,
    /// What is wrong with the stamps, and which samples get lost.
    pub clock: ClockErrors,
    /// Errors of the gyroscope, rad/s.
    pub gyroscope: SensorErrors,
    /// Errors of the accelerometer, m/s².
    pub accelerometer: SensorErrors,
}

impl Default for Scene {
    /// Ideal sensors at rest: 4 h at 200 Hz, seed 1.
    fn default() -> Self {
        Self {
            motion: Path::Rest,
            gravity: GRAVITY,
            rate: Rate::DEFAULT,
            duration_ns: DEFAULT_DURATION_NS,
            seed: 1,
            start_ns: DEFAULT_START_NS,
            samples: SampleKind::Instantaneous,
            temperature: None,
            clock: ClockErrors::default(),
            gyroscope: SensorErrors::default(),
            accelerometer: SensorErrors::default(),
        }
    }
}

/// A true motion.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
pub enum Path {
    /// Standing still and level at the origin.
    Rest,
    /// The classic ellipse ([`imu_core::trajectory::Ellipse`]).
    Ellipse,
    /// A curve through a user's poses; true times are those of its poses.
    #[serde(skip)]
    Along(Arc<Route>),
}

/// The three noise levels of the course program `vio_data_simulation`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// N 0.01 rad/s/√Hz and 0.01 m/s²/√Hz, K 1e-5 rad/s²/√Hz and 1e-4 m/s³/√Hz.
    Low,
    /// N 0.015 and 0.019, K 5e-5 and 5e-4.
    Mid,
    /// N 0.03 and 0.03, K 1e-4 and 1e-3.
    High,
}

impl Preset {
    /// From low to high.
    pub const ALL: [Self; 3] = [Self::Low, Self::Mid, Self::High];

    /// `low`, `mid` or `high`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::Mid => "mid",
            Self::High => "high",
        }
    }

    /// The preset of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }

    /// At rest for four hours at 200 Hz.
    #[must_use]
    pub fn scene(self) -> Scene {
        let (gyro_n, accel_n, gyro_k, accel_k) = match self {
            Self::Low => (0.01, 0.01, 1e-5, 1e-4),
            Self::Mid => (0.015, 0.019, 5e-5, 5e-4),
            Self::High => (0.03, 0.03, 1e-4, 1e-3),
        };
        let errors = |n, k| SensorErrors {
            noise_density: [n; 3],
            random_walk: [k; 3],
            ..SensorErrors::default()
        };
        Scene {
            gyroscope: errors(gyro_n, gyro_k),
            accelerometer: errors(accel_n, accel_k),
            ..Scene::default()
        }
    }
}
