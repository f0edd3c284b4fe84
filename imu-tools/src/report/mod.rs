//! Results for people and for machines: one form a file, no decisions in any of them.
//!
//! [`table`] for a terminal, [`json`] for programs, [`yaml`] for Kalibr and [`formats`] for other
//! filters, [`csv`] for plots of one's own, [`plot`] for pictures, [`html`] for the report, [`demo`]
//! for the comparison of several with the truth. All write a [`Calibration`](crate::calibrate::Calibration) into text.
//! [`tradeoff`] shows what accuracy costs, [`integration`] where dead reckoning went,
//! [`live`] shows a running session, [`spline`](mod@spline) how far a curve is from poses.

pub mod csv;
pub mod demo;
pub mod formats;
mod harmless;
pub mod html;
pub mod info;
pub mod integration;
pub mod json;
pub mod live;
pub mod plot;
pub mod spline;
pub mod table;
pub mod tradeoff;
mod units;
pub mod yaml;

pub(crate) use harmless::harmless;
pub use units::{Quantity, Twin};
