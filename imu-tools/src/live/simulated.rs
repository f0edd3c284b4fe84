//! A sensor that is not there: samples go out as frames of a protocol over a pseudo-terminal, when
//! they are due.
//!
//! Whoever opens the terminal reads what a device would send. In real time, what finds no room waits
//! no longer than a sensor's would, and is lost; as fast as can be, the sensor waits for its reader.
//! Samples that the recording lost are missing numbers in frames that are numbered.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::protocol::{Encoder, Protocol};
use super::{Count, Kind, Message, Ticks};
use crate::error::Error;
use crate::recording::{Block, SampleKind, Sink, merge};

/// What a user names such a sensor by.
const PREFIX: &str = "pty:";

/// Bytes that are sent at once, at least, where there is no hurry.
const PIECE: usize = 2048;

/// How long a piece may wait for room, in real time: as long as a UART's buffer lasts.
const PATIENCE: Duration = Duration::from_millis(20);

/// How long the terminal stays when all is said, for what is still under way in it.
const LINGER: Duration = Duration::from_secs(2);

/// What to simulate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Terminal {
    /// What it speaks.
    pub protocol: Protocol,
    /// A name for it besides the system's.
    pub link: Option<PathBuf>,
}

impl Terminal {
    /// What `pty:PROTOCOL` or `pty:PROTOCOL:LINK` asks for; `None` for anything else.
    ///
    /// # Errors
    /// When there is no such protocol.
    pub fn of(output: &Path) -> Result<Option<Self>, Error> {
        let Some(asked) = output.to_str().and_then(|text| text.strip_prefix(PREFIX)) else {
            return Ok(None);
        };
        let (protocol, link) = match asked.split_once(':') {
            Some((protocol, link)) => (protocol, Some(PathBuf::from(link))),
            None => (asked, None),
        };
        let protocol = protocol.parse().map_err(Error::usage)?;
        Ok(Some(Self { protocol, link }))
    }

    /// Opens it for samples of this kind, `rate_hz` of them a second, `speed` times as fast as they are
    /// stamped; 0 is as fast as they are read. Says to `name` what to open.
    ///
    /// # Errors
    /// When the protocol has no such samples, or there can be no such terminal.
    pub fn open(
        self,
        samples: SampleKind,
        rate_hz: f64,
        speed: f64,
        name: impl FnOnce(&Path),
    ) -> Result<Box<dyn Sink>, Error> {
        let kind = match samples {
            SampleKind::Increments => Kind::Increments { over_s: Some(1.0 / rate_hz) },
            SampleKind::Instantaneous | SampleKind::Mean => Kind::Rates,
        };
        if !Encoder::can_send(self.protocol, kind) {
            return Err(Error::usage(format!(
                "{} has no message for increments: take another protocol, or other samples",
                self.protocol
            )));
        }
        let line = line::Line::open(self.link, speed)?;
        name(line.name());
        Ok(Box::new(Sensor {
            encoder: Encoder::new(self.protocol),
            line,
            kind,
            rate_hz,
            speed,
            last: None,
            start: None,
            celsius: None,
        }))
    }
}

/// The sensor at work.
struct Sensor {
    encoder: Encoder,
    line: line::Line,
    kind: Kind,
    rate_hz: f64,
    speed: f64,
    /// Stamp and number of the last message.
    last: Option<(i64, u32)>,
    /// When the first was sent, and its stamp.
    start: Option<(Instant, i64)>,
    celsius: Option<f64>,
}

impl Sensor {
    /// The number of a message: samples that were due since the last are counted.
    fn number(&mut self, stamp_ns: i64) -> Count {
        let number = self.last.map_or(0, |(before_ns, number)| {
            let periods = stamp_ns.saturating_sub(before_ns) as f64 * 1e-9 * self.rate_hz;
            number.wrapping_add(periods.round().max(1.0) as u32)
        });
        self.last = Some((stamp_ns, number));
        Count { value: number, wraps_at: 1 << 32 }
    }

    /// How long until a stamp is due.
    fn wait(&mut self, stamp_ns: i64) -> Duration {
        let (start, first_ns) = *self.start.get_or_insert_with(|| (Instant::now(), stamp_ns));
        if self.speed <= 0.0 {
            return Duration::ZERO;
        }
        let due_s = stamp_ns.saturating_sub(first_ns).max(0) as f64 * 1e-9 / self.speed;
        Duration::try_from_secs_f64(due_s).unwrap_or_default().saturating_sub(start.elapsed())
    }
}

