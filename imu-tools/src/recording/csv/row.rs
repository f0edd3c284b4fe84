//! One row of a table into samples.
//!
//! Rows that are written plainly, numbers with a decimal point and one byte between them, take a
//! short way: one pass, in which each number's end is found by reading it. Whatever it does not
//! expect it leaves to the long way, field by field, which also knows what to say of a fault.

use super::columns::Column;
use super::dialect::Separator;
use super::layout::{Layout, Time};
use super::number;
use crate::recording::{Block, Sample, Temperature, TimeUnit};

/// Why a row cannot be read: the column (from 1) and what is wrong with it.
pub struct Fault {
    /// Counted from 1.
    pub column: usize,
    /// In words.
    pub what: String,
}

/// What a row holds.
#[derive(Clone, Copy)]
struct Row {
    stamp_ns: i64,
    rate: Triple,
    force: Triple,
    temperature: Option<f64>,
}

/// What three fields of a sensor hold.
#[derive(Clone, Copy)]
struct Triple {
    value: [f64; 3],
    /// Some field was not empty.
    present: bool,
}

const EMPTY: Triple = Triple { value: [f64::NAN; 3], present: false };

impl Triple {
    #[inline]
    fn set(&mut self, axis: u8, value: f64) {
        if let Some(place) = self.value.get_mut(usize::from(axis)) {
            *place = value;
            self.present = true;
        }
    }
}

impl Row {
    const NOTHING: Self = Self { stamp_ns: 0, rate: EMPTY, force: EMPTY, temperature: None };

    #[inline]
    fn push(self, block: &mut Block) {
        let stamp_ns = self.stamp_ns;
        if self.rate.present {
            block.gyroscope.push(Sample { stamp_ns, value: self.rate.value });
        }
        if self.force.present {
            block.accelerometer.push(Sample { stamp_ns, value: self.force.value });
        }
        if let Some(celsius) = self.temperature {
            block.temperature.push(Temperature { stamp_ns, celsius });
        }
    }
}

/// Takes the samples of a line, without its end, into `block`.
#[inline]
pub fn take(layout: &Layout, line: &[u8], block: &mut Block) -> Result<(), Fault> {
    let row = match plain(layout, line) {
        Some(row) => row,
        None => by_fields(layout, line)?,
    };
    row.push(block);
    Ok(())
}

/// A row that is written plainly; `None` when there is anything else in it.
#[inline]
fn plain(layout: &Layout, line: &[u8]) -> Option<Row> {
    let Separator::Byte(separator) = layout.dialect.separator else { return None };
    if layout.dialect.decimal_comma {
        return None;
    }
    let mut row = Row::NOTHING;
    let mut rest = Some(line);
    for column in &layout.columns {
        let line = rest?;
        let used = match *column {
            Column::Other => memchr::memchr(separator, line).unwrap_or(line.len()),
            Column::Rate(axis) => {
                let (value, used) = number::leading_value(line)?;
                row.rate.set(axis, value * layout.rate);
                used
            }
            Column::Force(axis) => {
                let (value, used) = number::leading_value(line)?;
                row.force.set(axis, value * layout.force);
                used
            }
            Column::Time => {
                let Time::Number(exponent) = layout.time else { return None };
                let (stamp_ns, used) = number::leading_nanoseconds(line, exponent)?;
                row.stamp_ns = stamp_ns;
                used
            }
            // Their sums are for the long way.
            Column::Seconds | Column::Nanoseconds | Column::Date => return None,
            Column::Temperature => {
                let (value, used) = number::leading_value(line)?;
                row.temperature = Some(value * layout.celsius.factor + layout.celsius.zero);
                used
            }
        };
        rest = match line.get(used..)? {
            [] => None,
            [end, rest @ ..] if *end == separator => Some(rest),
            _ => return None,
        };
    }
    Some(row)
}

/// A row of any kind.
#[cold]
fn by_fields(layout: &Layout, line: &[u8]) -> Result<Row, Fault> {
    let mut row = Row::NOTHING;
    let mut fields = layout.dialect.fields(line);
    for (at, &column) in layout.columns.iter().enumerate() {
        let Some(field) = fields.next() else {
            let needed = layout.columns.len();
            let what = format!("the row has {at} columns where {needed} are needed");
            return Err(Fault { column: at + 1, what });
        };
        let fault = |what: &str| Fault {
            column: at + 1,
            what: format!("'{}' is no {what}", String::from_utf8_lossy(excerpt(field))),
        };
        let time = |time: Time| {
            time.nanoseconds(layout.dialect, field).ok_or_else(|| match time {
                Time::Number(exponent) if is_large(layout.dialect.value(field)) => {
                    let unit = TimeUnit::of_exponent(exponent).symbol();
                    let field = String::from_utf8_lossy(excerpt(field));
                    let what = format!(
                        "'{field}' is too large a time in {unit}: --time-unit says its unit"
                    );
                    Fault { column: at + 1, what }
                }
                _ => fault("time"),
            })
        };
        let value = || match field {
            [] => Ok(None),
            field => layout.dialect.value(field).map(Some).ok_or_else(|| fault("number")),
        };
        match column {
            Column::Other => {}
            Column::Time => row.stamp_ns = row.stamp_ns.saturating_add(time(layout.time)?),
            Column::Seconds => row.stamp_ns = row.stamp_ns.saturating_add(time(Time::Number(9))?),
            Column::Nanoseconds => {
                row.stamp_ns = row.stamp_ns.saturating_add(time(Time::Number(0))?);
            }
            Column::Date => row.stamp_ns = row.stamp_ns.saturating_add(time(Time::Text)?),
            Column::Rate(axis) => {
                if let Some(value) = value()? {
                    row.rate.set(axis, value * layout.rate);
                }
            }
            Column::Force(axis) => {
                if let Some(value) = value()? {
                    row.force.set(axis, value * layout.force);
                }
            }
            // A thermometer that fails does not spoil the row.
            Column::Temperature => {
                row.temperature = layout
                    .dialect
                    .value(field)
                    .map(|value| value * layout.celsius.factor + layout.celsius.zero)
                    .filter(|celsius| celsius.is_finite());
            }
        }
    }
    Ok(row)
}

/// Whether this is a number, and too large to be a small one.
fn is_large(value: Option<f64>) -> bool {
    value.is_some_and(|value| value.is_finite() && value.abs() > 1.0)
}

/// The start of a field, to be shown.
fn excerpt(field: &[u8]) -> &[u8] {
    field.get(..40).unwrap_or(field)
}
