//! Splines: how far off a curve is from the motion whose poses it was made of, in every form, at any knot spacing and in
//! any numbers; and what evaluating it costs.
//!
//! Errors are the largest between knots over the whole motion. The price is that of a full state, `T_wb`, v, ω, a and α,
//! on the machine that runs this; it does not depend on the spacing. Poses are exact: what noise of theirs does is
//! [`crate::spline`]'s to say.

mod cost;
mod curves;
mod errors;

pub use cost::Price;
pub use curves::{CONTROLS, Control, FORMS, Form, NUMBERS, Numbers};
pub use errors::Errors;

use imu_core::se3::Pose;

use super::rules::motion::{MOTIONS, Motion};
use crate::error::Error;
use curves::{BEYOND, Poses};
use errors::Truth;

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Knot spacings, s, falling.
    pub spacings_s: Vec<f64>,
    /// What is followed.
    pub motions: Vec<Motion>,
}

impl Default for Plan {
    /// 0.4 s down to 12.5 ms, of the ellipse and of a walk.
    fn default() -> Self {
        Self {
            spacings_s: vec![0.4, 0.2, 0.1, 0.05, 0.025, 0.0125],
            motions: vec![Motion::Ellipse, Motion::Gait],
        }
    }
}

impl Plan {
    /// The closest knots, s: a minute of them is kept in memory.
    pub const CLOSEST_S: f64 = 1e-3;

    /// # Errors
    /// Where there is no spacing or no motion; where a spacing is below [`Self::CLOSEST_S`], above 4 s, or leaves a motion
    /// fewer than four poses.
    pub fn check(&self) -> Result<(), Error> {
        let fine = |s: &f64| (Self::CLOSEST_S..=4.0).contains(s);
        if self.spacings_s.is_empty() || !self.spacings_s.iter().all(fine) {
            let closest = Self::CLOSEST_S;
            return Err(Error::usage(format!("knot spacings are from {closest} to 4 s")));
        }
        if self.motions.is_empty() {
            return Err(Error::usage("there is no motion to follow".to_owned()));
        }
        let short = self.motions.iter().find_map(|motion| {
            let spacing = self.spacings_s.iter().find(|s| 3.0 * **s > motion.duration_s())?;
            Some((motion, spacing))
        });
        match short {
            Some((motion, spacing)) => Err(Error::usage(format!(
                "knots {spacing} s apart leave {}, of {} s, fewer than four poses",
                motion.name(),
                motion.duration_s()
            ))),
            None => Ok(()),
        }
    }

    /// Steps of progress: motions and spacings.
    #[must_use]
    pub fn steps(&self) -> u64 {
        (self.motions.len() * self.spacings_s.len()) as u64
    }
}

/// Any of the motions by name.
///
/// # Errors
/// With the names that there are.
pub fn motion(name: &str) -> Result<Motion, Error> {
    Motion::named(name).ok_or_else(|| {
        let names = MOTIONS.map(Motion::name).join(", ");
        Error::usage(format!("there is no motion {name}: {names}"))
    })
}

/// A curve beside the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Whose poses it was made of.
    pub motion: Motion,
    /// Of which form it is.
    pub form: Form,
    /// Where its control points come from.
    pub control: Control,
    /// In which numbers.
    pub numbers: Numbers,
    /// From knot to knot, s.
    pub spacing_s: f64,
    /// How far off; `None` where poses, or control points, are half a turn apart.
    pub errors: Option<Errors>,
}

/// All that was measured.
#[derive(Clone, Debug)]
pub struct Tradeoff {
    /// What was asked for.
    pub plan: Plan,
    /// Of every curve.
    pub runs: Vec<Run>,
    /// Of every form in all numbers.
    pub prices: Vec<Price>,
}

impl Tradeoff {
    /// The runs of a curve, one for each spacing.
    pub fn of(
        &self,
        motion: Motion,
        form: Form,
        control: Control,
        numbers: Numbers,
    ) -> impl Iterator<Item = &Run> {
        let which = (motion, form, control, numbers);
        self.runs.iter().filter(move |r| (r.motion, r.form, r.control, r.numbers) == which)
    }

    /// The order of an error, from the two closest spacings; `None` of one spacing, or of no error.
    #[must_use]
    pub fn order(
        &self,
        motion: Motion,
        form: Form,
        control: Control,
        of: fn(&Errors) -> f64,
    ) -> Option<f64> {
        let runs = self.of(motion, form, control, Numbers::F64);
        let mut points = runs.filter_map(|run| Some((run.spacing_s, of(&run.errors?))));
        let mut wide = points.next()?;
        let mut close = points.next()?;
        for next in points {
            (wide, close) = (close, next);
        }
        let order = (wide.1 / close.1).ln() / (wide.0 / close.0).ln();
        order.is_finite().then_some(order)
    }

    /// The price of a run's curve, ns a full state.
    #[must_use]
    pub fn price(&self, run: &Run) -> Option<f64> {
        let price = self.prices.iter().find(|p| (p.form, p.numbers) == (run.form, run.numbers))?;
        Some(price.ns)
    }

