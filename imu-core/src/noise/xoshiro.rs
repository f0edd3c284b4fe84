//! The generators behind the noise: xoshiro128++ for `f32`, xoshiro256++ for `f64`.
//!
//! Source: Blackman & Vigna (2021), "Scrambled Linear Pseudorandom Number Generators", ACM
//! Transactions on Mathematical Software 47(4); seeding by SplitMix64, Steele, Lea & Flood (2014).
//! Only additions, shifts and exclusive ors of the machine word of the scalar's size: no
//! multiplication, which a Cortex-M0 does slowly for 64 bits. Not for cryptography.
//!
//! They differ from the `rand_xoshiro` types (whose numbers they repeat bit for bit) in being
//! `Copy`, so that a noise stage is plain data that a caller can save and run again.
//!
//! ```
//! use imu_core::noise::Xoshiro128PlusPlus;
//! use rand_core::{Rng, SeedableRng};
//! let mut a = Xoshiro128PlusPlus::seed_from_u64(7);
//! let mut b = a;
//! assert_eq!(a.next_u32(), b.next_u32());
//! ```

use core::convert::Infallible;
use rand_core::{SeedableRng, TryRng};

/// The increment of SplitMix64: 2⁶⁴ divided by the golden ratio, made odd.
pub(super) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// SplitMix64's output function: a bijection of 64-bit words that mixes every bit into every other
/// (Stafford's variant 13 of MurmurHash3's finaliser).
pub(super) const fn mix(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

macro_rules! xoshiro {
    ($(#[$doc:meta])* $name:ident, $word:ident, $bytes:literal, $sum:literal, $shift:literal,
     $last:literal, $of:ident => $state:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct $name {
            state: [$word; 4],
        }

        impl $name {
            #[inline(always)]
            fn next(&mut self) -> $word {
                let [a, b, c, d] = self.state;
                let out = a.wrapping_add(d).rotate_left($sum).wrapping_add(a);
                let (c, d) = (c ^ a, d ^ b);
                self.state = [a ^ d, b ^ c, c ^ (b << $shift), d.rotate_left($last)];
                out
            }
        }

        impl SeedableRng for $name {
            type Seed = [u8; $bytes];

            /// Little-endian words of state; all zeros, which xoshiro cannot leave, stand for the
            /// seed number 0.
            fn from_seed(seed: [u8; $bytes]) -> Self {
                let mut state = [0; 4];
                let words = seed.as_chunks().0;
                for (word, bytes) in state.iter_mut().zip(words) {
                    *word = $word::from_le_bytes(*bytes);
                }
                if state == [0; 4] { Self::seed_from_u64(0) } else { Self { state } }
            }

            /// The state is the next output of SplitMix64 started at `seed`, never all zeros:
            /// SplitMix64 does not repeat a word.
            #[inline]
            fn seed_from_u64(seed: u64) -> Self {
                let $of = |k: u64| mix(seed.wrapping_add(GOLDEN.wrapping_mul(k)));
                Self { state: $state }
            }
        }
    };
}

xoshiro!(
    /// xoshiro128++: 16 bytes, period 2¹²⁸ − 1, a 32-bit word at a time. Drives the `f32` noise.
    Xoshiro128PlusPlus, u32, 16, 7, 9, 11,
    word => {
        let (a, b) = (word(1), word(2));
        [a as u32, (a >> 32) as u32, b as u32, (b >> 32) as u32]
    }
);

xoshiro!(
    /// xoshiro256++: 32 bytes, period 2²⁵⁶ − 1, a 64-bit word at a time. Drives the `f64` noise.
    Xoshiro256PlusPlus, u64, 32, 23, 17, 45,
    word => [word(1), word(2), word(3), word(4)]
);

impl TryRng for Xoshiro128PlusPlus {
    type Error = Infallible;

    #[inline(always)]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.next())
    }

    /// Two words, the low one first.
    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let low = u64::from(self.next());
        Ok(low | u64::from(self.next()) << 32)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(4) {
            chunk.iter_mut().zip(self.next().to_le_bytes()).for_each(|(to, from)| *to = from);
        }
        Ok(())
    }
}

impl TryRng for Xoshiro256PlusPlus {
    type Error = Infallible;

    /// The high half of the next word.
    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok((self.next() >> 32) as u32)
    }

    #[inline(always)]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.next())
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            chunk.iter_mut().zip(self.next().to_le_bytes()).for_each(|(to, from)| *to = from);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_core::Rng;
    use rand_xoshiro as theirs;

    #[test]
    fn both_repeat_rand_xoshiro_bit_for_bit() {
        for seed in [0, 1, 7, u64::MAX] {
            let mut ours = Xoshiro128PlusPlus::seed_from_u64(seed);
            let mut peer = theirs::Xoshiro128PlusPlus::seed_from_u64(seed);
            assert!((0..100).all(|_| ours.next_u32() == peer.next_u32()));
            assert!((0..100).all(|_| ours.next_u64() == peer.next_u64()));
            let mut ours = Xoshiro256PlusPlus::seed_from_u64(seed);
            let mut peer = theirs::Xoshiro256PlusPlus::seed_from_u64(seed);
            assert!((0..100).all(|_| ours.next_u64() == peer.next_u64()));
            assert!((0..100).all(|_| ours.next_u32() == peer.next_u32()));
            let (mut a, mut b) = ([0; 21], [0; 21]);
            ours.fill_bytes(&mut a);
            peer.fill_bytes(&mut b);
            assert_eq!(a, b);
        }
    }

    #[test]
    fn a_seed_of_bytes_is_the_state_and_zeros_are_replaced() {
        let mut seed = [0; 16];
        for (k, word) in seed.chunks_mut(4).enumerate() {
            word[0] = k as u8 + 1;
        }
        let mut ours = Xoshiro128PlusPlus::from_seed(seed);
        // First outputs of the authors' C program for the state 1, 2, 3, 4.
        assert_eq!(
            [(); 4].map(|()| ours.next_u32()),
            [641, 1_573_767, 3_222_811_527, 3_517_856_514]
        );
        assert_eq!(Xoshiro256PlusPlus::from_seed([0; 32]), Xoshiro256PlusPlus::seed_from_u64(0));
    }
}
