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

/// Named classes of sensors, by one number of theirs at rest: white noise, or bias instability.
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
    /// Noisier than consumer sensors usually are.
    Beyond,
}

impl Grade {
    const ALL: [Self; 5] =
        [Self::Navigation, Self::Tactical, Self::Industrial, Self::Consumer, Self::Beyond];

    const GYROSCOPE: [f64; 4] = [0.005, 0.1, 0.5, 5.0];
    const ACCELEROMETER: [f64; 4] = [15.0, 50.0, 120.0, 500.0];

    /// The grade of white noise N, in the unit of datasheets (°/√h or µg/√Hz).
    #[must_use]
    pub fn of(kind: SensorKind, density: f64) -> Self {
        Self::among(Self::borders(kind), density)
    }

    /// The largest white noise of each grade but the last, in the same unit.
    #[must_use]
    pub const fn borders(kind: SensorKind) -> [f64; 4] {
        match kind {
            SensorKind::Gyroscope => Self::GYROSCOPE,
            SensorKind::Accelerometer => Self::ACCELEROMETER,
        }
    }

    /// The grade of a gyroscope's bias instability, °/h. The same table has no such number of accelerometers,
    /// but the constant bias, which is far larger.
    #[must_use]
    pub fn of_bias_instability(degrees_per_hour: f64) -> Self {
        Self::among([0.1, 10.0, 60.0, 360.0], degrees_per_hour)
    }

    fn among(borders: [f64; 4], value: f64) -> Self {
        let class = borders.iter().take_while(|border| value > **border).count();
        Self::ALL.get(class).copied().unwrap_or(Self::Beyond)
    }
}

/// How long to record next time, so that each axis shows K to 10 % (one standard deviation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NextRecord {
    /// No longer than this one.
    LongEnough,
    /// At least so long, s, in round numbers.
    AtLeast(f64),
    /// A longer one shows little more of K, because flicker hides it.
    HiddenByFlicker,
    /// Too little is known to say.
    Unknown,
}

impl NextRecord {
    /// The advice for a sensor; all that speaks of the next record quotes it.
    ///
    /// sd(ln K) is √(2N/(K T)) for white noise and a random walk. In the place of a K that does not show
    /// stands its bound: K lies below, and needs longer.
    #[must_use]
    pub fn of(sensor: &SensorNoise) -> Self {
        if let Some(Parameter::Observable { .. }) = sensor.pooled.bias_instability {
            return Self::HiddenByFlicker;
        }
        let Parameter::Observable { value: n, .. } = sensor.pooled.noise_density else {
            return Self::Unknown;
        };
        let (k, earliest_s) = match sensor.pooled.random_walk {
            Parameter::Observable { value, .. } => (value, 0.0),
            Parameter::NotObservable { upper90, record_at_least_s } if upper90.is_finite() => {
                (upper90, record_at_least_s)
            }
            Parameter::NotObservable { .. } => return Self::Unknown,
        };
        let wanted_s = (2.0 * n / (k * 0.1 * 0.1)).max(earliest_s);
        match wanted_s {
            wanted if !wanted.is_finite() => Self::Unknown,
            wanted if wanted <= 1.05 * sensor.stamps.span_s => Self::LongEnough,
            wanted => Self::AtLeast(round_up(wanted)),
        }
    }
}

/// Up to a length that a person would set, s: 5 min, half hours from one hour on, hours from ten on.
fn round_up(seconds: f64) -> f64 {
    let step = match seconds {
        s if s < 3600.0 => 300.0,
        s if s < 36_000.0 => 1800.0,
        _ => 3600.0,
    };
    (seconds / step).ceil() * step
}

/// How many times a pooled value a filter may need, by what its own numbers leave open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// The upper end of the 90 % interval over the value.
    pub interval: f64,
    /// The largest value of an axis over the pooled one; 1 where no axis is above it.
    pub axes: f64,
}

impl Margin {
    /// That of a parameter of the axes and of all together; `None` where there is no value with an interval.
    #[must_use]
    pub fn of(axes: [Parameter; 3], pooled: Parameter) -> Option<Self> {
        let Parameter::Observable { value, high90, .. } = pooled else { return None };
        if !(high90.is_finite() && value > 0.0) {
            return None;
        }
        let of_axis = |axis| match axis {
            Parameter::Observable { value, .. } => value,
            Parameter::NotObservable { .. } => 0.0,
        };
        let largest = axes.map(of_axis).into_iter().fold(value, f64::max);
        Some(Self { interval: high90 / value, axes: largest / value })
    }

    /// The larger of the two.
    #[must_use]
    pub fn most(self) -> f64 {
        self.interval.max(self.axes)
    }
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
        assert_eq!(Grade::of_bias_instability(4.0), Grade::Tactical);
        assert_eq!(Grade::of_bias_instability(1000.0), Grade::Beyond);
    }

    #[test]
    fn lengths_are_round() {
        for (seconds, round) in [(250.0, 300.0), (3601.0, 5400.0), (36_001.0, 39_600.0)] {
            assert_eq!(round_up(seconds), round);
        }
    }

    /// 1.5 of the interval; 1.2 of the axes, of which one does not show.
    #[test]
    fn margins() {
        let known = |value, high90| Parameter::Observable { value, sd: 0.1, low90: 0.0, high90 };
        let hidden = Parameter::NotObservable { upper90: 9.0, record_at_least_s: 1.0 };
        let margin = Margin::of([known(0.9, 1.0), known(1.2, 1.3), hidden], known(1.0, 1.5));
        assert_eq!(margin, Some(Margin { interval: 1.5, axes: 1.2 }));
        assert_eq!(Margin::of([hidden; 3], hidden), None);
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
