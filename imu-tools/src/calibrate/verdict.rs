//! What a calibration is worth: how well each number is known, what grade the sensor is of, how long
//! to record, and how much more than the sensor's own noise a filter should allow for.

use imu_core::allan::Parameter;

use super::{AxisNoise, SensorKind, SensorNoise};

/// How well a parameter is known, by half its 90 % interval over its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// To 5 % and better.
    Well(f64),
    /// To 30 % and better.
    Fairly(f64),
    /// Worse.
    Roughly(f64),
    /// Only that it is below a bound.
    Below(f64),
    /// A reading, of which no interval is known.
    Reading,
    /// Nothing.
    NotAtAll,
}

impl Known {
    /// How well this one is known.
    #[must_use]
    pub fn of(parameter: Parameter) -> Self {
        match parameter {
            Parameter::Observable { value, low90, high90, .. } if high90.is_finite() => {
                match 0.5 * (high90 - low90) / value {
                    half if half <= 0.05 => Self::Well(half),
                    half if half <= 0.3 => Self::Fairly(half),
                    half => Self::Roughly(half),
                }
            }
            Parameter::Observable { .. } => Self::Reading,
            Parameter::NotObservable { upper90, .. } if upper90.is_finite() => Self::Below(upper90),
            Parameter::NotObservable { .. } => Self::NotAtAll,
        }
    }
}

/// Named classes of sensors, by their white noise at rest.
///
/// Borders between such classes are customary and not sharp: those of the gyroscope lie between the
/// values of table 1 in El-Sheimy & Youssef (2020), *Inertial sensors technologies for navigation
/// applications*, Satellite Navigation 1:2; industrial lies between tactical and consumer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Grade {
    /// Ring lasers and their like.
    Navigation,
    /// Fibre optics, and the best of MEMS.
    Tactical,
    /// Selected MEMS.
    Industrial,
    /// Telephones, toys, cameras.
    Consumer,
    /// Noisier than sensors that are sold: shaken, badly set, or simulated.
    Beyond,
}

impl Grade {
    const ALL: [Self; 5] =
        [Self::Navigation, Self::Tactical, Self::Industrial, Self::Consumer, Self::Beyond];

    /// The largest white noise of each grade but the last: °/√h, or µg/√Hz.
    const GYROSCOPE: [f64; 4] = [0.005, 0.1, 0.5, 5.0];
    const ACCELEROMETER: [f64; 4] = [15.0, 50.0, 120.0, 500.0];

    /// The grade of white noise N, in the unit of datasheets (°/√h or µg/√Hz).
    #[must_use]
    pub fn of(kind: SensorKind, density: f64) -> Self {
        let borders = match kind {
            SensorKind::Gyroscope => Self::GYROSCOPE,
            SensorKind::Accelerometer => Self::ACCELEROMETER,
        };
        let class = borders.iter().take_while(|border| density > **border).count();
        Self::ALL.get(class).copied().unwrap_or(Self::Beyond)
    }
}

/// How long a record must be for each axis to show K to 10 % (standard deviation), s: sd(ln K) is
/// √(2N/(K T)) for white noise and a random walk. `None` where N or K is not known.
#[must_use]
pub fn record_for_walk_s(sensor: &SensorNoise) -> Option<f64> {
    let value = |parameter| match parameter {
        Parameter::Observable { value, .. } => Some(value),
        Parameter::NotObservable { .. } => None,
    };
    let (n, k) = (value(sensor.pooled.noise_density)?, value(sensor.pooled.random_walk)?);
    (k > 0.0).then(|| 2.0 * n / (k * 0.1 * 0.1))
}

