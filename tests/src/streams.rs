//! A sensor that streams our own frames into a pseudo-terminal, for tests of `imu live`.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use imu_tools::live::protocol::{Encoder, Protocol};
use imu_tools::live::{Message, Ticks};
use serial2::SerialPort;

/// A sensor at 1 kHz, until it is dropped.
pub struct Streaming {
    /// The device to read it from.
    pub device: PathBuf,
    sent: Arc<AtomicU64>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Streaming {
    /// Samples a second.
    pub const RATE: u64 = 1000;

    /// Begins to stream, in bursts of 16 ms as USB adapters do. What nobody reads is lost, as on a line.
    ///
    /// # Panics
    /// When there are no pseudo-terminals.
    #[must_use]
    pub fn start() -> Self {
        use std::os::fd::AsRawFd as _;
        let (ours, theirs) = SerialPort::pair().expect("pseudo-terminals");
        let link = format!("/proc/self/fd/{}", theirs.as_raw_fd());
        let device = std::fs::read_link(link).expect("the name of a pseudo-terminal");
        let (sent, stop) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicBool::new(false)));
        let (counter, end) = (sent.clone(), stop.clone());
        let thread = std::thread::spawn(move || stream(ours, &theirs, &counter, &end));
        Self { device, sent, stop, thread: Some(thread) }
    }

    /// Samples sent so far.
    #[must_use]
    pub fn sent(&self) -> u64 {
        self.sent.load(Ordering::SeqCst)
    }
}

impl Drop for Streaming {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        // Its failure is seen in what was read.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

fn stream(mut port: SerialPort, theirs: &SerialPort, sent: &AtomicU64, stop: &AtomicBool) {
    let (start, mut bytes) = (Instant::now(), Vec::new());
    let mut encoder = Encoder::new(Protocol::ImuFrame);
    // Nobody reads between two sessions: what a full line does not take is gone.
    let _ = port.set_write_timeout(Duration::from_millis(5));
    let (mut state, mut number) = (1_u64, 0_u64);
    while !stop.load(Ordering::SeqCst) {
        std::thread::sleep(Duration::from_millis(16));
        let due = (start.elapsed().as_secs_f64() * Streaming::RATE as f64) as u64;
        bytes.clear();
        while number < due {
            encoder.encode(&message(number, &mut state), &mut bytes);
            number += 1;
        }
        if port.write_all(&bytes).is_err() {
            let _ = theirs.discard_input_buffer();
        }
        sent.store(number, Ordering::SeqCst);
    }
}

/// White noise on all axes: the sum of bytes of a random word.
fn message(number: u64, state: &mut u64) -> Message {
    let mut noise = || {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        let sum: u32 = state.to_le_bytes().iter().map(|byte| u32::from(*byte)).sum();
        f64::from((1e-4 * (f64::from(sum) - 1020.0)) as f32)
    };
    let ticks = Ticks {
        value: number * (1_000_000 / Streaming::RATE),
        per_second: 1_000_000,
        wraps_at: None,
    };
    Message {
        gyroscope: Some([noise(), noise(), noise()]),
        accelerometer: Some([noise(), noise(), noise() + 9.75]),
        ticks: Some(ticks),
        ..Message::default()
    }
}
