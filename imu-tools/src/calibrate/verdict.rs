//! What a calibration is worth: how well each number is known, whether that is enough, what grade the sensor is of
//! and how long to record. What a filter should be given is in [`filter`](super::filter).

use imu_core::allan::Parameter;

use super::filter::{Basis, Factors, FilterValue};
use super::{SensorKind, SensorNoise, advice};

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
    /// Half an interval over its value up to which a number is good enough: what use adds ([`Factors::USE`]) is larger
    /// by far.
    pub const ENOUGH: f64 = 0.3;

    /// How well this one is known.
    #[must_use]
    pub fn of(parameter: Parameter) -> Self {
        match parameter {
            Parameter::Observable { value, low90, high90, .. } if high90.is_finite() => {
                match 0.5 * (high90 - low90) / value {
                    half if half <= 0.05 => Self::Well(half),
                    half if half <= Self::ENOUGH => Self::Fairly(half),
                    half => Self::Roughly(half),
                }
            }
            Parameter::Observable { .. } => Self::Reading,
            Parameter::NotObservable { upper90, .. } if upper90.is_finite() => Self::Below(upper90),
            Parameter::NotObservable { .. } => Self::NotAtAll,
        }
    }

    /// Whether it is known well enough for a filter.
    #[must_use]
    pub fn is_enough(self) -> bool {
        matches!(self, Self::Well(_) | Self::Fairly(_))
    }
}

/// The 90 % interval of a value, from 0 where its lower end is less than a hundredth of the value: there the
/// likelihood never fell far enough, and the end is that of the search.
#[must_use]
pub fn interval(value: f64, low90: f64, high90: f64) -> (f64, f64) {
    (if low90 < 0.01 * value { 0.0 } else { low90 }, high90)
}

/// Whether a sensor's numbers are good enough for a filter; the worst last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Enough {
    /// N and K are.
    Yes,
    /// N is; of K an upper bound serves.
    BoundOfWalk,
    /// Too little is known of them.
    NotKnown,
    /// The values are not those of a healthy sensor at rest: a warning says what is wrong.
    NotAtRest,
}

impl Enough {
    /// The verdict on a sensor.
    #[must_use]
    pub fn of(sensor: &SensorNoise) -> Self {
        let checks = &sensor.checks;
        let faulty = checks.stuck.contains(&true)
            || checks.saturated.iter().any(|count| *count > 0)
            || checks.is_held(sensor.stamps.samples);
        if faulty || advice::moved_throughout(sensor) {
            return Self::NotAtRest;
        }
        let walk = FilterValue::random_walk(sensor).map(|walk| walk.basis);
        let covered = Factors::random_walk(sensor)
            .and_then(|factors| factors.interval)
            .is_some_and(|interval| interval <= 1.0 + Known::ENOUGH);
        match (Known::of(sensor.pooled.noise_density).is_enough(), walk) {
            (true, Some(Basis::Estimate)) => Self::Yes,
            (true, Some(Basis::CoversFlicker)) if covered => Self::Yes,
            (true, Some(Basis::UpperBound)) => Self::BoundOfWalk,
            _ => Self::NotKnown,
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

    /// The largest bias instability of a gyroscope of each grade but the last, °/h: our own choice. The same table
    /// has no such number of accelerometers, but the constant bias, which is far larger.
    pub const BIAS_INSTABILITY: [f64; 4] = [0.1, 10.0, 60.0, 360.0];

    /// The grade of a gyroscope's bias instability as most datasheets print it, the lowest point of the Allan curve,
    /// °/h.
    #[must_use]
    pub fn of_bias_instability(degrees_per_hour: f64) -> Self {
        Self::among(Self::BIAS_INSTABILITY, degrees_per_hour)
    }

    fn among(borders: [f64; 4], value: f64) -> Self {
        let class = borders.iter().take_while(|border| value > **border).count();
        Self::ALL.get(class).copied().unwrap_or(Self::Beyond)
    }
}

/// How long to record next time, so that each axis shows K to 10 % (one standard deviation), which is
/// [`NextRecord::WITHIN`] in the 90 % of all intervals.
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
    /// The standard deviation of K that is aimed at, over K.
    const DEVIATION: f64 = 0.1;

    /// Half the 90 % interval of K of an axis after a record of this length, over K: 1.645 standard deviations.
    pub const WITHIN: f64 = 1.645 * Self::DEVIATION;

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
        let wanted_s = (2.0 * n / (k * Self::DEVIATION * Self::DEVIATION)).max(earliest_s);
        match wanted_s {
            wanted if !wanted.is_finite() => Self::Unknown,
            wanted if wanted <= 1.05 * sensor.stamps.span_s => Self::LongEnough,
            wanted => Self::AtLeast(round_up(wanted)),
        }
    }

