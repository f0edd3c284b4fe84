//! One rule, in one scalar, along one motion: how far off it is at worst.

use imu_core::delta::Delta;
use imu_core::integrate::{
    ConingSculling, Euler, Halves, Midpoint, PreviousIncrement, ThreeSample, TwoSample,
};
use imu_core::nalgebra::{Quaternion, Vector3};
use imu_core::sample::{Bias, Increment, Sample};
use imu_core::time::Step;
use imu_core::world::{Flat, World};
use imu_core::{Compensated, Error, Real, State, integrate, so3};

use super::motion::{GRAVITY, Motion, Truth};

/// An integration rule by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// [`Euler`].
    Euler,
    /// [`Midpoint`].
    Midpoint,
    /// [`ConingSculling`].
    ConingSculling,
    /// [`ThreeSample`].
    ThreeSample,
    /// [`PreviousIncrement`], of exact increments.
    PreviousIncrement,
    /// [`TwoSample`], of exact increments.
    TwoSample,
}

/// All of them, in the order of tables.
pub const RULES: [Rule; 6] = [
    Rule::Euler,
    Rule::Midpoint,
    Rule::ConingSculling,
    Rule::ThreeSample,
    Rule::PreviousIncrement,
    Rule::TwoSample,
];

impl Rule {
    /// What tables call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Euler => "Euler",
            Self::Midpoint => "midpoint",
            Self::ConingSculling => "coning+sculling",
            Self::ThreeSample => "three samples",
            Self::PreviousIncrement => "previous increment",
            Self::TwoSample => "two increments",
        }
    }

    /// Samples, or increments, that a step takes.
    #[must_use]
    pub fn inputs_per_step(self) -> f64 {
        if self == Self::TwoSample { 2.0 } else { 1.0 }
    }

    /// Whether it takes increments, and not samples.
    #[must_use]
    pub fn takes_increments(self) -> bool {
        matches!(self, Self::PreviousIncrement | Self::TwoSample)
    }
}

/// In what numbers the state is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carrier {
    /// A plain state in `f64`.
    F64,
    /// A plain state in `f32`.
    F32,
    /// Blocks of eight steps composed in `f32` before they move a compensated state in `f32`.
    F32Blocks,
    /// A compensated state in `f32`.
    F32Compensated,
}

/// All of them, in the order of tables.
pub const CARRIERS: [Carrier; 4] =
    [Carrier::F64, Carrier::F32, Carrier::F32Blocks, Carrier::F32Compensated];

impl Carrier {
    /// What tables call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
            Self::F32Blocks => "f32, blocks of 8",
            Self::F32Compensated => "f32, compensated",
        }
    }
}

/// What an IMU on a motion reads, at instants and between them, and where it is.
#[derive(Clone, Debug)]
pub struct Record {
    /// The stamps of the instants, ns.
    pub stamps: Vec<i64>,
    /// The truth at each instant.
    pub truth: Vec<Truth>,
    /// ∫ω dt and ∫f dt from each instant to the next.
    pub gathered: Vec<[Vector3<f64>; 2]>,
}

impl Record {
    /// A record of a motion at these stamps, ns. `gathered` is only worked out where increments are asked for.
    #[must_use]
    pub fn new(motion: Motion, stamps: Vec<i64>, increments: bool) -> Self {
        let truth = stamps.iter().map(|&ns| motion.at(ns)).collect();
        let gathered = if increments {
            stamps.windows(2).map(|pair| motion.gathered(pair[0], pair[1])).collect()
        } else {
            Vec::new()
        };
        Self { stamps, truth, gathered }
    }

    /// At an even rate over the motion's length, Hz.
    #[must_use]
    pub fn at_rate(motion: Motion, rate: u32, increments: bool) -> Self {
        let last = (motion.duration_s() * f64::from(rate)) as i64;
        let stamps = (0..=last).map(|k| k * 1_000_000_000 / i64::from(rate)).collect();
        Self::new(motion, stamps, increments)
    }
}

/// The largest errors of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Angle between the attitudes, °.
    pub attitude_deg: f64,
    /// m/s
    pub velocity: f64,
    /// m
    pub position: f64,
}

