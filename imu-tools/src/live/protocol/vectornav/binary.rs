//! VectorNav's binary frames: 0xFA, a byte of groups, a mask of fields for each, the fields, a CRC-16.
//!
//! Little-endian singles. Taken are, of angular rates and accelerations, the ones without the
//! filter's estimate of bias where both are sent (common Imu; IMU UncompAccel, UncompGyro), else Accel and
//! AngularRate; where there are none, DeltaTheta (degrees) and DeltaVel as increments. Time is
//! TimeStartup or else TimeGps, nanoseconds in 64 bits. Frames are not numbered.

use super::{crc, groups};
use crate::live::protocol::fields::{le, u8};
use crate::live::protocol::framer::{Check, Wire, not_before};
use crate::live::{Kind, Message, Ticks};

const START: u8 = 0xFA;
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Groups, counted from 0.
const COMMON: usize = 0;
const TIME: usize = 1;
const IMU: usize = 2;

/// Frames that begin with 0xFA.
pub struct Binary;

impl Wire for Binary {
    const LONGEST: usize = 2 + 2 * groups::GROUPS + groups::LONGEST + 2;

    fn check(&self, bytes: &[u8]) -> Check {
        let no = not_before(START, bytes);
        match bytes {
            [START] => return Check::Short,
            // Bit 7 would announce groups that no document tells of.
            [START, groups, ..] if (1..0x80).contains(groups) => {}
            _ => return no,
        }
        let header = View(bytes).header_length();
        if bytes.len() < header {
            return Check::Short;
        }
        let Some(payload) = View(bytes).payload_length() else { return no };
        let length = header + payload + 2;
        match bytes.get(1..length) {
            None => Check::Short,
            Some(said) if crc(said) == 0 => Check::Whole(length),
            Some(_) => Check::Damaged(1),
        }
    }

    fn take(&mut self, frame: &[u8], each: &mut dyn FnMut(Message)) {
        View(frame).sample().into_iter().for_each(each);
    }
}

/// A frame whose header is whole.
#[derive(Clone, Copy)]
struct View<'a>(&'a [u8]);

impl View<'_> {
    fn groups(self) -> u8 {
        u8(self.0, 1)
    }

    fn header_length(self) -> usize {
        2 + 2 * self.groups().count_ones() as usize
    }

    /// The mask of a group; 0 without it.
    fn mask(self, group: usize) -> u16 {
        if self.groups() >> group & 1 == 0 {
            return 0;
        }
        let before = self.groups() & ((1 << group) - 1);
        le::u16(self.0, 2 + 2 * before.count_ones() as usize)
    }

    /// `None` where a field is not known, or a group has none.
    fn payload_length(self) -> Option<usize> {
        let there = (0..groups::GROUPS).filter(|group| self.groups() >> group & 1 == 1);
        let lengths = there.map(|group| match self.mask(group) {
            0 => None,
            mask => groups::length(group, mask),
        });
        lengths.sum()
    }

    /// Where a field is.
    fn place(self, group: usize, bit: u32) -> Option<usize> {
        let mask = self.mask(group);
        if mask >> bit & 1 == 0 {
            return None;
        }
        let groups_before: Option<usize> =
            (0..group).map(|group| groups::length(group, self.mask(group))).sum();
        let fields_before = groups::length(group, mask & ((1 << bit) - 1))?;
        Some(self.header_length() + groups_before? + fields_before)
    }

    fn vector(self, group: usize, bit: u32, offset: usize) -> Option<[f64; 3]> {
        self.place(group, bit).map(|at| le::vector(self.0, at + offset))
    }

    fn single(self, group: usize, bit: u32, offset: usize) -> Option<f64> {
        self.place(group, bit).map(|at| le::f32(self.0, at + offset).into())
    }

    fn sample(self) -> Option<Message> {
        let time = [(COMMON, 0), (TIME, 0), (COMMON, 1), (TIME, 1)];
        let time = time.into_iter().find_map(|(group, bit)| self.place(group, bit));
        let message = Message {
            ticks: time.map(|at| Ticks {
                value: le::u64(self.0, at),
                per_second: 1_000_000_000,
                wraps_at: None,
            }),
            celsius: self.single(IMU, 4, 0).or_else(|| self.single(COMMON, 10, 12)),
            ..Message::default()
        };
        let force = self
            .vector(IMU, 2, 0)
            .or_else(|| self.vector(COMMON, 9, 0))
            .or_else(|| self.vector(IMU, 9, 0))
            .or_else(|| self.vector(COMMON, 8, 0));
        let rate = self
            .vector(IMU, 3, 0)
            .or_else(|| self.vector(COMMON, 9, 12))
            .or_else(|| self.vector(IMU, 10, 0))
            .or_else(|| self.vector(COMMON, 5, 0));
        if force.is_some() || rate.is_some() {
            return Some(Message { gyroscope: rate, accelerometer: force, ..message });
        }
        let angle = self.vector(IMU, 6, 4).or_else(|| self.vector(COMMON, 11, 4));
        let velocity = self.vector(IMU, 7, 0).or_else(|| self.vector(COMMON, 11, 16));
        let over_s = self.single(IMU, 6, 0).or_else(|| self.single(COMMON, 11, 0));
        (angle.is_some() || velocity.is_some()).then(|| Message {
            gyroscope: angle.map(|angle| angle.map(|degrees| degrees * DEGREE)),
            accelerometer: velocity,
            kind: Kind::Increments { over_s: over_s.filter(|over| *over > 0.0) },
            ..message
        })
    }
}

