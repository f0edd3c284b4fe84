//! A second term of one kind: another stream for the same sensor and axis.
//!
//! Streams are keyed by the kind of a term, so two [`GaussMarkov`](super::GaussMarkov) in one tuple
//! would draw the same numbers and move together. `Nth(1, term)` draws others, `Nth(2, term)` others
//! again; `Nth(0, term)` is the term itself.
//!
//! ```
//! use imu_core::noise::{Axis, BandVibration, Channel, Nth, Sensor, Stage, Term};
//! let mode = |frequency| BandVibration { standard_deviation: 0.5, frequency, bandwidth: 10.0 };
//! let z = Channel::new(7, Sensor::ACCELEROMETER, Axis::Z);
//! let mut frame = (mode(80.0_f32), Nth(1, mode(210.0))).prepare(0.001, z).unwrap();
//! assert_ne!(frame.step(9.81), 9.81);
//! ```

use super::{Channel, Normal, Term};
use crate::Error;

/// One more term of a kind that the channel already has: its number, from 1, and the term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nth<P>(pub u16, pub P);

impl<T: Normal, P: Term<T>> Term<T> for Nth<P> {
    type Stage = P::Stage;

    fn prepare(self, dt: T, channel: Channel) -> Result<P::Stage, Error> {
        self.1.prepare(dt, channel.nth(self.0))
    }
}
