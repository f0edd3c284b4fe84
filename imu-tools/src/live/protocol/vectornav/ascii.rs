//! VectorNav's lines of text: `$VNIMU,…*66`.
//!
//! The checksum, behind the asterisk, is the exclusive or of all bytes between dollar and asterisk in two
//! digits, or their CRC-16 in four. IMU, YMR, QMR, MAR, ACC and GYR are read, and DTV as increments (angles in
//! degrees). There is neither time nor count in them; what the option "serial status" appends is not
//! read. ISL and ISE are not read: UM004's table of their fields contradicts the example beside it.

use super::crc;
use crate::live::protocol::framer::{Check, Wire, not_before};
use crate::live::{Kind, Message};
use crate::recording::csv::number;

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Lines that begin with `$VN`.
pub struct Ascii;

impl Wire for Ascii {
    const LONGEST: usize = 320;

    fn check(&self, bytes: &[u8]) -> Check {
        const START: &[u8] = b"$VN";
        // More may be at hand, or not: that must make no difference.
        let bytes = bytes.get(..Self::LONGEST).unwrap_or(bytes);
        if !START.starts_with(bytes) && !bytes.starts_with(START) {
            return not_before(b'$', bytes);
        }
        let stops = |byte: &u8| matches!(byte, b'$' | b'\n') || !(b' '..=b'~').contains(byte);
        let rest = bytes.get(1..).unwrap_or_default();
        let Some(length) = rest.iter().position(|byte| *byte != b'\r' && stops(byte)) else {
            return Check::Short;
        };
        // No frame begins before the next dollar.
        match rest.get(length) {
            Some(b'\n') => {}
            Some(b'$') => return Check::Not(1 + length),
            _ => return Check::Not(2 + length),
        }
        let line = rest.get(..length).unwrap_or_default().trim_ascii_end();
        let whole = length + 2;
        if is_right(line) { Check::Whole(whole) } else { Check::Damaged(whole) }
    }

    fn take(&mut self, frame: &[u8], each: &mut dyn FnMut(Message)) {
        View::of(frame).and_then(|view| view.sample()).into_iter().for_each(each);
    }
}

/// Whether the checksum at the end of a line, without its dollar, is that of the line.
fn is_right(line: &[u8]) -> bool {
    let Some(asterisk) = memchr::memrchr(b'*', line) else { return false };
    let (said, sum) = line.split_at(asterisk);
    let sum = sum.get(1..).unwrap_or_default();
    let Ok(digits) = std::str::from_utf8(sum) else { return false };
    let Ok(value) = u16::from_str_radix(digits, 16) else { return false };
    match sum.len() {
        2 => value == said.iter().fold(0, |sum, byte| sum ^ u16::from(*byte)),
        4 => value == crc(said),
        _ => false,
    }
}

/// A checked line.
struct View<'a> {
    header: &'a [u8],
    fields: &'a [u8],
}

impl<'a> View<'a> {
    fn of(frame: &'a [u8]) -> Option<Self> {
        let asterisk = memchr::memrchr(b'*', frame)?;
        let header = frame.get(3..6)?;
        Some(Self { header, fields: frame.get(7..asterisk)? })
    }

    /// The number in a field, counted from 0.
    fn number(&self, field: usize) -> Option<f64> {
        number::value(self.fields.split(|byte| *byte == b',').nth(field)?)
    }

    /// The three numbers from a field on, times `unit`.
    fn vector(&self, field: usize, unit: f64) -> Option<[f64; 3]> {
        let at = |axis| self.number(field + axis).map(|value| value * unit);
        Some([at(0)?, at(1)?, at(2)?])
    }

    fn sample(&self) -> Option<Message> {
        let of =
            |acceleration: Option<usize>, rate: Option<usize>, celsius: Option<usize>| Message {
                accelerometer: acceleration.and_then(|at| self.vector(at, 1.0)),
                gyroscope: rate.and_then(|at| self.vector(at, 1.0)),
                celsius: celsius.and_then(|at| self.number(at)),
                ..Message::default()
            };
        let message = match self.header {
            b"IMU" => of(Some(3), Some(6), Some(9)),
            b"YMR" => of(Some(6), Some(9), None),
            b"QMR" => of(Some(7), Some(10), None),
            b"MAR" => of(Some(3), Some(6), None),
            b"ACC" => of(Some(0), None, None),
            b"GYR" => of(None, Some(0), None),
            b"DTV" => Message {
                gyroscope: self.vector(1, DEGREE),
                accelerometer: self.vector(4, 1.0),
                kind: Kind::Increments { over_s: self.number(0).filter(|over| *over > 0.0) },
                ..Message::default()
            },
            _ => return None,
        };
        (message.gyroscope.is_some() || message.accelerometer.is_some()).then_some(message)
    }
}

