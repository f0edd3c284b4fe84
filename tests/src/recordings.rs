//! A recording with known noise, changed as a test wants it, and what `imu calibrate` says of it.

use std::path::{Path, PathBuf};

use imu_tools::recording::{self, Block, Source as _};
use imu_tools::scene::{Scene, Simulator};
use serde_json::Value;

use crate::command::{Said, run};

/// A sensor at rest whose record shows K in 100 000 samples: N/K = 10 s in 2000 s at 50 Hz, where
/// no estimator of K does better than √(2N/(K T)) = 10 % an axis.
pub const SCENE: &str = "\
rate_hz = 50
duration = \"2000s\"
[gyroscope]
noise_density = 0.01
random_walk = 0.001
[accelerometer]
noise_density = 0.02
random_walk = 0.002
";

/// True N and K of [`SCENE`].
pub const TRUTH: [(&str, f64, f64); 2] =
    [("gyroscope", 0.01, 0.001), ("accelerometer", 0.02, 0.002)];

/// All samples of a scene.
///
/// # Panics
/// When the text is no scene.
#[must_use]
pub fn simulated(toml: &str, seed: u64) -> Block {
    let mut scene = Scene::from_toml(toml, "test").expect("a valid scene");
    scene.seed = seed;
    let mut simulator = Simulator::new(&scene).expect("a valid scene");
    let (mut all, mut block) = (Block::default(), Block::default());
    while simulator.next_block(&mut block).expect("a simulator does not fail") {
        all.gyroscope.append(&mut block.gyroscope);
        all.accelerometer.append(&mut block.accelerometer);
    }
    all
}

/// A folder that is deleted at the end of its test.
#[derive(Debug)]
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// A new one.
    ///
    /// # Panics
    /// When the system refuses.
    #[must_use]
    #[expect(clippy::new_without_default, reason = "it makes a folder")]
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    /// The folder itself.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// The path of a file in it, as text.
    ///
    /// # Panics
    /// When the path is no text.
    #[must_use]
    pub fn at(&self, name: &str) -> String {
        self.path().join(name).to_str().expect("the temporary folder is UTF-8").to_owned()
    }

    /// Puts a file into it.
    ///
    /// # Panics
    /// When the system refuses.
    pub fn put(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        std::fs::write(self.path().join(name), bytes).expect("written");
        self.at(name)
    }

    /// Writes a recording into it: `.bag` or `.csv`.
    ///
    /// # Panics
    /// When that fails.
    pub fn record(&self, name: &str, block: &Block) -> String {
        let path: PathBuf = self.path().join(name);
        let mut sink = recording::create(&path).expect("a name that ends in .bag or .csv");
        sink.write_block(block).expect("written");
        sink.finish().expect("written");
        self.at(name)
    }

    /// The names of what is in it, sorted.
    ///
    /// # Panics
    /// When the system refuses.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path()).expect("the folder");
        let mut names: Vec<_> = entries
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

/// Runs `imu calibrate` with these arguments.
#[must_use]
pub fn calibrate(arguments: &[&str]) -> Said {
    run(&[&["calibrate"], arguments].concat())
}

/// The JSON that `imu calibrate --json` prints.
///
/// # Panics
/// When it fails, or prints anything else.
#[must_use]
pub fn json(arguments: &[&str]) -> Value {
    let said = calibrate(&[&["--json"], arguments].concat());
    assert_eq!(said.code, 0, "{arguments:?}: {}", said.err);
    serde_json::from_str(&said.out).expect("one JSON object")
}

/// The number at a place such as `/gyroscope/rate_hz`.
///
/// # Panics
/// When there is none.
#[must_use]
pub fn number(value: &Value, place: &str) -> f64 {
    let found = value.pointer(place).and_then(Value::as_f64);
    found.unwrap_or_else(|| panic!("no number at {place} of {value}"))
}

/// How many standard deviations the logarithm of the truth lies from that of an estimate, by the
/// 90 % interval (± 1.645 of them) on that side.
///
/// # Panics
/// When the parameter is not observable.
#[must_use]
pub fn deviations_off(parameter: &Value, truth: f64) -> f64 {
    let value = number(parameter, "/value");
    let side = number(parameter, if truth > value { "/high90" } else { "/low90" });
    1.645 * (truth / value).ln().abs() / (side / value).ln().abs()
}

/// Asserts that N and K of every axis and of all together are those of [`SCENE`], as well as their
/// record can show them.
///
/// # Panics
/// When one is not.
pub fn assert_truth(calibration: &Value) {
    for (sensor, noise_density, random_walk) in TRUTH {
        let sensor = &calibration[sensor];
        let axes = sensor["axes"].as_array().expect("three axes");
        for axis in axes.iter().chain([&sensor["pooled"]]) {
            for (name, truth) in [("noise_density", noise_density), ("random_walk", random_walk)] {
                // 5 sd: 6e-7 of a normal's deviates lie outside.
                let off = deviations_off(&axis[name], truth);
                assert!(off < 5.0, "{name} is off by {off} sd: {axis}");
            }
            // An interval so wide that it holds anything would be no answer: an estimate of K has
            // an sd of 10 % at best (5.8 % pooled), one of N 0.22 %; twice that is too much.
            let width = |name: &str| number(&axis[name], "/sd") / number(&axis[name], "/value");
            assert!(width("random_walk") < 0.2, "{axis}");
            assert!(width("noise_density") < 0.0045, "{axis}");
        }
    }
}
