//! Recordings of every format: read, written, converted, damaged.

mod bag;
mod bag_damage;
mod compressed;
mod convert;
mod csv;
mod euroc;
mod mcap;
mod numpy;
mod rosbag2;
mod several_files;
mod tables;
mod ulog;
mod ulog_damage;
mod wrong_formats;
