//! Tables of numbers in text: comma, semicolon, tab, bar or blanks between columns, point or comma in
//! numbers, with a preamble, a header and a row of units or without.
//!
//! Columns and units come from the options, or from the names in the header and the units below
//! them, or are the common order t, gyroscope x y z, accelerometer x y z. Time is a number, a date,
//! or two columns. What was taken for granted is told by a
//! [`Note`](super::Note). A row whose three fields of a sensor are all empty has no sample of it,
//! so that sensors of different rates share a file; a field that is no finite number is a reading
//! that failed.

mod beside;
pub(crate) mod celsius;
pub(crate) mod columns;
#[cfg(test)]
mod columns_tests;
mod date;
pub(crate) mod dialect;
pub(super) mod granted;
pub(super) mod increments;
mod layout;
pub(crate) mod names;
pub(crate) mod number;
mod reader;
mod row;
pub(crate) mod time_unit;
pub(crate) mod told;
mod writer;

pub use reader::CsvReader;
pub use writer::CsvWriter;
pub(super) use writer::{push_integer, push_values};
