//! MAVLink, versions 1 (0xFE) and 2 (0xFD): HIGHRES_IMU, SCALED_IMU, SCALED_IMU2, SCALED_IMU3 and RAW_IMU.
//!
//! Source: MAVLink Developer Guide, "Packet Serialization", and the definitions of `common.xml`. The CRC
//! is that of X.25 (0x1021 reflected, from all ones) with a byte of the message's definition behind;
//! version 2 leaves trailing zeros of the payload out, and may have a signature, which is not verified.
//!
//! An autopilot sends several of these of the same sensor, and those of other sensors: one stream is handed
//! out, of one sender, the best in the order above; HIGHRES_IMU of its first instance only. Which sensor it is
//! is chosen among the first 1024 that come, whatever the sender. After that only messages of the same sensor
//! are taken: a better one at once, and another where the present one comes no more. One that ceased is gone
//! back to only where its heir ceases too. Each such change is a stream of its own ([`Message::stream`]).
//! SCALED_IMU is in 0.001 g and 0.001 rad/s. RAW_IMU has no unit by its definition: it is read as
//! ArduPilot fills it, as SCALED_IMU; who sends counts of a converter gets values of no meaning.
//! Time is µs or ms of the sender; that of ms is coarse, and wraps at 32 bits. The sequence number counts all
//! messages of a sender, whatever they are, so that it is no count of these and not given.

mod crc_extra;

use super::fields::{le, u8};
use super::framer::{Check, Wire};
use crate::live::{Kind, Message, Ticks};

const START_1: u8 = 0xFE;
const START_2: u8 = 0xFD;
/// The only flag of a frame of version 2 that is defined: a signature follows.
const SIGNED: u8 = 1;
const SIGNATURE: usize = 13;
const CRC: usize = 2;

const SCALED_IMU: u32 = 26;
const RAW_IMU: u32 = 27;
const HIGHRES_IMU: u32 = 105;
const SCALED_IMU2: u32 = 116;
const SCALED_IMU3: u32 = 129;
/// The best first.
const PREFERRED: [u32; 5] = [HIGHRES_IMU, SCALED_IMU, SCALED_IMU2, SCALED_IMU3, RAW_IMU];

/// Those of a sender's first sensor.
const FIRST: [u32; 3] = [HIGHRES_IMU, SCALED_IMU, RAW_IMU];
/// Messages among which the sensor is chosen.
const CHOICE: u32 = 1024;
/// After so many others of the same sensor the one that was taken comes no more.
const PATIENCE: u32 = 1024;

const MILLI_G: f64 = 9.80665e-3;
const MILLI: f64 = 1e-3;

/// Frames of both versions, and whose messages are taken.
#[derive(Default)]
pub struct Mavlink {
    taken: Option<Stream>,
    /// Which of the streams that were taken that is.
    number: u8,
    /// Messages with samples, whoever's, up to [`CHOICE`].
    came: u32,
    /// Other messages of the same sensor since the latest of this stream.
    passed: u32,
    /// Ranks of those that came no more, a bit each: they are not better any more.
    ceased: u8,
}

/// A message of a sender, by its rank.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Stream {
    rank: usize,
    sender: [u8; 2],
}

impl Stream {
    fn is_of_the_sensor_of(self, other: Self) -> bool {
        let is_first = |stream: Self| {
            PREFERRED.get(stream.rank).is_some_and(|message| FIRST.contains(message))
        };
        self.sender == other.sender && is_first(self) && is_first(other)
    }

    fn bit(self) -> u8 {
        1 << self.rank
    }
}

impl Mavlink {
    /// Whether a message of this stream is taken.
    fn takes(&mut self, stream: Stream) -> bool {
        let is_chosen = self.came >= CHOICE;
        self.came = self.came.saturating_add(1).min(CHOICE);
        let Some(taken) = self.taken else {
            self.taken = Some(stream);
            return true;
        };
        if stream == taken {
            self.passed = 0;
            return true;
        }
        let is_same = stream.is_of_the_sensor_of(taken);
        let is_better = stream.rank < taken.rank && self.ceased & stream.bit() == 0;
        let is_heir = is_same && self.passed >= PATIENCE;
        if is_heir {
            self.ceased |= taken.bit();
        } else if !is_better || is_chosen && !is_same {
            self.passed = self.passed.saturating_add(is_same.into());
            return false;
        }
        self.ceased &= !stream.bit();
        (self.taken, self.passed) = (Some(stream), 0);
        self.number = self.number.wrapping_add(1);
        true
    }
}

impl Wire for Mavlink {
    const LONGEST: usize = 10 + 255 + CRC + SIGNATURE;

    fn check(&self, bytes: &[u8]) -> Check {
        let no = {
            let rest = bytes.get(1..).unwrap_or_default();
            Check::Not(1 + memchr::memchr2(START_1, START_2, rest).unwrap_or(rest.len()))
        };
        match bytes {
            [START_1 | START_2] | [START_2, _] => return Check::Short,
            // A receiver must not take a frame with a flag that it does not know.
            [START_2, _, flags, ..] if flags & !SIGNED != 0 => return no,
            [START_1 | START_2, ..] => {}
            _ => return no,
        }
        let view = View(bytes);
        if bytes.len() < view.header() {
            return Check::Short;
        }
        let Some(extra) = crc_extra::of(view.message()) else { return no };
        let said = view.header() + view.payload_length();
        let length = said + CRC + if view.is_signed() { SIGNATURE } else { 0 };
        if bytes.len() < length {
            return Check::Short;
        }
        let crc = crc(bytes.get(1..said).unwrap_or_default().iter().chain([&extra]));
        if crc == le::u16(bytes, said) { Check::Whole(length) } else { Check::Damaged(1) }
    }

