//! What each error adds to each sample, as a CSV with a line for each sample that was due.
//!
//! Columns: true time, and stamp if the scene's clock errs, as in the truth; then for each axis of both
//! sensors the truth (what an ideal sensor reads, of the scene's kind of samples) and each error that
//! the axis has, in the order in which they act, such as `gyro_x_white_noise_rad_s`. The columns of an
//! axis add up to its sample, but for rounding; those before `bandwidth`, `saturation` and the
//! quantisations to what these begin with. Increments are divided by their interval.

use std::path::Path;

use super::truth::{Stamps, push_numbers};
use super::{Contributions, Scene, Truth};
use crate::error::Error;
use crate::output::Output;

/// A file of terms in the making.
#[derive(Debug)]
pub struct TermsWriter {
    output: Output,
    text: Vec<u8>,
    stamps: Stamps,
    has_header: bool,
}

impl TermsWriter {
    /// Starts the terms of `scene`, which will stand at `path`; `-` is the standard output.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn create(path: &Path, scene: &Scene) -> Result<Self, Error> {
        let stamps = Stamps::of(scene);
        let output = Output::create(path)?;
        Ok(Self { output, text: stamps.header().into(), stamps, has_header: false })
    }

    /// Appends the lines of a block, of a simulator that was told to keep its terms.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn write(&mut self, truth: &Truth) -> Result<(), Error> {
        if !self.has_header {
            self.has_header = true;
            self.name("gyro", "rad_s", &truth.gyroscope_terms);
            self.name("accel", "m_s2", &truth.accelerometer_terms);
            self.text.push(b'\n');
        }
        let sensors = [&truth.gyroscope_terms, &truth.accelerometer_terms];
        let terms = || sensors.into_iter().flatten().flat_map(|axis| &axis.terms);
        for (i, (time, stamp)) in truth.times_ns.iter().zip(&truth.stamps_ns).enumerate() {
            self.stamps.write(&mut self.text, *time, *stamp);
            push_numbers(&mut self.text, terms().filter_map(|(_, added)| added.get(i)));
            self.text.push(b'\n');
        }
        self.output.write(&self.text)?;
        self.text.clear();
        Ok(())
    }

    fn name(&mut self, sensor: &str, unit: &str, axes: &[Contributions; 3]) {
        for (axis, contributions) in ["x", "y", "z"].into_iter().zip(axes) {
            for (term, _) in &contributions.terms {
                let name = format!(",{sensor}_{axis}_{}_{unit}", term.name());
                self.text.extend_from_slice(name.as_bytes());
            }
        }
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn finish(mut self) -> Result<(), Error> {
        if !self.has_header {
            self.text.push(b'\n');
        }
        self.output.write(&self.text)?;
        self.output.finish()
    }
}
