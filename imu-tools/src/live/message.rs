//! What one message of a sensor says, in SI units, whatever the protocol.

/// One message of a sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Message {
    /// What the gyroscope said, where the message has it: rad/s, or rad if these are increments.
    pub gyroscope: Option<[f64; 3]>,
    /// What the accelerometer said, where the message has it: m/s², or m/s if these are increments.
    pub accelerometer: Option<[f64; 3]>,
    /// What the two are.
    pub kind: Kind,
    /// The sensor's own time.
    pub ticks: Option<Ticks>,
    /// The number of the message.
    pub count: Option<Count>,
    /// A thermometer in the sensor, degrees Celsius.
    pub celsius: Option<f64>,
    /// Which of a sender's streams it is of, where that may change: another has another rate, and nothing of
    /// its times is that of the one before.
    pub stream: u8,
}

/// What the numbers of a [`Message`] are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Kind {
    /// Angular rate and specific force.
    #[default]
    Rates,
    /// Their integrals Δθ and Δv since the message before this one.
    Increments {
        /// Over how many seconds, where the message says so.
        over_s: Option<f64>,
    },
}

/// A reading of a counter that counts time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ticks {
    /// What it shows.
    pub value: u64,
    /// Ticks in a second; never 0.
    pub per_second: u64,
    /// It goes on from 0 when it reaches this: 2³² of a counter of 32 bits. `None`: never.
    pub wraps_at: Option<u64>,
}

impl Ticks {
    /// The same time in ticks of another length, `per_second` of them: whole ones.
    #[must_use]
    pub fn in_units_of(self, per_second: u64) -> u64 {
        let value = u128::from(self.value) * u128::from(per_second);
        let value = value.checked_div(self.per_second.into()).unwrap_or(0);
        u64::try_from(value).unwrap_or(u64::MAX)
    }
}

/// A reading of a counter that counts messages (or samples of which every n-th is sent).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count {
    /// What it shows.
    pub value: u32,
    /// It goes on from 0 when it reaches this: 256 of a counter of 8 bits. Never 0.
    pub wraps_at: u64,
}
