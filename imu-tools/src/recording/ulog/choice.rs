//! Which topics the samples are taken from: what was asked for, or what suits best.

use std::path::Path;

use super::channel::Kind;
use super::definitions::{Definitions, Subscription};
use super::survey::{Candidate, Survey};
use crate::error::Error;
use crate::recording::Note;
use crate::recording::sensor::Sensor;

/// Topics listed in an error, at most.
const LISTED: usize = 40;

/// A topic, an instance or both.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Asked {
    topic: Option<String>,
    instance: Option<u8>,
}

impl Asked {
    /// Reads `topic`, `topic:1` or `1`.
    fn parse(text: &str) -> Result<Self, Error> {
        let wrong = || {
            Error::usage(format!(
                "{text} is no topic of a ULog: name one like sensor_gyro:0, or its number, like 0"
            ))
        };
        let number = |text: &str| text.parse::<u8>().map_err(|_| wrong());
        let text = text.trim().trim_start_matches('/');
        if text.is_empty() {
            Err(wrong())
        } else if text.bytes().all(|b| b.is_ascii_digit()) {
            Ok(Self { topic: None, instance: Some(number(text)?) })
        } else if let Some((topic, instance)) = text.split_once(':') {
            Ok(Self { topic: Some(topic.to_owned()), instance: Some(number(instance)?) })
        } else {
            Ok(Self { topic: Some(text.to_owned()), instance: None })
        }
    }

    /// The same with the name that the topic has for another sensor.
    fn renamed(&self, from: &str, to: &str) -> Self {
        let topic = self.topic.as_ref().map(|topic| topic.replace(from, to));
        Self { topic, instance: self.instance }
    }

    fn fits(&self, topic: &str, instance: u8) -> bool {
        self.topic.as_ref().is_none_or(|asked| asked == topic)
            && self.instance.is_none_or(|asked| asked == instance)
    }

    fn in_words(&self) -> String {
        match (&self.topic, self.instance) {
            (Some(topic), Some(instance)) => format!("{topic}:{instance}"),
            (Some(topic), None) => topic.clone(),
            (None, Some(instance)) => format!("of an IMU with the number {instance}"),
            (None, None) => "of an IMU".into(),
        }
    }
}

/// What was asked for, and what is taken: labels such as `sensor_gyro:0`, empty while there is none.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    asked: [Asked; 2],
    /// Each sensor was named by itself: both must be there.
    both: bool,
    survey: bool,
    /// Where angular rates are taken from.
    pub gyroscope: String,
    /// Where specific forces are taken from.
    pub accelerometer: String,
    /// Where temperatures are taken from.
    pub thermometer: String,
    /// What was chosen, in words.
    pub notes: Vec<Note>,
}

impl Choice {
    /// `asked` is one topic, instance or both, or two such joined by a comma: gyroscope's,
    /// accelerometer's. With `survey`, the first of several is taken.
    ///
    /// # Errors
    /// When it can be no topic.
    pub fn new(asked: Option<&str>, survey: bool) -> Result<Self, Error> {
        let (asked, both) = match asked.map(|asked| asked.split_once(',').ok_or(asked)) {
            None => (<[Asked; 2]>::default(), false),
            Some(Ok((gyroscope, accelerometer))) => {
                ([Asked::parse(gyroscope)?, Asked::parse(accelerometer)?], true)
            }
            Some(Err(one)) => {
                let one = Asked::parse(one)?;
                ([one.renamed("accel", "gyro"), one.renamed("gyro", "accel")], false)
            }
        };
        Ok(Self { asked, both, survey, ..Self::default() })
    }

    /// Whether the topics of both sensors were found.
    pub fn complete(&self) -> bool {
        !self.gyroscope.is_empty() && !self.accelerometer.is_empty()
    }

    /// Whether the topic of a sensor was found.
    pub fn any(&self) -> bool {
        !self.gyroscope.is_empty() || !self.accelerometer.is_empty()
    }

    /// Whether what was found is all that was asked for.
    pub fn enough(&self) -> bool {
        if self.both { self.complete() } else { self.any() }
    }

