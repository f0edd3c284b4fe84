//! The loop over real pseudo-terminals and connections, with lines of text in the place of a protocol.

use std::fs;
use std::io::Write as _;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use serial2::SerialPort;

use super::*;
use crate::calibrate::Options;
use crate::live::checkpoint::Place;
use crate::live::port::{self, Address, Expected, How};
use crate::output::Output;
use crate::recording::{Sample, Sink};

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
        if self.bytes > 0 && self.refused == self.bytes {
            return Err(Error::data("of no known protocol"));
        }
        Ok(())
    }

    fn tell(&self, link: &mut Link) {
        (link.bytes, link.refused) = (self.bytes, self.refused);
    }
}

/// What a sender sees of the session that reads it.
#[derive(Default)]
struct Seen {
    /// Times that the port was opened.
    opened: AtomicU64,
    samples: AtomicU64,
}

/// Waits until so much was seen.
fn wait_for(number: &AtomicU64, least: u64) {
    while number.load(Ordering::SeqCst) < least {
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Remembers what was said, and quits when so many samples came.
struct Watch {
    said: Vec<String>,
    enough: u64,
    seen: Arc<Seen>,
}

impl Face for Watch {
    fn every(&self) -> Duration {
        Duration::from_millis(20)
    }

    fn show(&mut self, view: &View) -> Result<(), Error> {
        self.seen.samples.store(view.samples[0], Ordering::SeqCst);
        Ok(())
    }

    fn say(&mut self, sentence: &str) {
        self.seen.opened.fetch_add(u64::from(sentence.ends_with("is back")), Ordering::SeqCst);
        self.said.push(sentence.to_owned());
    }

    fn key(&mut self) -> Option<Key> {
        (self.seen.samples.load(Ordering::SeqCst) >= self.enough).then_some(Key::Quit)
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
fn run(
    address: &Address,
    enough: u64,
    keep: Keep,
    seen: Arc<Seen>,
) -> (View, Vec<String>, Result<Ended, Error>) {
    let how = How { baud: Some(115_200), ..How::default() };
    let live = Live {
        session: Session::new("it", &Options::default()),
        port: port::open(address, &how, &Expected { protocol: None, refused: &|_| None }).unwrap(),
        decode: Some(Box::new(Text::default())),
        keep,
        goal: Goal::default(),
        save: &mut |_| Ok(None),
    };
    seen.opened.store(1, Ordering::SeqCst);
    let mut watch = Watch { said: Vec::new(), enough, seen };
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
    let (there, seen) = (link.clone(), Arc::new(Seen::default()));
    let its = seen.clone();
    let sender = std::thread::spawn(move || {
        // What comes before it is opened is thrown away.
        wait_for(&its.opened, 1);
        ours.write_all(b"noise\n").unwrap();
        send(&ours, 0..3000);
        // All is read before the line is cut.
        wait_for(&its.samples, 3000);
        drop((ours, theirs));
        let (ours, theirs) = terminal(&there);
        wait_for(&its.opened, 2);
        send(&ours, 3500..6500);
        (ours, theirs)
    });
    let keep = Keep { raw: Some(Output::growing(&raw).unwrap()), ..Keep::default() };
    let (view, said, ended) = run(&Address::Serial(link), 6000, keep, seen);
    let _ends = sender.join().unwrap();
    assert_eq!(ended.unwrap(), Ended::Quit);
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
    let (view, said, ended) = run(&address, 6000, keep, Arc::default());
    let _stream = sender.join().unwrap();
    assert_eq!(view.samples[0], 6000);
    assert_eq!(said, ["warning: the disk is full; the session goes on without it"]);
    assert_eq!(ended.unwrap_err().to_string(), "the disk is full");
}

/// Presses keys, one after the other.
struct Keys {
    keys: std::vec::IntoIter<Key>,
    said: Vec<String>,
    lost: Vec<String>,
}

impl Face for Keys {
    fn every(&self) -> Duration {
        Duration::ZERO
    }

    fn show(&mut self, view: &View) -> Result<(), Error> {
        self.lost.clone_from(&view.lost);
        Ok(())
    }

    fn say(&mut self, sentence: &str) {
        self.said.push(sentence.to_owned());
    }

    fn key(&mut self) -> Option<Key> {
        self.keys.next()
    }
}

/// A session of lines that wait already, in which these keys are pressed, one after the other.
fn press(
    lines: impl Iterator<Item = String>,
    keep: Keep,
    save: &mut dyn FnMut(&View) -> Result<Option<String>, Error>,
    keys: Vec<Key>,
) -> (View, Result<Ended, Error>, Keys) {
    // The device stays there.
    let (to, arrivals) = std::sync::mpsc::sync_channel(1000);
    for bytes in lines.map(String::into_bytes) {
        to.send(Arrival::Bytes { arrival_ns: 0, bytes }).unwrap();
    }
    let live = Live {
        session: Session::new("it", &Options::default()),
        port: Port { name: "it".into(), arrivals },
        decode: Some(Box::new(Text::default())),
        keep,
        goal: Goal::default(),
        save,
    };
    let mut face = Keys { keys: keys.into_iter(), said: Vec::new(), lost: Vec::new() };
    let (view, ended) = live.run(&mut face);
    (view, ended, face)
}

#[test]
fn what_came_before_the_end_is_taken() {
    for (key, how) in [(Key::Quit, Ended::Quit), (Key::Interrupt, Ended::Signal(2))] {
        let (view, ended, _) =
            press((0..900).map(line), Keep::default(), &mut |_| Ok(None), vec![key]);
        assert_eq!((view.samples[0], ended.unwrap()), (900, how));
    }
}

/// It is not the way in which a port fails that is not known yet.
#[test]
fn what_the_user_ends_has_ended_so_though_its_protocol_is_unknown() {
    for (key, how) in [(Key::Quit, Ended::Quit), (Key::Interrupt, Ended::Signal(2))] {
        let lines = std::iter::once("who knows\n".to_owned());
        let (view, ended, _) = press(lines, Keep::default(), &mut |_| Ok(None), vec![key]);
        assert_eq!((view.link.refused, ended.unwrap()), (10, how));
        assert_eq!(view.link.amiss.as_deref(), Some("of no known protocol"));
    }
}

#[test]
fn a_checkpoint_that_cannot_be_written_is_in_sight_until_one_can() {
    let folder = tempfile::tempdir().unwrap();
    let away = folder.path().join("away");
    fs::create_dir(&away).unwrap();
    let place = Place::take(&away.join("c")).unwrap();
    let mut keep = Keep { checkpoint: Some((place, Duration::ZERO)), ..Keep::default() };
    let mut session = Session::new("it", &Options::default());
    let mut block = Block::default();
    block.gyroscope.push(Sample { stamp_ns: 0, value: [0.0; 3] });
    session.take(&mut block);
    assert!(keep.checkpoint(&session, false).unwrap());
    let there = folder.path().join("there");
    fs::rename(&away, &there).unwrap();
    assert!(keep.checkpoint(&session, false).is_err());
    assert!(keep.troubles()[0].starts_with("no checkpoint: "), "{:?}", keep.troubles());
    fs::rename(&there, &away).unwrap();
    assert!(keep.checkpoint(&session, false).unwrap());
    assert!(keep.troubles().is_empty());
}

#[test]
fn a_recording_that_was_given_up_stays_in_sight() {
    let keep = Keep { record: Some(Box::new(Full)), ..Keep::default() };
    let keys = [vec![Key::Mark; 40], vec![Key::Quit]].concat();
    let (_, _, face) = press((0..9).map(line), keep, &mut |_| Ok(None), keys);
    assert_eq!(face.lost, ["recorded no longer: the disk is full"]);
    assert!(face.said.last().unwrap().starts_with("mark 40 at"), "{:?}", face.said);
}

#[test]
fn saving_says_what_was_saved_and_what_was_not() {
    type Saved<'a> = &'a dyn Fn() -> Result<Option<String>, Error>;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("c");
    let keep = |checkpoint: bool| Keep {
        checkpoint: checkpoint.then(|| (Place::take(&path).unwrap(), Duration::from_secs(3600))),
        ..Keep::default()
    };
    let out = || Ok(Some("out".to_owned()));
    let early = || Err(Error::data("it is too early"));
    let nothing = "nothing to save: neither --checkpoint nor -o was given, or no sample came";
    let cases: [(bool, Saved<'_>, &str); 4] = [
        (true, &|| Ok(None), "the checkpoint is saved"),
        (true, &out, "the checkpoint is saved; the results are in out"),
        (true, &early, "the checkpoint is saved; the results are not saved: it is too early"),
        (false, &|| Ok(None), nothing),
    ];
    for (checkpoint, results, wanted) in cases {
        let keys = vec![Key::Save, Key::Quit];
        let (_, ended, face) = press((0..9).map(line), keep(checkpoint), &mut |_| results(), keys);
        assert_eq!(ended.unwrap(), Ended::Quit);
        assert_eq!(face.said, [wanted]);
    }
    assert!(path.exists());
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
    let (view, said, ended) = run(&address, 6000, Keep::default(), Arc::default());
    sender.join().unwrap();
    assert_eq!(ended.unwrap(), Ended::Quit);
    let noise = view.snapshot.calibration.gyroscope.unwrap();
    assert_eq!((noise.stamps.samples, noise.stamps.missing), (6000, 1000));
    assert!(said[0].contains("the connection was closed"), "{said:?}");
}
