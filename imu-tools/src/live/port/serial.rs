//! A serial device: found or named, its baud rate given or tried, opened again when it comes back.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

use serial2::{IntoSettings as _, KeepSettings, SerialPort};

use super::again::{self, Again};
use super::{Arrival, Expected, PIECE};
use crate::error::Error;

/// Usual baud rates, the most usual first.
const RATES: [u32; 9] =
    [115_200, 921_600, 460_800, 230_400, 9_600, 57_600, 38_400, 19_200, 1_000_000];

/// How long each is listened to.
const TRIAL: Duration = Duration::from_millis(700);

/// How long the first bytes are waited for, as many as can be judged: boards with a converter of their own start
/// anew when their port is opened, behind a boot loader of two seconds.
const BOOT: Duration = Duration::from_secs(4);

/// How often all are tried, where anything comes: while they are tried first, a board may still be in its loader.
const ROUNDS: usize = 2;

/// Bytes that are enough to judge a rate.
const ENOUGH: usize = 2048;

/// More than this part of the bytes refused: the rate is wrong, or the protocol unknown.
const TOO_MANY: f64 = 0.3;

/// How long a read waits, and the time between attempts to open a device that went away.
const PAUSE: Duration = Duration::from_millis(200);

/// What systems answer that are asked for the baud rate of what has none (`ENOTTY`).
const NO_TERMINAL: i32 = 25;

/// The serial ports that exist.
#[must_use]
pub fn available() -> Vec<PathBuf> {
    let mut ports = SerialPort::available_ports().unwrap_or_default();
    ports.sort();
    ports
}

/// They, in words.
fn list() -> String {
    match available().as_slice() {
        [] => "there is no serial port now; plug the sensor in".to_owned(),
        ports => {
            let names: Vec<String> = ports.iter().map(|port| port.display().to_string()).collect();
            format!("the serial ports are {}", names.join(", "))
        }
    }
}

/// The only serial port.
pub(super) fn only_one() -> Result<PathBuf, Error> {
    match available().as_slice() {
        [port] => Ok(port.clone()),
        [] => Err(Error::data("no serial port is found: plug the sensor in, or name its port")),
        _ => Err(Error::usage(format!("there are several; name one: {}", list()))),
    }
}

/// Nothing is named.
pub(super) fn unnamed() -> Error {
    Error::usage(format!("no port is named: {}", list()))
}

/// Nothing is called so.
pub(super) fn no_such(name: &str) -> Error {
    Error::data(format!("there is no port or recording {name}: {}", list()))
}

/// Why a port cannot be opened, and the way out.
fn refusal(path: &Path, error: &io::Error) -> Error {
    let name = path.display();
    match error.kind() {
        io::ErrorKind::NotFound => no_such(&name.to_string()),
        io::ErrorKind::PermissionDenied => match group(path) {
            Some(group) => Error::data(format!(
                "no permission to open {name}: it belongs to the group {group}; say \
                 sudo usermod -aG {group} $USER, log out and in again"
            )),
            None => Error::data(format!(
                "no permission to open {name}: ask who administers this computer"
            )),
        },
        io::ErrorKind::ResourceBusy => Error::data(format!(
            "{name} is busy: another program has it open (a serial monitor, ModemManager, another imu \
             live); end that first"
        )),
        _ if error.raw_os_error() == Some(NO_TERMINAL) => {
            Error::data(format!("{name} is no serial port: {}", list()))
        }
        _ => Error::data(format!("cannot open {name}: {error}")),
    }
}

/// The group of a device by name.
#[cfg(unix)]
fn group(path: &Path) -> Option<String> {
    use std::os::unix::fs::MetadataExt as _;
    let id = fs::metadata(path).ok()?.gid().to_string();
    let groups = fs::read_to_string("/etc/group").ok()?;
    let named = groups.lines().find_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        (fields.nth(1)? == id).then(|| name.to_owned())
    });
    named.filter(|group| group != "root")
}

#[cfg(not(unix))]
fn group(_: &Path) -> Option<String> {
    None
}

/// Opens a device that nobody else has.
fn claim(path: &Path) -> io::Result<SerialPort> {
    let mut port = SerialPort::open(path, KeepSettings)?;
    // Before the baud rate is set: it is that of whoever has the port.
    lock(&port)?;
    port.set_read_timeout(PAUSE)?;
    Ok(port)
}

