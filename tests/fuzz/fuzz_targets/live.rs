//! Any bytes in any pieces, through every decoder of a sensor: the pieces make no difference.
#![no_main]

use imu_tools::live::Message;
use imu_tools::live::protocol::{Decoder, Protocol, candidates};
use imu_tools::recording::ReadOptions;
use libfuzzer_sys::fuzz_target;

fn messages(protocol: Protocol, bytes: &[u8], piece: usize) -> Vec<Message> {
    let mut decoder = Decoder::new(protocol, &ReadOptions::default()).unwrap();
    let mut messages = Vec::new();
    for piece in bytes.chunks(piece) {
        decoder.feed(piece, &mut |message| messages.push(message));
    }
    decoder.end(&mut |message| messages.push(message));
    let tally = decoder.tally();
    assert_eq!(tally.bytes, bytes.len() as u64);
    assert!(tally.refused + tally.frames <= tally.bytes);
    assert_eq!(tally.messages, messages.len() as u64);
    // A frame is refused as a whole or by single bytes.
    assert!(tally.damaged <= tally.refused);
    messages
}

fuzz_target!(|bytes: &[u8]| {
    let Some((piece, bytes)) = bytes.split_first() else { return };
    for protocol in Protocol::ALL {
        let whole = messages(protocol, bytes, bytes.len().max(1));
        let pieces = messages(protocol, bytes, usize::from(*piece).max(1));
        // NaN is a number that a sensor may send.
        assert_eq!(format!("{whole:?}"), format!("{pieces:?}"), "{protocol}");
    }
    let shares = candidates(bytes);
    assert!(shares.iter().all(|candidate| (0.0..=1.0).contains(&candidate.accepted)));
});
