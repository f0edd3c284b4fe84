//! WitMotion's standard protocol: frames of eleven bytes that begin with 0x55.
//!
//! Source: WitMotion, WT901 and HWT905 datasheets and online protocol guide (2020 to 2024): type, eight bytes
//! of data, little-endian, the sum of all before as a checksum; acceleration (0x51) in 16 g / 32768
//! with the temperature in 0.01 °C, angular rate (0x52) in 2000 °/s / 32768, time (0x50) of a calendar to
//! the millisecond. A device set to another range says so nowhere. For g the standard one is taken,
//! 9.80665 m/s². The BWT61's older formula of temperature is not known by its frames, and not used. Frames
//! of Bluetooth modules (0x55 0x61) have no checksum and are left out.
//!
//! A device sends its frames in cycles: time, acceleration, rate, each if it is set to. A cycle is one message,
//! and one that lacks a frame which those before it had is none: its halves would count as two samples, and
//! frames of two cycles never make one. The checksum is weak, one wrong frame in 256 passes it, and nothing
//! counts frames.

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

/// So many cycles in a row that lack a frame: the device was set to send others.
const CHANGED: u8 = 32;

/// WitMotion's frames, and the message that they build up.
#[derive(Default)]
pub struct WitMotion {
    time: Option<Ticks>,
    /// An acceleration that waits for its rate.
    waiting: Option<Message>,
    /// Whether cycles have a time, an acceleration and a rate.
    usual: [bool; 3],
    /// Cycles in a row that lacked one of them.
    incomplete: u8,
}

impl WitMotion {
    /// Hands a cycle out if it has all that cycles have.
    fn hand(&mut self, cycle: Message, each: &mut dyn FnMut(Message)) {
        let has = [cycle.ticks.is_some(), cycle.accelerometer.is_some(), cycle.gyroscope.is_some()];
        let is_whole = has.iter().zip(self.usual).all(|(has, usual)| *has || !usual);
        if is_whole || self.incomplete >= CHANGED {
            (self.usual, self.incomplete) = (has, 0);
            each(cycle);
        } else {
            self.incomplete += 1;
        }
    }

    /// Ends a cycle that has no rate, or has it not yet.
    fn end_waiting(&mut self, each: &mut dyn FnMut(Message)) {
        if let Some(cycle) = self.waiting.take() {
            self.hand(cycle, each);
        }
    }
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
        match view.kind() {
            RATE => {
                let before = self.waiting.take();
                let cycle = before
                    .unwrap_or_else(|| Message { ticks: self.time.take(), ..Message::default() });
                self.hand(Message { gyroscope: Some(view.rate()), ..cycle }, each);
            }
            ACCELERATION => {
                self.end_waiting(each);
                self.waiting = Some(Message {
                    accelerometer: Some(view.acceleration()),
                    celsius: Some(view.celsius()),
                    ticks: self.time.take(),
                    ..Message::default()
                });
            }
            TIME => {
                self.end_waiting(each);
                self.time = view.time();
            }
            _ => self.end_waiting(each),
        }
    }

    fn broken(&mut self, _refused: &[u8], each: &mut dyn FnMut(Message)) {
        // What was damaged may have been the frame that began the next cycle.
        self.time = None;
        self.end_waiting(each);
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

    /// Of one cycle the rate is damaged, of the next the acceleration, of a third the time: no message has parts of
    /// two of them, and none is half.
    #[test]
    fn a_cycle_that_is_not_whole_is_no_message() {
        let (mut bytes, cycle) = (Vec::new(), 3 * LENGTH);
        (0..6).for_each(|i| encode(&tests::message(i), &mut bytes));
        let whole = tests::decoded(Protocol::WitMotion, &bytes);
        for place in [cycle + 2 * LENGTH, 2 * cycle + LENGTH, 3 * cycle] {
            bytes[place + 3] ^= 1;
        }
        let messages = tests::decoded(Protocol::WitMotion, &bytes);
        assert_eq!(messages, [whole[0], whole[4], whole[5]]);
    }

    /// A device that is set to send one sensor sends whole cycles, from the first on or after a while.
    #[test]
    fn a_device_may_send_one_sensor_alone() {
        let both = tests::message(1);
        for alone in [Message { gyroscope: None, ..both }, Message { accelerometer: None, ..both }]
        {
            let mut bytes = Vec::new();
            (0..40).for_each(|_| encode(&alone, &mut bytes));
            assert_eq!(tests::decoded(Protocol::WitMotion, &bytes).len(), 40);
            let mut changed = Vec::new();
            encode(&both, &mut changed);
            changed.extend_from_slice(&bytes);
            let messages = tests::decoded(Protocol::WitMotion, &changed);
            assert_eq!(messages.len(), 1 + 40 - usize::from(CHANGED));
        }
    }
}
