//! The rotation from one control point to the next, and the part of it that a weight takes.

use crate::lanes::Four;
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

    /// weight·d in three lanes.
    #[inline(always)]
    pub(super) fn times(&self, weight: T) -> T::Four {
        let d = &self.vector;
        // Four neighbours in memory are one load; what becomes of the last is of no interest.
        T::Four::new([d.x, d.y, d.z, self.quarter]) * T::Four::all(weight)
    }

    /// exp(weight·d) of each, four at a time: polynomials while their angles stay below 0.7 rad.
    #[inline(always)]
    pub(super) fn parts<const K: usize>(turns: &[Self; K], weights: &[T; K]) -> [T::Four; K] {
        let mut parts = [T::Four::all(T::ZERO); K];
        let fours = parts.chunks_mut(4).zip(turns.chunks(4)).zip(weights.chunks(4));
        for ((parts, turns), weights) in fours {
            let mut lanes = [(T::ZERO, T::ZERO); 4];
            for ((lane, turn), weight) in lanes.iter_mut().zip(turns).zip(weights) {
                *lane = (turn.quarter, *weight);
            }
            let quarters = T::Four::new(lanes.map(|(quarter, _)| quarter));
            let weights = T::Four::new(lanes.map(|(_, weight)| weight));
            let (cos, sinc) = so3::four_cos_and_sinc::<T>(quarters * (weights * weights));
            let scales = sinc * (weights * T::Four::all(T::from_f64(0.5)));
            let lanes = cos.lanes().into_iter().zip(scales.lanes());
            for ((part, turn), (cos, scale)) in parts.iter_mut().zip(turns).zip(lanes) {
                *part = turn.times(scale).with_w(T::Four::all(cos));
            }
        }
        parts
    }

    pub(super) fn cast<S: Real>(&self) -> Turn<S> {
        Turn::new(Vector3::from(<[T; 3]>::from(self.vector).map(|x| S::from_f64(x.to_f64()))))
    }
}
