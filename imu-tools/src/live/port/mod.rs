//! Where bytes or samples come from: a serial port, a pipe, a network connection, a recording replayed.
//!
//! Each is read on a thread of its own, which notes when bytes came; what it reads waits in a queue, so that a
//! calculation or a slow disk does not keep it from reading. A device or connection that goes away is waited
//! for and opened again.

mod again;
mod network;
mod pipe;
mod replay;
mod serial;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crate::error::Error;
use crate::recording::{Block, Note, ReadOptions, SampleKind};
pub use serial::available;

/// Pieces of bytes that wait to be taken, at most: 18 s of the busiest port (900 pieces a second), minutes of others.
pub const AHEAD: usize = 1 << 14;

/// Blocks of a recording that wait, at most: they are large, and none is lost where they are read later.
const BLOCKS_AHEAD: usize = 4;

/// Bytes of a piece, at most.
const PIECE: usize = 4096;

/// After a piece of so many bytes the next ones are gathered for so long: they are of a fast sensor, and to be
/// woken for each would cost more than all else.
const MANY: usize = 256;
const GATHERED: Duration = Duration::from_millis(4);

/// What comes out of a port.
#[derive(Debug)]
pub enum Arrival {
    /// Bytes, and when the last of them came, host time in nanoseconds since 1970.
    Bytes {
        /// When.
        arrival_ns: i64,
        /// What.
        bytes: Vec<u8>,
    },
    /// Samples of a recording, and what they are.
    Samples(Block, SampleKind),
    /// What a recording's reader has to tell.
    Note(Note),
    /// The device went away, in words; it is waited for.
    Gone(String),
    /// It is there again.
    Back,
    /// There is nothing more.
    End,
    /// It cannot be read on.
    Failed(Error),
}

/// A port that is being read.
pub struct Port {
    /// What it is called in messages.
    pub name: String,
    /// What comes out.
    pub arrivals: Receiver<Arrival>,
}

/// What a user names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// A serial device.
    Serial(PathBuf),
    /// The standard input, or a named pipe.
    Pipe(PathBuf),
    /// `host:port` of a network.
    Tcp(String),
    /// A recording, to be replayed.
    Recording(PathBuf),
}

impl Address {
    /// What `text` names: `-`, `tcp://host:port`, `auto` (the only serial port there is), a device, or a
    /// recording.
    ///
    /// # Errors
    /// When there is no such port; the sentence lists those that exist.
    pub fn of(text: &str) -> Result<Self, Error> {
        if text == "-" {
            return Ok(Self::Pipe(text.into()));
        }
        if let Some(address) = text.strip_prefix("tcp://") {
            if address.rsplit_once(':').is_none_or(|(_, port)| port.parse::<u16>().is_err()) {
                return Err(Error::usage(format!(
                    "{text} lacks a port: write it as tcp://host:4000"
                )));
            }
            return Ok(Self::Tcp(address.to_owned()));
        }
        if text == "auto" {
            return serial::only_one().map(Self::Serial);
        }
        if text.is_empty() {
            return Err(serial::unnamed());
        }
        let path = Path::new(text);
        match fs::metadata(path) {
            Ok(there) if there.is_dir() || there.is_file() => Ok(Self::Recording(path.to_owned())),
            Ok(there) if is_pipe(&there) => Ok(Self::Pipe(path.to_owned())),
            Ok(_) => Ok(Self::Serial(path.to_owned())),
            // The names of serial ports of Windows are no files.
            Err(_) if cfg!(windows) => Ok(Self::Serial(path.to_owned())),
            Err(_) => Err(serial::no_such(text)),
        }
    }

    /// Whether the same samples come again when it is opened again.
    #[must_use]
    pub const fn comes_again(&self) -> bool {
        matches!(self, Self::Recording(_))
    }

    /// What it is called in messages.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Pipe(path) if path == Path::new("-") => "the pipe".into(),
            Self::Tcp(address) => format!("tcp://{address}"),
            Self::Serial(path) | Self::Pipe(path) | Self::Recording(path) => {
                path.display().to_string()
            }
        }
    }
}

#[cfg(unix)]
fn is_pipe(there: &fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    there.file_type().is_fifo()
}

#[cfg(not(unix))]
fn is_pipe(_: &fs::Metadata) -> bool {
    false
}

/// How to open a port.
#[derive(Clone, Debug, Default)]
pub struct How {
    /// Bits a second of a serial port; `None` tries the usual ones.
    pub baud: Option<u32>,
    /// How to read a recording.
    pub reading: ReadOptions,
    /// How many times faster than it was recorded a recording comes; 0: as fast as can be.
    pub speed: f64,
    /// Samples of a recording up to this stamp, ns, were taken before: they come at once.
    pub again_ns: Option<i64>,
}