/// Appends the frame of a message: TimeStartup of the common group, and of the IMU group UncompAccel,
/// UncompGyro and Temp, or DeltaTheta and DeltaVel.
pub fn encode(message: &Message, bytes: &mut Vec<u8>) {
    let time = message.ticks.map_or(0, |ticks| ticks.in_units_of(1_000_000_000));
    let (mut mask, mut fields) = (0_u16, Vec::new());
    let mut field = |bit: u32, values: &[f64]| {
        mask |= 1 << bit;
        fields.extend(values.iter().flat_map(|value| (*value as f32).to_le_bytes()));
    };
    match message.kind {
        Kind::Rates => {
            message.accelerometer.iter().for_each(|force| field(2, force));
            message.gyroscope.iter().for_each(|rate| field(3, rate));
            message.celsius.iter().for_each(|celsius| field(4, &[*celsius]));
        }
        Kind::Increments { over_s } => {
            message.celsius.iter().for_each(|celsius| field(4, &[*celsius]));
            if let Some(angle) = message.gyroscope {
                let [x, y, z] = angle.map(|angle| angle / DEGREE);
                field(6, &[over_s.unwrap_or(0.0), x, y, z]);
            }
            message.accelerometer.iter().for_each(|velocity| field(7, velocity));
        }
    }
    if mask == 0 {
        return;
    }
    let start = bytes.len();
    bytes.extend_from_slice(&[START, 0b101, 1, 0]);
    bytes.extend_from_slice(&mask.to_le_bytes());
    bytes.extend_from_slice(&time.to_le_bytes());
    bytes.extend_from_slice(&fields);
    let crc = crc(bytes.get(start + 1..).unwrap_or_default());
    bytes.extend_from_slice(&crc.to_be_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::protocol::{Protocol, tests};

    /// UM001, "Example Case 1": yaw, pitch and roll of group 1.
    #[test]
    fn the_manuals_example_is_a_whole_frame() {
        let bytes = [
            0xFA, 0x01, 0x08, 0x00, 0x93, 0x50, 0x2E, 0x42, 0x83, 0x3E, 0xF1, 0x3F, 0x48, 0xB5,
            0x04, 0xBB, 0x92, 0x88,
        ];
        assert_eq!(Binary.check(&bytes), Check::Whole(18));
        assert_eq!(View(&bytes).sample(), None);
        let yaw = View(&bytes).vector(COMMON, 3, 0).unwrap()[0];
        assert_eq!(yaw, f64::from(f32::from_bits(0x422E_5093)));
    }

    #[test]
    fn a_message_comes_back() {
        for kind in [Kind::Rates, Kind::Increments { over_s: Some(0.0078125) }] {
            let sent = Message { kind, count: None, ..tests::message(8) };
            let mut bytes = Vec::new();
            encode(&sent, &mut bytes);
            let [back] = tests::decoded(Protocol::VectorNav, &bytes).try_into().unwrap();
            if kind == Kind::Rates {
                assert_eq!(back, sent);
            }
            assert_eq!((back.kind, back.celsius, back.ticks), (kind, sent.celsius, sent.ticks));
            assert_eq!(back.accelerometer, sent.accelerometer);
            // A degree in a single, of up to 45 of them.
            tests::assert_near(
                back.gyroscope,
                sent.gyroscope,
                45.0 * DEGREE * f64::from(f32::EPSILON),
            );
        }
    }

    #[test]
    fn common_group_fields_are_found() {
        // AngularRate (5), Accel (8), Imu (9), MagPres (10), DeltaThetaVel (11) in the order of their bits.
        let mask: u16 = 1 << 5 | 1 << 8 | 1 << 9 | 1 << 10 | 1 << 11;
        let mut bytes = vec![START, 1];
        bytes.extend_from_slice(&mask.to_le_bytes());
        bytes.extend((0..3 + 3 + 6 + 5 + 7).flat_map(|i| (i as f32).to_le_bytes()));
        bytes.extend_from_slice(&crc(&bytes[1..]).to_be_bytes());
        let [message] = tests::decoded(Protocol::VectorNav, &bytes).try_into().unwrap();
        assert_eq!(message.accelerometer, Some([6.0, 7.0, 8.0]));
        assert_eq!(message.gyroscope, Some([9.0, 10.0, 11.0]));
        assert_eq!(message.celsius, Some(15.0));
    }
}
