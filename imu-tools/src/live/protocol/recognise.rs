//! Which protocol a stream speaks, from a few kilobytes of it: the one whose frames make up most of it.

use super::{Decoder, Protocol};
use crate::recording::ReadOptions;

/// How well a protocol explains some bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The protocol.
    pub protocol: Protocol,
    /// The share of bytes that are whole frames of it, 0 to 1.
    pub accepted: f64,
    /// Whole frames.
    pub frames: u64,
    /// Messages of a sensor in them.
    pub messages: u64,
}

/// Fewer frames are chance.
const FEWEST_FRAMES: u64 = 2;

/// The protocol that these bytes speak, which may begin and end within a frame: the one of whose frames
/// more than half of them consist. `None` with a wrong baud rate, a protocol that is not read, or too
/// few bytes: [`candidates`] has the shares, none of them above a few per cent where the baud rate is
/// wrong.
#[must_use]
pub fn recognise(bytes: &[u8]) -> Option<Protocol> {
    let best = *candidates(bytes).first()?;
    (best.accepted > 0.5 && best.frames >= FEWEST_FRAMES).then_some(best.protocol)
}

/// All protocols, the one that explains these bytes best first.
#[must_use]
pub fn candidates(bytes: &[u8]) -> Vec<Candidate> {
    let options = ReadOptions::default();
    let mut all: Vec<Candidate> =
        Protocol::ALL.into_iter().filter_map(|p| candidate(p, &options, bytes)).collect();
    // The order of those that explain as much stays: first those with the stronger checksums.
    all.sort_by(|a, b| b.accepted.total_cmp(&a.accepted));
    all
}

/// How well one protocol does, with lines of text as `options` say; `None` where they are none for lines.
#[must_use]
pub fn candidate(protocol: Protocol, options: &ReadOptions, bytes: &[u8]) -> Option<Candidate> {
    let mut decoder = Decoder::new(protocol, options).ok()?;
    decoder.feed(bytes, &mut |_| {});
    let before_end = decoder.tally();
    decoder.end(&mut |_| {});
    let tally = decoder.tally();
    // A frame that is cut by the end is neither taken nor refused.
    let seen = tally.bytes - (tally.refused - before_end.refused).min(tally.bytes);
    let accepted = match seen {
        0 => 0.0,
        seen => (tally.bytes - tally.refused) as f64 / seen as f64,
    };
    Some(Candidate { protocol, accepted, frames: tally.frames, messages: tally.messages })
}
