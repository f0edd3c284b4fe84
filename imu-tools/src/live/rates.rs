//! Messages to samples in rad/s and m/s²: increments divided by the time that the sensor took for them.
//!
//! What comes out is a mean over the interval that ends at the stamp, as
//! [`SampleKind::Mean`](crate::recording::SampleKind::Mean) says. The interval is the message's own where
//! it has one, else what the clock found. An increment covers the time since the message before it, lost
//! or not: what lost messages held is lost, so the interval is not longer behind a gap.

use super::clock::Taken;
use super::{Kind, Message};
use crate::recording::Sample;

/// What a message's gyroscope and accelerometer say at its stamp, where it has them.
#[must_use]
pub fn rates(message: &Message, taken: &Taken) -> (Option<Sample>, Option<Sample>) {
    let interval_s = match message.kind {
        Kind::Rates => 1.0,
        Kind::Increments { over_s } => {
            over_s.filter(|s| s.is_finite() && *s > 0.0).unwrap_or(taken.interval_s)
        }
    };
    let sample =
        |value: [f64; 3]| Sample { stamp_ns: taken.stamp_ns, value: value.map(|x| x / interval_s) };
    (message.gyroscope.map(sample), message.accelerometer.map(sample))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn increments_are_divided_by_their_interval_and_rates_are_not() {
        let taken = Taken { stamp_ns: 7, interval_s: 0.5, lost: 3, certain: true, restart: false };
        let mut message = Message { gyroscope: Some([1.0, -2.0, 4.0]), ..Message::default() };
        let said = |message: &Message| rates(message, &taken).0.map(|s| s.value);
        assert_eq!(said(&message), Some([1.0, -2.0, 4.0]));
        message.kind = Kind::Increments { over_s: None };
        assert_eq!(said(&message), Some([2.0, -4.0, 8.0]));
        message.kind = Kind::Increments { over_s: Some(0.25) };
        assert_eq!(said(&message), Some([4.0, -8.0, 16.0]));
        // An interval that no sensor has is not believed.
        message.kind = Kind::Increments { over_s: Some(0.0) };
        assert_eq!(said(&message), Some([2.0, -4.0, 8.0]));
        assert_eq!(rates(&message, &taken).1, None);
    }
}
