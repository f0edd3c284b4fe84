//! How far a curve is from the motion whose poses it was made of.

use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::spline::Full;
use imu_core::{Error, Real, so3};

use super::curves::Use;
use crate::tradeoff::rules::follow::norm;
use crate::tradeoff::rules::motion::{GRAVITY, Motion};

/// The largest errors of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// m
    pub position: f64,
    /// Angle between the attitudes, rad.
    pub rotation: f64,
    /// ω, rad/s.
    pub angular_rate: f64,
    /// a, m/s².
    pub acceleration: f64,
}

/// What the curve should be at an instant.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    t_ns: i64,
    position_w: Vector3<f64>,
    attitude_wb: Quaternion<f64>,
    angular_rate: Vector3<f64>,
    acceleration_w: Vector3<f64>,
}

/// The truth between knots.
pub(super) struct Truth {
    wanted: Vec<Wanted>,
}

/// Instants in every interval: an eighth apart, the first one off the knot by half of that.
const TO_AN_INTERVAL: i64 = 8;

impl Truth {
    pub(super) fn of(motion: Motion, step_ns: u32, intervals: usize) -> Self {
        let eighths = 0..intervals as i64 * TO_AN_INTERVAL;
        let wanted = eighths.map(|k| {
            let t_ns = (2 * k + 1) * i64::from(step_ns) / (2 * TO_AN_INTERVAL);
            let truth = motion.at(t_ns);
            let felt = so3::rotate(&truth.attitude_wb, &truth.specific_force);
            Wanted {
                t_ns,
                position_w: truth.position_w,
                attitude_wb: truth.attitude_wb,
                angular_rate: truth.angular_rate,
                acceleration_w: felt - Vector3::new(0.0, 0.0, GRAVITY),
            }
        });
        Self { wanted: wanted.collect() }
    }
}

impl Use for Truth {
    type Out = Errors;

    fn with<T: Real>(
        &mut self,
        full: impl Fn(i64) -> Result<Full<T>, Error>,
    ) -> Result<Errors, Error> {
        let double = |v: Vector3<T>| Vector3::from(<[T; 3]>::from(v).map(T::to_f64));
        let mut errors = Errors::default();
        for wanted in &self.wanted {
            let there = full(wanted.t_ns)?;
            let [i, j, k, w] = <[T; 4]>::from(there.pose.rotation().coords).map(T::to_f64);
            let back = so3::inverse(&wanted.attitude_wb);
            let turn = so3::log(&so3::product(&back, &Quaternion::new(w, i, j, k)));
            let now = Errors {
                position: norm(&(double(there.pose.translation()) - wanted.position_w)),
                rotation: norm(&turn),
                angular_rate: norm(&(double(there.angular_rate) - wanted.angular_rate)),
                acceleration: norm(&(double(there.acceleration_w) - wanted.acceleration_w)),
            };
            errors = errors.worse(&now);
        }
        Ok(errors)
    }
}

impl Errors {
    fn worse(&self, other: &Self) -> Self {
        Self {
            position: self.position.max(other.position),
            rotation: self.rotation.max(other.rotation),
            angular_rate: self.angular_rate.max(other.angular_rate),
            acceleration: self.acceleration.max(other.acceleration),
        }
    }
}
