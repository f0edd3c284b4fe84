//! The loop over real pseudo-terminals and connections, with lines of text in the place of a protocol.

use std::fs;
use std::io::Write as _;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serial2::SerialPort;

use super::*;
use crate::calibrate::Options;
use crate::live::port::{self, Address, Expected, How};
use crate::recording::Sample;

/// Lines `STAMP VALUE`, a sample each; anything else is refused.
#[derive(Default)]
struct Text {
    open: Vec<u8>,
    bytes: u64,
    refused: u64,
}

impl Decode for Text {
    fn feed(&mut self, _: i64, bytes: &[u8], to: &mut Vec<Step>) -> Result<(), Error> {
        let mut block = Block::default();
        self.bytes += bytes.len() as u64;
        for byte in bytes {
            if *byte != b'\n' {
                self.open.push(*byte);
                continue;
            }
            let line = String::from_utf8_lossy(&self.open).into_owned();
            let mut fields = line.split(' ');
            let stamp = fields.next().and_then(|f| f.parse().ok());
            match (stamp, fields.next().and_then(|f| f.parse().ok())) {
                (Some(stamp_ns), Some(x)) => {
                    block.gyroscope.push(Sample { stamp_ns, value: [x; 3] });
                }
                _ => self.refused += self.open.len() as u64 + 1,
            }
            self.open.clear();
        }
        to.push(Step::Samples(block, SampleKind::default()));
        Ok(())
    }

    fn reopened(&mut self, _: &mut Vec<Step>) {}

    fn finish(&mut self, _: &mut Vec<Step>) -> Result<(), Error> {
        Ok(())
    }

    fn tell(&self, link: &mut Link) {
        (link.bytes, link.refused) = (self.bytes, self.refused);
    }
}

/// Remembers what was said, and quits when so many samples came.
struct Watch {
    said: Vec<String>,
    enough: u64,
    quit: Arc<AtomicBool>,
}

impl Face for Watch {
    fn every(&self) -> Duration {
        Duration::from_millis(20)
    }

    fn show(&mut self, view: &View) -> Result<(), Error> {
        if view.samples[0] >= self.enough {
            self.quit.store(true, Ordering::SeqCst);
        }
        Ok(())
    }

    fn say(&mut self, sentence: &str) {
        self.said.push(sentence.to_owned());
    }

    fn key(&mut self) -> Option<Key> {
        self.quit.load(Ordering::SeqCst).then_some(Key::Quit)
    }
}

fn line(number: i64) -> String {
    format!("{} {}\n", number * 1_000_000, number * number % 101)
}

/// A disk that is full.
struct Full;

impl Sink for Full {
    fn write_block(&mut self, _: &Block) -> Result<(), Error> {
        Err(Error::data("the disk is full"))
    }

    fn finish(self: Box<Self>) -> Result<(), Error> {
        Ok(())
    }
}

/// Runs until `enough` samples came from `address`.
fn follow(address: &Address, enough: u64, keep: Keep) -> (View, Vec<String>) {
    let (view, said, ended) = run(address, enough, keep);
    assert_eq!(ended.unwrap(), Ended::Quit);
    (view, said)
}

fn run(address: &Address, enough: u64, keep: Keep) -> (View, Vec<String>, Result<Ended, Error>) {
    let how = How { baud: Some(115_200), ..How::default() };
    let live = Live {
        session: Session::new("it", &Options::default()),
        port: port::open(address, &how, &Expected { protocol: None, refused: &|_| None }).unwrap(),
        decode: Some(Box::new(Text::default())),
        keep,
        goal: Goal::default(),
        save: &mut |_| Ok(String::new()),
    };
    let mut watch = Watch { said: Vec::new(), enough, quit: Arc::default() };
    let (view, ended) = live.run(&mut watch);
    (view, watch.said, ended)
}

/// A pseudo-terminal whose other end stands at `link`.
fn terminal(link: &Path) -> (SerialPort, SerialPort) {
    use std::os::fd::AsRawFd as _;
    let (ours, theirs) = SerialPort::pair().unwrap();
    let at: PathBuf = fs::read_link(format!("/proc/self/fd/{}", theirs.as_raw_fd())).unwrap();
    let part = link.with_extension("new");
    std::os::unix::fs::symlink(at, &part).unwrap();
    fs::rename(part, link).unwrap();
    (ours, theirs)
}

fn send(port: &SerialPort, numbers: std::ops::Range<i64>) {
    for number in numbers {
        port.write_all(line(number).as_bytes()).unwrap();
    }
}

#[test]
fn a_device_that_hangs_up_is_waited_for_and_the_time_is_a_gap() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("tty");
    let raw = folder.path().join("raw");
    let (ours, theirs) = terminal(&link);
    let there = link.clone();
    let sender = std::thread::spawn(move || {
        // Opened by the session by now: nothing is lost to a mode that is not raw yet.
        std::thread::sleep(Duration::from_millis(300));
        ours.write_all(b"noise\n").unwrap();
        send(&ours, 0..3000);
        // All is read before the line is cut.
        std::thread::sleep(Duration::from_millis(500));
        drop((ours, theirs));
        std::thread::sleep(Duration::from_millis(300));
        let (ours, theirs) = terminal(&there);
        std::thread::sleep(Duration::from_millis(800));
        send(&ours, 3500..6500);
        (ours, theirs)
    });
    let keep = Keep { raw: Some(Output::growing(&raw).unwrap()), ..Keep::default() };
    let (view, said) = follow(&Address::Serial(link), 6000, keep);
    let _ends = sender.join().unwrap();
    let noise = view.snapshot.calibration.gyroscope.unwrap();
    assert_eq!(
        (noise.stamps.samples, noise.stamps.missing, noise.stamps.gap_count),
        (6000, 500, 1)
    );
    assert_eq!(view.link.refused, 6);
    assert!(
        said[0].contains("waiting for it to come back") && said[1].ends_with("is back"),
        "{said:?}"
    );
    let lines = fs::read_to_string(raw).unwrap();
    assert_eq!(lines.lines().count(), 6001);
}

#[test]
fn a_recording_that_cannot_be_written_is_given_up_and_the_measurement_goes_on() {
    let server = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = Address::Tcp(server.local_addr().unwrap().to_string());
    let sender = std::thread::spawn(move || {
        let (mut stream, _) = server.accept().unwrap();
        let text: String = (0..6000).map(line).collect();
        stream.write_all(text.as_bytes()).unwrap();
        stream
    });
    let keep = Keep { record: Some(Box::new(Full)), ..Keep::default() };
    let (view, said, ended) = run(&address, 6000, keep);
    let _stream = sender.join().unwrap();
    assert_eq!(view.samples[0], 6000);
    assert_eq!(said, ["warning: the disk is full; the session goes on without it"]);
    assert_eq!(ended.unwrap_err().to_string(), "the disk is full");
}

#[test]
fn a_connection_that_closes_is_opened_again() {
    let server = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = Address::Tcp(server.local_addr().unwrap().to_string());
    let sender = std::thread::spawn(move || {
        for numbers in [0..3000, 4000..7000] {
            let (mut stream, _) = server.accept().unwrap();
            let text: String = numbers.map(line).collect();
            stream.write_all(text.as_bytes()).unwrap();
        }
    });
    let (view, said) = follow(&address, 6000, Keep::default());
    sender.join().unwrap();
    let noise = view.snapshot.calibration.gyroscope.unwrap();
    assert_eq!((noise.stamps.samples, noise.stamps.missing), (6000, 1000));
    assert!(said[0].contains("the connection was closed"), "{said:?}");
}
