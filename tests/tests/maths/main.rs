//! The mathematics of `imu-core` across its modules: published vectors, orders, extremes, statistics.

mod allan_vectors;
mod extremes;
mod integration;
mod integration_extremes;
mod integration_textbook;
mod noise_allan;
mod noise_normals;
mod noise_terms;
mod spline;
mod spline_orders;
mod statistics;
mod term_selection;
