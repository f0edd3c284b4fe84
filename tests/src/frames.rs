//! Frames of sensors as a bad line delivers them: among garbage, damaged, cut, doubled, in any pieces.

use imu_tools::live::protocol::{Decoder, Encoder, Protocol};
use imu_tools::live::{Count, Kind, Message, Ticks};
use imu_tools::recording::ReadOptions;

/// What became of frames on a bad line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Frames sent as they should be.
    pub whole: u64,
    /// Of them, those whose message did not come.
    pub lost: u64,
    /// Of them, those before which another whole one went without garbage between.
    pub second_lost: u64,
    /// Messages that nobody sent: damage that no checksum found.
    pub invented: u64,
}

/// The `i`-th message of a sensor at 1 kHz.
#[must_use]
pub fn message(i: u32) -> Message {
    let part = f64::from(i % 4096) / 4096.0;
    Message {
        gyroscope: Some([part, -0.5, 0.25]),
        accelerometer: Some([1.0 - part, 0.125, 9.8125]),
        kind: Kind::Rates,
        ticks: Some(Ticks {
            value: 1_000_000_000 + u64::from(i) * 1_000_000,
            per_second: 1_000_000_000,
            wraps_at: None,
        }),
        count: Some(Count { value: i, wraps_at: 1 << 32 }),
        celsius: Some(21.5),
        ..Message::default()
    }
}

/// Well-mixed integers (Marsaglia 2003, xorshift).
struct Integers(u64);

impl Integers {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % end.max(1)
    }

    fn byte(&mut self) -> u8 {
        /// The bytes with which frames and their parts begin come more often than others.
        const STARTS: [u8; 14] =
            [0xA9, 0x56, 0x55, 0x51, 0xFA, 0xFF, 0x36, 0x05, 0xFD, 0xFE, b'$', b'V', b'N', b'\n'];
        match self.below(4) {
            0 => STARTS[self.below(STARTS.len())],
            _ => self.below(256) as u8,
        }
    }
}

/// Sends `frames` frames, of which one in four is damaged, or has garbage before it, followed by one that
/// has not.
///
/// # Panics
/// When the decoder does.
#[must_use]
pub fn bad_line(protocol: Protocol, frames: u32, seed: u64) -> Outcome {
    let mut integers = Integers(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let mut encoder = Encoder::new(protocol);
    let mut decoder = Decoder::new(protocol, &ReadOptions::default()).expect("no options");
    let mut outcome = Outcome::default();
    // What is decoded with every frame in its place, and whether it was sent so, first or second.
    let mut perfect = Decoder::new(protocol, &ReadOptions::default()).expect("no options");
    let (mut bytes, mut frame, mut sent, mut came) = (vec![], vec![], vec![], vec![]);
    let mut after_garbage = false;
    for i in 0..frames {
        frame.clear();
        encoder.encode(&message(i), &mut frame);
        let mut wanted = None;
        perfect.feed(&frame, &mut |message| wanted = Some(message));
        let is_damaged = i > 0 && !after_garbage && integers.below(4) == 0;
        if is_damaged {
            match integers.below(5) {
                0 => (0..=integers.below(100)).for_each(|_| bytes.push(integers.byte())),
                1 => {
                    let at = integers.below(frame.len());
                    frame[at] ^= 1 << integers.below(8);
                    wanted = None;
                }
                2 => {
                    frame.truncate(integers.below(frame.len()));
                    wanted = None;
                }
                3 => {
                    frame.insert(1 + integers.below(frame.len() - 1), integers.byte());
                    wanted = None;
                }
                _ => {
                    let twice = frame.get(..integers.below(frame.len())).unwrap_or_default();
                    bytes.extend_from_slice(twice);
                }
            }
        }
        bytes.extend_from_slice(&frame);
        sent.extend(wanted.map(|message| (message, is_damaged || after_garbage)));
        // Behind damage go two whole frames: one may be joined to it.
        after_garbage = is_damaged;
        let is_last = i + 1 == frames;
        if bytes.len() > 1 << 14 || is_last {
            let mut rest = bytes.as_slice();
            while !rest.is_empty() {
                let (piece, later) = rest.split_at((1 + integers.below(200)).min(rest.len()));
                decoder.feed(piece, &mut |message| came.push(message));
                rest = later;
            }
            bytes.clear();
        }
    }
    decoder.end(&mut |message| came.push(message));
    outcome.count(&sent, &came);
    outcome
}

impl std::ops::AddAssign for Outcome {
    fn add_assign(&mut self, other: Self) {
        self.whole += other.whole;
        self.lost += other.lost;
        self.second_lost += other.second_lost;
        self.invented += other.invented;
    }
}

impl Outcome {
    /// Compares what was sent with what came, in order.
    fn count(&mut self, sent: &[(Message, bool)], came: &[Message]) {
        /// How far ahead a message is looked for.
        const AHEAD: usize = 64;
        self.whole = sent.len() as u64;
        let mut next = 0;
        let miss = |outcome: &mut Self, missed: &[(Message, bool)]| {
            outcome.lost += missed.len() as u64;
            outcome.second_lost +=
                missed.iter().filter(|(_, near_damage)| !near_damage).count() as u64;
        };
        for message in came {
            let ahead = sent.get(next..(next + AHEAD).min(sent.len())).unwrap_or_default();
            match ahead.iter().position(|(wanted, _)| wanted == message) {
                Some(skipped) => {
                    miss(self, &ahead[..skipped]);
                    next += skipped + 1;
                }
                None => self.invented += 1,
            }
        }
        miss(self, sent.get(next..).unwrap_or_default());
    }
}
