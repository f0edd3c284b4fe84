//! Noise parameters as the programs want them that use them: each in the unit that its program takes.
//!
//! Where the record does not show a parameter well enough, an upper 90 % bound that covers all axes stands there
//! ([`FilterValue`]), and a comment says so; one of which nothing is known is a comment alone. Nothing is multiplied.

use std::fmt::Write as _;

use imu_core::allan::Parameter;

use super::table::short;
use crate::calibrate::filter::{Basis, FilterValue};
use crate::calibrate::one_sample::OneSample;
use crate::calibrate::{Calibration, SensorKind, SensorNoise};

/// A program's form of the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// `imu.yaml` of Kalibr.
    #[default]
    Kalibr,
    /// What imu_utils writes.
    ImuUtils,
    /// VINS-Mono and VINS-Fusion.
    Vins,
    /// `kalibr_imu_chain.yaml` of OpenVINS.
    OpenVins,
    /// ORB-SLAM3.
    OrbSlam3,
    /// Covariances of `sensor_msgs/Imu`.
    RosCovariance,
}

impl Form {
    /// The parameters in this form.
    #[must_use]
    pub fn write(self, calibration: &Calibration) -> String {
        let sensors = Sensors {
            gyroscope: calibration.gyroscope.as_ref(),
            accelerometer: calibration.accelerometer.as_ref(),
            warnings: super::yaml::warnings(calibration),
        };
        match self {
            Self::Kalibr => super::yaml::kalibr(calibration),
            Self::ImuUtils => sensors.imu_utils(),
            Self::Vins => sensors.vins(),
            Self::OpenVins => sensors.open_vins(),
            Self::OrbSlam3 => sensors.orb_slam3(),
            Self::RosCovariance => sensors.ros_covariance(),
        }
    }
}

struct Sensors<'a> {
    gyroscope: Option<&'a SensorNoise>,
    accelerometer: Option<&'a SensorNoise>,
    /// As comments.
    warnings: String,
}

