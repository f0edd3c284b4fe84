//! What is known of the way from the sensor to here: bytes, frames, clock, losses.

/// The state of a link.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Link {
    /// The port, in words.
    pub name: String,
    /// The protocol, once it is known.
    pub protocol: Option<&'static str>,
    /// What was found out about the stream, or taken for granted.
    pub learnt: Option<String>,
    /// Why nothing comes now, if so: the device was unplugged.
    pub gone: Option<String>,
    /// The port is there, and for so long nothing came, s.
    pub silent_s: Option<f64>,
    /// What is wrong with what comes now, though it goes on; at the end also, what nobody could make out of it.
    pub amiss: Option<String>,
    /// Bytes that came.
    pub bytes: u64,
    /// Bytes of them that were part of no valid frame.
    pub refused: u64,
    /// Frames whose checksum was wrong.
    pub bad_checksums: u64,
    /// Messages with samples.
    pub messages: u64,
    /// What the clock found, where there is one.
    pub clock: Option<LinkClock>,
}

/// What the clock of a link found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkClock {
    /// Messages carry neither time nor count: theirs is when they came.
    pub by_arrival: bool,
    /// Messages a second.
    pub rate_hz: f64,
    /// Its standard deviation, Hz.
    pub rate_sd_hz: f64,
    /// How far arrivals scatter about the sensor's clock, s (rms).
    pub jitter_s: f64,
    /// Messages that did not come.
    pub lost: u64,
    /// Whether they were counted, and not guessed from arrivals.
    pub lost_is_certain: bool,
    /// Times that the sensor was switched on anew.
    pub restarts: u64,
}

impl Link {
    /// The share of bytes that were refused; 0 of none.
    #[must_use]
    pub fn refused_share(&self) -> f64 {
        if self.bytes == 0 { 0.0 } else { self.refused as f64 / self.bytes as f64 }
    }
}
