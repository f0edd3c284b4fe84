//! What estimators of white noise N and random walk K are worth, and what they cost.
//!
//! Records of known noise at rest are simulated and given to all. The error is that of
//! K̂/K − 1, beside the limit √(2N/(KT)) that no estimator can beat on a record of length T (and
//! √(1/2n) of N, n samples); what an estimator does not call observable has no error, and is counted.
//!
//! ```
//! use imu_tools::tradeoff::allan::{Plan, measure};
//!
//! let plan = Plan { duration_s: 600.0, rate_hz: 10.0, records: 2, seed: 1 };
//! let tradeoff = measure(&plan, |_| {})?;
//! assert_eq!(tradeoff.rows.len(), 11);
//! # Ok::<(), imu_tools::error::Error>(())
//! ```

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::channel;

use imu_core::allan::Parameter;
use imu_core::noise::{RandomWalk, Sensor, Stage, ThreeAxis, White};

use super::cost::{self, Cost};
use super::estimators::{ESTIMATORS, Estimates, Estimator, estimate};
use crate::error::Error;

/// The noise of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// N, unit/√Hz.
    pub noise_density: f64,
    /// K, unit/s/√Hz.
    pub random_walk: f64,
}

/// The gyroscope and the accelerometer of the middle preset of `imu simulate`: N/K = 300 s and 38 s.
pub const NOISES: [Noise; 2] = [
    Noise { noise_density: 0.015, random_walk: 5e-5 },
    Noise { noise_density: 0.019, random_walk: 5e-4 },
];

/// What is simulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Length of a record, s.
    pub duration_s: f64,
    /// Samples a second. Error of K hardly depends on it.
    pub rate_hz: f64,
    /// Records of three axes, of each noise.
    pub records: u64,
    /// Seed of the first; they count up.
    pub seed: u64,
}

impl Default for Plan {
    /// 200 records of 4 h at 20 Hz.
    fn default() -> Self {
        Self { duration_s: 4.0 * 3600.0, rate_hz: 20.0, records: 200, seed: 1 }
    }
}

impl Plan {
    /// Samples of an axis.
    #[must_use]
    pub fn samples(&self) -> usize {
        (self.duration_s * self.rate_hz).round() as usize
    }

    /// Standard deviation of ln K that no estimator can beat.
    #[must_use]
    pub fn limit_of_random_walk(&self, noise: &Noise) -> f64 {
        (2.0 * noise.noise_density / (noise.random_walk * self.duration_s)).sqrt()
    }

    /// The same of ln N.
    #[must_use]
    pub fn limit_of_noise_density(&self) -> f64 {
        1.0 / (2.0 * self.samples() as f64).sqrt()
    }
}

/// How far estimates scatter about the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Root mean square of the relative error; NaN where there is no estimate.
    pub rms: f64,
    /// Standard deviation of that, by the number of records.
    pub rms_sd: f64,
    /// Median of the relative error.
    pub median: f64,
    /// Part of the 90 % intervals that hold the truth; `None` of a method that gives none.
    pub coverage: Option<f64>,
    /// Part of the records without an estimate.
    pub without: f64,
}

/// How well an estimator does on one noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Of N.
    pub noise_density: Scatter,
    /// Of K.
    pub random_walk: Scatter,
}

/// An estimator, what it costs, and what it is worth on each of [`NOISES`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Which one.
    pub estimator: Estimator,
    /// Its price.
    pub cost: Cost,
    /// Its errors.
    pub accuracy: [Accuracy; 2],
}

/// All of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Tradeoff {
    /// What was simulated.
    pub plan: Plan,
    /// A plain sum of the same values, ns a value: the baseline.
    pub sum_ns: f64,
    /// The cheapest estimator first.
    pub rows: Vec<Row>,
}

/// Simulates, estimates and times. `progress` is told the records that are done, of twice
/// [`Plan::records`].
///
/// # Errors
/// When the plan holds no number that can be simulated, or fewer than 1000 samples a record.
pub fn measure(plan: &Plan, mut progress: impl FnMut(u64)) -> Result<Tradeoff, Error> {
    if !(plan.duration_s * plan.rate_hz >= 1000.0 && plan.duration_s * plan.rate_hz < 1e8) {
        return Err(Error::usage(
            "a record of the trade-off has from 1000 to 100 million samples: choose another --duration \
             or --rate"
                .to_owned(),
        ));
    }
    let prices = cost::measure(1.0 / plan.rate_hz, &simulate(plan, &NOISES[0], plan.seed)?);
    let mut done = 0;
    let mut accuracies = Vec::new();
    for noise in &NOISES {
        let records = simulate_all(plan, noise, || {
            done += 1;
            progress(done);
        })?;
        accuracies.push(accuracy(&records, noise));
    }
    let rows =
        ESTIMATORS.iter().enumerate().zip(prices.costs).filter_map(|((k, &estimator), cost)| {
            let accuracy = [*accuracies.first()?.get(k)?, *accuracies.get(1)?.get(k)?];
            Some(Row { estimator, cost, accuracy })
        });
    Ok(Tradeoff { plan: *plan, sum_ns: prices.sum_ns, rows: rows.collect() })
}

