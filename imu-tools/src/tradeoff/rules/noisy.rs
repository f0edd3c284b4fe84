//! The same with white noise: where the sensor errs more than the rule does, a better rule buys nothing.

use imu_core::State;
use imu_core::integrate::{self, ConingSculling, Euler, Midpoint, ThreeSample};
use imu_core::nalgebra::Vector3;
use imu_core::noise::{Sensor, Stage as _, ThreeAxis, White};
use imu_core::sample::Sample;
use imu_core::time::Step;
use imu_core::world::Flat;

use super::follow::{Errors, Record, Rule, begin};
use super::motion::{GRAVITY, MOTIONS, Motion};
use super::{Plan, impossible};
use crate::error::Error;
use crate::tradeoff::parallel;

/// White noise of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grade {
    /// What tables call it.
    pub name: &'static str,
    /// N of the gyroscope, rad/s/√Hz.
    pub gyroscope: f64,
    /// N of the accelerometer, m/s²/√Hz.
    pub accelerometer: f64,
}

const DEGREE_PER_ROOT_HOUR: f64 = std::f64::consts::PI / 180.0 / 60.0;
const MICRO_G: f64 = 9.806_65e-6;

/// Sensors of a telephone, of a good drone, and of an aircraft.
pub const GRADES: [Grade; 3] = [
    Grade {
        name: "consumer (0.6 °/√h, 300 µg/√Hz)",
        gyroscope: 0.6 * DEGREE_PER_ROOT_HOUR,
        accelerometer: 300.0 * MICRO_G,
    },
    Grade {
        name: "industrial (0.15 °/√h, 60 µg/√Hz)",
        gyroscope: 0.15 * DEGREE_PER_ROOT_HOUR,
        accelerometer: 60.0 * MICRO_G,
    },
    Grade {
        name: "tactical (0.01 °/√h, 15 µg/√Hz)",
        gyroscope: 0.01 * DEGREE_PER_ROOT_HOUR,
        accelerometer: 15.0 * MICRO_G,
    },
];

/// The rules that take samples: instants are what noise is usually seen on.
const RULES: [Rule; 4] = [Rule::Euler, Rule::Midpoint, Rule::ConingSculling, Rule::ThreeSample];

/// Errors at the end of a motion, over many records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noisy {
    /// What was followed.
    pub motion: Motion,
    /// Samples a second.
    pub rate: u32,
    /// With what noise.
    pub grade: Grade,
    /// By what, in `f64`.
    pub rule: Rule,
    /// Root mean squares over the records.
    pub rms: Errors,
    /// By how much of themselves they scatter, one standard deviation: 1/√(2 records), of errors that are mostly noise.
    pub scatter: f64,
}

/// Records in all.
pub(super) fn records(plan: &Plan) -> u64 {
    (MOTIONS.len() * plan.noisy_rates.len()) as u64 * plan.records
}

/// All of them, on all processors; `progress` is told the records that are done.
pub(super) fn measure(plan: &Plan, mut progress: impl FnMut(u64)) -> Result<Vec<Noisy>, Error> {
    let mut noisy = Vec::new();
    let mut done = 0;
    for motion in MOTIONS {
        for &rate in &plan.noisy_rates {
            let record = Record::at_rate(motion, rate, false);
            let squares = sum_of_squares(plan, &record, rate, || {
                done += 1;
                progress(done);
            })?;
            let mean = 1.0 / plan.records as f64;
            for (grade, squares) in GRADES.into_iter().zip(squares) {
                for (rule, sum) in RULES.into_iter().zip(squares) {
                    let rms = Errors {
                        attitude_deg: (sum.attitude_deg * mean).sqrt(),
                        velocity: (sum.velocity * mean).sqrt(),
                        position: (sum.position * mean).sqrt(),
                    };
                    let scatter = 1.0 / (2.0 * plan.records as f64).sqrt();
                    noisy.push(Noisy { motion, rate, grade, rule, rms, scatter });
                }
            }
        }
    }
    Ok(noisy)
}

/// Of each grade and rule.
type Squares = [[Errors; RULES.len()]; GRADES.len()];