/// Appends the line of a message, with the digits that the manual's examples have.
pub fn encode(message: &Message, bytes: &mut Vec<u8>) {
    let force = |[x, y, z]: [f64; 3]| format!(",{x:+07.3},{y:+07.3},{z:+07.3}");
    let rate = |[x, y, z]: [f64; 3]| format!(",{x:+010.6},{y:+010.6},{z:+010.6}");
    let said = match (message.kind, message.gyroscope, message.accelerometer) {
        (_, None, None) => return,
        (Kind::Increments { over_s }, angle, velocity) => {
            let [x, y, z] = angle.unwrap_or_default().map(|angle| angle / DEGREE);
            let over = over_s.unwrap_or(0.0);
            let angle = format!(",{x:+09.4},{y:+09.4},{z:+09.4}");
            let [x, y, z] = velocity.unwrap_or_default();
            format!("VNDTV,{over:+09.6}{angle},{x:+09.4},{y:+09.4},{z:+09.4}")
        }
        (Kind::Rates, Some(turning), None) => format!("VNGYR{}", rate(turning)),
        (Kind::Rates, None, Some(felt)) => format!("VNACC{}", force(felt)),
        (Kind::Rates, Some(turning), Some(felt)) => {
            let celsius = message.celsius.unwrap_or(0.0);
            let magnet = ",+00.0000,+00.0000,+00.0000";
            format!("VNIMU{magnet}{}{},{celsius:+05.1},+000.000", force(felt), rate(turning))
        }
    };
    let sum = said.bytes().fold(0, |sum, byte| sum ^ byte);
    bytes.extend_from_slice(format!("${said}*{sum:02X}\r\n").as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::protocol::{Protocol, tests};
    use crate::recording::ReadOptions;

    /// Lines of devices as quoted in VectorNav's own library and in users' programs.
    #[test]
    fn lines_of_devices() {
        let text = "$VNIMU,-00.0350,+00.4222,-00.6643,-00.015,+00.019,+09.948,+00.002066,-00.008442,\
                    -00.044656,+20.7,+084.322*66\r\n\
                    $VNYMR,+100.949,-007.330,+000.715,-00.0049,-00.2449,+00.5397,-01.258,-00.100,\
                    -09.701,-00.000018,+00.001122,-00.000551*69\r\n\
                    $VNYMR,+104.977,+004.548,-001.276,-00.8012,-02.7376,+01.0070,+00.837,+00.235,\
                    -10.414,-00.002081,-00.001151,+00.002113*61\r\n";
        let [imu, first, second] =
            tests::decoded(Protocol::VectorNavAscii, text.as_bytes()).try_into().unwrap();
        assert_eq!(imu.accelerometer, Some([-0.015, 0.019, 9.948]));
        assert_eq!(imu.gyroscope, Some([0.002066, -0.008442, -0.044656]));
        assert_eq!(imu.celsius, Some(20.7));
        assert_eq!(first.accelerometer, Some([-1.258, -0.1, -9.701]));
        assert_eq!(second.gyroscope, Some([-0.002081, -0.001151, 0.002113]));
    }

    /// A line is as long however much of what follows it is at hand.
    #[test]
    fn a_line_is_no_longer_in_a_piece_than_in_many() {
        for (padding, wanted) in [(300, 1), (303, 1), (304, 0), (330, 0)] {
            let said = format!("VNGYR,{}1,2,3", "0".repeat(padding));
            let sum = said.bytes().fold(0, |sum, byte| sum ^ byte);
            let line = format!("${said}*{sum:02X}\r\n");
            for piece in [1, 100, line.len()] {
                let options = ReadOptions::default();
                let protocol = Protocol::VectorNavAscii;
                let messages = tests::in_pieces(protocol, &options, line.as_bytes(), piece);
                assert_eq!(messages.len(), wanted, "{padding} {piece}");
            }
        }
    }

    /// UM004, register 80, its numbers with the checksum of an asynchronous line.
    #[test]
    fn increments_are_in_degrees() {
        let said = b"VNDTV,+0.665016,-000.119,-000.409,-000.025,+000.011,-000.084,-006.702";
        let line = format!("${}*{:04X}\r\n", String::from_utf8_lossy(said), crc(said));
        let [message] =
            tests::decoded(Protocol::VectorNavAscii, line.as_bytes()).try_into().unwrap();
        assert_eq!(message.kind, Kind::Increments { over_s: Some(0.665016) });
        assert_eq!(message.gyroscope, Some([-0.119, -0.409, -0.025].map(|angle| angle * DEGREE)));
        assert_eq!(message.accelerometer, Some([0.011, -0.084, -6.702]));
    }

    #[test]
    fn a_message_comes_back_to_half_a_digit() {
        let mut sent = tests::message(4);
        let back = |sent: &Message| {
            let mut bytes = Vec::new();
            encode(sent, &mut bytes);
            let [back] = tests::decoded(Protocol::VectorNavAscii, &bytes).try_into().unwrap();
            back
        };
        for kind in [Kind::Rates, Kind::Increments { over_s: Some(0.005) }] {
            sent.kind = kind;
            let back = back(&sent);
            let (rate, force) =
                if kind == Kind::Rates { (5e-7, 5e-4) } else { (5e-5 * DEGREE, 5e-5) };
            tests::assert_near(back.gyroscope, sent.gyroscope, rate);
            tests::assert_near(back.accelerometer, sent.accelerometer, force);
            assert_eq!(back.kind, kind);
        }
        sent.kind = Kind::Rates;
        let alone = back(&Message { accelerometer: None, ..sent });
        assert_eq!((alone.accelerometer, alone.gyroscope.is_some()), (None, true));
    }
}