impl Errors {
    /// The larger ones of two.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        Self {
            attitude_deg: self.attitude_deg.max(other.attitude_deg),
            velocity: self.velocity.max(other.velocity),
            position: self.position.max(other.position),
        }
    }

    /// Of a state, beside the truth.
    #[must_use]
    pub fn of<T: Real>(state: &State<T>, truth: &Truth) -> Self {
        let [i, j, k, w] = <[T; 4]>::from(state.attitude_wb().coords).map(T::to_f64);
        let apart = so3::product(&so3::inverse(&truth.attitude_wb), &Quaternion::new(w, i, j, k));
        let double = |v: Vector3<T>| Vector3::from(<[T; 3]>::from(v).map(T::to_f64));
        Self {
            attitude_deg: norm(&so3::log(&apart)).to_degrees(),
            velocity: norm(&(double(state.velocity_w()) - truth.velocity_w)),
            position: norm(&(double(state.position_w()) - truth.position_w)),
        }
    }
}

/// Follows a record by a rule from its true beginning: the largest errors at any step.
///
/// # Errors
/// Where stamps are not in order, or more than 4.29 s apart.
pub fn follow(record: &Record, rule: Rule, carrier: Carrier) -> Result<Errors, Error> {
    match carrier {
        Carrier::F64 => by_rule::<f64, State<f64>>(record, rule),
        Carrier::F32 => by_rule::<f32, State<f32>>(record, rule),
        Carrier::F32Blocks => by_rule::<f32, Blocks>(record, rule),
        Carrier::F32Compensated => by_rule::<f32, Compensated<f32>>(record, rule),
    }
}

/// What carries a state along.
pub(super) trait Carries<T: Real>: From<State<T>> {
    /// As [`State::advance`].
    fn advance<R: integrate::Rule<T>>(
        &mut self,
        rule: &mut R,
        input: &R::Input,
        dt: &Step<T>,
        world: &impl World<T>,
    );

    /// The state, where all steps have come into it.
    fn state(&self) -> Option<State<T>>;
}

impl<T: Real> Carries<T> for State<T> {
    fn advance<R: integrate::Rule<T>>(
        &mut self,
        rule: &mut R,
        input: &R::Input,
        dt: &Step<T>,
        world: &impl World<T>,
    ) {
        State::advance(self, rule, input, dt, world);
    }

    fn state(&self) -> Option<State<T>> {
        Some(*self)
    }
}

impl<T: Real> Carries<T> for Compensated<T> {
    fn advance<R: integrate::Rule<T>>(
        &mut self,
        rule: &mut R,
        input: &R::Input,
        dt: &Step<T>,
        world: &impl World<T>,
    ) {
        Compensated::advance(self, rule, input, dt, world);
    }

    fn state(&self) -> Option<State<T>> {
        Some(Compensated::state(self))
    }
}

/// Two speeds: eight steps make a block, and blocks move the state.
pub(super) struct Blocks {
    state: Compensated<f32>,
    block: Delta<f32>,
    steps: u8,
}

impl From<State<f32>> for Blocks {
    fn from(state: State<f32>) -> Self {
        Self { state: state.into(), block: Delta::identity(), steps: 0 }
    }
}

impl Carries<f32> for Blocks {
    fn advance<R: integrate::Rule<f32>>(
        &mut self,
        rule: &mut R,
        input: &R::Input,
        dt: &Step<f32>,
        world: &impl World<f32>,
    ) {
        self.block = self.block.then(&rule.step(input, dt));
        self.steps += 1;
        if self.steps == 8 {
            self.state.apply(&self.block, world);
            (self.block, self.steps) = (Delta::identity(), 0);
        }
    }

    fn state(&self) -> Option<State<f32>> {
        (self.steps == 0).then_some(self.state.state())
    }
}

pub(in crate::tradeoff) fn norm(v: &Vector3<f64>) -> f64 {
    v.x.hypot(v.y).hypot(v.z)
}

/// Vectors in another scalar, each number rounded once.
pub(super) fn cast<T: Real>(v: &Vector3<f64>) -> Vector3<T> {
    Vector3::from(<[f64; 3]>::from(*v).map(T::from_f64))
}

