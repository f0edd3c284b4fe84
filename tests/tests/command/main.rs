//! `imu simulate`, `imu integrate`, `imu spline` and `imu tradeoff`, as called.

mod integrate;
mod integrate_topic;
mod simulate;
mod simulate_errors;
mod simulate_scene;
mod spline;
mod tradeoff;
