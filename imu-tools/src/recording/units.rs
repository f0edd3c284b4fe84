//! Units of columns, by the names that people write for them.

use std::str::FromStr;

/// Nanoseconds in one unit of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUnit {
    /// s
    Seconds,
    /// ms
    Milliseconds,
    /// 100 µs, the tick of Xsens' SampleTimeFine
    HundredMicroseconds,
    /// µs
    Microseconds,
    /// ns
    Nanoseconds,
}

/// Unit of angular rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RateUnit {
    /// rad/s
    RadPerS,
    /// °/s
    DegPerS,
    /// °/h
    DegPerH,
    /// 0.001 °/s
    MilliDegPerS,
    /// 0.001 rad/s
    MilliRadPerS,
}

/// Unit of specific force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceUnit {
    /// m/s²
    MPerS2,
    /// Standard gravity, 9.80665 m/s²
    G,
    /// 0.001 g
    MilliG,
}

impl TimeUnit {
    /// Decimal digits between this unit and the nanosecond.
    pub fn exponent(self) -> u32 {
        match self {
            Self::Seconds => 9,
            Self::Milliseconds => 6,
            Self::HundredMicroseconds => 5,
            Self::Microseconds => 3,
            Self::Nanoseconds => 0,
        }
    }

    /// The unit with so many digits to the nanosecond.
    pub fn of_exponent(exponent: u32) -> Self {
        match exponent {
            9.. => Self::Seconds,
            6..9 => Self::Milliseconds,
            5 => Self::HundredMicroseconds,
            3..5 => Self::Microseconds,
            ..3 => Self::Nanoseconds,
        }
    }

    /// The unit's symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Seconds => "s",
            Self::Milliseconds => "ms",
            Self::HundredMicroseconds => "100 µs",
            Self::Microseconds => "µs",
            Self::Nanoseconds => "ns",
        }
    }
}

impl RateUnit {
    /// Multiply by this to get rad/s.
    pub fn to_rad_s(self) -> f64 {
        const DEGREE: f64 = std::f64::consts::PI / 180.0;
        match self {
            Self::RadPerS => 1.0,
            Self::DegPerS => DEGREE,
            Self::DegPerH => DEGREE / 3600.0,
            Self::MilliDegPerS => DEGREE / 1000.0,
            Self::MilliRadPerS => 1e-3,
        }
    }

    /// The unit of the mean of increments of angle that are written in this unit, over a second: rad/s of
    /// rad.
    ///
    /// # Errors
    /// When it is no unit of angle, in words.
    pub fn of_increment(name: &str) -> Result<Self, String> {
        Ok(match plain(name).as_str() {
            "rad" | "rads" | "radian" | "radians" => Self::RadPerS,
            "mrad" | "mrads" => Self::MilliRadPerS,
            "deg" | "degs" | "degree" | "degrees" | "°" => Self::DegPerS,
            "mdeg" | "m°" => Self::MilliDegPerS,
            "arcsec" | "arcsecond" | "arcseconds" => Self::DegPerH,
            _ => {
                return Err(format!(
                    "'{name}' is no unit of increments of angle: use rad, mrad, deg, mdeg or arcsec"
                ));
            }
        })
    }

    /// The unit's symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::RadPerS => "rad/s",
            Self::DegPerS => "deg/s",
            Self::DegPerH => "deg/h",
            Self::MilliDegPerS => "mdeg/s",
            Self::MilliRadPerS => "mrad/s",
        }
    }
}

impl ForceUnit {
    /// Multiply by this to get m/s².
    pub fn to_m_s2(self) -> f64 {
        match self {
            Self::MPerS2 => 1.0,
            Self::G => 9.80665,
            Self::MilliG => 9.80665e-3,
        }
    }

    /// The unit of the mean of increments of velocity that are written in this unit, over a second: m/s² of
    /// m/s.
    ///
    /// # Errors
    /// When it is no unit of velocity, in words.
    pub fn of_increment(name: &str) -> Result<Self, String> {
        Ok(match plain(name).as_str() {
            "m/s" | "ms-1" | "m/sec" | "mps" => Self::MPerS2,
            "gs" | "gsec" => Self::G,
            "mgs" | "mgsec" => Self::MilliG,
            _ => {
                return Err(format!(
                    "'{name}' is no unit of increments of velocity: use m/s, g s or mg s"
                ));
            }
        })
    }