/// Hears a device at this rate from now on: what waited in it came nobody knows when.
fn tune(port: &mut SerialPort, baud: u32) -> io::Result<()> {
    let mut settings = port.get_configuration()?;
    baud.apply_to_settings(&mut settings)?;
    port.set_configuration(&settings)?;
    port.discard_input_buffer()
}

/// Opens a device, and hears it at this rate.
fn connect(path: &Path, baud: u32) -> io::Result<SerialPort> {
    let mut port = claim(path)?;
    tune(&mut port, baud)?;
    Ok(port)
}

/// Keeps a port from other programs that lock what they open, until it is closed: two readers would share its
/// bytes out. `TIOCEXCL` would outlive us in a pseudo-terminal, and root passes it.
#[cfg(unix)]
fn lock(port: &SerialPort) -> io::Result<()> {
    use std::os::fd::AsFd as _;
    // The lock is that of what was opened, however many handles it has.
    let file = fs::File::from(port.as_fd().try_clone_to_owned()?);
    file.try_lock().map_err(|error| match error {
        fs::TryLockError::WouldBlock => io::ErrorKind::ResourceBusy.into(),
        fs::TryLockError::Error(error) => error,
    })
}

/// Windows opens a port for one program only.
#[cfg(not(unix))]
fn lock(_: &SerialPort) -> io::Result<()> {
    Ok(())
}

/// The first rate at which most of the bytes are part of frames, and the port at that rate: it is opened once,
/// because many a board starts anew whenever its port is opened.
fn find_rate(path: &Path, expected: &Expected<'_>) -> Result<(SerialPort, u32), Error> {
    let mut port = claim(path).map_err(|e| refusal(path, &e))?;
    let (mut most, mut patience) = (Vec::new(), BOOT);
    for (round, rate) in (0..ROUNDS).flat_map(|round| RATES.map(|rate| (round, rate))) {
        if round > 0 && most.is_empty() {
            break;
        }
        match tune(&mut port, rate) {
            Ok(()) => {}
            // Not every adapter has every rate: the driver refuses it, or keeps another.
            Err(e) if matches!(e.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Other) => {
                continue;
            }
            Err(e) => return Err(refusal(path, &e)),
        }
        let heard = listen(&port, std::mem::replace(&mut patience, TRIAL), expected.refused);
        // The first half may be what a loader says.
        let halves = [heard.as_slice(), heard.get(heard.len() / 2..).unwrap_or_default()];
        let is_right = |bytes| (expected.refused)(bytes).is_some_and(|share| share < TOO_MANY);
        if halves.into_iter().any(is_right) {
            return Ok((port, rate));
        }
        if heard.len() > most.len() {
            most = heard;
        }
    }
    let name = path.display();
    if most.is_empty() {
        return Err(Error::data(format!(
            "{name} is silent at all usual baud rates: see that the sensor has power and sends by \
             itself, or give its rate with --baud"
        )));
    }
    let (what, way_out) = match expected.protocol {
        Some(protocol) => (format!("not {protocol}"), "give --baud, or another --protocol"),
        None => ("of no known protocol".to_owned(), "give --baud and --protocol"),
    };
    Err(Error::data(format!(
        "what {name} sends is {what} at any usual baud rate: {way_out}; the first bytes are {}",
        super::super::shown::bytes(&most)
    )))
}

/// What comes in a short time, once it is as much as can be judged.
fn listen(
    port: &SerialPort,
    patience: Duration,
    refused: &dyn Fn(&[u8]) -> Option<f64>,
) -> Vec<u8> {
    let (mut heard, mut buffer) = (Vec::new(), [0; PIECE]);
    let (mut end, mut is_judged) = (Instant::now() + patience, false);
    while Instant::now() < end && heard.len() < ENOUGH {
        match port.read(&mut buffer) {
            Ok(0) => break,
            Ok(n) => {
                if heard.is_empty() {
                    end = end.max(Instant::now() + TRIAL);
                }
                heard.extend_from_slice(buffer.get(..n).unwrap_or_default());
                if !is_judged && refused(&heard).is_some() {
                    (end, is_judged) = (Instant::now() + TRIAL, true);
                }
            }
            Err(e) if e.kind() == io::ErrorKind::TimedOut => {}
            Err(_) => break,
        }
    }
    heard
}

