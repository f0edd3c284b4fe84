//! Decoders on bad lines, without memory of their own, and behind a terminal as a sensor's.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::io::Read as _;
use std::path::Path;

use imu_tests::command::imu;
use imu_tests::frames::{bad_line, message};
use imu_tools::live::protocol::{Decoder, Encoder, Protocol};
use imu_tools::recording::{self, Block, ReadOptions};

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

/// The system's memory, counted by thread.
struct Counting;

// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // A thread that ends has no counter any more.
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static MEMORY: Counting = Counting;

#[test]
fn decoding_does_not_allocate() {
    for protocol in Protocol::ALL {
        let mut encoder = Encoder::new(protocol);
        let (mut first, mut rest) = (Vec::new(), Vec::new());
        // A header of text is learnt from, and a time's unit, once.
        (0..40).for_each(|i| encoder.encode(&message(i), &mut first));
        (40..200).for_each(|i| encoder.encode(&message(i), &mut rest));
        // Damage is decoded, too.
        rest.extend_from_slice(&[
            0xFA, 0xFF, 0x36, 0xA9, 0x56, 0x17, b'$', b'V', b'N', 0xFD, 9, b'\n',
        ]);
        let mut decoder = Decoder::new(protocol, &ReadOptions::default()).unwrap();
        let mut messages = 0;
        decoder.feed(&first, &mut |_| messages += 1);
        let before = ALLOCATIONS.get();
        for piece in rest.chunks(7) {
            decoder.feed(piece, &mut |_| messages += 1);
        }
        decoder.end(&mut |_| messages += 1);
        assert_eq!(ALLOCATIONS.get(), before, "{protocol}");
        assert_eq!(messages, 200, "{protocol}");
    }
}

/// Of whole frames behind damage the first may be lost, never the second. (In full: examples/frames.rs.)
#[test]
fn whole_frames_are_found_on_a_bad_line() {
    for protocol in Protocol::ALL {
        let outcome = bad_line(protocol, 10_000, 7);
        assert!(outcome.whole > 8_000);
        assert_eq!(outcome.second_lost, 0, "{protocol}: {outcome:?}");
        // A line of text begins where the one before ends, and has no checksum. Elsewhere the first is lost,
        // or damage passes, where the byte that a cut frame lacks comes first in the next: once in 256
        // of cuts by one byte, in less than one frame in 1000.
        if protocol != Protocol::Text {
            assert!(outcome.lost * 1000 < outcome.whole, "{protocol}: {outcome:?}");
        }
        if matches!(protocol, Protocol::ImuFrame | Protocol::VectorNav | Protocol::Mavlink) {
            assert!(outcome.invented * 1000 < outcome.whole, "{protocol}: {outcome:?}");
        }
    }
}

/// What comes through a terminal is what a file of the same scene holds.
#[cfg(target_os = "linux")]
#[test]
fn a_simulated_sensor_sends_the_scene() {
    const SCENE: [&str; 7] = ["simulate", "low", "--duration", "2s", "--rate", "500", "--moving"];
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("imu.csv");
    let status = imu().args(SCENE).arg("-o").arg(&file).status().unwrap();
    assert!(status.success());
    let mut source = recording::open(&file, &ReadOptions::default()).unwrap();
    let mut block = Block::default();
    assert!(source.next_block(&mut block).unwrap());
    assert_eq!(block.gyroscope.len(), 1000);
    std::thread::scope(|scope| {
        for protocol in Protocol::ALL {
            let (block, link) = (&block, folder.path().join(protocol.name()));
            scope.spawn(move || {
                let output = format!("pty:{protocol}:{}", link.display());
                let sensor = imu().args(SCENE).args(["--speed", "max", "-o", &output]).spawn();
                let mut sensor = sensor.unwrap();
                let messages = heard(protocol, &link, block.gyroscope.len());
                assert!(sensor.wait().unwrap().success());
                let steps = [(Protocol::WitMotion, 6e-4), (Protocol::VectorNavAscii, 5.1e-7)];
                let exact = [Protocol::Text, Protocol::Xsens].contains(&protocol);
                // Half a step, or half of the last bit of a single below 8 rad/s.
                let step = steps.into_iter().find(|(coarse, _)| *coarse == protocol);
                let tolerance = step.map_or(if exact { 0.0 } else { 2.4e-7 }, |(_, step)| step);
                for (i, (message, sample)) in messages.iter().zip(&block.gyroscope).enumerate() {
                    let rate = message.gyroscope.unwrap();
                    for (heard, sent) in rate.iter().zip(sample.value) {
                        assert!(
                            (heard - sent).abs() <= tolerance,
                            "{protocol}: {i} {heard} {sent}"
                        );
                    }
                }
                assert!(!Path::new(&link).exists(), "{protocol} leaves its link behind");
            });
        }
    });
}

/// So many messages from a terminal.
#[cfg(target_os = "linux")]
fn heard(protocol: Protocol, link: &Path, messages: usize) -> Vec<imu_tools::live::Message> {
    let mut terminal = loop {
        match std::fs::File::open(link) {
            Ok(terminal) => break terminal,
            Err(_) => std::thread::sleep(std::time::Duration::from_millis(5)),
        }
    };
    let mut decoder = Decoder::new(protocol, &ReadOptions::default()).unwrap();
    let (mut piece, mut heard) = ([0; 4096], Vec::new());
    while heard.len() < messages {
        let length = terminal.read(&mut piece).unwrap();
        decoder.feed(&piece[..length], &mut |message| heard.push(message));
    }
    assert_eq!(decoder.tally().refused, 0, "{protocol}");
    heard
}
