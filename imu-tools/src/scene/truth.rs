//! The truth beside a simulated recording, as a CSV with a line for each sample.
//!
//! Columns: stamp; position and attitude (q_wb, Hamilton, w first); velocity; true angular rate and
//! specific force in body axes; the bias that each axis of both sensors carries. The header names
//! the units. Numbers are the shortest decimals that read back to the same double.

use std::io::Write as _;
use std::path::Path;

use super::Truth;
use crate::error::Error;
use crate::output::Output;

const HEADER: &str = "t_ns,p_x_m,p_y_m,p_z_m,q_w,q_x,q_y,q_z,v_x_m_s,v_y_m_s,v_z_m_s,\
    rate_x_rad_s,rate_y_rad_s,rate_z_rad_s,force_x_m_s2,force_y_m_s2,force_z_m_s2,\
    gyro_bias_x_rad_s,gyro_bias_y_rad_s,gyro_bias_z_rad_s,\
    accel_bias_x_m_s2,accel_bias_y_m_s2,accel_bias_z_m_s2\n";

/// A truth file in the making.
#[derive(Debug)]
pub struct TruthWriter {
    output: Output,
    text: Vec<u8>,
}

impl TruthWriter {
    /// Starts the file that will stand at `path`; `-` is the standard output.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn create(path: &Path) -> Result<Self, Error> {
        Ok(Self { output: Output::create(path)?, text: HEADER.into() })
    }

    /// Appends the lines of a block.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn write(&mut self, truth: &Truth) -> Result<(), Error> {
        let biases = truth.gyroscope_bias.iter().zip(&truth.accelerometer_bias);
        for ((stamp, motion), (gyro, accel)) in
            truth.stamps_ns.iter().zip(&truth.motions).zip(biases)
        {
            let q = motion.attitude_wb;
            let columns = motion.position_w.iter().chain([&q.w, &q.i, &q.j, &q.k]);
            let columns = columns.chain(motion.velocity_w.iter());
            let columns = columns.chain(motion.angular_rate.iter());
            let columns = columns.chain(motion.specific_force.iter()).chain(gyro).chain(accel);
            // Writing to memory cannot fail.
            let _ = write!(self.text, "{stamp}");
            let mut digits = zmij::Buffer::new();
            for &column in columns {
                self.text.push(b',');
                self.text.extend_from_slice(digits.format(column).as_bytes());
            }
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
