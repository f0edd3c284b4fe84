//! What `sensor.yaml` says of an IMU, to be told beside what is found.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use serde::Deserialize;

use crate::recording::Note;

/// More than this is no description of a sensor.
const LONGEST: u64 = 64 * 1024;

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Sensor {
    rate_hz: Option<f64>,
    gyroscope_noise_density: Option<f64>,
    gyroscope_random_walk: Option<f64>,
    accelerometer_noise_density: Option<f64>,
    accelerometer_random_walk: Option<f64>,
}

/// A sentence with its numbers; `None` where there is no such file or no number in it.
pub fn note(path: &Path) -> Option<Note> {
    let mut text = String::new();
    File::open(path).ok()?.take(LONGEST).read_to_string(&mut text).ok()?;
    // OpenCV's first line is no YAML.
    let text = match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("%YAML") => rest.trim_start_matches("---"),
        _ => text.as_str(),
    };
    let name = path.display();
    let Ok(sensor) = serde_saphyr::from_str::<Sensor>(text) else {
        return Some(Note::Info(format!("{name} cannot be read as YAML, and is not needed")));
    };
    let said: Vec<String> = [
        ("", sensor.rate_hz, "Hz"),
        ("gyroscope N ", sensor.gyroscope_noise_density, "rad/s/√Hz"),
        ("gyroscope K ", sensor.gyroscope_random_walk, "rad/s²/√Hz"),
        ("accelerometer N ", sensor.accelerometer_noise_density, "m/s²/√Hz"),
        ("accelerometer K ", sensor.accelerometer_random_walk, "m/s³/√Hz"),
    ]
    .into_iter()
    .filter_map(|(what, value, unit)| value.map(|value| format!("{what}{value:?} {unit}")))
    .collect();
    (!said.is_empty())
        .then(|| Note::Info(format!("{name} says {} (to compare; not used)", said.join(", "))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_sensor_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sensor.yaml");
        assert_eq!(note(&path), None);
        for first in ["", "%YAML:1.0\n---\n", "%YAML:1.0\n"] {
            let text = format!(
                "{first}sensor_type: imu\nT_BS:\n  cols: 4\n  data: [1.0, 0.0]\nrate_hz: 200\n\
                 gyroscope_noise_density: 1.6968e-04     # [ rad / s / sqrt(Hz) ]\n"
            );
            std::fs::write(&path, text).unwrap();
            let Some(Note::Info(said)) = note(&path) else { panic!("no note") };
            assert!(said.contains("200.0 Hz, gyroscope N 0.00016968 rad/s/√Hz"), "{said}");
        }
        std::fs::write(&path, "rate_hz: [").unwrap();
        assert!(matches!(note(&path), Some(Note::Info(said)) if said.contains("cannot be read")));
        std::fs::write(&path, "sensor_type: camera\n").unwrap();
        assert_eq!(note(&path), None);
    }
}
