//! The truth beside a simulated recording, as a CSV with a line for each sample.
//!
//! Columns: true time; the stamp in the recording, empty where the sample was lost, if the scene's clock
//! errs; position of the accelerometer (where its lever arm leads) and attitude (q_wb, Hamilton, w first); its
//! velocity; true angular rate and specific force in body axes, at that instant; the bias that each axis of both sensors carries; the
//! temperature, if the scene has one. The header names the units. Numbers are the shortest decimals that
//! read back to the same double.

use std::io::Write as _;
use std::path::Path;

use super::{ClockErrors, Scene, Truth};
use crate::error::Error;
use crate::output::Output;

const MOTION: &str = ",p_x_m,p_y_m,p_z_m,q_w,q_x,q_y,q_z,v_x_m_s,v_y_m_s,v_z_m_s,\
    rate_x_rad_s,rate_y_rad_s,rate_z_rad_s,force_x_m_s2,force_y_m_s2,force_z_m_s2,\
    gyro_bias_x_rad_s,gyro_bias_y_rad_s,gyro_bias_z_rad_s,\
    accel_bias_x_m_s2,accel_bias_y_m_s2,accel_bias_z_m_s2";

/// A truth file in the making.
#[derive(Debug)]
pub struct TruthWriter {
    output: Output,
    text: Vec<u8>,
    stamps: Stamps,
}

/// The first columns of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stamps {
    /// With the stamps, where they are not the times.
    stamps: bool,
}

impl Stamps {
    pub(super) fn of(scene: &Scene) -> Self {
        Self { stamps: scene.clock != ClockErrors::default() }
    }

    pub(super) const fn header(self) -> &'static str {
        if self.stamps { "t_ns,stamp_ns" } else { "t_ns" }
    }

    pub(super) fn write(self, text: &mut Vec<u8>, time_ns: i64, stamp_ns: Option<i64>) {
        // Writing to memory cannot fail.
        let _ = write!(text, "{time_ns}");
        if self.stamps {
            let _ = match stamp_ns {
                Some(stamp) => write!(text, ",{stamp}"),
                None => write!(text, ","),
            };
        }
    }
}

impl TruthWriter {
    /// Starts the truth of `scene`, which will stand at `path`; `-` is the standard output.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn create(path: &Path, scene: &Scene) -> Result<Self, Error> {
        let stamps = Stamps::of(scene);
        let temperature = if scene.temperature.is_some() { ",temperature_c" } else { "" };
        let header = format!("{}{MOTION}{temperature}\n", stamps.header());
        Ok(Self { output: Output::create(path)?, text: header.into(), stamps })
    }

    /// Appends the lines of a block.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn write(&mut self, truth: &Truth) -> Result<(), Error> {
        let times = truth.times_ns.iter().zip(&truth.stamps_ns);
        let biases = truth.gyroscope_bias.iter().zip(&truth.accelerometer_bias);
        let mut celsius = truth.celsius.iter();
        for (((time, stamp), motion), (gyro, accel)) in times.zip(&truth.motions).zip(biases) {
            let q = motion.attitude_wb;
            let columns = motion.position_w.iter().chain([&q.w, &q.i, &q.j, &q.k]);
            let columns = columns.chain(motion.velocity_w.iter());
            let columns = columns.chain(motion.angular_rate.iter());
            let columns = columns.chain(motion.specific_force.iter()).chain(gyro).chain(accel);
            self.stamps.write(&mut self.text, *time, *stamp);
            push_numbers(&mut self.text, columns.chain(celsius.next()));
            self.text.push(b'\n');
        }
        self.output.write(&self.text)?;
        self.text.clear();
        Ok(())
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn finish(mut self) -> Result<(), Error> {
        self.output.write(&self.text)?;
        self.output.finish()
    }
}

/// Appends fields, with the fewest digits that are read back as the same doubles.
pub(super) fn push_numbers<'a>(text: &mut Vec<u8>, numbers: impl Iterator<Item = &'a f64>) {
    let mut digits = zmij::Buffer::new();
    for &number in numbers {
        text.push(b',');
        text.extend_from_slice(digits.format(number).as_bytes());
    }
}
