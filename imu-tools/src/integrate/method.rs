//! The rules by name, and which samples each of them takes.

use std::fmt;
use std::str::FromStr;

/// What a sample says of the time since the one before. It decides more than the rule: the mean over an interval
/// belongs to the middle of it, a sample of an instant to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Rate and force at the instant of the stamp.
    Instantaneous,
    /// Their means over the interval that ends at the stamp, or increments divided by its length.
    Mean,
}

impl Kind {
    /// `instantaneous` or `mean`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Instantaneous => "instantaneous",
            Self::Mean => "mean",
        }
    }

    /// The rules that take such samples, in the order of tables.
    pub fn methods(self) -> impl Iterator<Item = Method> {
        Method::ALL.into_iter().filter(move |method| method.kind() == self)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A rule of [`imu_core::integrate`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// [`imu_core::integrate::Euler`].
    Euler,
    /// [`imu_core::integrate::Midpoint`].
    Midpoint,
    /// [`imu_core::integrate::ConingSculling`].
    ConingSculling,
    /// [`imu_core::integrate::ThreeSample`].
    ThreeSample,
    /// [`imu_core::integrate::TextbookEuler`].
    TextbookEuler,
    /// [`imu_core::integrate::TextbookMidpoint`].
    TextbookMidpoint,
    /// [`imu_core::integrate::TwoSample`].
    TwoIncrements,
    /// [`imu_core::integrate::PreviousIncrement`].
    PreviousIncrement,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::TextbookEuler,
        Self::Euler,
        Self::TextbookMidpoint,
        Self::Midpoint,
        Self::ConingSculling,
        Self::ThreeSample,
        Self::PreviousIncrement,
        Self::TwoIncrements,
    ];

    /// Its name on the command line and in file names.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Euler => "euler",
            Self::Midpoint => "midpoint",
            Self::ConingSculling => "coning-sculling",
            Self::ThreeSample => "three-sample",
            Self::TextbookEuler => "textbook-euler",
            Self::TextbookMidpoint => "textbook-midpoint",
            Self::TwoIncrements => "two-increments",
            Self::PreviousIncrement => "previous-increment",
        }
    }

    /// The samples that it takes.
    #[must_use]
    pub const fn kind(self) -> Kind {
        match self {
            Self::TwoIncrements | Self::PreviousIncrement => Kind::Mean,
            _ => Kind::Instantaneous,
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Method {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|method| method.name() == name).ok_or_else(|| {
            let names: Vec<&str> = Self::ALL.iter().map(|method| method.name()).collect();
            format!("rules are all, {}", names.join(", "))
        })
    }
}
