//! Published data and helpers that the cross-crate tests share.

pub mod allan_bands;
pub mod arrivals;
pub mod bags;
pub mod closure;
pub mod command;
pub mod databases;
pub mod disturbed;
pub mod flights;
pub mod frames;
pub mod mcaps;
pub mod monte_carlo;
pub mod recordings;
#[cfg(target_os = "linux")]
pub mod streams;
pub mod term_records;
pub mod ulog_outcomes;
pub mod ulogs;
