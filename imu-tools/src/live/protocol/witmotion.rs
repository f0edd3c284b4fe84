//! WitMotion's standard protocol: frames of eleven bytes that begin with 0x55.
//!
//! Source: WitMotion, WT901 and HWT905 datasheets and online protocol guide (2020 to 2024): type, eight bytes
//! of data, little-endian, the sum of all before as a checksum; acceleration (0x51) in 16 g / 32768
//! with the temperature in 0.01 °C, angular rate (0x52) in 2000 °/s / 32768, time (0x50) of a calendar to
//! the millisecond. A device set to another range says so nowhere. For g the standard one is taken,
//! 9.80665 m/s². The BWT61's older formula of temperature is not known by its frames, and not used. Frames
//! of Bluetooth modules (0x55 0x61) have no checksum and are left out.
//!
//! Rate follows acceleration at once; both become one message, stamped by the time before it, if one
//! is sent. The checksum is weak, one wrong frame in 256 passes it, and nothing counts frames.

use super::fields::{le, u8};
use super::framer::{Check, Wire, not_before};
use crate::live::{Kind, Message, Ticks};

const LENGTH: usize = 11;
const START: u8 = 0x55;
const TIME: u8 = 0x50;
const ACCELERATION: u8 = 0x51;
const RATE: u8 = 0x52;
/// The last type; those between are angles, fields, places and answers to questions.
const LAST_TYPE: u8 = 0x5F;

/// m/s² and rad/s of one step.
const FORCE_STEP: f64 = 16.0 * 9.80665 / 32768.0;
const RATE_STEP: f64 = 2000.0 * std::f64::consts::PI / 180.0 / 32768.0;

/// WitMotion's frames, and the message that they build up.
#[derive(Default)]
pub struct WitMotion {
    time: Option<Ticks>,
    /// An acceleration that waits for its rate.
    waiting: Option<Message>,
}

impl Wire for WitMotion {
    const LONGEST: usize = LENGTH;

    fn check(&self, bytes: &[u8]) -> Check {
        match bytes {
            [START] => return Check::Short,
            [START, TIME..=LAST_TYPE, ..] => {}
            _ => return not_before(START, bytes),
        }
        let Some(frame) = bytes.get(..LENGTH) else { return Check::Short };
        if sum(frame) == u8(frame, LENGTH - 1) { Check::Whole(LENGTH) } else { Check::Damaged(1) }
    }

    fn take(&mut self, frame: &[u8], each: &mut dyn FnMut(Message)) {
        let view = View(frame);
        let before = self.waiting.take();
        match view.kind() {
            RATE => {
                let gyroscope = Some(view.rate());
                let message = before.unwrap_or(Message { ticks: self.time, ..Message::default() });
                each(Message { gyroscope, ..message });
                return;
            }
            ACCELERATION => {
                self.waiting = Some(Message {
                    accelerometer: Some(view.acceleration()),
                    celsius: Some(view.celsius()),
                    ticks: self.time,
                    ..Message::default()
                });
            }
            TIME => self.time = view.time(),
            _ => {}
        }
        before.into_iter().for_each(each);
    }

    fn broken(&mut self, _refused: &[u8], each: &mut dyn FnMut(Message)) {
        // The time behind a damaged frame may be that of the cycle before.
        self.time = None;
        self.waiting.take().into_iter().for_each(each);
    }
}

/// The sum of all bytes but the last.
fn sum(frame: &[u8]) -> u8 {
    frame.iter().take(LENGTH - 1).fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

/// A checked frame.
struct View<'a>(&'a [u8]);

impl View<'_> {
    fn kind(&self) -> u8 {
        u8(self.0, 1)
    }

    /// m/s²
    fn acceleration(&self) -> [f64; 3] {
        le::scaled(self.0, 2, FORCE_STEP)
    }

    /// rad/s
    fn rate(&self) -> [f64; 3] {
        le::scaled(self.0, 2, RATE_STEP)
    }

    /// Degrees Celsius.
    fn celsius(&self) -> f64 {
        f64::from(le::i16(self.0, 8)) / 100.0
    }

    /// Milliseconds since the year 2000 by the device's calendar; `None` if it is no date.
    fn time(&self) -> Option<Ticks> {
        let [year, month, day, hour, minute, second] =
            [2, 3, 4, 5, 6, 7].map(|at| u64::from(u8(self.0, at)));
        let days = days_since_2000(year, month, day)?;
        if hour > 23 || minute > 59 || second > 59 {
            return None;
        }
        let seconds = ((days * 24 + hour) * 60 + minute) * 60 + second;
        let value = seconds * 1000 + u64::from(le::u16(self.0, 8));
        Some(Ticks { value, per_second: 1000, wraps_at: None })
    }
}

const DAYS_BEFORE_MONTH: [u64; 12] = [0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334];

/// Whole days, years from 0 for 2000.
fn days_since_2000(year: u64, month: u64, day: u64) -> Option<u64> {
    let before = DAYS_BEFORE_MONTH.get(usize::try_from(month.checked_sub(1)?).ok()?)?;
    // In this century, every fourth year from 2000 on has a leap day.
    let leap_days = year.div_ceil(4) + u64::from(year.is_multiple_of(4) && month > 2);
    (1..=31).contains(&day).then(|| year * 365 + leap_days + before + day - 1)
}