    /// The unit's symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::MPerS2 => "m/s^2",
            Self::G => "g",
            Self::MilliG => "mg",
        }
    }
}

/// The name in lower case without blanks, `^`, `*`, `_` and brackets, with `/` for "per".
fn plain(name: &str) -> String {
    let lower = name.trim().trim_matches(|c| "[](){}".contains(c)).to_lowercase();
    let mut plain = String::new();
    for c in lower.chars() {
        match c {
            ' ' | '^' | '*' | '_' | '.' | '·' => {}
            '²' => plain.push('2'),
            '⁻' => plain.push('-'),
            '¹' => plain.push('1'),
            'μ' => plain.push('µ'),
            c => plain.push(c),
        }
    }
    plain.replace("per", "/")
}

impl FromStr for TimeUnit {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Ok(match plain(name).as_str() {
            "s" | "sec" | "secs" | "second" | "seconds" => Self::Seconds,
            "ms" | "msec" | "millisecond" | "milliseconds" => Self::Milliseconds,
            "100us" | "100µs" => Self::HundredMicroseconds,
            "us" | "µs" | "usec" | "microsecond" | "microseconds" => Self::Microseconds,
            "ns" | "nsec" | "nanosecond" | "nanoseconds" => Self::Nanoseconds,
            _ => return Err(format!("'{name}' is no unit of time: use s, ms, us or ns")),
        })
    }
}

impl FromStr for RateUnit {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Ok(match plain(name).as_str() {
            "rad/s" | "rads-1" | "rad/sec" | "rads" | "radps" => Self::RadPerS,
            "deg/s" | "degs-1" | "deg/sec" | "dps" | "°/s" | "°s-1" | "degs" => Self::DegPerS,
            "deg/h" | "degh-1" | "deg/hr" | "dph" | "°/h" | "°h-1" => Self::DegPerH,
            "mdeg/s" | "mdps" | "m°/s" => Self::MilliDegPerS,
            "mrad/s" | "mrads-1" => Self::MilliRadPerS,
            _ => {
                return Err(format!(
                    "'{name}' is no unit of angular rate: use rad/s, mrad/s, deg/s, mdeg/s or deg/h"
                ));
            }
        })
    }
}

impl FromStr for ForceUnit {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Ok(match plain(name).as_str() {
            "m/s2" | "ms-2" | "ms2" | "m/sec2" | "m/s/s" | "mps2" | "mss" => Self::MPerS2,
            "g" | "gn" | "g0" => Self::G,
            "mg" | "milli-g" | "millig" => Self::MilliG,
            _ => {
                return Err(format!("'{name}' is no unit of specific force: use m/s^2, g or mg"));
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_people_write() {
        assert_eq!("[ns]".parse(), Ok(TimeUnit::Nanoseconds));
        assert_eq!("µs".parse(), Ok(TimeUnit::Microseconds));
        assert_eq!("rad s^-1".parse(), Ok(RateUnit::RadPerS));
        assert_eq!("[deg/s]".parse(), Ok(RateUnit::DegPerS));
        assert_eq!("m s^-2".parse(), Ok(ForceUnit::MPerS2));
        assert_eq!("m/s²".parse(), Ok(ForceUnit::MPerS2));
        assert_eq!("G".parse(), Ok(ForceUnit::G));
        assert_eq!("deg per s".parse(), Ok(RateUnit::DegPerS));
        assert!("furlong".parse::<ForceUnit>().is_err());
    }

    #[test]
    fn symbols_are_read_back() {
        for unit in [RateUnit::RadPerS, RateUnit::DegPerS, RateUnit::DegPerH] {
            assert_eq!(unit.symbol().parse(), Ok(unit));
        }
        for unit in [ForceUnit::MPerS2, ForceUnit::G, ForceUnit::MilliG] {
            assert_eq!(unit.symbol().parse(), Ok(unit));
        }
        assert_eq!(TimeUnit::Microseconds.symbol().parse(), Ok(TimeUnit::Microseconds));
    }
}