impl Sink for Sensor {
    fn write_block(&mut self, block: &Block) -> Result<(), Error> {
        let mut bytes = Vec::with_capacity(2 * PIECE);
        let mut temperatures = block.temperature.iter().peekable();
        merge(block, |stamp_ns, gyroscope, accelerometer| {
            while let Some(reading) = temperatures.next_if(|t| t.stamp_ns <= stamp_ns) {
                self.celsius = Some(reading.celsius);
            }
            let wait = self.wait(stamp_ns);
            // Sleeping is coarse, so that what is due within a while goes together.
            if bytes.len() >= PIECE || wait > Duration::from_millis(1) {
                self.line.send(&bytes)?;
                bytes.clear();
                std::thread::sleep(wait);
            }
            let message = Message {
                gyroscope,
                accelerometer,
                kind: self.kind,
                ticks: u64::try_from(stamp_ns).ok().map(|value| Ticks {
                    value,
                    per_second: 1_000_000_000,
                    wraps_at: None,
                }),
                count: Some(self.number(stamp_ns)),
                celsius: self.celsius,
                ..Message::default()
            };
            self.encoder.encode(&message, &mut bytes);
            Ok(())
        })?;
        self.line.send(&bytes)
    }

    fn finish(self: Box<Self>) -> Result<(), Error> {
        std::thread::sleep(LINGER);
        Ok(())
    }
}

#[cfg(unix)]
mod line {
    //! The pseudo-terminal.

    use std::fs;
    use std::io::ErrorKind;
    use std::os::fd::AsRawFd as _;
    use std::path::{Path, PathBuf};
    use std::time::Duration;

    use serial2::SerialPort;

    use crate::error::Error;

    /// Both ends of it: a reader may come and go.
    pub struct Line {
        ours: SerialPort,
        _theirs: SerialPort,
        name: PathBuf,
        link: Option<PathBuf>,
        waits: bool,
    }

    impl Line {
        pub fn open(link: Option<PathBuf>, speed: f64) -> Result<Self, Error> {
            let path = Path::new("a pseudo-terminal");
            let failed = |e| Error::io("open", path, e);
            let (mut ours, theirs) = SerialPort::pair().map_err(failed)?;
            ours.set_write_timeout(super::PATIENCE).map_err(failed)?;
            // Linux and others with such a folder say so what a file is.
            let place = format!("/proc/self/fd/{}", theirs.as_raw_fd());
            let name = fs::read_link(place).map_err(|_| {
                Error::data("this system does not say what its pseudo-terminals are called")
            })?;
            if let Some(link) = &link {
                // One that an earlier run left behind leads nowhere.
                if fs::symlink_metadata(link).is_ok_and(|there| there.is_symlink()) {
                    fs::remove_file(link).map_err(|e| Error::io("replace", link, e))?;
                }
                std::os::unix::fs::symlink(&name, link).map_err(|e| Error::io("write", link, e))?;
            }
            Ok(Self { ours, _theirs: theirs, name, link, waits: speed <= 0.0 })
        }

        /// What to open.
        pub fn name(&self) -> &Path {
            self.link.as_ref().unwrap_or(&self.name)
        }

        /// Sends bytes; those that find no room are lost, unless there is time to wait.
        pub fn send(&self, mut bytes: &[u8]) -> Result<(), Error> {
            while !bytes.is_empty() {
                match self.ours.write(bytes) {
                    Ok(sent) => bytes = bytes.get(sent..).unwrap_or_default(),
                    Err(e) if e.kind() == ErrorKind::Interrupted => {}
                    Err(e) if matches!(e.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) => {
                        if !self.waits {
                            return Ok(());
                        }
                        std::thread::sleep(Duration::from_millis(1));
                    }
                    Err(e) => return Err(Error::io("write", &self.name, e)),
                }
            }
            Ok(())
        }
    }

    impl Drop for Line {
        fn drop(&mut self) {
            if let Some(link) = &self.link {
                // It leads nowhere now; the next run replaces it in any case.
                let _ = fs::remove_file(link);
            }
        }
    }
}

#[cfg(not(unix))]
mod line {
    //! There are no pseudo-terminals.

    use std::path::{Path, PathBuf};

    use crate::error::Error;

    pub struct Line;

    impl Line {
        pub fn open(_link: Option<PathBuf>, _speed: f64) -> Result<Self, Error> {
            Err(Error::usage("there are no pseudo-terminals on this system: write a file, or to -"))
        }

        pub fn name(&self) -> &Path {
            Path::new("")
        }

        pub fn send(&self, _bytes: &[u8]) -> Result<(), Error> {
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for() {
        let of = |text: &str| Terminal::of(Path::new(text));
        assert_eq!(of("imu.bag").unwrap(), None);
        let plain = Terminal { protocol: Protocol::Xsens, link: None };
        assert_eq!(of("pty:xsens").unwrap(), Some(plain));
        let linked = of("pty:imu-frame:/tmp/imu").unwrap().unwrap();
        assert_eq!(linked.link, Some(PathBuf::from("/tmp/imu")));
        assert_eq!(of("pty:nmea").unwrap_err().exit_code(), 2);
        let increments = Terminal { protocol: Protocol::Mavlink, link: None };
        let refused = increments.open(SampleKind::Increments, 200.0, 0.0, |_| {}).err().unwrap();
        assert_eq!(refused.exit_code(), 2);
    }
}
