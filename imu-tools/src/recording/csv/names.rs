//! What the name of a column says: which quantity it holds, which axis, in which unit.

use super::columns::Column;
use super::increments;
use crate::recording::sensor::Sensor;
use crate::recording::{ForceUnit, RateUnit, TimeUnit};

/// A column's name in parts.
pub struct Name {
    /// Words and single letters, in lower case.
    words: Vec<String>,
    /// An axis as an index in brackets: `gyro_rad[0]`.
    index: Option<u8>,
    /// The unit in brackets or at the end of the name, as it is written.
    pub unit: Option<String>,
    /// The half of a time in two columns that it says to be.
    half: Option<Column>,
}

/// Words of a unit, at most: `metres per second per second`.
const UNIT: usize = 5;

/// Words that may precede an axis in one piece, as in `gyrox`.
const GYROSCOPE: [&str; 13] = [
    "gyro",
    "gyr",
    "gyroscope",
    "omega",
    "w",
    "g",
    "angularvelocity",
    "angvel",
    "angularrate",
    "angrate",
    "rotationrate",
    "bodyrate",
    "rate",
];
const ACCELEROMETER: [&str; 9] = [
    "accel",
    "acc",
    "accelerometer",
    "a",
    "linearacceleration",
    "acceleration",
    "linacc",
    "force",
    "specificforce",
];

/// Words of columns that hold means over an interval, and increments over it whatever else they say.
const MEANS: [&str; 4] = ["mean", "avg", "average", "averaged"];
const INCREMENTS: [&str; 3] = ["delta", "increment", "increments"];

/// Words of columns that hold something else about a sensor.
const FOREIGN: [&str; 14] = [
    "covariance",
    "cov",
    "bias",
    "std",
    "sigma",
    "b",
    "ref",
    "mag",
    "orientation",
    "temp",
    "temperature",
    "gravity",
    "user",
    "free",
];

impl Name {
    /// Takes a name apart.
    pub fn new(name: &[u8]) -> Self {
        let text = String::from_utf8_lossy(name);
        let text = text.trim().trim_start_matches(['%', '#']);
        let (name, bracketed) = match text.find(['[', '(']) {
            Some(at) => {
                let (name, unit) = text.split_at(at);
                (name, Some(unit.trim_end().to_owned()))
            }
            None => (text, None),
        };
        let index = match bracketed.as_deref() {
            Some("[0]") => Some(0),
            Some("[1]") => Some(1),
            Some("[2]") => Some(2),
            _ => None,
        };
        let mut words = words(name);
        let half = match words.last().map(String::as_str) {
            Some("sec" | "secs" | "seconds") => Some(Column::Seconds),
            Some("nsec" | "nsecs" | "nanosec" | "nanosecs" | "nanoseconds") => {
                Some(Column::Nanoseconds)
            }
            _ => None,
        };
        // A unit may also follow the name: time_ns, gyro_x_rad_s.
        let mut unit = bracketed.filter(|_| index.is_none());
        if unit.is_none() {
            let ends = |w: &String| axis(w).is_some() || is_time(w) || is_temperature(w);
            let last = words.iter().rposition(ends).map(|at| at + 1);
            if let Some(last) = last.filter(|&last| last < words.len()) {
                unit = Some(quotient(&words.split_off(last)));
            }
        }
        // Xsens' SampleTimeFine counts at 10 kHz.
        if words.ends_with(&["sample".into(), "time".into()]) && unit.as_deref() == Some("fine") {
            unit = Some("100us".into());
        }
        let mut name = Self { words, index, unit, half };
        if name.unit.is_none() {
            name.take_inner_unit();
        }
        name
    }

    /// Takes out a unit between sensor and axis, `gyro_dps_x`, or before an index, `gyro_rad[0]`.
    fn take_inner_unit(&mut self) {
        let before = match (self.index, self.words.split_last()) {
            (Some(_), _) => self.words.as_slice(),
            (None, Some((axis, before))) if ["x", "y", "z"].contains(&axis.as_str()) => before,
            _ => {
                self.take_elapsed_unit();
                return;
            }
        };
        for at in before.len().saturating_sub(UNIT).max(1)..before.len() {
            let (sensor, unit) = before.split_at(at);
            let (increments, unit) = (increments::sensor(sensor), quotient(unit));
            let unit = match increments {
                // What PX4 calls an angular rate.
                None if unit == "rad" => "rad/s".into(),
                _ => unit,
            };
            let known = match increments {
                Some(Sensor::Gyroscope) => RateUnit::of_increment(&unit).is_ok(),
                Some(Sensor::Accelerometer) => ForceUnit::of_increment(&unit).is_ok(),
                None => {
                    named(sensor, &GYROSCOPE) && unit.parse::<RateUnit>().is_ok()
                        || named(sensor, &ACCELEROMETER) && unit.parse::<ForceUnit>().is_ok()
                }
            };
            if known {
                let end = before.len();
                self.words.drain(at..end);
                self.unit = Some(unit);
                return;
            }
        }
    }

    /// Takes the unit out of `seconds_elapsed` and `TimeUS`.
    fn take_elapsed_unit(&mut self) {
        let unit = match self.words.as_slice() {
            [unit, elapsed] if elapsed == "elapsed" => unit.clone(),
            [.., last] => match last.strip_prefix("timestamp").or(last.strip_prefix("time")) {
                Some(unit) if unit.len() == 2 => unit.to_owned(),
                _ => return,
            },
            [] => return,
        };
        if unit.parse::<TimeUnit>().is_ok() {
            self.words = vec!["time".into()];
            self.unit = Some(unit);
        }
    }

