//! Four `f32` in one register of x86-64, which always has SSE2. Safe wrappers of the processor's instructions come from
//! `safe_arch`: each is one instruction with the rounding of the scalar one.

use super::{Four, order};
use safe_arch::{
    cmp_lt_mask_m128, m128, move_mask_m128, set_reversed_m128, set_splat_m128,
    shuffle_abi_f32_all_m128, unpack_high_m128,
};

impl Four<f32> for m128 {
    #[inline(always)]
    fn new([x, y, z, w]: [f32; 4]) -> Self {
        set_reversed_m128(x, y, z, w)
    }

    #[inline(always)]
    fn lanes(self) -> [f32; 4] {
        self.to_array()
    }

    #[inline(always)]
    fn all(x: f32) -> Self {
        set_splat_m128(x)
    }

    #[inline(always)]
    fn shuffled<const ORDER: i32>(self) -> Self {
        shuffle_abi_f32_all_m128::<ORDER>(self, self)
    }

    #[inline(always)]
    fn flipped<const LANES: u32>(self) -> Self {
        let sign = |lane: u32| if LANES & lane == 0 { 0.0 } else { -0.0 };
        self ^ set_reversed_m128(sign(1), sign(2), sign(4), sign(8))
    }

    #[inline(always)]
    fn all_below(self, limit: f32) -> bool {
        move_mask_m128(cmp_lt_mask_m128(self, set_splat_m128(limit))) == 0b1111
    }

    #[inline(always)]
    fn with_w(self, w: Self) -> Self {
        // z of this beside w of that one, and then x and y in front of them.
        let end = unpack_high_m128(self, w);
        shuffle_abi_f32_all_m128::<{ order(0, 1, 0, 3) }>(self, end)
    }
}
