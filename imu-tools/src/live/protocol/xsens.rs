//! Xsens' MTData2: 0xFA 0xFF 0x36, a length, packets of data that each say what they are, a checksum.
//!
//! Source: Xsens MT0101P, MT Low Level Communication Protocol Documentation, revisions Y (2017) and 2019.A;
//! the order of bytes of fixed point from Xsens' article on it. Big-endian; the sum of all bytes behind the
//! first is 0. A length of 255 is followed by the length in two bytes, 2048 at most.
//!
//! Read are PacketCounter (16 bits), SampleTimeFine (10 kHz, 32 bits), Acceleration (m/s²), RateOfTurn
//! (rad/s), or where there are neither DeltaV (m/s) and DeltaQ, whose rotation vector is the increment of angle,
//! and Temperature: each as a single, a double, or in fixed point 12.20 or 16.32. The values of high rate
//! (AccelerationHR, RateOfTurnHR), which come in messages of their own, are not read, and neither are other
//! messages of the device. The sum of eight bits is a weak guard: the packets must fill the message, too.

use super::fields::{be, u8};
use super::framer::{Check, Wire, not_before};
use crate::live::{Count, Kind, Message, Ticks};

const START: u8 = 0xFA;
/// A device that is its own bus.
const MASTER: u8 = 0xFF;
const MTDATA2: u8 = 0x36;
const EXTENDED: u8 = 0xFF;
const LONGEST_DATA: usize = 2048;

const TEMPERATURE: u16 = 0x0810;
const PACKET_COUNTER: u16 = 0x1020;
const SAMPLE_TIME_FINE: u16 = 0x1060;
const DELTA_V: u16 = 0x4010;
const ACCELERATION: u16 = 0x4020;
const RATE_OF_TURN: u16 = 0x8020;
const DELTA_Q: u16 = 0x8030;

/// Messages that begin with 0xFA 0xFF.
pub struct Xsens;

impl Wire for Xsens {
    const LONGEST: usize = 6 + LONGEST_DATA + 1;

    fn check(&self, bytes: &[u8]) -> Check {
        let no = not_before(START, bytes);
        match bytes {
            [START] | [START, MASTER] | [START, MASTER, MTDATA2] => return Check::Short,
            [START, MASTER, MTDATA2, ..] => {}
            _ => return no,
        }
        let view = View(bytes);
        if bytes.len() < view.header() {
            return Check::Short;
        }
        if view.data_length() > LONGEST_DATA {
            return no;
        }
        let length = view.header() + view.data_length() + 1;
        let Some(frame) = bytes.get(..length) else { return Check::Short };
        let sum = frame.iter().skip(1).fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        let packets: usize = view.packets().map(|packet| 3 + packet.data.len()).sum();
        let is_right = sum == 0 && packets == view.data_length();
        if is_right { Check::Whole(length) } else { Check::Damaged(1) }
    }

    fn take(&mut self, frame: &[u8], each: &mut dyn FnMut(Message)) {
        View(frame).sample().into_iter().for_each(each);
    }
}

/// A message whose header is whole.
#[derive(Clone, Copy)]
struct View<'a>(&'a [u8]);

impl<'a> View<'a> {
    fn is_extended(self) -> bool {
        u8(self.0, 3) == EXTENDED
    }

    fn header(self) -> usize {
        if self.is_extended() { 6 } else { 4 }
    }

    fn data_length(self) -> usize {
        if self.is_extended() { be::u16(self.0, 4).into() } else { u8(self.0, 3).into() }
    }

    /// The packets, each by what it is and in which numbers, up to one that is cut.
    fn packets(self) -> impl Iterator<Item = Packet<'a>> {
        let data = self.0.get(self.header()..self.header() + self.data_length());
        let mut rest = data.unwrap_or_default();
        std::iter::from_fn(move || {
            let length = usize::from(*rest.get(2)?);
            let id = be::u16(rest, 0);
            let data = rest.get(3..3 + length)?;
            rest = rest.get(3 + length..)?;
            Some(Packet { id, data })
        })
    }

    fn sample(self) -> Option<Message> {
        let mut message = Message::default();
        let (mut angle, mut velocity) = (None, None);
        for packet in self.packets() {
            match packet.kind() {
                PACKET_COUNTER if packet.data.len() == 2 => {
                    let value = be::u16(packet.data, 0).into();
                    message.count = Some(Count { value, wraps_at: 1 << 16 });
                }
                SAMPLE_TIME_FINE if packet.data.len() == 4 => {
                    let value = be::u32(packet.data, 0).into();
                    message.ticks =
                        Some(Ticks { value, per_second: 10_000, wraps_at: Some(1 << 32) });
                }
                TEMPERATURE => message.celsius = packet.numbers().map(|[celsius]| celsius),
                ACCELERATION => message.accelerometer = packet.numbers(),
                RATE_OF_TURN => message.gyroscope = packet.numbers(),
                DELTA_V => velocity = packet.numbers(),
                DELTA_Q => angle = packet.numbers().and_then(rotation_vector),
                _ => {}
            }
        }
        if message.accelerometer.is_none() && message.gyroscope.is_none() {
            message.kind = Kind::Increments { over_s: None };
            (message.gyroscope, message.accelerometer) = (angle, velocity);
        }
        (message.accelerometer.is_some() || message.gyroscope.is_some()).then_some(message)
    }
}

