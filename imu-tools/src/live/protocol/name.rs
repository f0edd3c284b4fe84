//! The protocols by name.

use std::fmt;
use std::str::FromStr;

/// A protocol that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Protocol {
    /// Lines of numbers.
    Text,
    /// WitMotion's frames that begin with 0x55.
    WitMotion,
    /// VectorNav's lines that begin with `$VN`.
    VectorNavAscii,
    /// VectorNav's binary frames.
    VectorNav,
    /// MAVLink, version 1 or 2.
    Mavlink,
    /// Xsens' MTData2.
    Xsens,
    /// Our own frame, which firmware sends.
    ImuFrame,
}

impl Protocol {
    /// All of them; those with the stronger checksums first.
    pub const ALL: [Self; 7] = [
        Self::ImuFrame,
        Self::Mavlink,
        Self::VectorNav,
        Self::VectorNavAscii,
        Self::Xsens,
        Self::WitMotion,
        Self::Text,
    ];

    /// As a flag names it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::WitMotion => "witmotion",
            Self::VectorNavAscii => "vectornav-ascii",
            Self::VectorNav => "vectornav",
            Self::Mavlink => "mavlink",
            Self::Xsens => "xsens",
            Self::ImuFrame => "imu-frame",
        }
    }
}

impl fmt::Display for Protocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Protocol {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let wanted = name.trim().to_lowercase().replace('_', "-");
        let found = Self::ALL.into_iter().find(|protocol| protocol.name() == wanted);
        found.ok_or_else(|| {
            let names: Vec<&str> = Self::ALL.into_iter().map(Self::name).collect();
            format!("'{name}' is no protocol that is read: use {}", names.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for protocol in Protocol::ALL {
            assert_eq!(protocol.to_string().parse(), Ok(protocol));
        }
        assert_eq!("IMU_Frame".parse(), Ok(Protocol::ImuFrame));
        let error = "nmea".parse::<Protocol>().unwrap_err();
        assert!(Protocol::ALL.iter().all(|protocol| error.contains(protocol.name())), "{error}");
    }
}
