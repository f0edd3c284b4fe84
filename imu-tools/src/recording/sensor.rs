//! The two sensors of an IMU.

/// One of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// Of angular rate.
    Gyroscope,
    /// Of specific force.
    Accelerometer,
}

impl Sensor {
    /// Both, in the order in which everything here names them.
    pub const BOTH: [Self; 2] = [Self::Gyroscope, Self::Accelerometer];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gyroscope => "gyroscope",
            Self::Accelerometer => "accelerometer",
        }
    }
}
