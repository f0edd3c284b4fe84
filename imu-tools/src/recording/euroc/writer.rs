//! Writing EuRoC's folders: `mav0/imu0/data.csv` and its `sensor.yaml`, both or neither.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::output::{Output, Unfinished};
use crate::recording::csv::{push_integer, push_values};
use crate::recording::{BLOCK_SAMPLES, Block, Sample, SampleKind, Sink, Timeline};

const HEADER: &str = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
                      a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";

/// The header of increments.
const INCREMENTS: &str = "#timestamp [ns],delta_angle_x [rad],delta_angle_y [rad],\
                          delta_angle_z [rad],delta_velocity_x [m s^-1],\
                          delta_velocity_y [m s^-1],delta_velocity_z [m s^-1]\n";

/// Text is handed on when there is so much of it.
const PIECE: usize = 256 * 1024;

/// Samples of one sensor that may wait for the other.
const MOST_WAITING: usize = 16 * BLOCK_SAMPLES;

/// EuRoC's folders being written.
pub struct EurocWriter {
    folder: PathBuf,
    /// Folders that were made for this, the outermost first.
    made: Vec<PathBuf>,
    /// The same, for when the program is interrupted.
    unfinished: Vec<Unfinished>,
    data: Option<Output>,
    text: Vec<u8>,
    gyroscope: VecDeque<Sample>,
    accelerometer: VecDeque<Sample>,
    /// What the stamps show of the rate.
    timeline: Timeline,
    samples: SampleKind,
}

/// The folder that the recording at `path` is written into: `imu0` in `path`, if that is a `mav0`, or
/// in `path/mav0`.
fn imu0(path: &Path) -> PathBuf {
    let mav0 = path.file_name().is_some_and(|name| name == "mav0");
    if mav0 { path.join("imu0") } else { path.join("mav0/imu0") }
}

/// The file that holds the samples of the recording at `path`.
pub(crate) fn data_file(path: &Path) -> PathBuf {
    imu0(path).join("data.csv")
}

impl EurocWriter {
    /// Starts `imu0` in `path`, if that is a `mav0`, or in `path/mav0`.
    ///
    /// # Errors
    /// When `path` is a pipe, or the folders cannot be made.
    pub fn create(path: &Path) -> Result<Self, Error> {
        Self::create_with(path, SampleKind::Instantaneous)
    }

    /// The same, of samples of this kind, which `sensor.yaml` says in its comment.
    ///
    /// # Errors
    /// When `path` is a pipe, or the folders cannot be made.
    pub fn create_with(path: &Path, samples: SampleKind) -> Result<Self, Error> {
        if path == Path::new("-") {
            return Err(Error::usage("EuRoC's recordings are folders: a pipe cannot be one"));
        }
        let folder = imu0(path);
        // The last ancestor of a relative path is empty: the folder where one is.
        let missing = |f: &&Path| !f.as_os_str().is_empty() && !f.exists();
        let missing: Vec<&Path> = folder.ancestors().take_while(missing).collect();
        let made: Vec<PathBuf> = missing.into_iter().rev().map(Path::to_owned).collect();
        let mut writer = Self {
            folder,
            made: Vec::new(),
            unfinished: Vec::new(),
            data: None,
            text: Vec::with_capacity(PIECE + 1024),
            gyroscope: VecDeque::new(),
            accelerometer: VecDeque::new(),
            timeline: Timeline::new(),
            samples,
        };
        let header = if samples == SampleKind::Increments { INCREMENTS } else { HEADER };
        writer.text.extend_from_slice(header.as_bytes());
        for folder in made {
            let make = || std::fs::create_dir(&folder).map(|()| ((), folder.clone()));
            let ((), unfinished) =
                Unfinished::create(make).map_err(|e| Error::io("make the folder", &folder, e))?;
            writer.unfinished.push(unfinished);
            writer.made.push(folder);
        }
        writer.data = Some(Output::create(&writer.folder.join("data.csv"))?);
        Ok(writer)
    }

    fn row(&mut self, rate: Sample, force: Sample) {
        push_integer(&mut self.text, rate.stamp_ns);
        push_values(&mut self.text, rate.value);
        push_values(&mut self.text, force.value);
        self.text.push(b'\n');
    }

    fn flush(&mut self) -> Result<(), Error> {
        if let Some(data) = &mut self.data {
            data.write(&self.text)?;
        }
        self.text.clear();
        Ok(())
    }

    /// The error for a sample without one of the other sensor at its instant.
    fn alone(&self, stamp_ns: i64) -> Error {
        Error::data(format!(
            "EuRoC's data.csv has both sensors in every row, but at {stamp_ns} ns there is one of \
             them alone: write a .csv or .bag instead of {}",
            self.folder.display()
        ))
    }

    /// The rate in Hz over the whole recording, to the digits that `imu info` shows.
    fn rate_hz(&mut self) -> Option<f64> {
        let rate_hz = std::mem::take(&mut self.timeline).finish(|_| {}).rate_hz;
        (rate_hz > 0.0).then(|| (1e6 * rate_hz).round() / 1e6)
    }
}

impl Sink for EurocWriter {
    fn write_block(&mut self, block: &Block) -> Result<(), Error> {
        self.timeline.push(&block.gyroscope, |_| {});
        self.gyroscope.extend(&block.gyroscope);
        self.accelerometer.extend(&block.accelerometer);
        while let (Some(&rate), Some(&force)) = (self.gyroscope.front(), self.accelerometer.front())
        {
            if rate.stamp_ns != force.stamp_ns {
                return Err(self.alone(rate.stamp_ns.min(force.stamp_ns)));
            }
            self.gyroscope.pop_front();
            self.accelerometer.pop_front();
            self.row(rate, force);
            if self.text.len() >= PIECE {
                self.flush()?;
            }
        }
        let waiting = self.gyroscope.front().or(self.accelerometer.front());
        match waiting {
            Some(sample) if self.gyroscope.len().max(self.accelerometer.len()) > MOST_WAITING => {
                Err(self.alone(sample.stamp_ns))
            }
            _ => Ok(()),
        }
    }

    fn finish(mut self: Box<Self>) -> Result<(), Error> {
        if let Some(sample) = self.gyroscope.front().or(self.accelerometer.front()) {
            return Err(self.alone(sample.stamp_ns));
        }
        self.flush()?;
        let mut sensor = Output::create(&self.folder.join("sensor.yaml"))?;
        let rate = self.rate_hz().map_or_else(String::new, |rate| format!("rate_hz: {rate}\n"));
        let yaml = format!(
            "sensor_type: imu\ncomment: {}, sensor axes\nT_BS:\n  cols: 4\n  rows: 4\n  \
             data: [1.0, 0.0, 0.0, 0.0,\n         0.0, 1.0, 0.0, 0.0,\n         0.0, 0.0, 1.0, \
             0.0,\n         0.0, 0.0, 0.0, 1.0]\n{rate}",
            self.samples.meaning()
        );
        sensor.write(yaml.as_bytes())?;
        // Both are complete before either takes its place.
        if let Some(data) = self.data.take() {
            data.finish()?;
        }
        sensor.finish()?;
        self.made.clear();
        Ok(())
    }
}

impl Drop for EurocWriter {
    fn drop(&mut self) {
        drop(self.data.take());
        // Folders that hold anything by now stay.
        for folder in self.made.iter().rev() {
            let _ = std::fs::remove_dir(folder);
        }
    }
}