fn sum_of_squares(
    plan: &Plan,
    record: &Record,
    rate: u32,
    done: impl FnMut(),
) -> Result<Squares, Error> {
    let of = |k| squares(record, rate, plan.seed.wrapping_add(k)).map_err(impossible);
    let all = parallel::each(plan.records, of, done)?;
    let mut sum = Squares::default();
    for squares in all {
        for (sum, more) in sum.as_flattened_mut().iter_mut().zip(squares.as_flattened()) {
            sum.attitude_deg += more.attitude_deg;
            sum.velocity += more.velocity;
            sum.position += more.position;
        }
    }
    Ok(sum)
}

/// The squares of the errors at the end of one record.
fn squares(record: &Record, rate: u32, seed: u64) -> Result<Squares, imu_core::Error> {
    // One noise for all grades, of density 1.
    let unit = |sensor| {
        let white = [White { noise_density: 1.0 }; 3];
        ThreeAxis::prepare(white, 1.0 / f64::from(rate), seed, sensor)
    };
    let (mut gyroscope, mut accelerometer) =
        (unit(Sensor::GYROSCOPE)?, unit(Sensor::ACCELEROMETER)?);
    let noise: Vec<[Vector3<f64>; 2]> = record
        .truth
        .iter()
        .map(|_| [gyroscope.step([0.0; 3]).into(), accelerometer.step([0.0; 3]).into()])
        .collect();
    let mut squares = Squares::default();
    for (squares, grade) in squares.iter_mut().zip(GRADES) {
        let read = |(truth, [rate, force]): (&super::motion::Truth, &[Vector3<f64>; 2])| {
            Sample::new(
                truth.angular_rate + rate * grade.gyroscope,
                truth.specific_force + force * grade.accelerometer,
            )
        };
        let samples = record.truth.iter().zip(&noise).map(read);
        let samples = samples.collect::<Result<Vec<_>, _>>()?;
        let Some((first, rest)) = samples.split_first() else { continue };
        for (square, rule) in squares.iter_mut().zip(RULES) {
            let last = match rule {
                Rule::Euler => last(record, Euler, rest),
                Rule::Midpoint => last(record, Midpoint::new(first), rest),
                Rule::ConingSculling => last(record, ConingSculling::new(first), rest),
                _ => last(record, ThreeSample::new(first), rest),
            }?;
            *square = Errors {
                attitude_deg: last.attitude_deg.powi(2),
                velocity: last.velocity.powi(2),
                position: last.position.powi(2),
            };
        }
    }
    Ok(squares)
}

/// The errors at the end.
fn last<R: integrate::Rule<f64, Input = Sample<f64>>>(
    record: &Record,
    mut rule: R,
    samples: &[Sample<f64>],
) -> Result<Errors, imu_core::Error> {
    let world = Flat::new(Vector3::new(0.0, 0.0, -GRAVITY))?;
    let (Some(first), Some(end)) = (record.truth.first(), record.truth.last()) else {
        return Ok(Errors::default());
    };
    let mut state: State<f64> = begin(first)?;
    for (sample, stamps) in samples.iter().zip(record.stamps.windows(2)) {
        state.advance(&mut rule, sample, &Step::between(stamps[0], stamps[1])?, &world);
    }
    Ok(Errors::of(&state, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At rest white noise of the gyroscope turns by N√t about each axis: √3 N√T in all, and by one in 2R of itself
    /// more or less; six of those.
    #[test]
    fn noise_at_rest_is_the_angle_random_walk() {
        let plan = Plan { rates: vec![10], noisy_rates: vec![20], records: 100, ..Plan::default() };
        let noisy = measure(&plan, |_| {}).unwrap();
        let rest: Vec<_> = noisy.iter().filter(|row| row.motion == Motion::Rest).collect();
        assert_eq!(rest.len(), GRADES.len() * RULES.len());
        for row in rest {
            let walk = (row.grade.gyroscope * (3.0 * 60.0_f64).sqrt()).to_degrees();
            let off = row.rms.attitude_deg / walk - 1.0;
            assert!(off.abs() < 6.0 * row.scatter, "{row:?}: {walk}");
        }
    }
}
