//! Prints, as JSON, what preintegration makes of one second of a body that turns and is shaken, and the samples as an
//! Euler-like program needs them to integrate the same motion.
//!
//! `cargo run --release -p imu-tests --example preintegration -- RATE_HZ`; `tests/peers/check_gtsam.py` reads it.

use imu_core::Error;
use imu_core::integrate::{Midpoint, Rule};
use imu_core::nalgebra::{Matrix3, Vector3};
use imu_core::preintegrate::{NoiseDensities, WithCovariance};
use imu_core::sample::{Bias, Sample};
use imu_core::so3;
use imu_core::time::Step;
use serde_json::{Value, json};

const DENSITIES: NoiseDensities<f64> = NoiseDensities {
    gyro_noise_density: 2e-3,
    accel_noise_density: 2e-2,
    gyro_random_walk: 1e-5,
    accel_random_walk: 1e-4,
};

fn main() -> Result<(), Error> {
    let rate = std::env::args().nth(1).and_then(|rate| rate.parse().ok()).unwrap_or(200_u32);
    let dt = Step::<f64>::from_nanoseconds(1_000_000_000 / i64::from(rate.max(1)))?;
    let sample = |k: u32| {
        let t = f64::from(k) * dt.seconds();
        let (slow, fast) = ((3.0 * t).sin(), (9.0 * t).cos());
        Sample::new(
            Vector3::new(1.2 + 0.5 * fast, -0.8 * slow, 1.5),
            Vector3::new(4.0 * slow, 2.0, 9.81 + 3.0 * fast),
        )
    };
    let (bias, first) = (Bias::default(), sample(0)?);
    let mut ours = WithCovariance::new(Midpoint::new(&first), bias, &DENSITIES)?;
    let mut rule = Midpoint::new(&first);
    let mut steps = Vec::new();
    for k in 1..=rate {
        let sample = sample(k)?;
        ours.step(&sample, &dt);
        // What held over the step would turn and push the body as the midpoint rule does.
        let step = rule.step(&sample, &dt);
        let angular_rate = so3::log(&step.rotation()) / dt.seconds();
        steps.push(json!([vector(&angular_rate), vector(&(step.velocity() / dt.seconds()))]));
    }
    let (delta, jacobian, covariance) = (ours.delta(), ours.jacobian(), ours.covariance());
    let printed = json!({
        "dt": dt.seconds(),
        "gyro_noise_density": DENSITIES.gyro_noise_density,
        "accel_noise_density": DENSITIES.accel_noise_density,
        "steps": steps,
        "rotation_vector": vector(&so3::log(&delta.rotation())),
        "velocity": vector(&delta.velocity()),
        "position": vector(&delta.position()),
        "jacobian": {
            "rotation_gyro": rows(&jacobian.rotation_gyro),
            "velocity_gyro": rows(&jacobian.velocity_gyro),
            "velocity_accel": rows(&jacobian.velocity_accel),
            "position_gyro": rows(&jacobian.position_gyro),
            "position_accel": rows(&jacobian.position_accel),
        },
        "covariance": {
            "rotation": rows(&covariance.rotation),
            "rotation_velocity": rows(&covariance.rotation_velocity),
            "rotation_position": rows(&covariance.rotation_position),
            "velocity": rows(&covariance.velocity),
            "velocity_position": rows(&covariance.velocity_position),
            "position": rows(&covariance.position),
        },
    });
    println!("{printed}");
    Ok(())
}

fn vector(v: &Vector3<f64>) -> Value {
    json!([v.x, v.y, v.z])
}

fn rows(m: &Matrix3<f64>) -> Value {
    json!([0, 1, 2].map(|i| [m[(i, 0)], m[(i, 1)], m[(i, 2)]]))
}
