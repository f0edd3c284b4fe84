//! Dead reckoning by one rule: samples in, a state after each of them.

use imu_core::integrate::{
    ConingSculling, Euler, Halves, Midpoint, PreviousIncrement, Rule as _, TextbookEuler,
    TextbookMidpoint, ThreeSample, TwoSample,
};
use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::sample::{Bias, Increment, Sample};
use imu_core::time::Step;
use imu_core::world::{Flat, Gain, RotatingEarth, World};
use imu_core::{Error, State};

use super::method::Method;

/// The world that a recording was made in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    Flat(Flat<f64>),
    Earth(RotatingEarth<f64>),
}

impl World<f64> for Place {
    fn gain(
        &self,
        velocity_w: &Vector3<f64>,
        position_w: &Vector3<f64>,
        felt: &Gain<f64>,
        dt: f64,
    ) -> Gain<f64> {
        match self {
            Self::Flat(flat) => flat.gain(velocity_w, position_w, felt, dt),
            Self::Earth(earth) => earth.gain(velocity_w, position_w, felt, dt),
        }
    }

    fn turn(&self, dt: f64) -> Option<Quaternion<f64>> {
        match self {
            Self::Flat(flat) => flat.turn(dt),
            Self::Earth(earth) => earth.turn(dt),
        }
    }
}

/// A state and the rule that moves it.
#[derive(Clone, Debug)]
pub(super) struct Reckoner {
    rule: Rule,
    state: State<f64>,
}

#[derive(Clone, Debug)]
enum Rule {
    Euler(Euler),
    Midpoint(Midpoint<f64>),
    ConingSculling(ConingSculling<f64>),
    ThreeSample(ThreeSample<f64>),
    TextbookEuler(TextbookEuler),
    TextbookMidpoint(TextbookMidpoint<f64>),
    PreviousIncrement(PreviousIncrement<f64>),
    TwoIncrements(TwoIncrements),
}

impl Reckoner {
    /// Begins in this state at the instant of this sample.
    pub(super) fn new(method: Method, state: State<f64>, first: &Sample<f64>) -> Self {
        let rule = match method {
            Method::Euler => Rule::Euler(Euler),
            Method::Midpoint => Rule::Midpoint(Midpoint::new(first)),
            Method::ConingSculling => Rule::ConingSculling(ConingSculling::new(first)),
            Method::ThreeSample => Rule::ThreeSample(ThreeSample::new(first)),
            Method::TextbookEuler => Rule::TextbookEuler(TextbookEuler),
            Method::TextbookMidpoint => Rule::TextbookMidpoint(TextbookMidpoint::new(first)),
            Method::PreviousIncrement => Rule::PreviousIncrement(PreviousIncrement::new()),
            Method::TwoIncrements => Rule::TwoIncrements(TwoIncrements::new(state)),
        };
        Self { rule, state }
    }

    pub(super) fn state(&self) -> &State<f64> {
        &self.state
    }

    /// Takes the sample that came `dt` after the one before, less the bias.
    pub(super) fn advance(
        &mut self,
        sample: &Sample<f64>,
        bias: &Bias<f64>,
        dt: &Step<f64>,
        world: &Place,
    ) -> Result<(), Error> {
        let state = &mut self.state;
        let instant = sample.minus(bias);
        let gathered = || {
            Increment::from_means(sample.angular_rate(), sample.specific_force(), dt)
                .map(|increment| increment.minus(bias, dt))
        };
        match &mut self.rule {
            Rule::Euler(rule) => state.advance(rule, &instant, dt, world),
            Rule::Midpoint(rule) => state.advance(rule, &instant, dt, world),
            Rule::ConingSculling(rule) => state.advance(rule, &instant, dt, world),
            Rule::ThreeSample(rule) => state.advance(rule, &instant, dt, world),
            Rule::TextbookEuler(rule) => state.advance(rule, &instant, dt, world),
            Rule::TextbookMidpoint(rule) => state.advance(rule, &instant, dt, world),
            Rule::PreviousIncrement(rule) => state.advance(rule, &gathered()?, dt, world),
            Rule::TwoIncrements(rule) => *state = rule.advance(gathered()?, dt, world),
        }
        Ok(())
    }
}

/// Two increments a step, and a state after the first of them too.
///
/// The state in the middle of a step comes from the third-order rule with the increment before; the next step begins at
/// the end of the one before, not there, so that the order of the whole stays that of [`TwoSample`].
#[derive(Clone, Debug)]
struct TwoIncrements {
    between: PreviousIncrement<f64>,
    /// At the end of the last whole step.
    whole: State<f64>,
    first: Option<(Increment<f64>, Step<f64>)>,
}

impl TwoIncrements {
    /// Halves that differ by no more than rounding to nanoseconds are equal, ns.
    const ROUNDING: u32 = 2;

    fn new(state: State<f64>) -> Self {
        Self { between: PreviousIncrement::new(), whole: state, first: None }
    }

    fn advance(&mut self, second: Increment<f64>, dt: &Step<f64>, world: &Place) -> State<f64> {
        let half = self.between.step(&second, dt);
        let Some((first, before)) = self.first.take() else {
            self.first = Some((second, *dt));
            let mut middle = self.whole;
            middle.apply(&half, world);
            return middle;
        };
        let halves = Halves { first, second };
        let even = before.nanoseconds().abs_diff(dt.nanoseconds()) <= Self::ROUNDING;
        let nanoseconds = i64::from(before.nanoseconds()) + i64::from(dt.nanoseconds());
        let both = Step::from_nanoseconds(nanoseconds).ok().filter(|_| even);
        match both {
            Some(both) => self.whole.advance(&mut TwoSample, &halves, &both, world),
            None => match TwoSample::uneven(&halves, &before, dt) {
                Some(delta) => self.whole.apply(&delta, world),
                // Longer than any step: one by one.
                None => {
                    let mut rule = PreviousIncrement::new();
                    self.whole.advance(&mut rule, &halves.first, &before, world);
                    self.whole.advance(&mut rule, &halves.second, dt, world);
                }
            },
        }
        self.whole
    }
}