/// The year, month and day that so many days after 2000 began are.
fn date_of(days: u64) -> [u8; 3] {
    let fits = |y: &u64, m: u64| days_since_2000(*y, m, 1).is_some_and(|first| first <= days);
    let year = (0..=99).take_while(|year| fits(year, 1)).last().unwrap_or(0);
    let month = (1..=12).take_while(|&month| fits(&year, month)).last().unwrap_or(1);
    let day = days.saturating_sub(days_since_2000(year, month, 1).unwrap_or(0)) + 1;
    [year, month, day].map(|part| u8::try_from(part).unwrap_or(u8::MAX))
}

/// Appends the frames of a message, rounded to their steps and held within their range: its time,
/// acceleration and rate. Increments have no frame.
pub fn encode(message: &Message, bytes: &mut Vec<u8>) {
    if message.kind != Kind::Rates {
        return;
    }
    if let Some(ticks) = message.ticks {
        let milliseconds = ticks.in_units_of(1000);
        let seconds = milliseconds / 1000;
        let [year, month, day] = date_of(seconds / 86_400);
        let clock = [seconds / 3600 % 24, seconds / 60 % 60, seconds % 60].map(|part| part as u8);
        let [hour, minute, second] = clock;
        let [low, high] = ((milliseconds % 1000) as u16).to_le_bytes();
        push(TIME, [year, month, day, hour, minute, second, low, high], bytes);
    }
    let temperature = (message.celsius.unwrap_or(0.0) * 100.0).round() as i16;
    let numbers = |values: [f64; 3], step: f64| {
        let [x, y, z] = values.map(|value| ((value / step).round() as i16).to_le_bytes());
        let t = temperature.to_le_bytes();
        [x[0], x[1], y[0], y[1], z[0], z[1], t[0], t[1]]
    };
    if let Some(force) = message.accelerometer {
        push(ACCELERATION, numbers(force, FORCE_STEP), bytes);
    }
    if let Some(rate) = message.gyroscope {
        push(RATE, numbers(rate, RATE_STEP), bytes);
    }
}

fn push(kind: u8, data: [u8; 8], bytes: &mut Vec<u8>) {
    let start = bytes.len();
    bytes.extend_from_slice(&[START, kind]);
    bytes.extend_from_slice(&data);
    let sum = sum(bytes.get(start..).unwrap_or_default());
    bytes.push(sum);
}

#[cfg(test)]
mod tests {
    use super::super::{Protocol, tests};
    use super::*;

    /// Bytes that a WT61PC sent, as quoted in a public driver of DFRobot's module.
    #[test]
    fn bytes_of_a_device() {
        let bytes = [
            0x55, 0x51, 0xae, 0xff, 0x0c, 0x00, 0x12, 0x08, 0x78, 0x08, 0xf9, //
            0x55, 0x52, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x78, 0x08, 0x27, //
            0x55, 0x53, 0x43, 0x00, 0x87, 0x01, 0x6d, 0x01, 0x6a, 0x42, 0x8d,
        ];
        let [message] = tests::decoded(Protocol::WitMotion, &bytes).try_into().unwrap();
        let g = 9.80665 * 16.0 / 32768.0;
        assert_eq!(message.accelerometer, Some([-82.0 * g, 12.0 * g, 2066.0 * g]));
        assert_eq!(message.gyroscope, Some([0.0; 3]));
        assert_eq!(message.celsius, Some(21.68));
    }

    #[test]
    fn a_message_comes_back_to_half_a_step() {
        let sent = tests::message(5);
        let mut bytes = Vec::new();
        encode(&sent, &mut bytes);
        let [back] = tests::decoded(Protocol::WitMotion, &bytes).try_into().unwrap();
        tests::assert_near(back.accelerometer, sent.accelerometer, FORCE_STEP / 2.0);
        tests::assert_near(back.gyroscope, sent.gyroscope, RATE_STEP / 2.0);
        assert!((back.celsius.unwrap() - sent.celsius.unwrap()).abs() < 0.0051);
        let milliseconds = sent.ticks.unwrap().in_units_of(1000);
        assert_eq!(back.ticks.unwrap().value, milliseconds);
    }

    #[test]
    fn dates_come_back() {
        for (days, date) in [
            (0, [0, 1, 1]),
            (59, [0, 2, 29]),
            (60, [0, 3, 1]),
            (366, [1, 1, 1]),
            (9822, [26, 11, 22]),
        ] {
            assert_eq!(date_of(days).map(u64::from), date.map(|part: u8| u64::from(part)));
            let [year, month, day] = date.map(u64::from);
            // 29 February 2000 is day 59.
            assert_eq!(days_since_2000(year, month, day), Some(days));
        }
    }

    /// An acceleration whose rate is lost must not be joined with the rate of the cycle after it.
    #[test]
    fn a_damaged_frame_joins_no_others() {
        let mut bytes = Vec::new();
        let still = Message { accelerometer: Some([0.0; 3]), ..Message::default() };
        let sent = Message { gyroscope: Some([1.0, 0.0, 0.0]), ..still };
        encode(&sent, &mut bytes);
        encode(&sent, &mut bytes);
        bytes[LENGTH + 3] ^= 1;
        bytes[2 * LENGTH + 3] ^= 1;
        let messages = tests::decoded(Protocol::WitMotion, &bytes);
        let has = |m: &Message| (m.accelerometer.is_some(), m.gyroscope.is_some());
        assert_eq!(messages.iter().map(has).collect::<Vec<_>>(), [(true, false), (false, true)]);
    }
}
