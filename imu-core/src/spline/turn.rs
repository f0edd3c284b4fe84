//! The rotation from one control point to the next, and the part of it that a weight takes.

use crate::vector::dot;
use crate::{Real, so3};
use nalgebra::{Quaternion, Vector3};

/// A rotation vector d with its square: two multiplications less in every evaluation, and no root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn<T: Real> {
    /// d, rad.
    pub(super) vector: Vector3<T>,
    /// |d/2|²
    quarter: T,
}

impl<T: Real> Turn<T> {
    #[inline(always)]
    pub(super) fn new(vector: Vector3<T>) -> Self {
        Self { vector, quarter: dot(&vector, &vector) * T::from_f64(0.25) }
    }

    /// From one attitude to another, both of unit length: Log(aᵀb), the shorter way.
    #[inline(always)]
    pub(super) fn between(a: &Quaternion<T>, b: &Quaternion<T>) -> Self {
        Self::new(so3::log_of_unit(&so3::product(&so3::inverse(a), b)))
    }

    /// exp(weight·d): polynomials while the angle stays below 0.7 rad.
    #[inline(always)]
    pub(super) fn part(&self, weight: T) -> Quaternion<T> {
        let half = self.vector * (weight * T::from_f64(0.5));
        so3::exp_of_squared_half(half, self.quarter * (weight * weight))
    }

    pub(super) fn cast<S: Real>(&self) -> Turn<S> {
        Turn::new(Vector3::from(<[T; 3]>::from(self.vector).map(|x| S::from_f64(x.to_f64()))))
    }
}