/// A value and what to remark about it.
type Remarked = (f64, &'static str);

/// N and K for a filter that takes one of each for all axes.
fn noise(sensor: &SensorNoise) -> [Option<Remarked>; 2] {
    [FilterValue::noise_density(sensor), FilterValue::random_walk(sensor)].map(|found| {
        let FilterValue { value, basis } = found?;
        let remark = match basis {
            Basis::Estimate => "",
            Basis::Reading => "; a reading without an interval",
            Basis::CoversFlicker => "; covers the bias instability too",
            Basis::UpperBound => {
                "; NOT KNOWN WELL: the largest upper end of x, y, z and all axes together"
            }
        };
        Some((value, remark))
    })
}

/// The line of a key.
fn put(text: &mut String, key: &str, value: Option<Remarked>, unit: &str) {
    let _ = match value {
        Some((value, remark)) => writeln!(text, "{key}: {value:.6e}  # {unit}{remark}"),
        None => writeln!(text, "# {}: nothing is known of it ({unit})", key.trim_start()),
    };
}

impl Sensors<'_> {
    /// Accelerometer, then gyroscope, those that are there.
    fn each(&self) -> impl Iterator<Item = &SensorNoise> {
        [self.accelerometer, self.gyroscope].into_iter().flatten()
    }

    fn rate_hz(&self) -> f64 {
        self.gyroscope.or(self.accelerometer).map_or(0.0, |sensor| sensor.stamps.rate_hz)
    }

    fn topic(&self) -> String {
        self.gyroscope.or(self.accelerometer).map_or_else(String::new, super::yaml::topic)
    }

    fn vins(&self) -> String {
        let mut text = String::from(
            "# For VINS-Mono and VINS-Fusion, which take these as standard deviations of one sample:\n\
             # their covariance grows by (value x dt)^2 a sample, so N is here N sqrt(rate) and K is\n\
             # K sqrt(rate). They hold for this rate only. Behind a low-pass filter N sqrt(rate) is more\n\
             # than one sample scatters, but it is what a sum of samples does, and VINS sums them.\n",
        );
        let _ = writeln!(text, "# rate: {:.3} Hz", self.rate_hz());
        text.push_str(&self.warnings);
        let _ = writeln!(text, "imu_topic: {}", self.topic());
        for sensor in self.each() {
            let (key, unit) = match sensor.kind {
                SensorKind::Gyroscope => ("gyr", "rad/s"),
                SensorKind::Accelerometer => ("acc", "m/s^2"),
            };
            let root = sensor.stamps.rate_hz.sqrt();
            let [n, k] = noise(sensor).map(|v| v.map(|(value, remark)| (value * root, remark)));
            put(&mut text, &format!("{key}_n"), n, &format!("{unit} a sample"));
            let unit = format!("{unit}/s a sample, the random walk of the bias");
            put(&mut text, &format!("{key}_w"), k, &unit);
        }
        text
    }

    fn open_vins(&self) -> String {
        let mut text = String::from(
            "%YAML:1.0\n# For OpenVINS (kalibr_imu_chain.yaml): continuous-time densities. \
             T_i_b and time_offset are not\n# known from a record at rest: keep yours.\n",
        );
        text.push_str(&self.warnings);
        text.push_str("imu0:\n  T_i_b:\n");
        for row in 0..4 {
            let cells = (0..4).map(|column| if row == column { "1.0" } else { "0.0" });
            let _ = writeln!(text, "  - [{}]", cells.collect::<Vec<_>>().join(", "));
        }
        for sensor in self.each() {
            let name = sensor.kind.name();
            let (n_unit, k_unit) = densities(sensor.kind);
            let [n, k] = noise(sensor);
            put(&mut text, &format!("  {name}_noise_density"), n, n_unit);
            put(&mut text, &format!("  {name}_random_walk"), k, k_unit);
        }
        let _ = writeln!(
            text,
            "  rostopic: {}\n  time_offset: 0.0\n  update_rate: {:.6}",
            self.topic(),
            self.rate_hz()
        );
        text
    }

    fn orb_slam3(&self) -> String {
        let mut text = String::from(
            "# For ORB-SLAM3: continuous-time densities; it multiplies by sqrt(IMU.Frequency) itself.\n",
        );
        text.push_str(&self.warnings);
        for sensor in self.each() {
            let (noise_key, walk_key) = match sensor.kind {
                SensorKind::Gyroscope => ("IMU.NoiseGyro", "IMU.GyroWalk"),
                SensorKind::Accelerometer => ("IMU.NoiseAcc", "IMU.AccWalk"),
            };
            let (n_unit, k_unit) = densities(sensor.kind);
            let [n, k] = noise(sensor);
            put(&mut text, noise_key, n, n_unit);
            put(&mut text, walk_key, k, k_unit);
        }
        let _ = writeln!(text, "IMU.Frequency: {:.3}", self.rate_hz());
        text
    }

    fn ros_covariance(&self) -> String {
        let mut text = String::from(
            "# For sensor_msgs/Imu: variances of one sample (x, y, z on the diagonal), row by row: half the sum\n\
             # of the Allan variances up to the averaging time that is named, and white noise beyond. What\n\
             # wanders more slowly is the bias, and not in them. Behind a low-pass filter they are less than\n\
             # N^2 x rate: neighbouring samples are alike there, which no variance of one sample says.\n",
        );
        text.push_str(&self.warnings);
        for sensor in self.each() {
            let (key, unit) = match sensor.kind {
                SensorKind::Gyroscope => ("angular_velocity_covariance", "(rad/s)^2"),
                SensorKind::Accelerometer => ("linear_acceleration_covariance", "(m/s^2)^2"),
            };
            let _ = match OneSample::of(sensor) {
                Some(OneSample { variance: [x, y, z], up_to_s }) => writeln!(
                    text,
                    "{key}: [{x:.6e}, 0, 0, 0, {y:.6e}, 0, 0, 0, {z:.6e}]  # {unit}, up to {} s",
                    short(up_to_s)
                ),
                None => writeln!(text, "# {key}: of an axis nothing is known ({unit})"),
            };
        }
        text
    }

    fn imu_utils(&self) -> String {
        let mut text = String::from(
            "%YAML:1.0\n---\n\
             # As imu_utils writes it. _n: white noise of one sample, N sqrt(rate), for this rate only.\n\
             # _w is NOT a random walk, although it is named like one: it is the lowest Allan deviation,\n\
             # sqrt(2 N K/sqrt(3)) without flicker. Who wants the random walk K takes --format vins, kalibr or orbslam3.\n",
        );
        text.push_str(&self.warnings);
        text.push_str("type: IMU\nname: imu\n");
        for sensor in [self.gyroscope, self.accelerometer].into_iter().flatten() {
            let (head, key, unit) = match sensor.kind {
                SensorKind::Gyroscope => ("Gyr", "gyr", "rad/s"),
                SensorKind::Accelerometer => ("Acc", "acc", "m/s^2"),
            };
            let _ = writeln!(text, "{head}:\n   unit: \" {unit}\"");
            let [x, y, z] = &sensor.axes;
            for (name, axis) in
                [("avg-axis", &sensor.pooled), ("x-axis", x), ("y-axis", y), ("z-axis", z)]
            {
                let (n, k) = (shown(axis.noise_density), shown(axis.random_walk));
                let white = n.map(|(n, remark)| (n * sensor.stamps.rate_hz.sqrt(), remark));
                // The flat of B is under all of the curve of N and K.
                let b = axis.bias_instability.map_or(0.0, |b| match b {
                    Parameter::Observable { value, .. } => value,
                    Parameter::NotObservable { .. } => 0.0,
                });
                let flat = 2.0 * std::f64::consts::LN_2 / std::f64::consts::PI * b * b;
                let least = n.zip(k).map(|((n, _), (k, remark))| {
                    ((2.0 * n * k / 3_f64.sqrt() + flat).sqrt(), remark)
                });
                let _ = writeln!(text, "   {name}:");
                for (letter, value) in [("n", white), ("w", least)] {
                    let _ = match value {
                        Some((value, "")) => {
                            writeln!(text, "      {key}_{letter}: {value:.16e}")
                        }
                        Some((value, remark)) => {
                            writeln!(text, "      {key}_{letter}: {value:.16e}  # {remark}")
                        }
                        None => writeln!(text, "      # {key}_{letter}: nothing is known of it"),
                    };
                }
            }
        }
        text
    }
}

