//! Tables of numbers in text: comma, semicolon, tab or blanks between columns, with a header or
//! without.
//!
//! Columns and units come from the options, or from the names in the header, or are the common
//! order t, gyroscope x y z, accelerometer x y z. What was taken for granted is told by a
//! [`Note`](super::Note). A row whose three fields of a sensor are all empty has no sample of it,
//! so that sensors of different rates share a file; a field that is no finite number is a reading
//! that failed.

mod columns;
mod number;
mod reader;
mod time_unit;
mod writer;

pub use reader::CsvReader;
pub use writer::CsvWriter;