    /// Decides, as far as it is not decided yet.
    ///
    /// # Errors
    /// When there are several IMUs and none was asked for.
    pub fn choose(&mut self, found: &Survey, path: &Path) -> Result<(), Error> {
        let [asked_gyroscope, asked_accelerometer] = &self.asked;
        let gyroscopes = best(&found.gyroscope, asked_gyroscope);
        let accelerometers = best(&found.accelerometer, asked_accelerometer);
        let several = (self.gyroscope.is_empty() && gyroscopes.len() > 1)
            || (self.accelerometer.is_empty() && accelerometers.len() > 1);
        if several {
            self.several(&gyroscopes, &accelerometers, path)?;
        }
        let (gyroscope, accelerometer) = (gyroscopes.first(), accelerometers.first());
        let new_gyroscope = gyroscope.filter(|_| self.gyroscope.is_empty());
        let new_accelerometer = accelerometer.filter(|_| self.accelerometer.is_empty());
        if let Some(chosen) = new_gyroscope {
            self.gyroscope = chosen.label();
            self.tell(Sensor::Gyroscope.name(), chosen, &found.gyroscope);
        }
        if let Some(chosen) = new_accelerometer {
            self.accelerometer = chosen.label();
            if self.accelerometer == self.gyroscope && new_gyroscope.is_some() {
                self.notes.pop();
                self.tell("IMU", chosen, &found.accelerometer);
            } else {
                self.tell(Sensor::Accelerometer.name(), chosen, &found.accelerometer);
            }
        }
        if self.thermometer.is_empty() {
            let thermometer = gyroscope
                .and_then(|chosen| same_chip(chosen, &found.gyroscope))
                .or_else(|| accelerometer.and_then(|c| same_chip(c, &found.accelerometer)));
            self.thermometer = thermometer.map(Candidate::label).unwrap_or_default();
        }
        Ok(())
    }

    /// An error that lists several IMUs, or a warning where a survey takes the first.
    fn several(
        &mut self,
        gyroscopes: &[&Candidate],
        accelerometers: &[&Candidate],
        path: &Path,
    ) -> Result<(), Error> {
        let mut listed: Vec<String> = Vec::new();
        for label in gyroscopes.iter().chain(accelerometers).map(|c| c.label()) {
            if !listed.contains(&label) {
                listed.push(label);
            }
        }
        let (path, listed) = (path.display(), listed.join(", "));
        let label = |side: &[&Candidate]| side.first().map(|c| c.label()).unwrap_or_default();
        let (gyroscope, accelerometer) = (label(gyroscopes), label(accelerometers));
        if !self.survey {
            return Err(Error::usage(format!(
                "{path} has several IMUs: {listed}; choose one by its number, such as --topic 0, \
                 or by names, such as --topic {gyroscope},{accelerometer}"
            )));
        }
        self.notes.push(Note::Warning(format!(
            "{path} has several IMUs: {listed}; the first ones are taken: {gyroscope} and \
             {accelerometer}"
        )));
        Ok(())
    }

    /// Says what was chosen, and what else there is.
    fn tell(&mut self, whose: &str, chosen: &Candidate, all: &[Candidate]) {
        let others: Vec<String> =
            all.iter().filter(|c| *c != chosen && c.readings > 0).map(Candidate::label).collect();
        let others = match others.join(", ") {
            none if none.is_empty() => String::new(),
            others => format!("; --topic has others: {others}"),
        };
        self.notes.push(Note::Info(format!(
            "the {whose}'s readings are those of {}: {}{others}",
            chosen.label(),
            chosen.kind.in_words(),
        )));
    }

    /// The error for a log whose end was reached without finding the topics.
    pub fn not_found(&self, definitions: &Definitions, path: &Path) -> Error {
        let path = path.display();
        let all = definitions.subscriptions();
        if all.is_empty() {
            return Error::data(format!("{path} holds no messages"));
        }
        for subscription in all {
            if let Some(Err(why)) = &subscription.layout
                && self.asked.iter().any(|a| a.fits(&subscription.topic, subscription.instance))
            {
                return Error::data(format!(
                    "topic {} of {path} cannot be read: it {why}",
                    subscription.label()
                ));
            }
        }
        // Whoever asked wants an IMU: a log has many topics that are none.
        let mut listed: Vec<&Subscription> = all.iter().collect();
        listed.sort_by_key(|subscription| Kind::of(&subscription.topic).is_none());
        let listed: Vec<String> =
            listed.into_iter().take(LISTED).map(Subscription::label).collect();
        let mut listed = listed.join(", ");
        if all.len() > LISTED {
            listed.push_str(&format!(" and {} more", all.len() - LISTED));
        }
        let [gyroscope, accelerometer] = &self.asked;
        let asked = if self.gyroscope.is_empty() { gyroscope } else { accelerometer };
        if *asked == Asked::default() {
            return Error::data(format!(
                "{path} has no topic of an IMU (sensor_gyro, sensor_accel, their _fifo, \
                 vehicle_imu or sensor_combined); it has {listed}"
            ));
        }
        let asked = asked.in_words();
        Error::usage(format!("{path} has no readings in a topic {asked}; it has {listed}"))
    }
}

/// Of all that were asked for, or else of the rawest kind that is not thinned out, those that have
/// readings; those without where none has any.
fn best<'a>(all: &'a [Candidate], asked: &Asked) -> Vec<&'a Candidate> {
    let mut fit: Vec<&Candidate> =
        all.iter().filter(|c| asked.fits(&c.topic, c.instance)).collect();
    let richest = fit.iter().map(|c| c.readings).max().unwrap_or(0);
    if asked.topic.is_none() {
        let rich = fit.iter().filter(|c| c.readings.saturating_mul(2) >= richest);
        let kind = rich.map(|c| c.kind).min();
        fit.retain(|c| Some(c.kind) == kind);
    }
    fit.retain(|c| richest == 0 || c.readings > 0 || asked.instance.is_some());
    fit
}