/// A value of an axis, or its upper bound; none where nothing is known.
fn shown(parameter: Parameter) -> Option<Remarked> {
    match parameter {
        Parameter::Observable { value, .. } => Some((value, "")),
        Parameter::NotObservable { upper90, .. } => {
            upper90.is_finite().then_some((upper90, "NOT OBSERVABLE: by its upper 90 % bound"))
        }
    }
}

/// Units of N and K in letters that every reader of YAML takes.
fn densities(kind: SensorKind) -> (&'static str, &'static str) {
    match kind {
        SensorKind::Gyroscope => ("rad/s/sqrt(Hz)", "rad/s^2/sqrt(Hz)"),
        SensorKind::Accelerometer => ("m/s^2/sqrt(Hz)", "m/s^3/sqrt(Hz)"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::{Options, calibrate};
    use crate::scene::{Preset, Scene, Simulator};

    fn calibration() -> Calibration {
        let scene = Scene { duration_ns: 3_600_000_000_000, ..Preset::High.scene() };
        let source = Box::new(Simulator::new(&scene).unwrap());
        calibrate(source, "simulated", &Options::default(), |_| {}).unwrap()
    }

    /// The first number behind a key.
    fn number(text: &str, key: &str) -> f64 {
        let (_, rest) =
            text.split_once(&format!("{key}: ")).unwrap_or_else(|| panic!("{key}: {text}"));
        let end = rest.find(|c: char| c.is_whitespace() || c == ',').unwrap_or(rest.len());
        rest[..end].trim_start_matches('[').parse().unwrap()
    }

    /// High noise at 200 Hz: N 0.03 and 0.03, K 1e-4 and 1e-3 (N of an hour is known to 0.1 %, K of the
    /// accelerometer to some 10 %: five of those).
    #[test]
    fn units_are_those_of_the_programs() {
        let calibration = calibration();
        let close = |form: Form, key: &str, expected: f64, relative: f64| {
            let value = number(&form.write(&calibration), key);
            assert!((value / expected - 1.0).abs() < relative, "{form:?} {key}: {value}");
        };
        let root = 200_f64.sqrt();
        close(Form::Vins, "gyr_n", 0.03 * root, 0.01);
        close(Form::Vins, "acc_w", 1e-3 * root, 0.5);
        close(Form::OpenVins, "gyroscope_noise_density", 0.03, 0.01);
        close(Form::OpenVins, "accelerometer_random_walk", 1e-3, 0.5);
        close(Form::OrbSlam3, "IMU.NoiseAcc", 0.03, 0.01);
        close(Form::OrbSlam3, "IMU.Frequency", 200.0, 1e-6);
        close(Form::RosCovariance, "angular_velocity_covariance", 0.03 * 0.03 * 200.0, 0.02);
        close(Form::ImuUtils, "gyr_n", 0.03 * root, 0.01);
        // √(2NK/√3)
        close(Form::ImuUtils, "acc_w", (2.0 * 0.03 * 1e-3 / 3_f64.sqrt()).sqrt(), 0.3);
        assert!(Form::ImuUtils.write(&calibration).contains("NOT a random walk"));
    }

    #[test]
    fn every_form_warns_and_names_the_topic() {
        let mut calibration = calibration();
        calibration.warnings = vec!["gyroscope: shaken\nall: the time".into()];
        calibration.gyroscope.as_mut().unwrap().topic = "/imu/data".into();
        for form in [
            Form::Kalibr,
            Form::ImuUtils,
            Form::Vins,
            Form::OpenVins,
            Form::OrbSlam3,
            Form::RosCovariance,
        ] {
            let text = form.write(&calibration);
            assert!(
                text.contains("\n# Warning: gyroscope: shaken\\u000aall: the time\n"),
                "{text}"
            );
        }
        assert!(Form::OpenVins.write(&calibration).contains("  rostopic: \"/imu/data\"\n"));
        assert!(Form::Vins.write(&calibration).contains("\nimu_topic: \"/imu/data\"\n"));
    }
}
