//! From bytes to frames, for every protocol: bytes come in pieces of any length, frames go out whole.
//!
//! A protocol says of the bytes at hand whether a frame begins there ([`Check`]). Where none does, or
//! its checksum is wrong, as many bytes are given up as cannot begin a frame, for a binary protocol
//! one, and the next is looked at: a start that is none, or a damaged frame, never takes the frame
//! behind it along. Bytes wait in one buffer that is made once; nothing is allocated later.

use crate::live::Message;

/// What a protocol sees at the start of the bytes at hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// Perhaps a frame: more bytes are needed to tell.
    Short,
    /// A frame of so many bytes, its checksum right.
    Whole(usize),
    /// No frame begins in the first so many bytes; at least 1.
    Not(usize),
    /// A frame that ends where it should, with a wrong checksum: its first so many bytes are given up;
    /// at least 1.
    Damaged(usize),
}

/// A protocol, to a [`Framer`].
pub trait Wire: Send {
    /// Bytes of the longest frame: [`Check::Short`] of so many bytes counts as no frame.
    const LONGEST: usize;

    /// What begins here.
    fn check(&self, bytes: &[u8]) -> Check;

    /// Takes a frame that [`Wire::check`] found whole; what it says goes to `each`.
    fn take(&mut self, frame: &[u8], each: &mut dyn FnMut(Message));

    /// Hears that bytes were given up here, or that the stream ended: a message that waits for
    /// another frame waits no longer.
    fn broken(&mut self, _refused: &[u8], _each: &mut dyn FnMut(Message)) {}

    /// What was found out about the stream, or taken for granted, where that is worth a sentence.
    fn learnt(&self) -> Option<&str> {
        None
    }
}

/// What came so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Bytes fed.
    pub bytes: u64,
    /// Of them, those that were given up; those that still wait are not among them.
    pub refused: u64,
    /// Whole frames, of any kind.
    pub frames: u64,
    /// Frames with a wrong checksum.
    pub damaged: u64,
    /// Messages handed out.
    pub messages: u64,
}

/// Finds the frames of a protocol in a stream.
pub struct Framer<W> {
    wire: W,
    buffer: Box<[u8]>,
    /// Where the bytes at hand begin and end in the buffer.
    start: usize,
    end: usize,
    tally: Tally,
}

impl<W: Wire> Framer<W> {
    /// Before the first byte.
    pub fn new(wire: W) -> Self {
        let buffer = vec![0; 2 * W::LONGEST].into_boxed_slice();
        Self { wire, buffer, start: 0, end: 0, tally: Tally::default() }
    }

    /// Takes bytes in; messages go to `each` as soon as they are whole.
    pub fn feed(&mut self, mut bytes: &[u8], each: &mut dyn FnMut(Message)) {
        self.tally.bytes += bytes.len() as u64;
        while !bytes.is_empty() {
            // What waits is shorter than a frame, so that at least as much finds room.
            self.buffer.copy_within(self.start..self.end, 0);
            (self.start, self.end) = (0, self.end - self.start);
            let room = self.buffer.get_mut(self.end..).unwrap_or_default();
            let (now, later) = bytes.split_at(room.len().min(bytes.len()));
            for (place, byte) in room.iter_mut().zip(now) {
                *place = *byte;
            }
            self.end += now.len();
            bytes = later;
            self.look(false, each);
        }
    }

    /// Ends the stream: what waits for more bytes waits no longer, and is looked through.
    pub fn end(&mut self, each: &mut dyn FnMut(Message)) {
        self.look(true, each);
        let mut counted = Counted { messages: &mut self.tally.messages, each };
        self.wire.broken(&[], &mut |message| counted.hand(message));
    }

    /// What came so far.
    pub fn tally(&self) -> Tally {
        self.tally
    }

    /// What was found out about the stream.
    pub fn learnt(&self) -> Option<&str> {
        self.wire.learnt()
    }

    /// Takes all frames at hand. `last`: no more bytes will come.
    fn look(&mut self, last: bool, each: &mut dyn FnMut(Message)) {
        loop {
            let at_hand = self.buffer.get(self.start..self.end).unwrap_or_default();
            if at_hand.is_empty() {
                return;
            }
            let found = match self.wire.check(at_hand) {
                Check::Short if last || at_hand.len() >= W::LONGEST => Check::Not(1),
                found => found,
            };
            let mut counted = Counted { messages: &mut self.tally.messages, each };
            let each = &mut |message| counted.hand(message);
            let given_up = match found {
                Check::Short => return,
                Check::Whole(length) => {
                    let length = length.clamp(1, at_hand.len());
                    self.tally.frames += 1;
                    self.wire.take(at_hand.get(..length).unwrap_or_default(), each);
                    self.start += length;
                    continue;
                }
                Check::Not(length) => length,
                Check::Damaged(length) => {
                    self.tally.damaged += 1;
                    length
                }
            };
            let length = given_up.clamp(1, at_hand.len());
            self.tally.refused += length as u64;
            self.wire.broken(at_hand.get(..length).unwrap_or_default(), each);
            self.start += length;
        }
    }
}

/// Counts messages on their way.
struct Counted<'a> {
    messages: &'a mut u64,
    each: &'a mut dyn FnMut(Message),
}

impl Counted<'_> {
    fn hand(&mut self, message: Message) {
        *self.messages += 1;
        (self.each)(message);
    }
}

/// Bytes before the next one of this value: none of them begins a frame. At least 1.
pub fn not_before(start: u8, bytes: &[u8]) -> Check {
    let rest = bytes.get(1..).unwrap_or_default();
    Check::Not(1 + memchr::memchr(start, rest).unwrap_or(rest.len()))
}