    /// What the column holds; axes without a sensor are those of `hint`.
    pub fn meaning(&self, hint: Option<Sensor>) -> Column {
        let Some(last) = self.words.last() else { return Column::Other };
        if is_temperature(last) && self.index.is_none() {
            return Column::Temperature;
        }
        let word = |list: &[&str]| self.words.iter().any(|w| list.contains(&w.as_str()));
        if word(&FOREIGN) {
            return Column::Other;
        }
        if is_time(last) {
            return Column::Time;
        }
        let Some((stems, axis)) = self.stems() else { return Column::Other };
        if stems.is_empty() {
            let unit = self.unit.as_deref().unwrap_or_default();
            return match hint {
                _ if unit.parse::<RateUnit>().is_ok() => Column::Rate(axis),
                _ if unit.parse::<ForceUnit>().is_ok() => Column::Force(axis),
                Some(Sensor::Gyroscope) => Column::Rate(axis),
                Some(Sensor::Accelerometer) => Column::Force(axis),
                None => Column::Other,
            };
        }
        match increments::sensor(&stems) {
            Some(Sensor::Gyroscope) => return Column::Rate(axis),
            Some(Sensor::Accelerometer) => return Column::Force(axis),
            None => {}
        }
        match (named(&stems, &GYROSCOPE), named(&stems, &ACCELEROMETER)) {
            (true, false) => Column::Rate(axis),
            (false, true) => Column::Force(axis),
            _ => Column::Other,
        }
    }

    /// Its words without the axis, and the axis, if it has one.
    fn stems(&self) -> Option<(Vec<String>, u8)> {
        let mut stems = self.words.clone();
        if let Some(axis) = self.index {
            return Some((stems, axis));
        }
        let last = stems.pop()?;
        let (stem, axis) = axis(&last)?;
        stems.push(stem.to_owned());
        // An axis by itself leaves an empty stem.
        stems.retain(|stem| !stem.is_empty());
        Some((stems, axis))
    }

    /// It says of a reading that it is a mean over an interval.
    pub fn is_mean(&self) -> bool {
        self.words.iter().any(|word| MEANS.contains(&word.as_str()))
    }

    /// It says of a reading that it is an increment over an interval.
    pub fn is_increment(&self) -> bool {
        self.words.iter().any(|word| INCREMENTS.contains(&word.as_str()))
            || self.stems().is_some_and(|(stems, _)| increments::sensor(&stems).is_some())
    }

    /// The half of a time in two columns that this is by its name, if there is another half.
    pub fn half(&self) -> Option<Column> {
        self.half
    }

    /// It says `date` and not when on that day.
    pub fn is_date(&self) -> bool {
        self.words.last().is_some_and(|word| word == "date")
    }

    /// It says that the stamp is the message's own, not that of its recording.
    pub fn is_header_stamp(&self) -> bool {
        matches!(self.words.as_slice(), [.., header, stamp] if header == "header" && stamp == "stamp")
    }
}

/// The words of a name: letters and digits, and before a capital axis or a capital that begins a
/// word there is a gap.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let characters: Vec<char> = name.chars().collect();
    for (at, &c) in characters.iter().enumerate() {
        if !c.is_alphanumeric() {
            words.push(String::new());
            continue;
        }
        let after_small =
            at.checked_sub(1).and_then(|at| characters.get(at)).is_some_and(|c| c.is_lowercase());
        let next = characters.get(at + 1);
        let begins = match next {
            Some(next) if next.is_alphanumeric() => c.is_uppercase() && next.is_lowercase(),
            _ => matches!(c, 'X' | 'Y' | 'Z'),
        };
        if after_small && begins {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut() {
            word.extend(c.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Whether one of these words, or the last of them written as one, is of `list`.
fn named(words: &[String], list: &[&str]) -> bool {
    let one_piece = words.concat();
    let tail = list.iter().filter(|w| w.len() > 3).any(|w| one_piece.ends_with(w));
    tail || words.iter().any(|w| list.contains(&w.as_str()))
}

/// The unit that words of a name make up: `rad` and `s` are rad/s.
fn quotient(words: &[String]) -> String {
    match words {
        [over, under] if !under.starts_with(|c: char| c.is_ascii_digit()) => {
            format!("{over}/{under}")
        }
        words => words.concat(),
    }
}

fn is_time(word: &str) -> bool {
    [
        "t",
        "time",
        "times",
        "timestamp",
        "timestamps",
        "stamp",
        "stamps",
        "ts",
        "clock",
        "date",
        "datetime",
        "elapsed",
        "epoch",
    ]
    .contains(&word)
}

fn is_temperature(word: &str) -> bool {
    ["temp", "temperature"].contains(&word)
}

/// The axis at the end of a word, and what stands before: `gyrox` is gyro and 0.
fn axis(word: &str) -> Option<(&str, u8)> {
    let stem = word.strip_suffix(['x', 'y', 'z'])?;
    let axis = word.bytes().last()?.checked_sub(b'x')?;
    let known = stem.is_empty()
        || GYROSCOPE.contains(&stem)
        || ACCELEROMETER.contains(&stem)
        || increments::sensor_in_one_piece(stem).is_some();
    known.then_some((stem, axis))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As many words as a megabyte holds: to try each as the first of a unit takes an hour.
    #[test]
    fn a_name_of_any_length_is_read_in_one_go() {
        let name = format!("gyro {}deg s x", "q ".repeat(500_000));
        let name = Name::new(name.as_bytes());
        assert_eq!(name.meaning(None), Column::Rate(0));
        assert_eq!(name.unit.as_deref(), Some("deg/s"));
    }
}
