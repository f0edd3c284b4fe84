//! Four numbers as four numbers: what a lane holds is computed only where it is read.

use super::Four;
use crate::Real;
use core::ops::{Add, Mul, Neg, Sub};

/// Four numbers, one after the other.
#[derive(Clone, Copy, Debug)]
pub struct Plain<T>([T; 4]);

macro_rules! lane_by_lane {
    ($Trait:ident, $function:ident) => {
        impl<T: Real> $Trait for Plain<T> {
            type Output = Self;

            #[inline(always)]
            fn $function(self, Self([a, b, c, d]): Self) -> Self {
                let Self([x, y, z, w]) = self;
                Self([x.$function(a), y.$function(b), z.$function(c), w.$function(d)])
            }
        }
    };
}

lane_by_lane!(Add, add);
lane_by_lane!(Sub, sub);
lane_by_lane!(Mul, mul);

impl<T: Real> Neg for Plain<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl<T: Real> Four<T> for Plain<T> {
    #[inline(always)]
    fn new(lanes: [T; 4]) -> Self {
        Self(lanes)
    }

    #[inline(always)]
    fn lanes(self) -> [T; 4] {
        self.0
    }

    #[inline(always)]
    fn all(x: T) -> Self {
        Self([x; 4])
    }

    #[inline(always)]
    fn shuffled<const ORDER: i32>(self) -> Self {
        let [x, y, z, w] = self.0;
        Self([ORDER, ORDER >> 2, ORDER >> 4, ORDER >> 6].map(|lane| match lane & 3 {
            0 => x,
            1 => y,
            2 => z,
            _ => w,
        }))
    }

    #[inline(always)]
    fn flipped<const LANES: u32>(self) -> Self {
        let [x, y, z, w] = self.0;
        let flip = |lane: u32, x: T| if LANES & lane == 0 { x } else { -x };
        Self([flip(1, x), flip(2, y), flip(4, z), flip(8, w)])
    }

    #[inline(always)]
    fn all_below(self, limit: T) -> bool {
        self.0.iter().all(|x| *x < limit)
    }

    #[inline(always)]
    fn with_w(self, Self([.., w]): Self) -> Self {
        let Self([x, y, z, _]) = self;
        Self([x, y, z, w])
    }
}
