//! Dot and cross products in one fixed order of operations: nalgebra's own want scalars whose arithmetic may change
//! with its features.

use crate::Real;
use nalgebra::Vector3;

#[inline(always)]
pub(crate) fn dot<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> T {
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[inline(always)]
pub(crate) fn cross<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Vector3<T> {
    Vector3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

/// a×b + c×d, in the order that multiply-and-add instructions like.
#[inline(always)]
pub(crate) fn two_crosses<T: Real>(
    a: &Vector3<T>,
    b: &Vector3<T>,
    c: &Vector3<T>,
    d: &Vector3<T>,
) -> Vector3<T> {
    Vector3::new(
        a.y * b.z - a.z * b.y + c.y * d.z - c.z * d.y,
        a.z * b.x - a.x * b.z + c.z * d.x - c.x * d.z,
        a.x * b.y - a.y * b.x + c.x * d.y - c.y * d.x,
    )
}

/// Whether every component is finite and at most `limit` from zero.
#[inline(always)]
pub(crate) fn within<T: Real>(v: &Vector3<T>, limit: T) -> bool {
    v.x.abs() <= limit && v.y.abs() <= limit && v.z.abs() <= limit
}

#[cfg(test)]
pub(crate) fn norm<T: Real>(v: &Vector3<T>) -> T {
    dot(v, v).sqrt()
}
