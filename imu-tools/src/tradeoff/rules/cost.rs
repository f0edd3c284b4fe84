//! What a step costs: from a sample, or an increment, to the moved state.

use std::hint::black_box;
use std::time::Instant;

use imu_core::integrate::{
    self, ConingSculling, Euler, Midpoint, PreviousIncrement, TextbookMidpoint, ThreeSample,
    TwoSample,
};
use imu_core::nalgebra::Vector3;
use imu_core::time::Step;
use imu_core::world::Flat;
use imu_core::{Compensated, Error, Real, State};

use super::follow::{
    Blocks, CARRIERS, Carrier, Carries, RULES, Record, Rule, begin, cast, halves, increments,
    samples,
};
use super::motion::{GRAVITY, Motion};

/// Steps of a pass: 4 kHz for one second, 0.2 MB of samples in `f64`.
const RATE: i64 = 4_096;
/// All take turns, and the fastest turn of each counts: some seconds in all, as neighbours on a shared machine come
/// and go.
const PASSES: usize = 1000;

/// The price of a rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Price {
    /// The rule.
    pub rule: Rule,
    /// In what numbers.
    pub carrier: Carrier,
    /// Nanoseconds of a step.
    pub ns: f64,
}

/// The prices of all, and that of the midpoint rule of textbooks in `f64`.
pub(super) fn measure() -> Result<(Vec<Price>, f64), Error> {
    let stamps = (0..=RATE).map(|k| k * 1_000_000_000 / RATE).collect();
    let record = Record::new(Motion::Gait, stamps, true);
    let (double, single) = (Inputs::<f64>::of(&record)?, Inputs::<f32>::of(&record)?);
    let mut textbook = f64::INFINITY;
    let mut prices: Vec<Price> = CARRIERS
        .iter()
        .flat_map(|&carrier| RULES.map(|rule| Price { rule, carrier, ns: f64::INFINITY }))
        .collect();
    for _ in 0..PASSES {
        let first = &double.samples[0];
        textbook = textbook
            .min(double.time::<State<f64>, _>(TextbookMidpoint::new(first), &double.samples));
        for Price { rule, carrier, ns } in &mut prices {
            let time = match carrier {
                Carrier::F64 => double.pass::<State<f64>>(*rule),
                Carrier::F32 => single.pass::<State<f32>>(*rule),
                Carrier::F32Blocks => single.pass::<Blocks>(*rule),
                Carrier::F32Compensated => single.pass::<Compensated<f32>>(*rule),
            };
            *ns = ns.min(time);
        }
    }
    Ok((prices, textbook))
}

/// What all rules take.
struct Inputs<T: Real> {
    begin: State<T>,
    dt: Step<T>,
    world: Flat<T>,
    samples: Vec<imu_core::sample::Sample<T>>,
    increments: Vec<imu_core::sample::Increment<T>>,
    halves: Vec<integrate::Halves<T>>,
}

impl<T: Real> Inputs<T> {
    fn of(record: &Record) -> Result<Self, Error> {
        let increments = increments(record)?;
        Ok(Self {
            begin: begin(&record.truth[0])?,
            dt: Step::from_nanoseconds(1_000_000_000 / RATE)?,
            world: Flat::new(cast(&Vector3::new(0.0, 0.0, -GRAVITY)))?,
            samples: samples(record)?,
            halves: halves(&increments),
            increments,
        })
    }

    /// Nanoseconds of a step.
    fn pass<C: Carries<T>>(&self, rule: Rule) -> f64 {
        let first = &self.samples[0];
        match rule {
            Rule::Euler => self.time::<C, _>(Euler, &self.samples),
            Rule::Midpoint => self.time::<C, _>(Midpoint::new(first), &self.samples),
            Rule::ConingSculling => self.time::<C, _>(ConingSculling::new(first), &self.samples),
            Rule::ThreeSample => self.time::<C, _>(ThreeSample::new(first), &self.samples),
            Rule::PreviousIncrement => {
                self.time::<C, _>(PreviousIncrement::new(), &self.increments)
            }
            Rule::TwoSample => self.time::<C, _>(TwoSample, &self.halves),
        }
    }

    fn time<C: Carries<T>, R: integrate::Rule<T>>(&self, mut rule: R, inputs: &[R::Input]) -> f64 {
        let mut carried = C::from(self.begin);
        let start = Instant::now();
        for input in black_box(inputs) {
            carried.advance(&mut rule, input, &self.dt, &self.world);
        }
        black_box(carried.state());
        start.elapsed().as_secs_f64() * 1e9 / inputs.len() as f64
    }
}
