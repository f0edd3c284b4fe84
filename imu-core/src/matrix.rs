//! 3×3 matrices as three rows, in one fixed order of operations: nalgebra's own products want scalars whose arithmetic
//! may change with its features.

use crate::Real;
use crate::vector::{cross, dot};
use nalgebra::{Matrix3, Quaternion, Vector3};

/// The rows of a 3×3 matrix.
pub(crate) type Rows<T> = [Vector3<T>; 3];

/// The matrix of a unit quaternion.
#[inline(always)]
pub(crate) fn rotation<T: Real>(q: &Quaternion<T>) -> Rows<T> {
    let c = &q.coords;
    let (x2, y2, z2) = (c.x + c.x, c.y + c.y, c.z + c.z);
    let (xx, yy, zz) = (c.x * x2, c.y * y2, c.z * z2);
    let (xy, xz, yz) = (c.x * y2, c.x * z2, c.y * z2);
    let (wx, wy, wz) = (c.w * x2, c.w * y2, c.w * z2);
    [
        Vector3::new(T::ONE - (yy + zz), xy - wz, xz + wy),
        Vector3::new(xy + wz, T::ONE - (xx + zz), yz - wx),
        Vector3::new(xz - wy, yz + wx, T::ONE - (xx + yy)),
    ]
}

/// \[v\]×
pub(crate) fn skew<T: Real>(v: &Vector3<T>) -> Rows<T> {
    let zero = T::ZERO;
    [Vector3::new(zero, -v.z, v.y), Vector3::new(v.z, zero, -v.x), Vector3::new(-v.y, v.x, zero)]
}

/// \[v\]× m: every column of m crossed.
#[inline(always)]
pub(crate) fn crossed<T: Real>(v: &Vector3<T>, m: &Rows<T>) -> Rows<T> {
    [m[2] * v.y - m[1] * v.z, m[0] * v.z - m[2] * v.x, m[1] * v.x - m[0] * v.y]
}

/// m \[v\]×: every row of m crossed.
#[inline(always)]
pub(crate) fn crossed_behind<T: Real>(m: &Rows<T>, v: &Vector3<T>) -> Rows<T> {
    [cross(&m[0], v), cross(&m[1], v), cross(&m[2], v)]
}

/// \[a\]×\[b\]× = b aᵀ − (a·b) 1
#[inline(always)]
pub(crate) fn two_skews<T: Real>(a: &Vector3<T>, b: &Vector3<T>) -> Rows<T> {
    let inner = dot(a, b);
    let mut product = [a * b.x, a * b.y, a * b.z];
    product[0].x -= inner;
    product[1].y -= inner;
    product[2].z -= inner;
    product
}

/// a + k b
#[inline(always)]
pub(crate) fn add_scaled<T: Real>(a: &Rows<T>, k: T, b: &Rows<T>) -> Rows<T> {
    [a[0] + b[0] * k, a[1] + b[1] * k, a[2] + b[2] * k]
}

/// 1
pub(crate) fn identity<T: Real>() -> Rows<T> {
    let (one, zero) = (T::ONE, T::ZERO);
    [Vector3::new(one, zero, zero), Vector3::new(zero, one, zero), Vector3::new(zero, zero, one)]
}

/// a b
pub(crate) fn product<T: Real>(a: &Rows<T>, b: &Rows<T>) -> Rows<T> {
    a.map(|row| b[0] * row.x + b[1] * row.y + b[2] * row.z)
}

/// m v
pub(crate) fn rows_times<T: Real>(m: &Rows<T>, v: &Vector3<T>) -> Vector3<T> {
    Vector3::new(dot(&m[0], v), dot(&m[1], v), dot(&m[2], v))
}

/// aᵀ b
pub(crate) fn transposed_times<T: Real>(a: &Rows<T>, b: &Rows<T>) -> Rows<T> {
    let row = |x: T, y: T, z: T| b[0] * x + b[1] * y + b[2] * z;
    [row(a[0].x, a[1].x, a[2].x), row(a[0].y, a[1].y, a[2].y), row(a[0].z, a[1].z, a[2].z)]
}

pub(crate) fn transposed<T: Real>(m: &Rows<T>) -> Rows<T> {
    let [a, b, c] = m;
    [Vector3::new(a.x, b.x, c.x), Vector3::new(a.y, b.y, c.y), Vector3::new(a.z, b.z, c.z)]
}

/// As nalgebra has it.
pub(crate) fn matrix<T: Real>(m: &Rows<T>) -> Matrix3<T> {
    Matrix3::from(transposed(m).map(<[T; 3]>::from))
}

/// m v
pub(crate) fn times<T: Real>(m: &Matrix3<T>, v: &Vector3<T>) -> Vector3<T> {
    let row = |x: T, y: T, z: T| x * v.x + y * v.y + z * v.z;
    Vector3::new(row(m.m11, m.m12, m.m13), row(m.m21, m.m22, m.m23), row(m.m31, m.m32, m.m33))
}
