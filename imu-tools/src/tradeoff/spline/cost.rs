//! What a full state costs: `T_wb`, v, ω, a and α at one instant.

use std::hint::black_box;
use std::time::Instant;

use imu_core::spline::Full;
use imu_core::{Error, Real};

use super::curves::{Control, FORMS, Form, NUMBERS, Numbers, Stored, Use};
use super::poses;
use crate::tradeoff::rules::motion::Motion;

/// Instants of a pass, in order, and the knots that they are spread over: half a minute of the ellipse, 0.1 MB of knots
/// in `f64`. Neighbours turn by 2° there: no angle needs more than a polynomial.
const INSTANTS: i64 = 1024;
const STEP_NS: u32 = 50_000_000;
const INTERVALS: usize = 600;
/// All take turns, and the fastest turn of each counts, as of integration rules.
const PASSES: usize = 1000;

/// The price of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Price {
    /// Of which form.
    pub form: Form,
    /// In which numbers.
    pub numbers: Numbers,
    /// Nanoseconds of a full state.
    pub ns: f64,
}

/// The prices of all.
pub(super) fn measure() -> Result<Vec<Price>, Error> {
    let poses = poses(Motion::Ellipse, STEP_NS, INTERVALS)?;
    let mut contenders: Vec<(Price, Stored)> = Vec::new();
    for form in FORMS {
        let points = poses.control(form, Control::QuasiInterpolant)?;
        for numbers in NUMBERS {
            let price = Price { form, numbers, ns: f64::INFINITY };
            contenders.push((price, points.stored(form, numbers)?));
        }
    }
    let span = INTERVALS as i64 * i64::from(STEP_NS);
    let mut pass = Pass { instants: (0..INSTANTS).map(|k| k * span / INSTANTS).collect() };
    for _ in 0..PASSES {
        for (price, stored) in &mut contenders {
            price.ns = price.ns.min(stored.used(&mut pass)?);
        }
    }
    Ok(contenders.into_iter().map(|(price, _)| price).collect())
}

struct Pass {
    instants: Vec<i64>,
}

impl Use for Pass {
    type Out = f64;

    fn with<T: Real>(
        &mut self,
        full: impl Fn(i64) -> Result<Full<T>, Error>,
    ) -> Result<f64, Error> {
        let start = Instant::now();
        for &t_ns in black_box(&self.instants) {
            black_box(full(t_ns)?);
        }
        Ok(start.elapsed().as_secs_f64() * 1e9 / self.instants.len() as f64)
    }
}
