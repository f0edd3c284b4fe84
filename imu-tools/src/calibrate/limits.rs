//! What a reading of a sensor can be, learnt from the first ones of a record.

use serde::{Deserialize, Serialize};

use super::{SensorKind, SensorLadder};

/// What a reading of the sensor can be: anything else is a glitch, and counts as missing.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
pub(super) struct Limits {
    pub(super) reference: [f64; 3],
    pub(super) bound: [f64; 3],
}

impl Limits {
    /// Around values like these: their median, and as a bound a thousand times their median absolute
    /// deviation. Where that is zero, or values are few, no sensor's range is beyond 1000 rad/s or
    /// 10 km/s².
    pub(super) fn of(kind: SensorKind, values: &[[f64; 3]]) -> Self {
        let range = match kind {
            SensorKind::Gyroscope => 1e3,
            SensorKind::Accelerometer => 1e4,
        };
        let (mut reference, mut bound) = ([0.0; 3], [range; 3]);
        for (axis, (reference, bound)) in reference.iter_mut().zip(&mut bound).enumerate() {
            let column = || values.iter().map(|row| row[axis]).filter(|x| x.is_finite());
            *reference = median(column().collect());
            let deviation = median(column().map(|x| (x - *reference).abs()).collect());
            if deviation > 0.0 && values.len() >= 64 {
                *bound = (1e3 * deviation).min(SensorLadder::limit());
            }
        }
        Self { reference, bound }
    }

    /// Whether a reading is within.
    #[inline]
    pub(super) fn hold(&self, value: &[f64; 3]) -> bool {
        let within = |axis: usize| (value[axis] - self.reference[axis]).abs() <= self.bound[axis];
        within(0) & within(1) & within(2) // false for a NaN
    }

    /// Whether all of them are.
    #[inline]
    pub(super) fn hold_all(&self, values: &[[f64; 3]]) -> bool {
        values.iter().fold(true, |all, value| all & self.hold(value))
    }
}

/// The middle value; 0 of none.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(vec![]), 0.0);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
    }

    #[test]
    fn a_glitch_at_the_start_is_not_the_reference() {
        let mut values = vec![[0.0, 0.01, 9.8]; 100];
        for (k, row) in values.iter_mut().enumerate() {
            row[2] += 1e-3 * (k % 7) as f64;
        }
        values[0] = [1e4; 3];
        let limits = Limits::of(SensorKind::Accelerometer, &values);
        assert!((limits.reference[2] - 9.803).abs() < 1e-9);
        assert_eq!(values.iter().filter(|value| !limits.hold(value)).count(), 1);
        assert!(!limits.hold(&[0.0, f64::NAN, 9.8]));
    }
}
