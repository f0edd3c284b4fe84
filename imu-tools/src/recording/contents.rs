//! What the numbers of a recording being written are, where its format can say so.

use std::str::FromStr;

use serde::Deserialize;

/// What a sample says of the time since the one before.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum SampleKind {
    /// Rate and force at the instant of the stamp.
    #[default]
    Instantaneous,
    /// Their means over the interval that ends at the stamp.
    Mean,
    /// Their integrals over that interval: Δθ in rad, Δv in m/s, in body axes.
    Increments,
}

impl SampleKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Instantaneous, Self::Mean, Self::Increments];

    /// `instantaneous`, `mean` or `increments`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Instantaneous => "instantaneous",
            Self::Mean => "mean",
            Self::Increments => "increments",
        }
    }

    /// What a sample is, in words.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Instantaneous => "angular rate in rad/s, specific force in m/s^2",
            Self::Mean => {
                "angular rate in rad/s, specific force in m/s^2, means over the interval that ends \
                 at the stamp"
            }
            Self::Increments => {
                "increments of angle in rad and of velocity in m/s over the interval that ends at \
                 the stamp"
            }
        }
    }
}

impl FromStr for SampleKind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| "samples are instantaneous, mean or increments".into())
    }
}

/// What a recording to be written will hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contents {
    /// The kind of its samples.
    pub samples: SampleKind,
    /// With the temperature at each sample, where the format has a place for it: a CSV.
    pub temperature: bool,
}