/// The truth as a state.
pub(super) fn begin<T: Real>(truth: &Truth) -> Result<State<T>, Error> {
    let [i, j, k, w] = <[f64; 4]>::from(truth.attitude_wb.coords).map(T::from_f64);
    State::new(Quaternion::new(w, i, j, k), cast(&truth.velocity_w), cast(&truth.position_w))
}

/// Samples at all instants.
pub(super) fn samples<T: Real>(record: &Record) -> Result<Vec<Sample<T>>, Error> {
    let sample =
        |truth: &Truth| Sample::new(cast(&truth.angular_rate), cast(&truth.specific_force));
    record.truth.iter().map(sample).collect()
}

/// Increments between all instants.
pub(super) fn increments<T: Real>(record: &Record) -> Result<Vec<Increment<T>>, Error> {
    record
        .gathered
        .iter()
        .map(|[angle, velocity]| Increment::new(cast(angle), cast(velocity)))
        .collect()
}

/// Pairs of increments.
pub(super) fn halves<T: Real>(increments: &[Increment<T>]) -> Vec<Halves<T>> {
    let (pairs, _) = increments.as_chunks();
    pairs.iter().map(|&[first, second]| Halves { first, second }).collect()
}

/// Two increments and their lengths.
type Pair<T> = (Halves<T>, [Step<T>; 2]);

/// [`TwoSample`] of halves that need not be even: each pair brings its own lengths.
struct Pairs;

impl<T: Real> integrate::Rule<T> for Pairs {
    type Input = Pair<T>;
    const TRAPEZOID: bool = false;

    fn step(&mut self, (halves, [first, second]): &Self::Input, dt: &Step<T>) -> Delta<T> {
        let uneven = (first != second).then(|| TwoSample::uneven(halves, first, second));
        uneven.flatten().unwrap_or_else(|| TwoSample.step(halves, dt))
    }

    /// It remembers nothing.
    fn rebias(&mut self, _: &Bias<T>) {}
}

fn pairs<T: Real>(record: &Record) -> Result<Vec<Pair<T>>, Error> {
    let steps = record.stamps.windows(2).map(|pair| Step::between(pair[0], pair[1]));
    let steps = steps.collect::<Result<Vec<_>, _>>()?;
    let (steps, _) = steps.as_chunks();
    Ok(halves(&increments(record)?).into_iter().zip(steps.iter().copied()).collect())
}

fn by_rule<T: Real, C: Carries<T>>(record: &Record, rule: Rule) -> Result<Errors, Error> {
    if rule.takes_increments() {
        return match rule {
            Rule::TwoSample => run::<T, C, _>(record, Pairs, &pairs(record)?, 2),
            _ => run::<T, C, _>(record, PreviousIncrement::new(), &increments(record)?, 1),
        };
    }
    let samples = samples::<T>(record)?;
    let Some((first, rest)) = samples.split_first() else { return Ok(Errors::default()) };
    match rule {
        Rule::Euler => run::<T, C, _>(record, Euler, rest, 1),
        Rule::Midpoint => run::<T, C, _>(record, Midpoint::new(first), rest, 1),
        Rule::ConingSculling => run::<T, C, _>(record, ConingSculling::new(first), rest, 1),
        _ => run::<T, C, _>(record, ThreeSample::new(first), rest, 1),
    }
}

/// Each input brings the state `stride` instants further.
fn run<T: Real, C: Carries<T>, R: integrate::Rule<T>>(
    record: &Record,
    mut rule: R,
    inputs: &[R::Input],
    stride: usize,
) -> Result<Errors, Error> {
    let world = Flat::new(cast(&Vector3::new(0.0, 0.0, -GRAVITY)))?;
    let Some(first) = record.truth.first() else { return Ok(Errors::default()) };
    let mut carried = C::from(begin(first)?);
    let mut worst = Errors::default();
    let instants = record.stamps.iter().zip(&record.truth).step_by(stride);
    let mut before = record.stamps.first().copied().unwrap_or_default();
    for (input, (&stamp, truth)) in inputs.iter().zip(instants.skip(1)) {
        let dt = Step::between(before, stamp)?;
        carried.advance(&mut rule, input, &dt, &world);
        if let Some(state) = carried.state() {
            worst = worst.worse(Errors::of(&state, truth));
        }
        before = stamp;
    }
    Ok(worst)
}
