//! What holds for every protocol: pieces of any length, garbage, damage, recognition.

use super::{Decoder, Encoder, Protocol, candidates, recognise};
use crate::live::{Count, Kind, Message, Ticks};
use crate::recording::ReadOptions;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

/// A message with all that a protocol may carry, its values exact as singles; the `i`-th of many.
pub fn message(i: u32) -> Message {
    let part = f64::from(i % 1000) / 1024.0;
    Message {
        gyroscope: Some([0.25 + part, -0.5, 1.0 / 1024.0]),
        accelerometer: Some([-part, 0.125, 9.8125]),
        kind: Kind::Rates,
        ticks: Some(Ticks {
            value: 1_000_000_000 + u64::from(i) * 1_000_000,
            per_second: 1_000_000_000,
            wraps_at: None,
        }),
        count: Some(Count { value: i & 0xFFFF, wraps_at: 1 << 16 }),
        celsius: Some(21.5),
        ..Message::default()
    }
}

pub fn decoded(protocol: Protocol, bytes: &[u8]) -> Vec<Message> {
    decoded_with(protocol, &ReadOptions::default(), bytes)
}

/// All messages of bytes fed at once.
pub fn decoded_with(protocol: Protocol, options: &ReadOptions, bytes: &[u8]) -> Vec<Message> {
    in_pieces(protocol, options, bytes, bytes.len().max(1))
}

/// All messages of bytes fed in pieces.
pub fn in_pieces(
    protocol: Protocol,
    options: &ReadOptions,
    bytes: &[u8],
    piece: usize,
) -> Vec<Message> {
    let mut decoder = Decoder::new(protocol, options).unwrap();
    let mut messages = Vec::new();
    for piece in bytes.chunks(piece) {
        decoder.feed(piece, &mut |message| messages.push(message));
    }
    decoder.end(&mut |message| messages.push(message));
    let tally = decoder.tally();
    assert_eq!((tally.bytes, tally.messages), (bytes.len() as u64, messages.len() as u64));
    assert!(tally.refused <= tally.bytes);
    messages
}

pub fn assert_near(found: Option<[f64; 3]>, wanted: Option<[f64; 3]>, tolerance: f64) {
    let pairs = found.unwrap().into_iter().zip(wanted.unwrap());
    let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off <= tolerance * (1.0 + 1e-9), "{off} is more than {tolerance}");
}

/// So many messages as one stream.
fn stream(protocol: Protocol, messages: u32) -> Vec<u8> {
    let mut encoder = Encoder::new(protocol);
    let mut bytes = Vec::new();
    (0..messages).for_each(|i| encoder.encode(&message(i), &mut bytes));
    bytes
}

#[test]
fn pieces_of_any_length_give_the_same() {
    for protocol in Protocol::ALL {
        let bytes = stream(protocol, 12);
        let whole = decoded(protocol, &bytes);
        assert_eq!(whole.len(), 12, "{protocol}");
        for piece in 1..bytes.len() {
            let pieces = in_pieces(protocol, &ReadOptions::default(), &bytes, piece);
            assert_eq!(pieces, whole, "{protocol} in pieces of {piece}");
        }
    }
}

#[test]
fn a_stream_is_recognised_from_anywhere() {
    for protocol in Protocol::ALL {
        let mut bytes = stream(protocol, 60);
        if protocol == Protocol::Text {
            // Without a header, rows are still recognised as text.
            let header = bytes.iter().position(|byte| *byte == b'\n').unwrap();
            bytes.drain(..=header);
        }
        for cut in 0..150 {
            let part = &bytes[cut..bytes.len() - cut / 2];
            assert_eq!(recognise(part), Some(protocol), "from {cut} on: {:?}", candidates(part));
        }
    }
}

/// A line at a wrong baud rate gives bytes that are none of the sender's.
#[test]
fn noise_is_not_recognised() {
    let mut runner = TestRunner::deterministic();
    let noise = prop::collection::vec(any::<u8>(), 4096);
    runner
        .run(&noise, |noise| {
            prop_assert_eq!(recognise(&noise), None);
            let best = candidates(&noise)[0];
            prop_assert!(best.accepted < 0.1, "{:?}", best);
            Ok(())
        })
        .unwrap();
}

/// Every frame behind garbage is found. The sums of eight bits of some protocols let one start in 256
/// pass that is none, and what it covers is lost: hence "within two frames".
#[test]
fn what_is_behind_garbage_is_found_within_two_frames() {
    for protocol in Protocol::ALL {
        let mut runner = TestRunner::new_with_rng(
            Config { cases: 2000, failure_persistence: None, ..Config::default() },
            proptest::test_runner::TestRng::deterministic_rng(Default::default()),
        );
        let header = stream(protocol, 1);
        let frames: Vec<u8> = stream(protocol, 5)[header.len()..].to_vec();
        let garbage = prop::collection::vec(any::<u8>(), 0..120);
        runner
            .run(&garbage, |garbage| {
                let bytes: Vec<u8> =
                    [header.as_slice(), garbage.as_slice(), frames.as_slice()].concat();
                let messages = decoded(protocol, &bytes);
                for wanted in decoded(protocol, &stream(protocol, 5)).iter().skip(3) {
                    prop_assert!(messages.contains(wanted), "{} lost {:?}", protocol, wanted);
                }
                Ok(())
            })
            .unwrap();
    }
}

/// A frame with a byte changed, cut short, doubled or left out takes no other along.
#[test]
fn a_damaged_frame_is_lost_alone() {
    for protocol in Protocol::ALL {
        let header_and_three = stream(protocol, 3).len();
        let four = stream(protocol, 4).len();
        let bytes = stream(protocol, 8);
        let whole = decoded(protocol, &bytes);
        for at in header_and_three..four {
            // A changed digit of a line of text may be a digit again, and is not found.
            let mut changed = bytes.clone();
            changed[at] ^= 0x80;
            let mut cut = bytes.clone();
            cut.remove(at);
            for (what, damaged) in [("changed", changed), ("cut", cut)] {
                let messages = decoded(protocol, &damaged);
                let others = || whole.iter().enumerate().filter(|(i, _)| *i != 3).map(|(_, m)| m);
                // Where a frame's end is gone, the one behind it may be joined to it as a line.
                let lost = others().filter(|wanted| !messages.contains(wanted)).count();
                let allowed = usize::from(protocol == Protocol::Text && at + 1 == four);
                assert!(lost <= allowed, "{protocol}: byte {at} {what}: {lost} others lost");
            }
        }
    }
}
