//! Writing a CSV: stamps in integer nanoseconds, values with the fewest digits that are read back
//! as the same double.

use std::path::Path;

use crate::error::Error;
use crate::output::Output;
use crate::recording::{Block, Contents, SampleKind, Sink, merge};

/// The names of the columns; a program that knows rates takes no increments for them.
const fn header(samples: SampleKind) -> &'static str {
    match samples {
        SampleKind::Instantaneous => {
            "timestamp [ns],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],\
             accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2]"
        }
        SampleKind::Mean => {
            "timestamp [ns],gyro_mean_x [rad/s],gyro_mean_y [rad/s],gyro_mean_z [rad/s],\
             accel_mean_x [m/s^2],accel_mean_y [m/s^2],accel_mean_z [m/s^2]"
        }
        SampleKind::Increments => {
            "timestamp [ns],delta_angle_x [rad],delta_angle_y [rad],delta_angle_z [rad],\
             delta_velocity_x [m/s],delta_velocity_y [m/s],delta_velocity_z [m/s]"
        }
    }
}

/// Text is handed on when there is so much of it.
const PIECE: usize = 256 * 1024;

/// A CSV being written.
pub struct CsvWriter {
    output: Output,
    text: Vec<u8>,
    contents: Contents,
    /// The header is written: with the first samples, which show what they are.
    begun: bool,
}

impl CsvWriter {
    /// Starts the CSV that will stand at `path`; `-` is a pipe.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn create(path: &Path) -> Result<Self, Error> {
        Self::create_with(path, Contents::default())
    }

    /// The same, of a recording that holds `contents`.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn create_with(path: &Path, contents: Contents) -> Result<Self, Error> {
        Ok(Self::write_to(Output::create(path)?, contents))
    }

    /// Starts the CSV that `output` will be.
    pub(crate) fn write_to(output: Output, contents: Contents) -> Self {
        Self { output, text: Vec::with_capacity(PIECE + 1024), contents, begun: false }
    }

    fn begin(&mut self) {
        if !std::mem::replace(&mut self.begun, true) {
            let Contents { samples, temperature } = self.contents;
            self.text.extend_from_slice(header(samples).as_bytes());
            self.text.extend_from_slice(if temperature { b",temperature [degC]\n" } else { b"\n" });
        }
    }

    fn hand_on(&mut self) -> Result<(), Error> {
        self.output.write(&self.text)?;
        self.text.clear();
        Ok(())
    }
}

/// Appends three fields, empty ones where there is no sample.
fn push_sensor(text: &mut Vec<u8>, value: Option<[f64; 3]>) {
    match value {
        None => text.extend_from_slice(b",,,"),
        Some(value) => push_values(text, value),
    }
}

/// Appends three fields with the fewest digits that are read back as the same doubles.
pub(crate) fn push_values(text: &mut Vec<u8>, value: [f64; 3]) {
    let mut digits = zmij::Buffer::new();
    for v in value {
        text.push(b',');
        text.extend_from_slice(digits.format(v).as_bytes());
    }
}

/// Appends a whole number.
pub(crate) fn push_integer(text: &mut Vec<u8>, number: i64) {
    let mut digits = [0; 20];
    let mut left = number.unsigned_abs();
    let mut start = digits.len();
    for (at, digit) in digits.iter_mut().enumerate().rev() {
        *digit = b'0' + (left % 10) as u8;
        left /= 10;
        start = at;
        if left == 0 {
            break;
        }
    }
    if number < 0 {
        text.push(b'-');
    }
    text.extend_from_slice(digits.get(start..).unwrap_or_default());
}

impl Sink for CsvWriter {
    fn write_block(&mut self, block: &Block) -> Result<(), Error> {
        self.begin();
        let mut temperatures = block.temperature.iter().peekable();
        merge(block, |stamp_ns, rate, force| {
            push_integer(&mut self.text, stamp_ns);
            push_sensor(&mut self.text, rate);
            push_sensor(&mut self.text, force);
            if self.contents.temperature {
                while temperatures.next_if(|t| t.stamp_ns < stamp_ns).is_some() {}
                self.text.push(b',');
                if let Some(now) = temperatures.next_if(|t| t.stamp_ns == stamp_ns) {
                    let mut digits = zmij::Buffer::new();
                    self.text.extend_from_slice(digits.format(now.celsius).as_bytes());
                }
            }
            self.text.push(b'\n');
            if self.text.len() < PIECE { Ok(()) } else { self.hand_on() }
        })
    }

    fn flush(&mut self) -> Result<(), Error> {
        self.hand_on()?;
        self.output.sync()
    }

    fn samples_are(&mut self, samples: SampleKind) {
        self.contents.samples = samples;
    }

    fn finish(mut self: Box<Self>) -> Result<(), Error> {
        self.begin();
        self.hand_on()?;
        self.output.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_samples_are_is_said_with_the_first_of_them() {
        use crate::recording::Sample;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let output = Output::growing(&path).unwrap();
        let mut sink = Box::new(CsvWriter::write_to(output, Contents::default()));
        sink.flush().unwrap();
        sink.samples_are(SampleKind::Mean);
        let sample = Sample { stamp_ns: 7, value: [0.5; 3] };
        let block = Block { gyroscope: vec![sample], ..Block::default() };
        sink.write_block(&block).unwrap();
        sink.samples_are(SampleKind::Instantaneous);
        sink.write_block(&block).unwrap();
        sink.finish().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let header = header(SampleKind::Mean);
        assert_eq!(text, format!("{header}\n7,0.5,0.5,0.5,,,\n7,0.5,0.5,0.5,,,\n"));
    }

    #[test]
    fn integers_at_their_ends() {
        for number in [0, 7, -7, 10, i64::MAX, i64::MIN, 1_700_000_000_000_000_000] {
            let mut text = Vec::new();
            push_integer(&mut text, number);
            assert_eq!(String::from_utf8(text).unwrap(), number.to_string());
        }
    }
}