    /// How long to record, s, so that all axes together show K to [`Known::ENOUGH`], which is good enough for a filter;
    /// `None` where they do, or where it is not length that is wanting.
    ///
    /// An interval narrows as the root of the length. Where K does not show yet, a third of its bound stands for it, in the
    /// limit of three axes: sd(ln K) = √(2N/(3KT)). Such a bound is two to four times the K that a longer record shows.
    #[must_use]
    pub fn enough_s(sensor: &SensorNoise) -> Option<f64> {
        let (walk, density) = (sensor.pooled.random_walk, sensor.pooled.noise_density);
        if sensor.pooled.bias_instability.is_some() || sensor.misfit.contains(&true) {
            return None;
        }
        let wanted_s = match (Known::of(walk), walk, density) {
            (known, ..) if known.is_enough() => return None,
            (Known::Roughly(half), ..) => sensor.stamps.span_s * (half / Known::ENOUGH).powi(2),
            (
                _,
                Parameter::NotObservable { upper90, record_at_least_s },
                Parameter::Observable { value: n, .. },
            ) => {
                let deviation = Known::ENOUGH / 1.645;
                (2.0 * n / (upper90 * deviation * deviation))
                    .max(record_at_least_s)
                    .max(2.0 * sensor.stamps.span_s)
            }
            _ => return None,
        };
        (wanted_s.is_finite() && wanted_s > 0.0).then(|| round_up(wanted_s))
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

    #[test]
    fn what_is_good_enough() {
        use crate::calibrate::{Options, calibrate};
        use crate::scene::{Preset, Scene, Simulator};

        let scene = Scene { duration_ns: 60_000_000_000, ..Preset::Mid.scene() };
        let source = Box::new(Simulator::new(&scene).unwrap());
        let found = calibrate(source, "simulated", &Options::default(), |_| {}).unwrap();
        let known = |half| Parameter::Observable {
            value: 1.0,
            sd: half / 1.645,
            low90: 1.0 - half,
            high90: 1.0 + half,
        };
        let hidden = |upper90| Parameter::NotObservable { upper90, record_at_least_s: 1.0 };
        let mut sensor = found.gyroscope.unwrap();
        let mut with = |n, k, b| {
            sensor.pooled.noise_density = n;
            sensor.pooled.random_walk = k;
            sensor.pooled.bias_instability = b;
            sensor.clone()
        };
        let sensor = with(known(0.01), known(0.2), None);
        assert_eq!(Enough::of(&sensor), Enough::Yes);
        for broken in [
            SensorNoise { misfit: [false, true, false], ..sensor.clone() },
            with(known(0.01), known(0.4), None),
            with(known(0.01), hidden(1.0), None),
        ] {
            assert_eq!(Enough::of(&broken), Enough::BoundOfWalk);
        }
        let infinite = hidden(f64::INFINITY);
        for (n, k) in [(known(0.4), known(0.1)), (known(0.01), infinite), (infinite, known(0.1))] {
            assert_eq!(Enough::of(&with(n, k, None)), Enough::NotKnown);
        }
        // Flicker hides K, and is known itself, or is not.
        let flicker = |half| with(known(0.01), hidden(0.01), Some(known(half)));
        assert_eq!(
            [0.2, 0.4].map(flicker).map(|s| Enough::of(&s)),
            [Enough::Yes, Enough::NotKnown]
        );
        let mut stuck = sensor;
        stuck.checks.stuck[1] = true;
        assert_eq!(Enough::of(&stuck), Enough::NotAtRest);
    }

    /// z of a real record: the interval of two sides touches 0, which one of one side does not.
    #[test]
    fn an_interval_that_reaches_zero() {
        assert_eq!(interval(3.96e-5, 1.97e-8, 7.9e-5), (0.0, 7.9e-5));
        assert_eq!(interval(4.5e-5, 2.7e-5, 7.0e-5), (2.7e-5, 7.0e-5));
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