    /// The way to an accuracy: knots as far apart as they may be, and of such curves the cheapest to evaluate; of prices
    /// that differ by less than 5 % (what timing scatters by) the more accurate one.
    #[must_use]
    pub fn best(&self, motion: Motion, of: fn(&Errors) -> f64, within: f64) -> Option<(Run, f64)> {
        let good = self.runs.iter().filter(|run| {
            run.motion == motion
                && run.control.is_right()
                && run.errors.as_ref().is_some_and(|errors| of(errors) <= within)
        });
        let ways: Vec<(Run, f64)> = good.filter_map(|r| Some((*r, self.price(r)?))).collect();
        let widest = ways.iter().map(|(run, _)| run.spacing_s).fold(0.0, f64::max);
        let wide = || ways.iter().filter(|(run, _)| run.spacing_s == widest);
        let least = wide().map(|(_, ns)| *ns).fold(f64::INFINITY, f64::min);
        let error = |run: &Run| run.errors.as_ref().map_or(f64::INFINITY, of);
        let near = wide().filter(|(_, ns)| *ns <= 1.05 * least);
        near.min_by(|(a, _), (b, _)| error(a).total_cmp(&error(b))).copied()
    }
}

/// Poses of a motion, and beyond both ends of its span.
fn poses(motion: Motion, step_ns: u32, intervals: usize) -> Result<Poses, imu_core::Error> {
    let beyond = BEYOND as i64;
    let all = (-beyond..=intervals as i64 + beyond).map(|k| {
        let truth = motion.at(k * i64::from(step_ns));
        Pose::new(truth.attitude_wb, truth.position_w)
    });
    Ok(Poses { start_ns: 0, step_ns, all: all.collect::<Result<_, _>>()? })
}

/// Makes all curves, holds them beside their motions, and times them. `progress` is told the steps that are done, of
/// [`Plan::steps`].
///
/// # Errors
/// As [`Plan::check`].
pub fn measure(plan: &Plan, mut progress: impl FnMut(u64)) -> Result<Tradeoff, Error> {
    plan.check()?;
    let impossible =
        |error| Error::data(format!("a motion of the trade-off has no curve: {error}"));
    let mut runs = Vec::new();
    let mut done = 0;
    for &motion in &plan.motions {
        for &spacing_s in &plan.spacings_s {
            let step_ns = (spacing_s * 1e9).round() as u32;
            let intervals = (motion.duration_s() * 1e9 / f64::from(step_ns)) as usize;
            let poses = poses(motion, step_ns, intervals).map_err(impossible)?;
            let mut truth = Truth::of(motion, step_ns, intervals);
            for form in FORMS {
                for control in CONTROLS.into_iter().filter(|control| control.is_for(form)) {
                    let points = poses.control(form, control).ok();
                    for numbers in NUMBERS {
                        let stored = points.as_ref().and_then(|p| p.stored(form, numbers).ok());
                        let errors = stored.and_then(|stored| stored.used(&mut truth).ok());
                        runs.push(Run { motion, form, control, numbers, spacing_s, errors });
                    }
                }
            }
            done += 1;
            progress(done);
        }
    }
    Ok(Tradeoff { plan: plan.clone(), runs, prices: cost::measure().map_err(impossible)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_that_make_no_sense_are_refused() {
        let with = |spacings_s: Vec<f64>| Plan { spacings_s, ..Plan::default() };
        for wrong in [vec![], vec![0.0], vec![-0.1], vec![f64::NAN], vec![61.0], vec![1e-4]] {
            assert!(with(wrong).check().is_err());
        }
        assert!(Plan { motions: vec![], ..Plan::default() }.check().is_err());
        assert!(Plan { motions: vec![Motion::Spin], ..with(vec![3.5]) }.check().is_err());
        assert!(Plan::default().check().is_ok() && with(vec![4.0]).check().is_ok());
        assert!(motion("gait").is_ok() && motion("jump").is_err());
    }

    #[test]
    fn the_way_to_an_accuracy_is_the_widest_spacing_that_will_do() {
        let plan =
            Plan { spacings_s: vec![0.4, 0.1], motions: vec![Motion::Ellipse, Motion::Spin] };
        let mut seen = 0;
        let mut tradeoff = measure(&plan, |done| seen = done).unwrap();
        assert_eq!(seen, plan.steps());
        assert_eq!(tradeoff.runs.len(), 2 * 2 * 8 * 4);
        assert!(tradeoff.prices.iter().all(|price| price.ns > 0.0));
        // Prices of a quiet machine.
        for price in &mut tradeoff.prices {
            let form = if price.form == Form::Symmetric { 220.0 } else { 110.0 };
            price.ns = if price.numbers == Numbers::F32Cached { 0.7 * form } else { form };
        }
        let rotation = |errors: &Errors| errors.rotation;
        let (run, ns) = tradeoff.best(Motion::Ellipse, rotation, 1e-3).unwrap();
        assert_eq!((run.spacing_s, run.form, ns), (0.4, Form::Plain, 77.0));
        let (run, _) = tradeoff.best(Motion::Ellipse, |e| e.position, 1e-4).unwrap();
        assert_eq!((run.spacing_s, run.control), (0.1, Control::Interpolation));
        assert_eq!(tradeoff.best(Motion::Ellipse, rotation, 1e-12), None);
    }
}
