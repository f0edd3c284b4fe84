//! What the fields of a line are, and a line's numbers in SI units.

use std::fmt;

use super::Pointed;
use super::width::Width;
use crate::recording::csv::celsius::Celsius;
use crate::recording::csv::columns::{Column, Columns};
use crate::recording::csv::dialect::Dialect;
use crate::recording::csv::number;
use crate::recording::{ForceUnit, RateUnit, ReadOptions, TimeUnit};

/// Columns and units of lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    columns: Vec<Column>,
    width: Width,
    /// How the first row is written.
    dialect: Option<Dialect>,
    /// Unit of time, where it is told.
    pub time: Option<TimeUnit>,
    rate: RateUnit,
    force: ForceUnit,
    celsius: Celsius,
    /// Increments stand in the place of rates, each unit times a second.
    pub increments: bool,
    /// Units that nobody told.
    granted: bool,
}

/// A line's numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row<'a> {
    /// As it is written, with the unit's exponent still to be known; or whole seconds and nanoseconds.
    pub time: Option<Time<'a>>,
    /// rad/s, or rad
    pub rate: Option<[f64; 3]>,
    /// m/s², or m/s
    pub force: Option<[f64; 3]>,
    /// Degrees Celsius.
    pub celsius: Option<f64>,
}

/// A line's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Time<'a> {
    /// A number of units.
    Units(&'a [u8]),
    /// Nanoseconds.
    Nanoseconds(i64),
}

impl Layout {
    /// Of columns such as `t,gx,gy,gz,ax,ay,az`.
    pub fn of_spec(spec: &str, options: &ReadOptions) -> Result<Self, String> {
        Self::new(Columns::live_from_spec(spec)?, options)
    }

    /// Of a header, if it names a sensor.
    pub fn of_header(line: &[u8], options: &ReadOptions) -> Option<Self> {
        let line = match line {
            [b'#' | b'%', names @ ..] => names,
            names => names,
        };
        let names: Vec<&[u8]> = Dialect::of(line).fields(line).collect();
        if names.len() < 3 {
            return None;
        }
        let columns = match &options.map {
            Some(map) => Columns::from_map(map, &names),
            None => Columns::live_from_names(&names),
        };
        let layout = Self::new(columns.ok()?, options).ok()?;
        Some(Self { width: Width::told(names.len().max(layout.columns.len())), ..layout })
    }

    /// Whether a header told the same; a layout that has seen rows knows more.
    pub fn tells_as(&self, other: &Self) -> bool {
        let told = |layout: &Self| Self { dialect: None, ..layout.clone() };
        told(self) == told(other)
    }

    fn new(found: Columns, options: &ReadOptions) -> Result<Self, String> {
        let time = found.time.unless(options.time_unit)?;
        let rate = found.rate.unless(options.gyro_unit)?;
        let force = found.force.unless(options.accel_unit)?;
        let has = |column: Column| found.has(column);
        let increments = found.angles || found.velocities;
        if increments
            && (has(Column::Rate(0)) && !found.angles || has(Column::Force(0)) && !found.velocities)
        {
            return Err("one sensor has increments and the other has none".into());
        }
        let granted =
            rate.is_none() && has(Column::Rate(0)) || force.is_none() && has(Column::Force(0));
        Ok(Self {
            dialect: None,
            width: Width::at_least(found.columns.len()),
            time,
            rate: rate.unwrap_or(RateUnit::RadPerS),
            force: force.unwrap_or(ForceUnit::MPerS2),
            celsius: found.celsius,
            increments,
            granted,
            columns: found.columns,
        })
    }

    /// Learns from a row; whether it can be read: one that has more fields than were told may be two, of which
    /// the end of one and the line end between them were lost, until others have as many.
    pub fn see(&mut self, row: &[u8]) -> bool {
        let dialect = *self.dialect.get_or_insert_with(|| Dialect::of(row));
        self.width.known().is_some() || self.width.see(dialect.fields(row).count())
    }

    /// The numbers of a line; `None` where it lacks some, or one is none.
    pub fn row<'a>(&self, line: &'a [u8]) -> Option<Row<'a>> {
        let dialect = self.dialect.unwrap_or_else(|| Dialect::of(line));
        let (mut rate, mut force) = (Triple::default(), Triple::default());
        let (mut seconds, mut nanoseconds, mut units, mut celsius) = (None, None, None, None);
        let mut fields = dialect.fields(line);
        for column in &self.columns {
            let field = fields.next()?;
            let number = || match field {
                [] => Some(None),
                field => value(dialect, field).map(Some),
            };
            match *column {
                Column::Other | Column::Date => {}
                Column::Time => units = number()?.map(|_| Time::Units(field)),
                Column::Seconds => seconds = Some(number::nanoseconds(field, 9)?),
                Column::Nanoseconds => nanoseconds = Some(number::nanoseconds(field, 0)?),
                Column::Rate(axis) => rate.set(axis, number()?),
                Column::Force(axis) => force.set(axis, number()?),
                Column::Temperature => celsius = value(dialect, field),
            }
        }
        // Two lines, the line end between them lost.
        let more = self.width.known().map(|width| width.saturating_sub(self.columns.len()));
        if more.is_some_and(|more| fields.skip(more).any(|field| !field.is_empty())) {
            return None;
        }
        let halves = seconds.zip(nanoseconds);
        let halves = halves.map(|(whole, part)| Time::Nanoseconds(whole.saturating_add(part)));
        Some(Row {
            time: units.or(halves),
            rate: rate.times(self.rate.to_rad_s()),
            force: force.times(self.force.to_m_s2()),
            celsius: celsius
                .map(|value| value * self.celsius.factor + self.celsius.zero)
                .filter(|celsius| celsius.is_finite()),
        })
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let has = |column: Column| self.columns.contains(&column);
        let sensors = [
            has(Column::Rate(0)).then(|| format!("gyroscope in {}", self.rate.symbol())),
            has(Column::Force(0)).then(|| format!("accelerometer in {}", self.force.symbol())),
        ];
        let sensors: Vec<String> = sensors.into_iter().flatten().collect();
        let increments = if self.increments { ", increments times a second" } else { "" };
        write!(f, "{}{increments}", sensors.join(", "))?;
        if self.granted {
            f.write_str(" (units taken for granted: --gyro-unit and --accel-unit say others)")?;
        }
        Ok(())
    }
}

/// The three numbers of a sensor.
#[derive(Default)]
struct Triple([Option<f64>; 3]);

impl Triple {
    fn set(&mut self, axis: u8, value: Option<f64>) {
        if let Some(place) = self.0.get_mut(usize::from(axis)) {
            *place = value;
        }
    }

    /// All of them in SI units, if all are there and finite.
    fn times(self, unit: f64) -> Option<[f64; 3]> {
        let [x, y, z] = self.0;
        let values = [x? * unit, y? * unit, z? * unit];
        values.iter().all(|value| value.is_finite()).then_some(values)
    }
}

/// The number in a field, without memory of its own.
pub fn value(dialect: Dialect, field: &[u8]) -> Option<f64> {
    if dialect.decimal_comma {
        number::value(Pointed::of(field)?.get())
    } else {
        number::value(field)
    }
}
