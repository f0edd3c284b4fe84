//! What a thermometer said over a recording: biases follow temperature.

use serde::{Deserialize, Serialize};

use crate::recording::Temperature;

/// Temperatures of a recording, °C.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
pub struct TemperatureRange {
    /// The first reading.
    pub first: f64,
    /// The last one.
    pub last: f64,
    /// The lowest.
    pub low: f64,
    /// The highest.
    pub high: f64,
    /// How many there are.
    pub readings: u64,
}

/// Takes readings as they come.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub(super) struct Thermometer(Option<TemperatureRange>);

impl Thermometer {
    pub(super) fn push(&mut self, readings: &[Temperature]) {
        for celsius in readings.iter().map(|r| r.celsius).filter(|celsius| celsius.is_finite()) {
            let range = self.0.get_or_insert(TemperatureRange {
                first: celsius,
                last: celsius,
                low: celsius,
                high: celsius,
                readings: 0,
            });
            range.last = celsius;
            range.low = range.low.min(celsius);
            range.high = range.high.max(celsius);
            range.readings += 1;
        }
    }

    /// `None` without a reading.
    pub(super) fn range(&self) -> Option<TemperatureRange> {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_of_what_can_be_read() {
        let mut thermometer = Thermometer::default();
        assert_eq!(thermometer.range(), None);
        let reading = |celsius| Temperature { stamp_ns: 0, celsius };
        thermometer.push(&[reading(f64::NAN), reading(25.0), reading(31.5)]);
        thermometer.push(&[reading(24.0)]);
        let range =
            TemperatureRange { first: 25.0, last: 24.0, low: 24.0, high: 31.5, readings: 3 };
        assert_eq!(thermometer.range(), Some(range));
    }
}
