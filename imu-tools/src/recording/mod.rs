//! Recordings: one format a file, one stream of samples out of all of them.
//!
//! A [`Source`] fills [`Block`]s with the samples of both sensors, in the order of the file, in SI
//! units, stamped in integer nanoseconds. The two sensors of a block are independent: each has its
//! own samples, rate and gaps.

/// One reading of one three-axis sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Nanoseconds since the epoch of the recording's clock.
    pub stamp_ns: i64,
    /// Angular rate in rad/s, or specific force in m/s², in sensor axes x, y, z.
    pub value: [f64; 3],
}

/// A stretch of a recording: what each sensor said in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Block {
    /// Angular rate, rad/s.
    pub gyroscope: Vec<Sample>,
    /// Specific force, m/s².
    pub accelerometer: Vec<Sample>,
}

impl Block {
    /// Empties both lists and keeps their memory.
    pub fn clear(&mut self) {
        self.gyroscope.clear();
        self.accelerometer.clear();
    }
}