    fn take(&mut self, frame: &[u8], each: &mut dyn FnMut(Message)) {
        let view = View(frame);
        let Some(rank) = PREFERRED.iter().position(|message| *message == view.message()) else {
            return;
        };
        // A frame without a sample (another instance, neither sensor updated) says nothing of its stream.
        let Some(sample) = view.sample() else { return };
        if self.takes(Stream { rank, sender: view.sender() }) {
            each(Message { stream: self.number, ..sample });
        }
    }
}

/// X.25's CRC.
fn crc<'a>(bytes: impl Iterator<Item = &'a u8>) -> u16 {
    bytes.fold(0xFFFF, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte), |crc, _| {
            if crc & 1 == 0 { crc >> 1 } else { (crc >> 1) ^ 0x8408 }
        })
    })
}

/// A frame whose header is whole.
#[derive(Clone, Copy)]
struct View<'a>(&'a [u8]);

impl View<'_> {
    fn is_2(self) -> bool {
        u8(self.0, 0) == START_2
    }

    fn header(self) -> usize {
        if self.is_2() { 10 } else { 6 }
    }

    fn payload_length(self) -> usize {
        u8(self.0, 1).into()
    }

    fn is_signed(self) -> bool {
        self.is_2() && u8(self.0, 2) & SIGNED != 0
    }

    /// System and component.
    fn sender(self) -> [u8; 2] {
        let at = if self.is_2() { 5 } else { 3 };
        [u8(self.0, at), u8(self.0, at + 1)]
    }

    fn message(self) -> u32 {
        if self.is_2() { le::u32(self.0, 6) >> 8 } else { u8(self.0, 5).into() }
    }

    /// The payload with the zeros that were left out.
    fn payload(self) -> [u8; 64] {
        let sent = self.0.get(self.header()..self.header() + self.payload_length());
        let mut payload = [0; 64];
        for (place, byte) in payload.iter_mut().zip(sent.unwrap_or_default()) {
            *place = *byte;
        }
        payload
    }

    fn sample(self) -> Option<Message> {
        let payload = &self.payload()[..];
        let microseconds =
            Ticks { value: le::u64(payload, 0), per_second: 1_000_000, wraps_at: None };
        // Hundredths of a degree; 0 says that there is none.
        let celsius = |at: usize| match le::i16(payload, at) {
            0 => None,
            hundredths => Some(f64::from(hundredths) / 100.0),
        };
        match self.message() {
            HIGHRES_IMU => {
                // Version 1 and older senders have no instance, which reads as the first.
                let updated = le::u16(payload, 60);
                let has = |bits: u16| updated & bits == bits;
                let force = has(0b111).then(|| le::vector(payload, 8));
                let rate = has(0b111_000).then(|| le::vector(payload, 20));
                (u8(payload, 62) == 0 && (force.is_some() || rate.is_some())).then(|| Message {
                    accelerometer: force,
                    gyroscope: rate,
                    celsius: has(1 << 12).then(|| le::f32(payload, 56).into()),
                    ticks: Some(microseconds),
                    ..Message::default()
                })
            }
            RAW_IMU => Some(Message {
                accelerometer: Some(le::scaled(payload, 8, MILLI_G)),
                gyroscope: Some(le::scaled(payload, 14, MILLI)),
                celsius: celsius(27),
                ticks: Some(microseconds),
                ..Message::default()
            }),
            SCALED_IMU | SCALED_IMU2 | SCALED_IMU3 => Some(Message {
                accelerometer: Some(le::scaled(payload, 4, MILLI_G)),
                gyroscope: Some(le::scaled(payload, 10, MILLI)),
                celsius: celsius(22),
                ticks: Some(Ticks {
                    value: le::u32(payload, 0).into(),
                    per_second: 1000,
                    wraps_at: Some(1 << 32),
                }),
                ..Message::default()
            }),
            _ => None,
        }
    }
}

/// Appends HIGHRES_IMU of version 2 of a message, numbered by its count. Increments have none.
pub fn encode(message: &Message, bytes: &mut Vec<u8>) {
    if message.kind != Kind::Rates {
        return;
    }
    let singles = |values: Option<[f64; 3]>| values.unwrap_or_default().map(|value| value as f32);
    let mut updated = 0_u16;
    for (is_there, bits) in [
        (message.accelerometer.is_some(), 0b111),
        (message.gyroscope.is_some(), 0b111_000),
        (message.celsius.is_some(), 1 << 12),
    ] {
        updated |= if is_there { bits } else { 0 };
    }
    let microseconds = message.ticks.map_or(0, |ticks| ticks.in_units_of(1_000_000));
    let mut payload = microseconds.to_le_bytes().to_vec();
    let magnetic_and_pressures = [0.0; 6];
    let numbers = singles(message.accelerometer).into_iter().chain(singles(message.gyroscope));
    let numbers =
        numbers.chain(magnetic_and_pressures).chain([message.celsius.unwrap_or(0.0) as f32]);
    payload.extend(numbers.flat_map(f32::to_le_bytes));
    payload.extend_from_slice(&updated.to_le_bytes());
    while payload.len() > 1 && payload.last() == Some(&0) {
        payload.pop();
    }
    let number = message.count.map_or(0, |count| count.value as u8);
    let start = bytes.len();
    let [message, ..] = HIGHRES_IMU.to_le_bytes();
    bytes.extend_from_slice(&[START_2, payload.len() as u8, 0, 0, number, 1, 1, message, 0, 0]);
    bytes.extend_from_slice(&payload);
    let extra = crc_extra::of(HIGHRES_IMU).unwrap_or_default();
    let crc = crc(bytes.get(start + 1..).unwrap_or_default().iter().chain([&extra]));
    bytes.extend_from_slice(&crc.to_le_bytes());
}

#[cfg(test)]
mod tests;
