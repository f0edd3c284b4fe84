//! A curve as a table of instants: poses for TUM's readers, or all derivatives as CSV.

use std::io::Write as _;
use std::path::Path;

use imu_core::spline::Full;

use super::Route;
use crate::error::Error;
use crate::output::Output;
use crate::recording::poses;
use crate::scene::Rate;

const COLUMNS: &str = "t_ns,p_x_m,p_y_m,p_z_m,q_w,q_x,q_y,q_z,v_x_m_s,v_y_m_s,v_z_m_s,rate_x_rad_s,rate_y_rad_s,\
    rate_z_rad_s,acceleration_x_m_s2,acceleration_y_m_s2,acceleration_z_m_s2,angular_acceleration_x_rad_s2,\
    angular_acceleration_y_rad_s2,angular_acceleration_z_rad_s2";

/// Text is handed on when there is so much of it.
const PIECE: usize = 256 * 1024;

/// How a curve is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// Poses: `timestamp tx ty tz qx qy qz qw`.
    Tum,
    /// Pose, velocity, angular rate, acceleration and angular acceleration: p, v and a in the world's axes, rates and
    /// angular accelerations in the body's.
    Csv,
}

impl Table {
    /// As the name of a file says: TUM's for `.tum` and `.txt`, CSV for `.csv` and a pipe.
    ///
    /// # Errors
    /// A sentence for another name.
    pub fn of(path: &Path) -> Result<Self, Error> {
        if path == Path::new("-") {
            return Ok(Self::Csv);
        }
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        match ending.as_deref().and_then(|ending| ending.to_str()) {
            Some("tum" | "txt") => Ok(Self::Tum),
            Some("csv") => Ok(Self::Csv),
            _ => Err(Error::usage(format!(
                "{} says no format: name it .tum (poses) or .csv (with all derivatives)",
                path.display()
            ))),
        }
    }
}

/// Writes a curve from its first instant to its last, so many times a second; how many instants that are.
///
/// # Errors
/// When it cannot be written.
pub fn write(route: &Route, rate: Rate, path: &Path, table: Table) -> Result<u64, Error> {
    let mut output = Output::create(path)?;
    let mut text: Vec<u8> = match table {
        Table::Tum => poses::TUM_HEADER.into(),
        Table::Csv => format!("{COLUMNS}\n").into(),
    };
    let (begin, end) = route.span_ns();
    let mut count = 0;
    for offset_ns in rate.offsets() {
        let t_ns = begin.saturating_add(offset_ns);
        if t_ns > end {
            break;
        }
        let full =
            route.full(t_ns).map_err(|error| Error::data(format!("at {t_ns} ns: {error}")))?;
        match table {
            Table::Tum => {
                let (p, q) = (full.pose.translation(), full.pose.rotation());
                poses::push_tum(&mut text, t_ns, p.into(), [q.i, q.j, q.k, q.w]);
            }
            Table::Csv => push_row(&mut text, t_ns, &full),
        }
        count += 1;
        if text.len() > PIECE {
            output.write(&text)?;
            text.clear();
        }
    }
    output.write(&text)?;
    output.finish()?;
    Ok(count)
}

fn push_row(text: &mut Vec<u8>, t_ns: i64, full: &Full<f64>) {
    let (p, q) = (full.pose.translation(), full.pose.rotation());
    // Writing to memory cannot fail.
    let _ = write!(text, "{t_ns}");
    let numbers = p.iter().chain([&q.w, &q.i, &q.j, &q.k]).chain(full.velocity_w.iter());
    let numbers = numbers.chain(full.angular_rate.iter()).chain(full.acceleration_w.iter());
    let mut digits = zmij::Buffer::new();
    for number in numbers.chain(full.angular_acceleration.iter()) {
        text.push(b',');
        text.extend_from_slice(digits.format(*number).as_bytes());
    }
    text.push(b'\n');
}
