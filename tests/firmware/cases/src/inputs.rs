//! Inputs that are the same bits everywhere: integers, converted exactly.

use core::hint::black_box;
use imu_core::Real;

/// A stream of well-mixed integers (Marsaglia 2003, xorshift, triple 13, 17, 5).
#[derive(Clone, Copy)]
pub struct Integers(u32);

impl Integers {
    /// A stream; `seed` is not 0. The compiler cannot see which, so it computes nothing in advance.
    #[inline(never)]
    pub fn new(seed: u32) -> Self {
        Self(black_box(seed))
    }

    /// The next integer.
    #[inline]
    pub fn integer(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// The next number in [−1, 1), a multiple of 2⁻²³: exact in `f32` and `f64`.
    #[inline]
    pub fn unit<T: Real>(&mut self) -> T {
        let centred = i32::from_ne_bytes((self.integer() >> 8).to_ne_bytes()) - (1 << 23);
        T::from_f64(f64::from(centred)) * T::from_f64(1.0 / 8_388_608.0)
    }
}
