//! Four numbers at a time: a quaternion, a vector with room for one more, or a number of each of four.
//!
//! A processor with registers of four `f32` is three quarters idle under formulas of single numbers, and what a
//! compiler puts together of vectors of three costs as much as it saves. So splines say in so many words which four
//! belong together. On x86-64 four `f32` are one register ([`sse`]); elsewhere four numbers are four numbers
//! ([`plain`]), and lanes that nobody reads are never computed.
//!
//! Same bits: each lane takes the operations of [`so3`](crate::so3) and [`vector`](crate::vector) in their order. Lanes
//! are x, y, z, w; the last one of a vector holds anything.

mod plain;
#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
mod sse;

pub use plain::Plain;

use core::ops::{Add, Mul, Neg, Sub};
use nalgebra::{Quaternion, Vector3};

/// Four `f32`.
#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
pub type Single = safe_arch::m128;
/// Four `f32`.
#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2")))]
pub type Single = Plain<f32>;

/// Four numbers; arithmetic is lane by lane.
pub trait Four<T>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Lane by lane.
    fn new(lanes: [T; 4]) -> Self;
    /// The lanes.
    fn lanes(self) -> [T; 4];
    /// The same number in all lanes.
    fn all(x: T) -> Self;
    /// The lanes in another [`order`].
    fn shuffled<const ORDER: i32>(self) -> Self;
    /// With the signs of those lanes changed whose bits (1, 2, 4, 8) are set.
    fn flipped<const LANES: u32>(self) -> Self;
    /// Whether each lane is less than this: not where one is not a number.
    fn all_below(self, limit: T) -> bool;
    /// The first three lanes of this one, and the last of `w`.
    fn with_w(self, w: Self) -> Self;
}

/// The argument of [`Four::shuffled`]: which lane goes to x, y, z and w.
pub(crate) const fn order(x: i32, y: i32, z: i32, w: i32) -> i32 {
    x | y << 2 | z << 4 | w << 6
}

const YZX: i32 = order(1, 2, 0, 3);
const ZXY: i32 = order(2, 0, 1, 3);

/// A vector; 0 in the last lane.
#[inline(always)]
pub(crate) fn vector<T: crate::Real>(v: &Vector3<T>) -> T::Four {
    T::Four::new([v.x, v.y, v.z, T::ZERO])
}

#[inline(always)]
pub(crate) fn quaternion<T: crate::Real>(q: &Quaternion<T>) -> T::Four {
    T::Four::new([q.coords.x, q.coords.y, q.coords.z, q.coords.w])
}

#[inline(always)]
pub(crate) fn to_vector<T, F: Four<T>>(four: F) -> Vector3<T> {
    let [x, y, z, _] = four.lanes();
    Vector3::new(x, y, z)
}

#[inline(always)]
pub(crate) fn to_quaternion<T: crate::Real>(four: T::Four) -> Quaternion<T> {
    let [x, y, z, w] = four.lanes();
    Quaternion::new(w, x, y, z)
}

/// a×b
#[inline(always)]
pub(crate) fn cross<T, F: Four<T>>(a: F, b: F) -> F {
    (a * b.shuffled::<YZX>() - a.shuffled::<YZX>() * b).shuffled::<YZX>()
}

/// The conjugate.
#[inline(always)]
pub(crate) fn inverse<T, F: Four<T>>(q: F) -> F {
    q.flipped::<0b0111>()
}

/// `q_ac = q_ab q_bc`.
#[inline(always)]
pub(crate) fn product<T, F: Four<T>>(ab: F, bc: F) -> F {
    let of_x = bc.shuffled::<{ order(3, 2, 1, 0) }>().flipped::<0b1010>();
    let of_y = bc.shuffled::<{ order(2, 3, 0, 1) }>().flipped::<0b1100>();
    let of_z = bc.shuffled::<{ order(1, 0, 3, 2) }>().flipped::<0b1001>();
    ab.shuffled::<{ order(3, 3, 3, 3) }>() * bc
        + ab.shuffled::<{ order(0, 0, 0, 0) }>() * of_x
        + ab.shuffled::<{ order(1, 1, 1, 1) }>() * of_y
        + ab.shuffled::<{ order(2, 2, 2, 2) }>() * of_z
}

/// `v_a = q_ab v_b q_ab*`.
#[inline(always)]
pub(crate) fn rotate<T, F: Four<T>>(ab: F, b: F) -> F {
    let t = twice_cross(ab, b);
    let w = ab.shuffled::<{ order(3, 3, 3, 3) }>();
    b + w * t + ab.shuffled::<YZX>() * t.shuffled::<ZXY>()
        - ab.shuffled::<ZXY>() * t.shuffled::<YZX>()
}

/// `v_b = q_ab* v_a q_ab`: without changing signs first.
#[inline(always)]
pub(crate) fn rotate_back<T, F: Four<T>>(ab: F, a: F) -> F {
    let t = twice_cross(ab, a);
    let w = ab.shuffled::<{ order(3, 3, 3, 3) }>();
    a - w * t + ab.shuffled::<YZX>() * t.shuffled::<ZXY>()
        - ab.shuffled::<ZXY>() * t.shuffled::<YZX>()
}

#[inline(always)]
fn twice_cross<T, F: Four<T>>(a: F, b: F) -> F {
    let once = cross(a, b);
    once + once
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Real, so3};
    use proptest::prelude::*;

    /// Each formula, in lanes, gives what it gives without.
    fn agrees<T: Real>(p: [T; 4], q: [T; 4]) {
        let [x, y, z, w] = p;
        let (p3, p4) = (Vector3::new(x, y, z), Quaternion::new(w, x, y, z));
        let [x, y, z, w] = q;
        let (q3, q4) = (Vector3::new(x, y, z), Quaternion::new(w, x, y, z));
        let (p, q) = (T::Four::new(p), T::Four::new(q));
        assert_eq!(to_vector(cross(p, q)), crate::vector::cross(&p3, &q3));
        assert_eq!(to_quaternion::<T>(product(p, q)), so3::product(&p4, &q4));
        assert_eq!(to_quaternion::<T>(inverse(p)), so3::inverse(&p4));
        assert_eq!(to_vector(rotate(p, q)), so3::rotate(&p4, &q3));
        assert_eq!(to_vector(rotate_back(p, q)), so3::rotate(&so3::inverse(&p4), &q3));
        assert_eq!(to_quaternion::<T>(quaternion(&p4)), p4);
        assert_eq!(vector(&q3).lanes(), [q3.x, q3.y, q3.z, T::ZERO]);
        assert_eq!(p.with_w(q).lanes(), [p3.x, p3.y, p3.z, q4.coords.w]);
        let least = p.lanes().iter().fold(T::MAX, |a, b| if *b < a { *b } else { a });
        let most = p.lanes().iter().fold(-T::MAX, |a, b| if *b > a { *b } else { a });
        assert!(
            !p.all_below(most) && !p.all_below(least) && p.all_below(most + T::ONE + most.abs())
        );
        assert_eq!((-p).lanes(), p.flipped::<0b1111>().lanes());
        assert_eq!(T::Four::all(x).lanes(), [x; 4]);
    }

    proptest! {
        #[test]
        fn in_single(p: [f32; 4], q: [f32; 4]) {
            agrees(p.map(|x| x.clamp(-1e8, 1e8)), q.map(|x| x.clamp(-1e8, 1e8)));
        }

        #[test]
        fn in_double(p: [f64; 4], q: [f64; 4]) {
            agrees(p.map(|x| x.clamp(-1e80, 1e80)), q.map(|x| x.clamp(-1e80, 1e80)));
        }
    }
}
