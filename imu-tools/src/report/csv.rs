//! The Allan deviations as a table for plotting: a row for each sensor and τ.

use std::fmt::Write as _;

use crate::calibrate::Calibration;

/// `allan.csv`: deviations in rad/s or m/s², empty where an axis has none, and whether this τ
/// decided about N and K.
#[must_use]
pub fn deviations(calibration: &Calibration) -> String {
    let mut text =
        String::from("sensor,tau [s],adev_x,adev_y,adev_z,edf_x,edf_y,edf_z,differences,used\n");
    for sensor in [&calibration.gyroscope, &calibration.accelerometer].into_iter().flatten() {
        for d in &sensor.deviation {
            let used =
                sensor.tau_used_s.is_some_and(|(first, last)| d.tau_s >= first && d.tau_s <= last);
            let _ = write!(text, "{},{}", sensor.kind.name(), d.tau_s);
            for octave in &d.octaves {
                text.push(',');
                if octave.differences > 0 {
                    let _ = write!(text, "{:e}", octave.deviation());
                }
            }
            for edf in d.edf {
                let _ = write!(text, ",{edf:.2}");
            }
            let _ = writeln!(text, ",{},{used}", d.octaves[0].differences);
        }
    }
    text
}
