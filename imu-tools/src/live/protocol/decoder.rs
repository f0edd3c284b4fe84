//! A stream of bytes to messages, whatever the protocol.

use super::Protocol;
use super::framer::{Framer, Tally, Wire};
use super::imu_frame::ImuFrame;
use super::mavlink::Mavlink;
use super::text::Text;
use super::vectornav::ascii::Ascii;
use super::vectornav::binary::Binary;
use super::witmotion::WitMotion;
use super::xsens::Xsens;
use crate::error::Error;
use crate::live::Message;
use crate::recording::ReadOptions;

/// Takes the bytes of a sensor in pieces of any length, and hands out what they say.
pub struct Decoder {
    protocol: Protocol,
    stream: Box<dyn Stream>,
}

impl Decoder {
    /// Of this protocol. Of the options, those for tables tell what lines of text hold.
    ///
    /// # Errors
    /// When `options.columns` are no columns.
    pub fn new(protocol: Protocol, options: &ReadOptions) -> Result<Self, Error> {
        let stream: Box<dyn Stream> = match protocol {
            Protocol::Text => Box::new(Framer::new(Text::new(options)?)),
            Protocol::WitMotion => Box::new(Framer::new(WitMotion::default())),
            Protocol::VectorNavAscii => Box::new(Framer::new(Ascii)),
            Protocol::VectorNav => Box::new(Framer::new(Binary)),
            Protocol::Mavlink => Box::new(Framer::new(Mavlink::default())),
            Protocol::Xsens => Box::new(Framer::new(Xsens)),
            Protocol::ImuFrame => Box::new(Framer::new(ImuFrame)),
        };
        Ok(Self { protocol, stream })
    }

    /// What it reads.
    #[must_use]
    pub fn protocol(&self) -> Protocol {
        self.protocol
    }

    /// Takes bytes in; messages go to `each` as soon as they are whole. Nothing is allocated, except where
    /// lines of text have letters, which may be a header.
    pub fn feed(&mut self, bytes: &[u8], each: &mut dyn FnMut(Message)) {
        self.stream.feed(bytes, each);
    }

    /// Ends the stream, or a stretch of it: what waits for more bytes is looked through.
    pub fn end(&mut self, each: &mut dyn FnMut(Message)) {
        self.stream.end(each);
    }

    /// What came so far.
    #[must_use]
    pub fn tally(&self) -> Tally {
        self.stream.tally()
    }

    /// What was found out about the stream, or taken for granted: a sentence for the user, that may
    /// change.
    #[must_use]
    pub fn learnt(&self) -> Option<&str> {
        self.stream.learnt()
    }
}

/// A framer of any protocol.
trait Stream: Send {
    fn feed(&mut self, bytes: &[u8], each: &mut dyn FnMut(Message));
    fn end(&mut self, each: &mut dyn FnMut(Message));
    fn tally(&self) -> Tally;
    fn learnt(&self) -> Option<&str>;
}

impl<W: Wire> Stream for Framer<W> {
    fn feed(&mut self, bytes: &[u8], each: &mut dyn FnMut(Message)) {
        Self::feed(self, bytes, each);
    }

    fn end(&mut self, each: &mut dyn FnMut(Message)) {
        Self::end(self, each);
    }

    fn tally(&self) -> Tally {
        Self::tally(self)
    }

    fn learnt(&self) -> Option<&str> {
        Self::learnt(self)
    }
}
