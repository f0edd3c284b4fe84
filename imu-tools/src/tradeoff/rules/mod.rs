//! Integration rules: how far off each is, on smooth and rough motions, at any rate and in any numbers; and what it
//! costs.
//!
//! Errors are of dead reckoning from the true beginning, the largest at any step of a motion; or, with noise, root mean
//! squares over many records of those at its end. The price is that of a whole step, from sample to moved state, on
//! the machine that runs this, beside the midpoint rule of textbooks.

mod cost;
pub mod follow;
pub mod motion;
mod noisy;

pub use cost::Price;
pub use noisy::{GRADES, Grade, Noisy};

use crate::error::Error;
use follow::{CARRIERS, Carrier, Errors, RULES, Record, Rule, follow};
use motion::{MOTIONS, Motion};

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Rates of clean data, Hz, rising.
    pub rates: Vec<u32>,
    /// Rates of noisy data, Hz, rising.
    pub noisy_rates: Vec<u32>,
    /// Noisy records of each motion, rate and grade.
    pub records: u64,
    /// Seed of the first record.
    pub seed: u64,
}

impl Default for Plan {
    /// 100 Hz to 8 kHz, with noise at 200 Hz and 1 kHz in 200 records.
    fn default() -> Self {
        Self {
            rates: vec![100, 200, 500, 1000, 2000, 4000, 8000],
            noisy_rates: vec![200, 1000],
            records: 200,
            seed: 1,
        }
    }
}

impl Plan {
    /// The fastest rate, Hz: a minute of it is kept in memory.
    pub const FASTEST: u32 = 32_000;

    /// # Errors
    /// When there are no rates, one of them is 0 or above [`Self::FASTEST`], or there are no records or more than 10 000.
    pub fn check(&self) -> Result<(), Error> {
        let fine = |rate: &u32| (1..=Self::FASTEST).contains(rate);
        if self.rates.is_empty() || !self.rates.iter().chain(&self.noisy_rates).all(fine) {
            return Err(Error::usage(format!(
                "rates are whole numbers of Hz from 1 to {}",
                Self::FASTEST
            )));
        }
        if !(1..=10_000).contains(&self.records) {
            return Err(Error::usage("records are from 1 to 10000".to_owned()));
        }
        Ok(())
    }

    /// Steps of progress: clean motions and rates, then noisy records.
    #[must_use]
    pub fn steps(&self) -> u64 {
        (MOTIONS.len() * self.rates.len()) as u64 + noisy::records(self)
    }
}

/// The largest errors of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clean {
    /// What was followed.
    pub motion: Motion,
    /// By what.
    pub rule: Rule,
    /// In what numbers.
    pub carrier: Carrier,
    /// Samples, or increments, a second.
    pub rate: u32,
    /// How far off.
    pub errors: Errors,
}

/// All that was measured.
#[derive(Clone, Debug)]
pub struct Tradeoff {
    /// What was asked for.
    pub plan: Plan,
    /// Of clean data.
    pub clean: Vec<Clean>,
    /// Of noisy data.
    pub noisy: Vec<Noisy>,
    /// Of every rule in all numbers.
    pub prices: Vec<Price>,
    /// A step of the midpoint rule of textbooks, in `f64`, ns.
    pub textbook_ns: f64,
}

/// A way to an accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// The run.
    pub run: Clean,
    /// Nanoseconds of computing for each second of motion.
    pub ns_per_second: f64,
}

impl Tradeoff {
    /// The price of a run, ns for each second of motion.
    #[must_use]
    pub fn way(&self, run: &Clean) -> Option<Way> {
        let price = self.prices.iter().find(|p| p.rule == run.rule && p.carrier == run.carrier)?;
        let ns_per_second = price.ns * f64::from(run.rate) / run.rule.inputs_per_step();
        Some(Way { run: *run, ns_per_second })
    }

