//! Which topics are wanted, by what was asked for or by what their names say.

use super::words::sensor;
use crate::recording::sensor::Sensor;

/// The topics of the two sensors; `None` for one that is not wanted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// That of the angular rates.
    pub gyroscope: Option<String>,
    /// That of the specific forces.
    pub accelerometer: Option<String>,
}

impl Wanted {
    /// What one topic gives: both sensors, unless it is named for one.
    pub fn by_name(topic: &str) -> Self {
        let sensor = sensor(topic);
        let unless = |other| (sensor != Some(other)).then(|| topic.to_owned());
        Self { gyroscope: unless(Sensor::Accelerometer), accelerometer: unless(Sensor::Gyroscope) }
    }

    /// What two topics that are named for one sensor each give.
    pub fn pair(a: &str, b: &str) -> Self {
        let (g, a) = if sensor(a) == Some(Sensor::Gyroscope) { (a, b) } else { (b, a) };
        Self { gyroscope: Some(g.to_owned()), accelerometer: Some(a.to_owned()) }
    }

    /// What was asked for: one topic, or two joined by a comma, gyroscope's and accelerometer's.
    pub fn asked(topics: &str) -> Self {
        match topics.split_once(',') {
            None => Self::by_name(topics.trim()),
            Some((gyroscope, accelerometer)) => Self {
                gyroscope: Some(gyroscope.trim().to_owned()),
                accelerometer: Some(accelerometer.trim().to_owned()),
            },
        }
    }
}
