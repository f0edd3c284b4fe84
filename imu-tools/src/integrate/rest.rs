//! A start from rest: level by gravity, the gyroscope's bias by its mean.
//!
//! Roll and pitch from the mean specific force, which at rest points up (Savage (1998), part 1; Titterton & Weston
//! (2004), section 10.2); heading cannot be seen, and is 0 where the truth does not tell it. Whether the sensor was at
//! rest is seen from the means of ten parts: they scatter no more than the noise within the parts explains.

use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::so3;

use super::motion::length;
use super::pairs::Row;
use crate::calibrate::gravity;

/// Parts that are compared.
const PARTS: usize = 10;
/// Means of parts may lie so many standard deviations apart: of ten, one in a million does by noise alone.
const SCATTER: f64 = 8.0;
/// And so far in any case: rad/s, m/s².
const STILL: [f64; 2] = [0.01, 0.05];
/// No gyroscope that stands still reads as much, rad/s.
const LARGEST_BIAS: f64 = 0.35;

/// What a sensor read at rest, on average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rest {
    /// rad/s.
    pub(super) rate: Vector3<f64>,
    /// m/s².
    pub(super) force: Vector3<f64>,
}

impl Rest {
    /// The means of these readings.
    ///
    /// # Errors
    /// What shows that it was not at rest, to follow "the first … s are not at rest: ".
    pub(super) fn of(rows: &[Row]) -> Result<Self, String> {
        if rows.len() < 2 * PARTS {
            return Err(format!("{} samples do not show it", rows.len()));
        }
        let rates: Vec<_> = rows.iter().map(|row| row.reading.angular_rate()).collect();
        let forces: Vec<_> = rows.iter().map(|row| row.reading.specific_force()).collect();
        for (values, still, name, unit) in [
            (&rates, STILL[0], "angular rate", "rad/s"),
            (&forces, STILL[1], "specific force", "m/s²"),
        ] {
            for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
                let values: Vec<f64> = values.iter().map(|v| v[axis]).collect();
                let (range, allowed) = scatter(&values, still);
                if range > allowed {
                    return Err(format!(
                        "the {name} {letter} changes by {range:.3} {unit}, of which noise explains {allowed:.3}"
                    ));
                }
            }
        }
        let rest = Self { rate: mean(&rates), force: mean(&forces) };
        if length(&rest.rate) > LARGEST_BIAS {
            let rate = length(&rest.rate);
            return Err(format!("the angular rate is {rate:.3} rad/s on average"));
        }
        match gravity::check(rest.force.into()) {
            gravity::Verdict::Plausible => Ok(rest),
            gravity::Verdict::OtherUnit(why) | gravity::Verdict::Odd(why) => Err(why),
        }
    }
}

/// How far the means of parts lie apart, and how far they may.
fn scatter(values: &[f64], still: f64) -> (f64, f64) {
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
    let squares: f64 = steps.map(|step| step * step).sum();
    let noise = (squares / (2.0 * (values.len() - 1) as f64)).sqrt();
    let each = values.len() / PARTS;
    let means = values.chunks_exact(each).map(|part| part.iter().sum::<f64>() / each as f64);
    let (low, high) =
        means.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), m| (l.min(m), h.max(m)));
    (high - low, still.max(SCATTER * noise / (each as f64).sqrt()))
}

fn mean(values: &[Vector3<f64>]) -> Vector3<f64> {
    values.iter().sum::<Vector3<f64>>() / values.len() as f64
}

/// q_wb of a body that feels this force at rest and looks in this direction, rad from x to y.
pub(super) fn level(force: &Vector3<f64>, heading: f64) -> Quaternion<f64> {
    let roll = force.y.atan2(force.z);
    let pitch = (-force.x).atan2(force.y.hypot(force.z));
    let turn = |axis: [f64; 3], angle: f64| so3::exp(Vector3::from(axis) * angle);
    let tilt = so3::product(&turn([0.0, 1.0, 0.0], pitch), &turn([1.0, 0.0, 0.0], roll));
    so3::product(&turn([0.0, 0.0, 1.0], heading), &tilt)
}

/// In which direction a body looks: the angle from the world's x to y at which its x axis points, rad.
pub(super) fn heading(attitude_wb: &Quaternion<f64>) -> f64 {
    let ahead = so3::rotate(attitude_wb, &Vector3::x());
    ahead.y.atan2(ahead.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use imu_core::sample::Sample;

    fn rows(force: impl Fn(f64) -> Vector3<f64>) -> Vec<Row> {
        let row = |i: i64| {
            let t = i as f64 * 0.005;
            let shake = if i % 2 == 0 { 0.1 } else { -0.1 };
            let rate = Vector3::new(0.02 + shake, 0.0, 0.01);
            Row { stamp_ns: i * 5_000_000, reading: Sample::new(rate, force(t)).unwrap() }
        };
        (0..200).map(row).collect()
    }

    #[test]
    fn means_and_refusals() {
        let rest = Rest::of(&rows(|_| Vector3::new(0.0, 1.0, 9.75))).unwrap();
        assert!((rest.rate - Vector3::new(0.02, 0.0, 0.01)).abs().max() < 1e-12);
        let moving = Rest::of(&rows(|t| Vector3::new(0.0, t, 9.8))).unwrap_err();
        assert!(moving.contains("specific force y changes by 0.9"), "{moving}");
        let grams = Rest::of(&rows(|_| Vector3::new(0.0, 0.0, 1.0))).unwrap_err();
        assert!(grams.contains("--accel-unit g"), "{grams}");
        assert!(Rest::of(&rows(|_| Vector3::z())[..5]).unwrap_err().contains("5 samples"));
    }

    #[test]
    fn what_is_felt_points_up() {
        let force = Vector3::new(-2.0, 3.0, 9.0);
        let attitude = level(&force, 2.5);
        let up = so3::rotate(&attitude, &force) / length(&force);
        assert!((up - Vector3::z()).abs().max() < 1e-15);
        assert!((heading(&attitude) - 2.5).abs() < 1e-15);
    }
}
