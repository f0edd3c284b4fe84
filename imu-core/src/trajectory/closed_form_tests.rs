//! Every motion in closed form reads the derivatives of its own poses.

use super::*;
use crate::so3;
use proptest::prelude::*;
use std::boxed::Box;
use std::vec::Vec;

/// Each with the rate of its fastest wave, rad/s.
fn all() -> Vec<(Box<dyn Trajectory<f64>>, f64)> {
    const PI: f64 = core::f64::consts::PI;
    std::vec![
        (Box::new(Rest::default()), 1.0),
        (Box::new(Ellipse::default()), PI),
        (Box::new(Gait::default()), 12.0 * PI),
        (Box::new(Coning::default()), 50.0 * PI),
        (Box::new(Spin::default()), 160.0 * PI),
    ]
}

fn largest(v: Vector3<f64>) -> f64 {
    v.abs().max()
}

proptest! {
    /// Central differences of step h are off by (wh)²/6 of the largest derivative, here a hundredth of a thousandth;
    /// rounding of poses up to 700 m and 2000 rad away takes 1e-13/h, of rates 1e-14/h.
    #[test]
    fn readings_are_the_derivatives_of_the_poses(t_ns in 0_i64..60_000_000_000) {
        for (trajectory, fastest) in all() {
            let h_ns = (5e6 / fastest) as i64;
            let h = h_ns as f64 / 1e9;
            let [before, now, after] = [-h_ns, 0, h_ns].map(|dt| trajectory.at(t_ns + dt));
            let off = 1e-5;
            let v = (after.position_w - before.position_w) / (2.0 * h);
            let a = (after.velocity_w - before.velocity_w) / (2.0 * h);
            prop_assert!(largest(v - now.velocity_w) < off * (10.0 + 50.0 / fastest) + 2e-13 / h);
            let felt = so3::rotate(&now.attitude_wb, &now.specific_force);
            let size = 1.0 + largest(a);
            prop_assert!(largest(felt - a - Vector3::new(0.0, 0.0, GRAVITY)) < off * 60.0 * size + 2e-14 / h);
            let turn = so3::product(&so3::inverse(&before.attitude_wb), &after.attitude_wb);
            let rate = so3::log(&turn) / (2.0 * h);
            let size = 1.0 + largest(now.angular_rate);
            prop_assert!(largest(rate - now.angular_rate) < 3.0 * off * size + 1e-12 / h);
            prop_assert!((so3::length(&now.attitude_wb) - 1.0).abs() < 1e-14);

            let felt = trajectory.kinematics(t_ns, 0.0);
            prop_assert_eq!(felt.angular_rate, <[f64; 3]>::from(now.angular_rate));
            prop_assert_eq!(felt.specific_force, <[f64; 3]>::from(now.specific_force));
            let difference = (after.angular_rate - before.angular_rate) / (2.0 * h);
            let angular_acceleration = Vector3::from(felt.angular_acceleration);
            let size = 1.0 + fastest * (1.0 + largest(now.angular_rate));
            prop_assert!(largest(difference - angular_acceleration) < 3.0 * off * size + 1e-12 / h);
        }
    }
}
