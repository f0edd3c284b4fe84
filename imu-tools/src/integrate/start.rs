//! How an integration begins: in the state that the truth tells, or level where the sensor stood still.

use imu_core::nalgebra::Vector3;
use imu_core::sample::Bias;
use imu_core::so3;
use imu_core::world::{Flat, RotatingEarth};

use super::pairs::Row;
use super::reckoner::Place;
use super::rest::{self, Rest};
use super::run::{Phase, Run};
use super::truth::Begin;
use super::{Begun, GravityFrom, KnownBias, Motion, PathPoint, Start, USUAL_GRAVITY, motion};
use crate::error::Error;

impl Run<'_> {
    /// Begins here, if that can be.
    pub(super) fn wait(&mut self, row: Row) -> Result<(), Error> {
        let begin = self.begin(row.stamp_ns)?;
        if self.truth.is_some() && begin.is_none() {
            self.too_early += 1;
            return Ok(());
        }
        match begin.filter(|_| self.start == Start::Truth) {
            Some(begin) => {
                let bias = self.bias(Some(&begin));
                let (gravity, from) =
                    self.options.gravity.map_or((USUAL_GRAVITY, GravityFrom::Usual), |gravity| {
                        (gravity, GravityFrom::Given)
                    });
                self.set_out(row, begin.motion, bias, (gravity, from), begin.differenced)
            }
            None => {
                self.phase = Phase::Resting(vec![row], begin);
                Ok(())
            }
        }
    }

    /// What the truth says of this instant.
    pub(super) fn begin(&mut self, stamp_ns: i64) -> Result<Option<Begin>, Error> {
        let Some(truth) = &mut self.truth else { return Ok(None) };
        truth.skip_until(stamp_ns)?;
        truth.begin(stamp_ns)
    }

    /// The bias that was told; zero where none was.
    fn bias(&self, begin: Option<&Begin>) -> Bias<f64> {
        let none = Bias::default();
        match self.options.bias {
            None => none,
            Some(KnownBias::Given(bias)) => bias,
            Some(KnownBias::Truth) => begin.and_then(|begin| begin.bias).unwrap_or(none),
        }
    }

    /// Begins where the resting began, level.
    pub(super) fn rise(&mut self) -> Result<(), Error> {
        let Phase::Resting(rows, begin) = std::mem::replace(&mut self.phase, Phase::Stopped) else {
            return Ok(());
        };
        let Some(first) = rows.first().copied() else { return Ok(()) };
        let told = self.bias(begin.as_ref());
        let rest = Rest::of(&rows).map_err(|why| self.not_at_rest(&rows, &why))?;
        let force = rest.force - told.specific_force();
        let heading = begin.map_or(0.0, |begin| rest::heading(&begin.motion.attitude_wb));
        let attitude_wb = rest::level(&force, heading);
        let measured = (motion::length(&force), GravityFrom::Rest);
        self.force_at_rest = Some(measured.0);
        let gravity = self.options.gravity.map_or(measured, |g| (g, GravityFrom::Given));
        let bias = if self.options.bias.is_some() {
            told
        } else {
            let turning = match self.options.place {
                None => Vector3::zeros(),
                Some(place) => so3::rotate(&so3::inverse(&attitude_wb), &earth(place)?.rate()),
            };
            Bias::new(rest.rate - turning, Vector3::zeros()).map_err(|e| self.impossible(e))?
        };
        let position_w = begin.map_or(Vector3::zeros(), |begin| begin.motion.position_w);
        let motion = Motion { attitude_wb, velocity_w: Some(Vector3::zeros()), position_w };
        self.set_out(first, motion, bias, gravity, false)?;
        rows.into_iter().skip(1).try_for_each(|row| self.row(row))
    }

    fn not_at_rest(&self, rows: &[Row], why: &str) -> Error {
        let ends = rows.last().zip(rows.first());
        let span = ends.map_or(0, |(last, first)| last.stamp_ns.saturating_sub(first.stamp_ns));
        let mend = if self.truth.is_some() {
            "start from the truth (--start truth), or from a time at which it rests (--from)"
        } else {
            "name a truth to start from (--truth FILE), or start from a time at which it rests (--from)"
        };
        Error::data(format!(
            "the first {:.3} s of {} are not at rest ({why}): {mend}",
            span as f64 * 1e-9,
            self.path
        ))
    }

    /// The first step can be taken.
    fn set_out(
        &mut self,
        row: Row,
        motion: Motion,
        bias: Bias<f64>,
        gravity: (f64, GravityFrom),
        differenced: bool,
    ) -> Result<(), Error> {
        let gravity = match self.options.place {
            None => {
                let down = Vector3::new(0.0, 0.0, -gravity.0);
                self.place = Place::Flat(Flat::new(down).map_err(|e| self.impossible(e))?);
                gravity
            }
            Some(place) => {
                let earth = earth(place)?;
                self.place = Place::Earth(earth);
                (-earth.gravity().z, GravityFrom::Place)
            }
        };
        self.begun = Some(Begun {
            from: self.start,
            stamp_ns: row.stamp_ns,
            motion,
            bias,
            gravity: gravity.0,
            gravity_from: gravity.1,
            differenced,
        });
        if self.truth.is_some() {
            self.true_path.push(PathPoint { t_s: 0.0, position_w: motion.position_w.into() });
        }
        self.place_at(row, &motion)
    }
}

fn earth((latitude, height): (f64, f64)) -> Result<RotatingEarth<f64>, Error> {
    RotatingEarth::new(latitude, height).map_err(|_| {
        Error::usage("--latitude wants degrees from -90 to 90, --height metres within 100 km")
    })
}
