//! Which random numbers a noise term gets: one stream for each (seed, sensor, axis, term).
//!
//! Terms, sensors and axes are named by fixed numbers, so switching a term on or off, or adding a
//! sensor, never changes the numbers of any other. The numbers below are part of the format: a
//! change of them changes every simulated recording, and is a breaking change.
//!
//! The key of a stream is `mix(mix(seed + γ) ^ (nth·2⁴⁸ + sensor·2³² + axis·2¹⁶ + term))`, with
//! nth 0 but for a second term of one kind ([`Nth`](super::Nth)), `mix` SplitMix64's output function, a bijection, and γ its increment: so two streams of one seed never share a key, and two
//! seeds share one stream with a chance of 2⁻⁶⁴ a pair. The generator's state is then the first
//! words of SplitMix64 started at the key.
//!
//! ```
//! use imu_core::noise::{Axis, Channel, Sensor, TermId, Xoshiro256PlusPlus};
//! let x = Channel::new(7, Sensor::GYROSCOPE, Axis::X);
//! let white: Xoshiro256PlusPlus = x.stream(TermId::WHITE);
//! let walk: Xoshiro256PlusPlus = x.stream(TermId::RANDOM_WALK);
//! assert_ne!(white, walk);
//! ```

use super::xoshiro::{GOLDEN, mix};
use rand_core::SeedableRng;

/// The number of a sensor in the key of its streams. Further devices take any other number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sensor(pub u16);

impl Sensor {
    /// The gyroscope of the first IMU.
    pub const GYROSCOPE: Self = Self(0);
    /// The accelerometer of the first IMU.
    pub const ACCELEROMETER: Self = Self(1);
}

/// An axis of a three-axis sensor, in sensor frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u16)]
pub enum Axis {
    /// x
    X = 0,
    /// y
    Y = 1,
    /// z
    Z = 2,
}

impl Axis {
    /// x, y, z.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];
}

/// The number of a noise term in the key of its stream. A term of your own takes 256 or more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TermId(pub u16);

impl TermId {
    /// White noise ([`White`](super::White)).
    pub const WHITE: Self = Self(0);
    /// Bias random walk ([`RandomWalk`](super::RandomWalk)).
    pub const RANDOM_WALK: Self = Self(1);
    /// What a bandwidth limit remembers from before the first sample.
    pub const BANDWIDTH: Self = Self(2);
    /// First-order Gauss-Markov bias ([`GaussMarkov`](super::GaussMarkov)).
    pub const GAUSS_MARKOV: Self = Self(3);
    /// Flicker, all its processes ([`Flicker`](super::Flicker)).
    pub const FLICKER: Self = Self(4);
    /// Quantisation of increments ([`IncrementQuantisation`](super::IncrementQuantisation)).
    pub const QUANTISATION: Self = Self(5);
    /// The bias of this run ([`TurnOnBias`](super::TurnOnBias)).
    pub const TURN_ON_BIAS: Self = Self(6);
    /// Vibration in a band ([`BandVibration`](super::BandVibration)).
    pub const BAND_VIBRATION: Self = Self(7);
}

/// One axis of one sensor of one simulation: the place whose terms draw random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Channel {
    seed: u64,
    sensor: Sensor,
    axis: Axis,
    nth: u16,
}

impl Channel {
    /// The channel of `axis` of `sensor` in the simulation with this `seed` (any number).
    #[must_use]
    pub const fn new(seed: u64, sensor: Sensor, axis: Axis) -> Self {
        Self { seed, sensor, axis, nth: 0 }
    }

    /// The same place for one more term of a kind that it already has: see [`Nth`](super::Nth).
    /// `0` is the first, as [`new`](Self::new) makes it.
    #[must_use]
    pub const fn nth(self, nth: u16) -> Self {
        Self { nth, ..self }
    }

    /// The generator of a term on this channel, at its beginning.
    #[must_use]
    pub fn stream<G: SeedableRng>(&self, term: TermId) -> G {
        G::seed_from_u64(self.key(term))
    }

    const fn key(&self, term: TermId) -> u64 {
        let place = (self.sensor.0 as u64) << 32 | (self.axis as u64) << 16;
        let id = (self.nth as u64) << 48 | place | term.0 as u64;
        mix(mix(self.seed.wrapping_add(GOLDEN)) ^ id)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_two_streams_of_near_seeds_share_a_key() {
        let mut seen = HashSet::new();
        for seed in (0..1000).chain(u64::MAX - 1000..=u64::MAX) {
            for sensor in [0, 1, 2, u16::MAX] {
                for axis in Axis::ALL {
                    for term in [0, 1, 2, 256, u16::MAX] {
                        let channel = Channel::new(seed, Sensor(sensor), axis);
                        assert!(seen.insert(channel.key(TermId(term))));
                        assert!(seen.insert(channel.nth(1).key(TermId(term))));
                    }
                }
            }
        }
    }

    /// The keys are part of the format: recordings simulated by another version must come again.
    #[test]
    fn keys_never_change() {
        let key = |seed, sensor, axis, term| Channel::new(seed, sensor, axis).key(term);
        let keys = [
            key(0, Sensor::GYROSCOPE, Axis::X, TermId::WHITE),
            key(7, Sensor::GYROSCOPE, Axis::Z, TermId::RANDOM_WALK),
            key(u64::MAX, Sensor::ACCELEROMETER, Axis::Y, TermId::BANDWIDTH),
        ];
        assert_eq!(keys, KEYS);
    }

    const KEYS: [u64; 3] = [0x4821_8226_ff3c_d4bf, 0x6995_7c05_306a_b1b7, 0x0c32_c07f_d743_de40];
}
