//! What was estimated beside what is true, and beside what two classic tools print.

use std::fmt::Write as _;

use imu_core::allan::Parameter;

use super::Quantity;
use crate::calibrate::five_terms::{ImuUtilsReading, imu_utils};
use crate::calibrate::slope::kalibr_allan;
use crate::calibrate::{Calibration, SensorKind, SensorNoise};
use crate::scene::{Scene, SensorErrors};

/// A scene that was simulated and calibrated.
#[derive(Clone, Debug)]
pub struct Level {
    /// Its name.
    pub name: &'static str,
    /// What is true.
    pub scene: Scene,
    /// What was found.
    pub calibration: Calibration,
}

/// A parameter as it is, as it was found, and as two classic tools print it.
#[derive(Clone, Copy, Debug)]
pub struct Comparison {
    /// Name of the level.
    pub level: &'static str,
    /// Which parameter; all in its unit.
    pub quantity: Quantity,
    /// What is true.
    pub truth: f64,
    /// What was found.
    pub estimate: Parameter,
    /// What imu_utils prints, where it prints a number.
    pub imu_utils: Option<f64>,
    /// What kalibr_allan prints.
    pub kalibr_allan: Option<f64>,
}

/// One for each level, sensor and parameter.
#[must_use]
pub fn comparisons(levels: &[Level]) -> Vec<Comparison> {
    let of = |level: &Level| {
        let sensors = [
            (&level.calibration.gyroscope, &level.scene.gyroscope),
            (&level.calibration.accelerometer, &level.scene.accelerometer),
        ];
        let found = sensors.into_iter().filter_map(|(sensor, truth)| {
            sensor.as_ref().map(|sensor| of_sensor(level.name, sensor, truth))
        });
        found.flatten().collect::<Vec<_>>()
    };
    levels.iter().flat_map(of).collect()
}

/// One row for each comparison.
#[must_use]
pub fn table(levels: &[Level]) -> String {
    let mut text = format!(
        "{:<6}{:<28}{:<12}{:>10}{:>12}   {:<24}{:>11}{:>14}\n",
        "level",
        "parameter, all axes",
        "unit",
        "true",
        "estimate",
        "90 % interval",
        "imu_utils",
        "kalibr_allan"
    );
    for row in comparisons(levels) {
        let Comparison { level, quantity, truth, estimate, .. } = row;
        let (value, interval) = estimated(estimate);
        let [imu_utils, kalibr_allan] =
            [row.imu_utils, row.kalibr_allan].map(|reading| told(reading, truth));
        let _ = writeln!(
            text,
            "{level:<6}{:<28}{:<12}{truth:>10.1e}{value:>12}   {interval:<24}{imu_utils:>14}{kalibr_allan:>14}",
            quantity.name(),
            quantity.unit(),
        );
    }
    text + "\n" + REMARKS + "\n"
}

/// The estimate and its interval in words.
pub(super) fn estimated(estimate: Parameter) -> (String, String) {
    match estimate {
        Parameter::Observable { value, low90, high90, .. } => {
            (format!("{value:.3e}"), format!("{low90:.3e} to {high90:.3e}"))
        }
        Parameter::NotObservable { upper90, .. } => ("-".into(), format!("< {upper90:.2e}")),
    }
}

/// The reading of a tool, and how many times the truth it is, where that is twice or more.
pub(super) fn told(reading: Option<f64>, truth: f64) -> String {
    match reading {
        Some(reading) if reading / truth < 2.0 => format!("{reading:.2e}"),
        Some(reading) => format!("{reading:.1e} [{:.0}]", reading / truth),
        None => "-".into(),
    }
}

/// What the columns of the tools are.
pub(super) const REMARKS: &str = "\
In brackets: how many times the true value. imu_utils: the deviation that it fits, at 1 s, and the
lowest point of it divided by √dt, which is what the table of a well-known course makes of gyr_w and
acc_w; that is no random walk, nor in its unit. kalibr_allan: lines of slope ∓½, read at 1 s and 3 s;
a dash is where it would print NaN.";

fn of_sensor(level: &'static str, sensor: &SensorNoise, truth: &SensorErrors) -> [Comparison; 2] {
    let kind: SensorKind = sensor.kind;
    let tau0_s = sensor.tau0_s();
    let [x, y, z] = [0, 1, 2].map(|axis| sensor.curve(axis));
    let slopes = kalibr_allan(&[&x, &y, &z], tau0_s);
    let root_dt = tau0_s.sqrt();
    // imu_utils prints the mean of the axes.
    let fits: Option<Vec<_>> =
        [&x, &y, &z].into_iter().map(|axis| imu_utils(axis, tau0_s)).collect();
    let of_fits = |of: fn(&ImuUtilsReading) -> f64| {
        fits.as_ref().map(|fits| fits.iter().map(of).sum::<f64>() / fits.len() as f64)
    };
    let white_noise = of_fits(|fit| fit.white_noise).map(|sd| sd * root_dt);
    let minimum = of_fits(|fit| fit.minimum).map(|minimum| minimum / root_dt);
    [
        Comparison {
            level,
            quantity: Quantity::NoiseDensity(kind),
            truth: truth.noise_density[0],
            estimate: sensor.pooled.noise_density,
            imu_utils: white_noise,
            kalibr_allan: slopes.noise_density,
        },
        Comparison {
            level,
            quantity: Quantity::RandomWalk(kind),
            truth: truth.random_walk[0],
            estimate: sensor.pooled.random_walk,
            imu_utils: minimum,
            kalibr_allan: slopes.random_walk,
        },
    ]
}
