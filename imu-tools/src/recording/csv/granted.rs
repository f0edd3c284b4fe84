//! The units of a table: those that were given or told, or else those that are taken for granted,
//! which is said.

use super::columns::{Column, Columns};
use super::time_unit;
use crate::error::Error;
use crate::recording::{ForceUnit, Note, RateUnit, ReadOptions, TimeUnit};

/// Finds the units of a table's columns, and keeps what there is to say of them.
pub struct Granted<'a> {
    columns: &'a Columns,
    options: &'a ReadOptions,
    /// What errors call the table, and where units were told.
    name: &'a str,
    told_in: &'a str,
    granted: Vec<String>,
}

/// Factors to rad/s and m/s².
pub struct Factors {
    /// Of angular rates.
    pub rate: f64,
    /// Of specific forces.
    pub force: f64,
}

impl<'a> Granted<'a> {
    /// Of the table `name`, which told units in `told_in`, such as `the header of a.csv`.
    pub fn new(
        columns: &'a Columns,
        options: &'a ReadOptions,
        name: &'a str,
        told_in: &'a str,
    ) -> Self {
        Self { columns, options, name, told_in, granted: Vec::new() }
    }

    /// The unit of time: the one given, or told, or the one that these first times show.
    ///
    /// # Errors
    /// When what was told is unclear, or no IMU has the rate that follows.
    pub fn time(&mut self, given: Option<TimeUnit>, times: &[&[u8]]) -> Result<TimeUnit, Error> {
        let said = self.columns.time.unless(given);
        let said = said.map_err(|what| self.unclear(what, "--time-unit"))?;
        let unit = said.unwrap_or_else(|| {
            let unit = time_unit::from_data(times);
            self.granted.push(format!("time as {} (--time-unit)", unit.symbol()));
            unit
        });
        match time_unit::refusal(self.name, times, unit) {
            Some(why) => Err(Error::data(why)),
            None => Ok(unit),
        }
    }

    /// The factors of both sensors, and all that there is to say.
    ///
    /// # Errors
    /// When what was told is unclear.
    pub fn sensors(mut self) -> Result<(Factors, Vec<Note>), Error> {
        let rate = self.columns.rate.unless(self.options.gyro_unit);
        let rate = rate.map_err(|what| self.unclear(what, "--gyro-unit"))?;
        let force = self.columns.force.unless(self.options.accel_unit);
        let force = force.map_err(|what| self.unclear(what, "--accel-unit"))?;
        let (name, mut notes) = (self.name, Vec::new());
        if !self.columns.has(Column::Rate(0)) {
            notes.push(Note::Warning(format!("{name} has no columns of a gyroscope")));
        } else if rate.is_none() {
            self.granted.push(match self.columns.angles {
                true => "increments of angle as rad (--gyro-unit, deg/s of deg)".into(),
                false => "angular rate as rad/s (--gyro-unit)".into(),
            });
        }
        if !self.columns.has(Column::Force(0)) {
            notes.push(Note::Warning(format!("{name} has no columns of an accelerometer")));
        } else if force.is_none() {
            self.granted.push(match self.columns.velocities {
                true => "increments of velocity as m/s (--accel-unit, g of g s)".into(),
                false => "specific force as m/s^2 (--accel-unit)".into(),
            });
        }
        if !self.granted.is_empty() {
            notes.push(Note::Info(format!("{name} is read with {}", self.granted.join(", "))));
        }
        let rate = rate.unwrap_or(RateUnit::RadPerS).to_rad_s();
        let force = force.unwrap_or(ForceUnit::MPerS2).to_m_s2();
        Ok((Factors { rate, force }, notes))
    }

    /// The error for a unit that was told and cannot be used.
    fn unclear(&self, what: &str, flag: &str) -> Error {
        Error::data(format!("in {}, {what}; say which it is with {flag}", self.told_in))
    }
}