/// A packet of data.
struct Packet<'a> {
    id: u16,
    data: &'a [u8],
}

impl Packet<'_> {
    /// What it is, without how its numbers are written and in which axes of the world.
    fn kind(&self) -> u16 {
        self.id & 0xFFF0
    }

    /// Its numbers, if it has so many.
    fn numbers<const N: usize>(&self) -> Option<[f64; N]> {
        const TWO_20: f64 = (1_u64 << 20) as f64;
        const TWO_32: f64 = (1_u64 << 32) as f64;
        type Number = fn(&[u8], usize) -> f64;
        let (size, number): (usize, Number) = match self.id & 3 {
            0 => (4, |data, at| be::f32(data, at).into()),
            1 => (4, |data, at| f64::from(be::i32(data, at)) / TWO_20),
            // The part behind the point goes first.
            2 => (6, |data, at| {
                f64::from(be::i16(data, at + 4)) + f64::from(be::u32(data, at)) / TWO_32
            }),
            _ => (8, be::f64),
        };
        let mut numbers = [0.0; N];
        for (i, place) in numbers.iter_mut().enumerate() {
            *place = number(self.data, i * size);
        }
        (self.data.len() == N * size).then_some(numbers)
    }
}

/// The rotation vector of a quaternion, real part first, of any length but 0.
fn rotation_vector([w, x, y, z]: [f64; 4]) -> Option<[f64; 3]> {
    let sine = (x * x + y * y + z * z).sqrt();
    // The shorter way around; and of no turn, the limit of angle over sine.
    let half = if w < 0.0 { (-sine).atan2(-w) } else { sine.atan2(w) };
    let factor = if sine > 0.0 { 2.0 * half / sine } else { 2.0 };
    let vector = [x * factor, y * factor, z * factor];
    (w * w + sine * sine > 0.0 && vector.iter().all(|v| v.is_finite())).then_some(vector)
}

/// The quaternion of a rotation vector.
fn quaternion([x, y, z]: [f64; 3]) -> [f64; 4] {
    let angle = (x * x + y * y + z * z).sqrt();
    let factor = if angle > 0.0 { (angle / 2.0).sin() / angle } else { 0.5 };
    [(angle / 2.0).cos(), x * factor, y * factor, z * factor]
}

/// Appends the MTData2 of a message, in doubles: PacketCounter and SampleTimeFine where it has them,
/// Acceleration and RateOfTurn or DeltaV and DeltaQ, Temperature.
pub fn encode(message: &Message, bytes: &mut Vec<u8>) {
    const DOUBLE: u16 = 3;
    let mut data = Vec::new();
    let mut packet = |id: u16, content: &[u8]| {
        data.extend_from_slice(&id.to_be_bytes());
        data.push(content.len() as u8);
        data.extend_from_slice(content);
    };
    let doubles = |values: &[f64]| values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>();
    if let Some(count) = message.count {
        packet(PACKET_COUNTER, &(count.value as u16).to_be_bytes());
    }
    if let Some(ticks) = message.ticks {
        packet(SAMPLE_TIME_FINE, &(ticks.in_units_of(10_000) as u32).to_be_bytes());
    }
    if let Some(celsius) = message.celsius {
        packet(TEMPERATURE | DOUBLE, &doubles(&[celsius]));
    }
    let is_rates = message.kind == Kind::Rates;
    if let Some(force) = message.accelerometer {
        packet(DOUBLE | if is_rates { ACCELERATION } else { DELTA_V }, &doubles(&force));
    }
    match message.gyroscope {
        Some(rate) if is_rates => packet(RATE_OF_TURN | DOUBLE, &doubles(&rate)),
        Some(angle) => packet(DELTA_Q | DOUBLE, &doubles(&quaternion(angle))),
        None => {}
    }
    let start = bytes.len();
    bytes.extend_from_slice(&[START, MASTER, MTDATA2, data.len() as u8]);
    bytes.extend_from_slice(&data);
    let sum = bytes.iter().skip(start + 1).fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    bytes.push(sum.wrapping_neg());
}

#[cfg(test)]
mod tests {
    use super::super::{Protocol, tests};
    use super::*;

    /// A message around this data.
    fn framed(data: &[u8], extended: bool) -> Vec<u8> {
        let mut bytes = vec![START, MASTER, MTDATA2];
        if extended {
            bytes.push(EXTENDED);
            bytes.extend_from_slice(&(data.len() as u16).to_be_bytes());
        } else {
            bytes.push(data.len() as u8);
        }
        bytes.extend_from_slice(data);
        let sum = bytes.iter().skip(1).fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        bytes.push(sum.wrapping_neg());
        bytes
    }