/// A sensor at rest.
fn simulate(plan: &Plan, noise: &Noise, seed: u64) -> Result<Vec<[f64; 3]>, Error> {
    let terms = (
        White { noise_density: noise.noise_density },
        RandomWalk { random_walk: noise.random_walk },
    );
    let mut sensor = ThreeAxis::prepare([terms; 3], 1.0 / plan.rate_hz, seed, Sensor::GYROSCOPE)
        .map_err(|error| Error::usage(format!("this cannot be simulated: {error}")))?;
    Ok((0..plan.samples()).map(|_| sensor.step([0.0; 3])).collect())
}

/// The estimates of all axes of all records, on all processors; `done` is called after each record.
fn simulate_all(
    plan: &Plan,
    noise: &Noise,
    mut done: impl FnMut(),
) -> Result<Vec<Estimates>, Error> {
    let next = AtomicU64::new(0);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut records = vec![None; plan.records as usize];
    std::thread::scope(|scope| {
        let (to, from) = channel();
        for _ in 0..threads {
            let (to, next) = (to.clone(), &next);
            scope.spawn(move || {
                loop {
                    let record = next.fetch_add(1, Ordering::Relaxed);
                    if record >= plan.records {
                        return;
                    }
                    let values = simulate(plan, noise, plan.seed.wrapping_add(record));
                    let estimates = values.map(|values| estimate(1.0 / plan.rate_hz, &values));
                    if to.send((record, estimates)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(to);
        for (record, estimates) in from {
            if let Some(place) = records.get_mut(record as usize) {
                *place = Some(estimates?);
            }
            done();
        }
        Ok::<(), Error>(())
    })?;
    Ok(records.into_iter().flatten().flatten().collect())
}

/// How far the estimates of each estimator scatter.
fn accuracy(records: &[Estimates], noise: &Noise) -> Vec<Accuracy> {
    let of = |k: usize| records.iter().filter_map(move |record| record.get(k));
    (0..ESTIMATORS.len())
        .map(|k| Accuracy {
            noise_density: scatter(of(k).map(|(n, _)| *n), noise.noise_density),
            random_walk: scatter(of(k).map(|(_, k)| *k), noise.random_walk),
        })
        .collect()
}

fn scatter(estimates: impl Iterator<Item = Parameter>, truth: f64) -> Scatter {
    let (mut errors, mut held, mut intervals, mut all) = (Vec::new(), 0, 0, 0);
    for estimate in estimates {
        all += 1;
        let (low, high) = match estimate {
            Parameter::Observable { value, low90, high90, .. } => {
                errors.push(value / truth - 1.0);
                (low90, high90)
            }
            // All that is said is a bound.
            Parameter::NotObservable { upper90, .. } => (0.0, upper90),
        };
        if !high.is_nan() {
            intervals += 1;
            held += i32::from(low <= truth && truth <= high);
        }
    }
    let count = errors.len() as f64;
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt();
    errors.sort_unstable_by(f64::total_cmp);
    Scatter {
        rms,
        // As of independent Gaussian errors.
        rms_sd: rms / (2.0 * count).sqrt(),
        median: errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN),
        coverage: (intervals > 0).then(|| f64::from(held) / f64::from(intervals)),
        without: 1.0 - count / f64::from(all.max(1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::estimators::Method;

    #[test]
    fn scatters() {
        let seen = |value, low90, high90| Parameter::Observable { value, sd: 1.0, low90, high90 };
        let unseen = Parameter::NotObservable { upper90: 1.5, record_at_least_s: 1.0 };
        let estimates = [seen(3.0, 1.0, 4.0), seen(1.0, 0.5, 1.5), seen(2.0, 1.5, 2.5), unseen];
        let s = scatter(estimates.into_iter(), 2.0);
        assert!((s.rms - (0.5_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!((s.median, s.coverage, s.without), (0.0, Some(0.5), 0.25));
        let nothing = scatter([f64::NAN; 2].map(|v| seen(v, v, v)).into_iter(), 2.0);
        assert_eq!((nothing.coverage, nothing.without), (None, 0.0));
    }

    /// The errors of 60 axes scatter by 9 %: five of those, and what every estimator is known for.
    #[test]
    fn estimators_are_as_good_as_they_are_known_to_be() {
        let plan = Plan { duration_s: 14_400.0, rate_hz: 2.0, records: 20, seed: 1 };
        let tradeoff = measure(&plan, |_| {}).unwrap();
        for row in &tradeoff.rows {
            let k = row.accuracy[1].random_walk;
            let over = k.rms / plan.limit_of_random_walk(&NOISES[1]);
            let (low, high) = match row.estimator.method {
                Method::Fit => (0.5, 1.8),
                Method::MaximumLikelihood => (0.5, 1.6),
                Method::Slope => (1.2, 6.0),
            };
            assert!((low..high).contains(&over), "{:?}: {over} × limit", row.estimator);
            assert!(row.cost.ns_per_value > 0.0 && row.cost.state_bytes > 0);
        }
        assert!(measure(&Plan { rate_hz: f64::NAN, ..plan }, |_| {}).is_err());
    }
}
