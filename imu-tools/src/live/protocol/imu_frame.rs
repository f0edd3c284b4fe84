//! Our own frame, which firmware sends: [`imu_core::frame`] has its table of bytes.

use imu_core::frame::{self, Frame, LONGEST, View};

use super::framer::{Check, Wire, not_before};
use crate::live::{Count, Kind, Message, Ticks};

/// Frames of [`imu_core::frame`].
pub struct ImuFrame;

impl Wire for ImuFrame {
    const LONGEST: usize = LONGEST;

    fn check(&self, bytes: &[u8]) -> Check {
        let [first, _] = frame::SYNC;
        match frame::check(bytes) {
            frame::Check::Short => Check::Short,
            frame::Check::Whole(length) => Check::Whole(length),
            frame::Check::Not => not_before(first, bytes),
            frame::Check::Damaged => Check::Damaged(1),
        }
    }

    fn take(&mut self, frame: &[u8], each: &mut dyn FnMut(Message)) {
        if let Some(view) = View::of(frame) {
            each(sample(view));
        }
    }
}

/// The frame in SI units, which are its own.
fn sample(view: View<'_>) -> Message {
    Message {
        gyroscope: view.gyroscope().map(|rate| rate.map(f64::from)),
        accelerometer: view.accelerometer().map(|force| force.map(f64::from)),
        kind: if view.increments() { Kind::Increments { over_s: None } } else { Kind::Rates },
        ticks: Some(Ticks { value: view.time_ns(), per_second: 1_000_000_000, wraps_at: None }),
        count: Some(Count { value: view.number().into(), wraps_at: 1 << 16 }),
        celsius: view.celsius().map(f64::from),
        ..Message::default()
    }
}

/// Appends the frame of a message: its numbers as singles, zero time and number where it has none.
pub fn encode(message: &Message, bytes: &mut Vec<u8>) {
    let singles = |values: [f64; 3]| values.map(|value| value as f32);
    let frame = Frame {
        number: message.count.map_or(0, |count| count.value as u16),
        time_ns: message.ticks.map_or(0, |ticks| ticks.in_units_of(1_000_000_000)),
        gyroscope: message.gyroscope.map(singles),
        accelerometer: message.accelerometer.map(singles),
        celsius: message.celsius.map(|celsius| celsius as f32),
        increments: message.kind != Kind::Rates,
    };
    bytes.extend_from_slice(frame.encode(&mut [0; LONGEST]));
}

#[cfg(test)]
mod tests {
    use super::super::{Protocol, tests};
    use super::*;

    #[test]
    fn a_message_comes_back_bit_for_bit() {
        let mut message = tests::message(41);
        message.ticks = Some(Ticks { value: 77, per_second: 1_000_000_000, wraps_at: None });
        let mut bytes = Vec::new();
        encode(&message, &mut bytes);
        assert_eq!(tests::decoded(Protocol::ImuFrame, &bytes), [message]);
        message.kind = Kind::Increments { over_s: None };
        message.celsius = None;
        bytes.clear();
        encode(&message, &mut bytes);
        assert_eq!(tests::decoded(Protocol::ImuFrame, &bytes), [message]);
    }
}