/// The one of `all` that tells temperatures of the chip whose readings are chosen.
fn same_chip<'a>(chosen: &'a Candidate, all: &'a [Candidate]) -> Option<&'a Candidate> {
    let same = |c: &&Candidate| c.kind == Kind::Sensor && c.device == chosen.device;
    match chosen.kind {
        Kind::Sensor => Some(chosen),
        _ => all.iter().find(same).filter(|_| chosen.device.is_some()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(topic: &str, instance: u8, readings: u64, device: f64) -> Candidate {
        let kind = Kind::of(topic).unwrap();
        Candidate { topic: topic.into(), instance, kind, readings, device: Some(device) }
    }

    fn pair(name: &str, instance: u8, readings: u64) -> [Candidate; 2] {
        let (gyroscope, accelerometer) = (name.replace('*', "gyro"), name.replace('*', "accel"));
        let device = f64::from(instance) + 5.0;
        [
            candidate(&gyroscope, instance, readings, device),
            candidate(&accelerometer, instance, readings, device),
        ]
    }

    fn survey(pairs: &[[Candidate; 2]]) -> Survey {
        let side = |i: usize| pairs.iter().map(|pair| pair[i].clone()).collect();
        Survey { gyroscope: side(0), accelerometer: side(1) }
    }

    fn chosen(found: &Survey, asked: Option<&str>) -> Result<[String; 3], String> {
        let mut choice = Choice::new(asked, false).map_err(|e| e.to_string())?;
        choice.choose(found, "a.ulg".as_ref()).map_err(|e| e.to_string())?;
        Ok([choice.gyroscope, choice.accelerometer, choice.thermometer])
    }

    #[test]
    fn the_rawest_that_is_not_thinned_out_is_taken() {
        let combined = pair("sensor_combined", 0, 200);
        let (raw, thin) = (pair("sensor_*", 0, 150), pair("sensor_*", 0, 1));
        let fifo = pair("sensor_*_fifo", 0, 8000);
        let take = |pairs: &[[Candidate; 2]]| chosen(&survey(pairs), None).unwrap()[0].clone();
        assert_eq!(take(&[combined.clone(), raw.clone()]), "sensor_gyro:0");
        assert_eq!(take(&[combined.clone(), thin.clone()]), "sensor_combined:0");
        assert_eq!(take(&[combined.clone(), thin.clone(), fifo]), "sensor_gyro_fifo:0");
        assert_eq!(take(&[thin]), "sensor_gyro:0");
    }

    #[test]
    fn several_instances_are_asked_for() {
        let found = survey(&[pair("sensor_*", 0, 9), pair("sensor_*", 1, 9)]);
        let refused = chosen(&found, None).unwrap_err();
        assert!(refused.contains("sensor_gyro:0, sensor_gyro:1, sensor_accel:0, sensor_accel:1"));
        for (asked, gyroscope, accelerometer) in [
            ("1", "sensor_gyro:1", "sensor_accel:1"),
            ("0,1", "sensor_gyro:0", "sensor_accel:1"),
            ("sensor_accel:1", "sensor_gyro:1", "sensor_accel:1"),
            ("/sensor_gyro:1, sensor_accel:0", "sensor_gyro:1", "sensor_accel:0"),
            ("7", "", ""),
        ] {
            let [g, a, _] = chosen(&found, Some(asked)).unwrap();
            assert_eq!((g.as_str(), a.as_str()), (gyroscope, accelerometer), "{asked}");
        }
        for asked in ["", "sensor_gyro:x", "sensor_gyro:256", "300", ","] {
            assert!(chosen(&found, Some(asked)).is_err(), "{asked}");
        }
        let mut choice = Choice::new(None, true).unwrap();
        choice.choose(&found, "a.ulg".as_ref()).unwrap();
        assert_eq!(choice.gyroscope, "sensor_gyro:0");
        assert!(matches!(choice.notes[0], Note::Warning(_)));
    }

    #[test]
    fn temperatures_are_those_of_the_same_chip() {
        let mut pairs = [pair("vehicle_imu", 0, 200), pair("sensor_*", 0, 1)];
        assert_eq!(chosen(&survey(&pairs), None).unwrap()[2], "sensor_gyro:0");
        pairs[1][0].device = Some(1.0);
        assert_eq!(chosen(&survey(&pairs), None).unwrap()[2], "sensor_accel:0");
        pairs[1][1].device = None;
        assert_eq!(chosen(&survey(&pairs), None).unwrap()[2], "");
    }
}