/// The random walk to give a filter that has no term for flicker, unit/s/√Hz: the K that makes the bias go as far in
/// [`Inflation::OVER_S`] as B and K together do, K'²τ/3 = (2 ln 2/π)B² + K²τ/3. `None` where there is no B to cover:
/// then it is K.
#[must_use]
pub fn walk_for_filter(noise: &AxisNoise) -> Option<f64> {
    let Some(Parameter::Observable { value: flicker, .. }) = noise.bias_instability else {
        return None;
    };
    let walk = match noise.random_walk {
        Parameter::Observable { value, .. } => value,
        Parameter::NotObservable { .. } => 0.0,
    };
    let flat = 2.0 * std::f64::consts::LN_2 / std::f64::consts::PI * flicker * flicker;
    Some((walk * walk + 3.0 * flat / Inflation::OVER_S).sqrt())
}

/// How many times the sensor's own noise was seen here beside it, which a filter has to live with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inflation {
    /// Of N: what short averaging times show over what N explains. 1 where nothing more is seen.
    pub noise_density: f64,
    /// Of K: what the bias drifts by in [`Inflation::OVER_S`] over what K makes it walk.
    pub random_walk: f64,
}

impl Inflation {
    /// Drift and walk are compared over this time, s: as long as a filter goes without a fix.
    pub const OVER_S: f64 = 100.0;

    /// What this recording shows.
    #[must_use]
    pub fn of(sensor: &SensorNoise) -> Self {
        let value = |parameter| match parameter {
            Parameter::Observable { value, .. } => value,
            Parameter::NotObservable { .. } => 0.0,
        };
        let (n, k) = (value(sensor.pooled.noise_density), value(sensor.pooled.random_walk));
        let mut inflation = Self { noise_density: 1.0, random_walk: 1.0 };
        for d in &sensor.deviation {
            let beyond = sensor.tau_used_s.is_some_and(|(first, _)| d.tau_s < 0.99 * first);
            for octave in d.octaves.iter().filter(|o| beyond && o.differences > 0) {
                let white = octave.deviation() * d.tau_s.sqrt();
                if n > 0.0 && white > 1.1 * inflation.noise_density * n {
                    inflation.noise_density = white / n;
                }
            }
        }
        if let Some(ramp) = sensor.ramp
            && k > 0.0
        {
            let drift = ramp.iter().fold(0.0_f64, |most, r| most.max(r.abs())) * Self::OVER_S;
            let walk = k * Self::OVER_S.sqrt();
            inflation.random_walk = (drift / walk).max(1.0);
        }
        inflation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grades() {
        use SensorKind::{Accelerometer, Gyroscope};
        assert_eq!(Grade::of(Gyroscope, 0.001), Grade::Navigation);
        assert_eq!(Grade::of(Gyroscope, 0.3), Grade::Industrial);
        assert_eq!(Grade::of(Gyroscope, 51.6), Grade::Beyond);
        assert_eq!(Grade::of(Accelerometer, 220.0), Grade::Consumer);
        assert!(Grade::Navigation < Grade::Consumer);
    }

    /// B = 1, K = 0.1: 0.01 + 3·0.4413/100 = 0.02324.
    #[test]
    fn a_walk_that_covers_flicker() {
        let known = |value| Parameter::Observable { value, sd: 0.0, low90: value, high90: value };
        let two = AxisNoise::of_two(known(1.0), known(0.1));
        assert_eq!(walk_for_filter(&two), None);
        let noise = AxisNoise { bias_instability: Some(known(1.0)), ..two };
        let walk = walk_for_filter(&noise).unwrap();
        assert!((walk * walk - 0.023_238_136).abs() < 1e-9, "{walk}");
    }

    #[test]
    fn how_well_known() {
        let known =
            |low90, high90| Known::of(Parameter::Observable { value: 1.0, sd: 0.1, low90, high90 });
        assert!(matches!(known(0.99, 1.01), Known::Well(_)));
        assert!(matches!(known(0.8, 1.25), Known::Fairly(_)));
        assert!(matches!(known(0.5, 2.0), Known::Roughly(_)));
        assert_eq!(known(0.0, f64::INFINITY), Known::Reading);
    }
}