    /// Data that an MTi-300 sent and Xsens' MT Manager decoded, as published with a driver's tests.
    #[test]
    fn data_of_a_device() {
        let hex = "10 20 02 91 8D 10 60 04 01 36 3F A6 20 10 10 3F 35 E0 42 3F 31 CD 15 BD 9F 49 DB \
                   BD A9 38 CF 40 20 0C BD 63 5A 90 41 1D 08 D4 3E 5F AA 50 40 10 0C B9 11 68 00 3C \
                   C9 01 00 3A 0F 7D 00 40 30 0C BC 3B 29 80 3C 35 FC 00 3C A4 6E 00 80 20 0C 3C AE \
                   A2 41 BB 56 D8 00 BA D5 AC 01 80 30 10 3F 80 00 00 37 DF 88 01 B6 89 80 00 B6 08 \
                   C0 00 C0 20 0C BE FB FB F2 3F 33 C4 85 BF A0 A2 C1 08 10 04 42 16 80 00 30 10 04 \
                   00 01 86 E1 E0 20 04 00 40 00 03";
        let byte = |digits| u8::from_str_radix(digits, 16).unwrap();
        let data: Vec<u8> = hex.split_whitespace().map(byte).collect();
        for extended in [false, true] {
            let bytes = framed(&data, extended);
            let [message] = tests::decoded(Protocol::Xsens, &bytes).try_into().unwrap();
            let force = [-0.05550629, 9.81465530, 0.21842313];
            let rate = [0.02131760, -0.00327826, -0.00163019];
            // Half of the last digit that MT Manager printed.
            tests::assert_near(message.accelerometer, Some(force), 5e-9);
            tests::assert_near(message.gyroscope, Some(rate), 5e-9);
            assert_eq!(message.count, Some(Count { value: 37261, wraps_at: 1 << 16 }));
            assert_eq!(message.ticks.unwrap().value, 20_332_454);
            assert_eq!(message.celsius, Some(37.625));
            assert_eq!(message.kind, Kind::Rates);
        }
    }

    /// An answer to its configuration as published, and data that its packets do not fill.
    #[test]
    fn other_messages_are_refused() {
        let answer = [0xFA, 0xFF, 0x03, 0x04, 0x03, 0x70, 0x03, 0xF8, 0x8C];
        assert!(matches!(Xsens.check(&answer), Check::Not(_)));
        let whole = framed(&[0x10, 0x20, 2, 0, 7], false);
        assert_eq!(Xsens.check(&whole), Check::Whole(whole.len()));
        for cut in 0..whole.len() {
            let wanted = if cut == 0 { Check::Not(1) } else { Check::Short };
            assert_eq!(Xsens.check(&whole[..cut]), wanted);
        }
        for data in [&[0x10, 0x20, 2, 0, 7, 0][..], &[0x10, 0x20, 3, 0, 7][..]] {
            assert_eq!(Xsens.check(&framed(data, false)), Check::Damaged(1));
        }
    }

    /// −1.5 in the four ways of writing numbers.
    #[test]
    fn numbers_are_written_in_four_ways() {
        for (format, written) in [
            (0_u16, &(-1.5_f32).to_be_bytes()[..]),
            (1, &(-3_i32 << 19).to_be_bytes()[..]),
            (2, &[0x80, 0, 0, 0, 0xFF, 0xFE][..]),
            (3, &(-1.5_f64).to_be_bytes()[..]),
        ] {
            let mut data = (RATE_OF_TURN | format).to_be_bytes().to_vec();
            data.push(3 * written.len() as u8);
            data.extend(written.repeat(3));
            let bytes = framed(&data, false);
            let [message] = tests::decoded(Protocol::Xsens, &bytes).try_into().unwrap();
            assert_eq!(message.gyroscope, Some([-1.5; 3]), "format {format}");
        }
    }

    #[test]
    fn a_message_comes_back() {
        let mut sent = tests::message(6);
        for kind in [Kind::Rates, Kind::Increments { over_s: None }] {
            sent.kind = kind;
            let mut bytes = Vec::new();
            encode(&sent, &mut bytes);
            let [back] = tests::decoded(Protocol::Xsens, &bytes).try_into().unwrap();
            assert_eq!(back.kind, kind);
            assert_eq!(
                (back.accelerometer, back.count, back.celsius),
                (sent.accelerometer, sent.count, sent.celsius)
            );
            assert_eq!(back.ticks.unwrap().value, sent.ticks.unwrap().in_units_of(10_000));
            // A turn of a radian through a quaternion and back.
            tests::assert_near(back.gyroscope, sent.gyroscope, 4.0 * f64::EPSILON);
        }
    }
}