/// Opens the device, and begins to read.
pub(super) fn open(
    path: &Path,
    baud: Option<u32>,
    expected: &Expected<'_>,
    to: SyncSender<Arrival>,
) -> Result<(), Error> {
    let (port, baud) = match baud {
        Some(baud) => (connect(path, baud).map_err(|e| refusal(path, &e))?, baud),
        None => find_rate(path, expected)?,
    };
    let path = path.to_owned();
    let why = |ended: io::Result<()>| match ended {
        Ok(()) => "it was unplugged".to_owned(),
        Err(error) => format!("it was unplugged ({error})"),
    };
    again::read(port, Again { connect: move || connect(&path, baud), pause: PAUSE, why }, to);
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn refusals_say_the_way_out() {
        let folder = tempfile::tempdir().unwrap();
        let said = |kind: io::ErrorKind| refusal(folder.path(), &kind.into()).to_string();
        assert!(said(io::ErrorKind::ResourceBusy).contains("another program has it open"));
        assert!(said(io::ErrorKind::PermissionDenied).contains("no permission to open"));
        assert!(said(io::ErrorKind::NotFound).contains("there is no port or recording"));
        let error = connect(Path::new("/dev/null"), 9600).unwrap_err();
        let said = refusal(Path::new("/dev/null"), &error).to_string();
        assert!(said.starts_with("/dev/null is no serial port: "), "{said}");
    }

    /// Two readers would each have a part of the bytes. Once the first has ended, the port is free.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_port_has_one_reader() {
        use std::os::fd::AsRawFd as _;
        let (_ours, theirs) = SerialPort::pair().unwrap();
        let path = fs::read_link(format!("/proc/self/fd/{}", theirs.as_raw_fd())).unwrap();
        let first = connect(&path, 9600).unwrap();
        let second = connect(&path, 115_200).unwrap_err();
        assert!(refusal(&path, &second).to_string().contains("is busy"), "{second}");
        drop(first);
        connect(&path, 9600).unwrap();
    }

    /// A board that starts anew when its port is opened, as many do that are programmed over it: it says
    /// `banner`, and sends from `after` on. The rate at which it is heard.
    #[cfg(target_os = "linux")]
    fn rate_of_board(banner: &[u8], after: Duration) -> Result<u32, Error> {
        use std::os::fd::AsRawFd as _;
        use std::sync::atomic::{AtomicBool, Ordering};
        let (mut board, theirs) = SerialPort::pair().unwrap();
        let path = fs::read_link(format!("/proc/self/fd/{}", theirs.as_raw_fd())).unwrap();
        board.set_read_timeout(Duration::from_millis(10)).unwrap();
        drop(theirs);
        let over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let mut opened: Option<Instant> = None;
                while !over.load(Ordering::Relaxed) {
                    // Other errors than that nothing came: nobody has the other end open.
                    let is_open = match board.read(&mut [0; 16]) {
                        Ok(_) => true,
                        Err(e) => e.kind() == io::ErrorKind::TimedOut,
                    };
                    match opened {
                        _ if !is_open => std::thread::sleep(Duration::from_millis(10)),
                        None => board.write_all(banner).unwrap(),
                        Some(opened) if opened.elapsed() > after => {
                            board.write_all(&[b'1'; 64]).unwrap();
                        }
                        Some(_) => {}
                    }
                    opened = is_open.then(|| opened.unwrap_or_else(Instant::now));
                }
            });
            let refused = |bytes: &[u8]| {
                let noise = bytes.iter().filter(|byte| **byte != b'1').count();
                (bytes.len() >= 64).then_some(noise as f64 / bytes.len() as f64)
            };
            let found = find_rate(&path, &Expected { protocol: None, refused: &refused });
            over.store(true, Ordering::Relaxed);
            found.map(|(_, rate)| rate)
        })
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_board_that_starts_anew_when_its_port_is_opened_is_heard() {
        for banner in ["", "\0\0\r"] {
            let rate = rate_of_board(banner.as_bytes(), Duration::from_millis(1500));
            assert_eq!(rate.unwrap(), RATES[0], "{banner:?}");
        }
    }

    /// The stream follows at once what the loader says, which is nearly half of all that is listened to.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_board_that_speaks_before_its_stream_is_heard_at_once() {
        let words = [b'x'; ENOUGH * 9 / 20];
        assert_eq!(rate_of_board(&words, Duration::ZERO).unwrap(), RATES[0]);
    }

    /// What its loader says is of no protocol, and then all rates are tried before it sends.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_board_whose_loader_speaks_is_heard_in_the_end() {
        // A trial ends with the read that is under way.
        let after = (TRIAL + PAUSE) * (RATES.len() as u32 + 1);
        rate_of_board(&[b'x'; 80], after).unwrap();
    }
}