/// What a serial port is expected to send: by that a wrong baud rate is told from a right one.
pub struct Expected<'a> {
    /// The protocol, if the user named one.
    pub protocol: Option<&'static str>,
    /// The part of some bytes that is of no frame; `None` where they are too few to say.
    pub refused: &'a dyn Fn(&[u8]) -> Option<f64>,
}

/// Opens a port and begins to read it.
///
/// # Errors
/// When it cannot be opened: one sentence with the way out.
pub fn open(address: &Address, how: &How, expected: &Expected<'_>) -> Result<Port, Error> {
    let (to, arrivals) = sync_channel(if address.comes_again() { BLOCKS_AHEAD } else { AHEAD });
    match address {
        Address::Serial(path) => serial::open(path, how.baud, expected, to)?,
        Address::Pipe(path) => pipe::open(path, to),
        Address::Tcp(address) => network::open(address, to)?,
        Address::Recording(path) => replay::open(path, how, to)?,
    }
    Ok(Port { name: address.name(), arrivals })
}

/// Host time that goes on evenly, whatever happens to the clock on the wall while it is read.
struct HostClock {
    start: Duration,
    start_ns: i64,
}

impl HostClock {
    fn new() -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Self { start: running(), start_ns: i64::try_from(since.as_nanos()).unwrap_or(i64::MAX / 2) }
    }

    fn now_ns(&self) -> i64 {
        let passed = running().saturating_sub(self.start);
        self.start_ns.saturating_add(i64::try_from(passed.as_nanos()).unwrap_or(i64::MAX / 2))
    }
}

/// How long the computer has run, with the time that it slept: a sensor that goes on meanwhile leaves a gap.
#[cfg(target_os = "linux")]
fn running() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::Boottime);
    // Neither is negative.
    Duration::new(now.tv_sec.unsigned_abs(), u32::try_from(now.tv_nsec).unwrap_or_default())
}

/// How long this process has run. On macOS the time that the computer slept is not in it.
#[cfg(not(target_os = "linux"))]
fn running() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

/// Reads pieces until the end (`Ok`), a failure, or until nobody listens (`None`).
fn pump(
    mut read: impl FnMut(&mut [u8]) -> std::io::Result<usize>,
    clock: &HostClock,
    to: &SyncSender<Arrival>,
) -> Option<std::io::Result<()>> {
    use std::io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    let mut buffer = [0; PIECE];
    loop {
        let read = read(&mut buffer);
        // Where the buffer is full more waits already.
        let gather = read.as_ref().is_ok_and(|n| (MANY..PIECE).contains(n));
        let bytes = match read {
            Ok(0) => return Some(Ok(())),
            Ok(n) => buffer.get(..n).unwrap_or_default().to_vec(),
            Err(e) if matches!(e.kind(), Interrupted | TimedOut | WouldBlock) => Vec::new(),
            Err(e) => return Some(Err(e)),
        };
        // An empty piece asks whether somebody listens still.
        if to.send(Arrival::Bytes { arrival_ns: clock.now_ns(), bytes }).is_err() {
            return None;
        }
        if gather {
            std::thread::sleep(GATHERED);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn host_time_begins_on_the_wall_and_goes_on_with_the_clock_that_never_stops() {
        let wall_ns = || SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_nanos() as i64;
        let (before, clock, after) = (wall_ns(), HostClock::new(), wall_ns());
        assert!((before..=after).contains(&clock.start_ns));
        let [first, second] = [clock.now_ns(), clock.now_ns()];
        assert!(clock.start_ns <= first && first <= second);
        #[cfg(target_os = "linux")]
        {
            // Where the computer never slept, the other clock shows the same: then this says nothing.
            let ns = |t: rustix::time::Timespec| 1_000_000_000 * t.tv_sec as u64 + t.tv_nsec as u64;
            let slept = || ns(rustix::time::clock_gettime(rustix::time::ClockId::Boottime));
            let (before, now, after) = (slept(), running().as_nanos() as u64, slept());
            assert!((before..=after).contains(&now), "{before} {now} {after}");
        }
    }

    #[test]
    fn what_is_named() {
        assert_eq!(Address::of("-").unwrap(), Address::Pipe("-".into()));
        assert_eq!(Address::of("tcp://imu.local:4000").unwrap().name(), "tcp://imu.local:4000");
        assert_eq!(Address::of("tcp://imu.local").unwrap_err().exit_code(), 2);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().to_str().unwrap();
        assert!(Address::of(path).unwrap().comes_again());
        let error = Address::of("/dev/no-such-port").unwrap_err().to_string();
        assert!(error.starts_with("there is no port or recording /dev/no-such-port"), "{error}");
    }
}