    /// The cheapest run on samples, in one of these kinds of numbers, that keeps the attitude of a motion within so many
    /// degrees; of runs of which the price differs by less than 5 % (what timing scatters by) the more accurate one.
    #[must_use]
    pub fn cheapest(&self, motion: Motion, within_deg: f64, carriers: &[Carrier]) -> Option<Way> {
        let good = self.clean.iter().filter(|run| {
            run.motion == motion
                && !run.rule.takes_increments()
                && carriers.contains(&run.carrier)
                && run.errors.attitude_deg <= within_deg
        });
        let ways: Vec<Way> = good.filter_map(|run| self.way(run)).collect();
        let least = ways.iter().map(|way| way.ns_per_second).fold(f64::INFINITY, f64::min);
        let near = ways.into_iter().filter(|way| way.ns_per_second <= 1.05 * least);
        near.min_by(|a, b| a.run.errors.attitude_deg.total_cmp(&b.run.errors.attitude_deg))
    }
}

/// Follows all motions and times all rules. `progress` is told the steps that are done, of [`Plan::steps`].
///
/// # Errors
/// As [`Plan::check`].
pub fn measure(plan: &Plan, mut progress: impl FnMut(u64)) -> Result<Tradeoff, Error> {
    plan.check()?;
    let mut clean = Vec::new();
    let mut done = 0;
    for motion in MOTIONS {
        for &rate in &plan.rates {
            let record = Record::at_rate(motion, rate, true);
            for carrier in CARRIERS {
                for rule in RULES {
                    let errors = follow(&record, rule, carrier).map_err(impossible)?;
                    clean.push(Clean { motion, rule, carrier, rate, errors });
                }
            }
            done += 1;
            progress(done);
        }
    }
    let noisy = noisy::measure(plan, |records| progress(done + records))?;
    let (prices, textbook_ns) = cost::measure().map_err(impossible)?;
    Ok(Tradeoff { plan: plan.clone(), clean, noisy, prices, textbook_ns })
}

/// What the core refuses of motions that are known to be fine.
fn impossible(error: imu_core::Error) -> Error {
    Error::data(format!("a motion of the trade-off cannot be followed: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_that_make_no_sense_are_refused() {
        let wrong = [
            Plan { rates: vec![], ..Plan::default() },
            Plan { rates: vec![0], ..Plan::default() },
            Plan { noisy_rates: vec![Plan::FASTEST + 1], ..Plan::default() },
            Plan { records: 0, ..Plan::default() },
        ];
        assert!(wrong.iter().all(|plan| plan.check().is_err()));
        assert!(Plan::default().check().is_ok());
    }

    #[test]
    fn the_cheapest_way_is_the_slowest_rate_that_will_do() {
        let plan = Plan { rates: vec![50, 100], noisy_rates: vec![], records: 1, seed: 1 };
        let mut seen = 0;
        let mut tradeoff = measure(&plan, |done| seen = done).unwrap();
        assert_eq!(seen, plan.steps());
        assert_eq!(tradeoff.clean.len(), 5 * 2 * 4 * 6);
        assert!(tradeoff.prices.iter().all(|price| price.ns > 0.0) && tradeoff.textbook_ns > 0.0);
        // Prices of a quiet machine.
        for price in &mut tradeoff.prices {
            price.ns = if price.rule == Rule::ThreeSample { 35.0 } else { 25.0 };
        }
        let way = tradeoff.cheapest(Motion::Ellipse, 1.0, &CARRIERS).unwrap();
        assert_eq!((way.run.rate, way.ns_per_second), (50, 1250.0));
        let way = tradeoff.cheapest(Motion::Ellipse, 1e-4, &CARRIERS).unwrap();
        assert_eq!((way.run.rule, way.run.rate), (Rule::ThreeSample, 50));
        assert_eq!(tradeoff.cheapest(Motion::Spin, 1e-9, &CARRIERS), None);
    }
}
