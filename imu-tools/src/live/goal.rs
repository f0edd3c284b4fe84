//! When it is enough: `--until 10%`, `--for 6h`, and how long until then.

use imu_core::allan::Parameter;

use crate::calibrate::verdict::Known;
use crate::calibrate::{Calibration, SensorNoise};

/// What a session is to reach before it ends by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Goal {
    /// N and K of each sensor, all axes together, to this part of their values (half the 90 % interval).
    pub within: Option<f64>,
    /// So many seconds of the sensor's time, gaps counted.
    pub span_s: Option<f64>,
}

impl Goal {
    /// Whether there is nothing to reach.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Whether it is reached after so many seconds. Where the recording asks for a flicker that hides K, its B
    /// stands for K: a longer recording shows little more.
    #[must_use]
    pub fn is_reached(&self, span_s: f64, calibration: &Calibration) -> bool {
        let long_enough = self.span_s.is_some_and(|goal| span_s >= goal);
        let sensors = || [&calibration.gyroscope, &calibration.accelerometer].into_iter().flatten();
        let known = self.within.is_some_and(|within| {
            sensors().next().is_some() && sensors().all(|sensor| is_known(sensor, within))
        });
        long_enough || known
    }
}

fn is_known(sensor: &SensorNoise, within: f64) -> bool {
    let noise = &sensor.pooled;
    let to = |parameter| half(parameter).is_some_and(|half| half <= within);
    to(noise.noise_density) && (to(noise.random_walk) || noise.bias_instability.is_some_and(to))
}

/// Half the 90 % interval of a parameter over its value; `None` where it does not show.
#[must_use]
pub fn half(parameter: Parameter) -> Option<f64> {
    match Known::of(parameter) {
        Known::Well(half) | Known::Fairly(half) | Known::Roughly(half) => Some(half),
        Known::Below(_) | Known::Reading | Known::NotAtAll => None,
    }
}

/// Seconds from now until a parameter will be known to `within`, after `span_s`; 0 where it is, `None`
/// where nobody can say. An interval narrows as the root of the length; what does not show yet will not
/// do so before the length that the fit gives.
#[must_use]
pub fn left_s(parameter: Parameter, span_s: f64, within: f64) -> Option<f64> {
    match (half(parameter), parameter) {
        (Some(half), _) => Some((span_s * ((half / within).powi(2) - 1.0)).max(0.0)),
        (None, Parameter::NotObservable { record_at_least_s, .. })
            if record_at_least_s.is_finite() && record_at_least_s > 0.0 =>
        {
            Some((record_at_least_s - span_s).max(0.0))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_narrows_as_the_root_of_the_length() {
        let known = Parameter::Observable { value: 2.0, sd: 0.2, low90: 1.6, high90: 2.4 };
        assert_eq!(half(known).map(|h| (h * 1e9).round()), Some(2e8));
        // 20 % after 100 s: 10 % after 400 s.
        assert!((left_s(known, 100.0, 0.1).unwrap() - 300.0).abs() < 1e-9);
        assert_eq!(left_s(known, 100.0, 0.3), Some(0.0));
        let hidden = Parameter::NotObservable { upper90: 1.0, record_at_least_s: 500.0 };
        assert_eq!(left_s(hidden, 100.0, 0.1), Some(400.0));
        let unknown = Parameter::NotObservable { upper90: f64::INFINITY, record_at_least_s: 0.0 };
        assert_eq!(left_s(unknown, 100.0, 0.1), None);
    }
}
