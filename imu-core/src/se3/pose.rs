//! A pose: a rotation of unit length and a translation, both checked once.

use super::Twist;
use crate::vector::{cross, within};
use crate::{Error, Real, so3};
use nalgebra::{Quaternion, Vector3};

/// The largest component of a translation, m: far beyond orbits, and small enough that nothing overflows in `f32`.
const LIMIT: f64 = 1e9;
/// How far the length of a quaternion may be from 1.
const OFF: f64 = 1e-3;

/// Where a body is and how it is turned: `T_wb` takes points of the body's frame to the world's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<T: Real> {
    rotation: Quaternion<T>,
    translation: Vector3<T>,
}

impl<T: Real> Pose<T> {
    /// From q_wb, which is taken to unit length, and p_w in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the argument: `rotation` where a component is not a number or the length is off
    /// from 1 by more than 10⁻³, `translation` where a component is not a number or beyond ±10⁹.
    pub fn new(rotation: Quaternion<T>, translation: Vector3<T>) -> Result<Self, Error> {
        let length = so3::length(&rotation);
        let off = (length - T::ONE).abs();
        // What is not a number is not below anything.
        if off <= T::from_f64(OFF) {
            if within(&translation, T::from_f64(LIMIT)) {
                Ok(Self { rotation: Quaternion::from(rotation.coords / length), translation })
            } else {
                Err(Error::OutOfRange("translation"))
            }
        } else {
            Err(Error::OutOfRange("rotation"))
        }
    }

    /// Of parts that are in order.
    #[inline(always)]
    pub(crate) fn of_unit(rotation: Quaternion<T>, translation: Vector3<T>) -> Self {
        Self { rotation, translation }
    }

    /// Not turned, not moved.
    #[must_use]
    pub fn identity() -> Self {
        let (one, zero) = (T::ONE, T::ZERO);
        Self::of_unit(Quaternion::new(one, zero, zero, zero), Vector3::from([zero; 3]))
    }

    /// q_wb: rotates vectors of the body's frame into the world's; of unit length, of either sign.
    #[must_use]
    #[inline]
    pub fn rotation(&self) -> Quaternion<T> {
        self.rotation
    }

    /// p_w: where the body is in the world's frame, m.
    #[must_use]
    #[inline]
    pub fn translation(&self) -> Vector3<T> {
        self.translation
    }

    /// `T_ac = T_ab T_bc`: this pose, and another one seen from it. The rotation is taken back to unit length.
    #[must_use]
    #[inline]
    pub fn then(&self, bc: &Self) -> Self {
        let rotation = so3::renormalised(&so3::product(&self.rotation, &bc.rotation));
        Self { rotation, translation: self.point(&bc.translation) }
    }

    /// T⁻¹ = (R⁻¹, −R⁻¹p): takes points of frame a to frame b.
    #[must_use]
    #[inline]
    pub fn inverse(&self) -> Self {
        let rotation = so3::inverse(&self.rotation);
        Self { rotation, translation: -so3::rotate(&rotation, &self.translation) }
    }

    /// A point of frame b in frame a: Rx + p, m.
    #[must_use]
    #[inline]
    pub fn point(&self, b: &Vector3<T>) -> Vector3<T> {
        so3::rotate(&self.rotation, b) + self.translation
    }

    /// Ad(T⁻¹)ξ: a twist of frame a seen from frame b, (R⁻¹(ρ − p×φ), R⁻¹φ).
    #[must_use]
    #[inline]
    pub fn twist_inside(&self, twist: &Twist<T>) -> Twist<T> {
        let back = so3::inverse(&self.rotation);
        Twist {
            linear: so3::rotate(&back, &(twist.linear - cross(&self.translation, &twist.angular))),
            angular: so3::rotate(&back, &twist.angular),
        }
    }

    /// The same pose in another scalar, every number rounded once.
    #[must_use]
    pub fn cast<S: Real>(&self) -> Pose<S> {
        let cast = |x: T| S::from_f64(x.to_f64());
        let [i, j, k, w] = <[T; 4]>::from(self.rotation.coords).map(cast);
        let translation = Vector3::from(<[T; 3]>::from(self.translation).map(cast));
        Pose::of_unit(Quaternion::new(w, i, j, k), translation)
    }
}

impl<T: Real> Default for Pose<T> {
    /// Not turned, not moved.
    fn default() -> Self {
        Self::identity()
    }
}
