//! What a topic's name says about its sensor.
//!
//! Drivers that publish gyroscope and accelerometer apart use the same message for both and fill
//! what they do not have with zeros: only the name says which is which. A name is cut into words at
//! whatever is no letter, and where a small letter meets a capital one: `/camera/gyro/sample`,
//! `/device_0/sensor_2/Accel_0/imu/data`, `/imuGyro`.

use crate::recording::sensor::Sensor;

/// Words for a gyroscope, in small letters.
const GYROSCOPE: [&str; 4] = ["gyro", "gyros", "gyr", "gyroscope"];

/// Words for an accelerometer, in small letters.
const ACCELEROMETER: [&str; 5] = ["accel", "accels", "acc", "accelerometer", "acceleration"];

/// The sensor that `topic` is named for: `None` where it names neither, or both.
pub fn sensor(topic: &str) -> Option<Sensor> {
    split(topic).map(|(sensor, _)| sensor)
}

/// Whether two topics differ in nothing but the words for gyroscope and accelerometer.
pub fn twins(a: &str, b: &str) -> bool {
    match (split(a), split(b)) {
        (Some((one, rest)), Some((other, same))) => one != other && rest == same,
        _ => false,
    }
}

/// The sensor that a name tells, and the name with a star in the place of the word that tells it.
fn split(topic: &str) -> Option<(Sensor, String)> {
    let mut sensor = None;
    let mut rest = String::new();
    for word in words(topic.trim_start_matches('/')) {
        let small = word.to_ascii_lowercase();
        let told = if GYROSCOPE.contains(&small.as_str()) {
            Sensor::Gyroscope
        } else if ACCELEROMETER.contains(&small.as_str()) {
            Sensor::Accelerometer
        } else {
            rest.push_str(word);
            continue;
        };
        if sensor.is_some_and(|before| before != told) {
            return None;
        }
        sensor = Some(told);
        rest.push('*');
    }
    sensor.map(|sensor| (sensor, rest))
}

/// The words of a name and what stands between them, in order.
fn words(name: &str) -> impl Iterator<Item = &str> {
    let mut rest = name;
    std::iter::from_fn(move || {
        let mut before = rest.chars().next()?;
        let end = rest
            .char_indices()
            .find(|&(_, c)| {
                let inside = before.is_ascii_alphabetic() == c.is_ascii_alphabetic()
                    && !(before.is_ascii_lowercase() && c.is_ascii_uppercase());
                before = c;
                !inside
            })
            .map_or(rest.len(), |(at, _)| at);
        let (word, after) = rest.split_at_checked(end)?;
        rest = after;
        Some(word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_one_sensor_are_known() {
        use Sensor::{Accelerometer, Gyroscope};
        for (topic, expected) in [
            ("/camera/gyro/sample", Some(Gyroscope)),
            ("/camera/accel/sample", Some(Accelerometer)),
            ("/device_0/sensor_2/Gyro_0/imu/data", Some(Gyroscope)),
            ("/device_0/sensor_2/Accel_0/imu/data", Some(Accelerometer)),
            ("imuGyro", Some(Gyroscope)),
            ("acc0", Some(Accelerometer)),
            ("/gyro_accel", None),
            ("/imu", None),
            ("/gyroid/data", None),
            ("/access", None),
            ("/ünï/gyro", Some(Gyroscope)),
            ("", None),
        ] {
            assert_eq!(sensor(topic), expected, "{topic}");
        }
    }

    #[test]
    fn twins_differ_in_their_sensor_only() {
        for (a, b, expected) in [
            ("/camera/gyro/sample", "/camera/accel/sample", true),
            ("/Gyro_0/imu/data", "/Accel_0/imu/data", true),
            ("/Gyro_0/imu/data", "/Accel_1/imu/data", false),
            ("/a/gyro", "/b/accel", false),
            ("/gyro", "/gyroscope", false),
            ("/imu", "/accel", false),
            ("gyro", "/accel", true),
        ] {
            assert_eq!(twins(a, b), expected, "{a} {b}");
            assert_eq!(twins(b, a), expected, "{b} {a}");
        }
    }
}
