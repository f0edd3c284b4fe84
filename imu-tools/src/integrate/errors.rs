//! How far a trajectory is from the truth, summed as it goes.

use imu_core::nalgebra::Vector3;
use imu_core::so3;

use super::align::Alignment;
use super::motion::{Motion, length};
use super::thin::Thin;

/// Errors over all instants at which the truth is known, the start excluded.
#[derive(Clone, Debug, PartialEq)]
pub struct Errors {
    /// Instants compared.
    pub instants: u64,
    /// Root mean square of the distance to the true position, m.
    pub position_rmse_m: f64,
    /// The distance at the last instant, m.
    pub position_final_m: f64,
    /// Root mean square of the angle to the true attitude, rad.
    pub rotation_rmse_rad: f64,
    /// The angle at the last instant, rad.
    pub rotation_final_rad: f64,
    /// The error of the velocity at the last instant, m/s; none where the truth has no velocity.
    pub velocity_final_m_s: Option<f64>,
    /// Absolute trajectory error, m: root mean square of the distances after the rotation and translation that make
    /// it least.
    pub ate_m: f64,
}

/// Errors at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorAt {
    /// Seconds from the start.
    pub t_s: f64,
    /// m.
    pub position_m: f64,
    /// rad.
    pub rotation_rad: f64,
}

/// The sums.
#[derive(Clone, Debug, Default)]
pub(super) struct ErrorSums {
    instants: u64,
    position_squares: f64,
    rotation_squares: f64,
    last: Option<(ErrorAt, Option<f64>)>,
    alignment: Alignment,
    pub(super) curve: Thin<ErrorAt>,
}

impl ErrorSums {
    pub(super) fn push(&mut self, t_s: f64, found: &Motion, truth: &Motion) {
        let off: Vector3<f64> = found.position_w - truth.position_w;
        let turn = so3::product(&so3::inverse(&truth.attitude_wb), &found.attitude_wb);
        let at = ErrorAt { t_s, position_m: length(&off), rotation_rad: length(&so3::log(&turn)) };
        let velocities = found.velocity_w.zip(truth.velocity_w);
        self.instants += 1;
        self.position_squares += at.position_m * at.position_m;
        self.rotation_squares += at.rotation_rad * at.rotation_rad;
        self.last = Some((at, velocities.map(|(found, truth)| length(&(found - truth)))));
        self.alignment.push(&found.position_w, &off);
        self.curve.push(at);
    }

    /// None before there was an instant.
    pub(super) fn errors(&self) -> Option<Errors> {
        let (last, velocity_final_m_s) = self.last?;
        let mean = |squares: f64| (squares / self.instants as f64).sqrt();
        Some(Errors {
            instants: self.instants,
            position_rmse_m: mean(self.position_squares),
            position_final_m: last.position_m,
            rotation_rmse_rad: mean(self.rotation_squares),
            rotation_final_rad: last.rotation_rad,
            velocity_final_m_s,
            ate_m: self.alignment.rmse(),
        })
    }
}
