//! Where a body is, how it is turned and how fast it goes, at one instant; and between two instants.

use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::{State, so3};

/// Attitude, velocity where it is known, and position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// q_wb: rotates body to world, of unit length.
    pub attitude_wb: Quaternion<f64>,
    /// m/s.
    pub velocity_w: Option<Vector3<f64>>,
    /// m.
    pub position_w: Vector3<f64>,
}

impl From<&State<f64>> for Motion {
    fn from(state: &State<f64>) -> Self {
        Self {
            attitude_wb: state.attitude_wb(),
            velocity_w: Some(state.velocity_w()),
            position_w: state.position_w(),
        }
    }
}

impl Motion {
    /// The motion at the part `u` (0 to 1) of the `span` seconds from here to `end`: the attitude along the shortest
    /// turn, by logarithm and exponential; the position by the cubic through both positions and velocities, or on a
    /// line where velocities are not known.
    pub(super) fn towards(&self, end: &Self, span: f64, u: f64) -> Self {
        let turn = so3::log(&so3::product(&so3::inverse(&self.attitude_wb), &end.attitude_wb));
        let attitude_wb = so3::product(&self.attitude_wb, &so3::exp(turn * u));
        let way = end.position_w - self.position_w;
        let Some((from, to)) = self.velocity_w.zip(end.velocity_w) else {
            return Self { attitude_wb, velocity_w: None, position_w: self.position_w + way * u };
        };
        // Hermite's cubic, in differences from the beginning.
        let rest = 1.0 - u;
        let position_w = self.position_w
            + way * (u * u * (3.0 - 2.0 * u))
            + (from * rest - to * u) * (span * u * rest);
        let velocity_w = way * (6.0 * u * rest / span)
            + from * (rest * (1.0 - 3.0 * u))
            + to * (u * (3.0 * u - 2.0));
        Self { attitude_wb, velocity_w: Some(velocity_w), position_w }
    }
}

/// The length of a vector.
pub(super) fn length(v: &Vector3<f64>) -> f64 {
    v.dot(v).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic position and a turn at a constant rate are met exactly.
    #[test]
    fn between_two_instants() {
        let at = |t: f64| Motion {
            attitude_wb: so3::exp(Vector3::new(0.3, -0.2, 0.5) * t),
            velocity_w: Some(Vector3::new(3.0 * t * t, -2.0 * t, 1.0)),
            position_w: Vector3::new(t * t * t, 4.0 - t * t, t),
        };
        let (begin, end) = (at(0.2), at(0.7));
        let middle = begin.towards(&end, 0.5, 0.3);
        let exact = at(0.35);
        assert!((middle.position_w - exact.position_w).abs().max() < 1e-15);
        let (found, known) = (middle.velocity_w.unwrap(), exact.velocity_w.unwrap());
        assert!((found - known).abs().max() < 1e-15);
        let turn = so3::product(&so3::inverse(&middle.attitude_wb), &exact.attitude_wb);
        assert!(length(&so3::log(&turn)) < 1e-15);
        let blind = Motion { velocity_w: None, ..begin }.towards(&end, 0.5, 0.5);
        assert_eq!(blind.position_w, (begin.position_w + end.position_w) * 0.5);
    }
}
