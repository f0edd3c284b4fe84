//! The desktop side of the project: recordings in, noise parameters and reports out.
//!
//! Data flows one way: [`recording`] → core → report. See `ARCHITECTURE.md` for the map.

pub mod calibrate;
pub mod cli;
pub mod error;
pub mod integrate;
pub mod live;
pub mod output;
pub mod recording;
pub mod report;
pub mod scene;
pub mod spline;
pub mod tradeoff;
