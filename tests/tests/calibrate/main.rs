//! `imu calibrate`, `imu info` and `imu demo`, as called.

mod damage;
mod demo;
mod disturbed;
mod info;
mod interrupted;
mod refusals;
mod results;
mod terms;
