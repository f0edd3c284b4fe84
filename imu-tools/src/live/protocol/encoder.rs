//! Messages as a sensor would send them: for simulated sensors, and for tests.

use super::vectornav::{ascii, binary};
use super::{Protocol, imu_frame, mavlink, text, witmotion, xsens};
use crate::live::{Kind, Message};

/// Writes messages as frames of a protocol.
pub struct Encoder {
    protocol: Protocol,
    has_begun: bool,
}

impl Encoder {
    /// Of this protocol.
    #[must_use]
    pub fn new(protocol: Protocol) -> Self {
        Self { protocol, has_begun: false }
    }

    /// Whether the protocol has messages of this kind.
    #[must_use]
    pub fn can_send(protocol: Protocol, kind: Kind) -> bool {
        let rates_only = [Protocol::WitMotion, Protocol::Mavlink];
        kind == Kind::Rates || !rates_only.contains(&protocol)
    }

    /// Appends the frames of a message; nothing where [`Self::can_send`] is false. The first is preceded
    /// by what the protocol begins with.
    pub fn encode(&mut self, message: &Message, bytes: &mut Vec<u8>) {
        let is_first = !std::mem::replace(&mut self.has_begun, true);
        match self.protocol {
            Protocol::Text => {
                if is_first {
                    text::encode_header(message.kind, bytes);
                }
                text::encode(message, bytes);
            }
            Protocol::WitMotion => witmotion::encode(message, bytes),
            Protocol::VectorNavAscii => ascii::encode(message, bytes),
            Protocol::VectorNav => binary::encode(message, bytes),
            Protocol::Mavlink => mavlink::encode(message, bytes),
            Protocol::Xsens => xsens::encode(message, bytes),
            Protocol::ImuFrame => imu_frame::encode(message, bytes),
        }
    }
}
