//! What is read until it goes away, and opened again when it is back: a device, a connection.

use std::io::{self, Read};
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use super::{Arrival, HostClock, pump};

/// How to open again what went away.
pub(super) struct Again<C> {
    /// Opens it.
    pub connect: C,
    /// The time between attempts.
    pub pause: Duration,
    /// Why it went away, in words.
    pub why: fn(io::Result<()>) -> String,
}

/// Reads on a thread of its own, again and again, until nobody listens.
pub(super) fn read<S, C>(first: S, again: Again<C>, to: SyncSender<Arrival>)
where
    S: Read + Send + 'static,
    C: Fn() -> io::Result<S> + Send + 'static,
{
    std::thread::spawn(move || {
        let clock = HostClock::new();
        let mut source = first;
        while let Some(ended) = pump(|buffer| source.read(buffer), &clock, &to) {
            // A device that is still held cannot be opened.
            drop(source);
            let Some(next) = wait(&again, ended, &clock, &to) else { return };
            source = next;
        }
    });
}

/// Says that it is gone, and waits until it is back; `None` when nobody listens.
fn wait<S>(
    again: &Again<impl Fn() -> io::Result<S>>,
    ended: io::Result<()>,
    clock: &HostClock,
    to: &SyncSender<Arrival>,
) -> Option<S> {
    to.send(Arrival::Gone((again.why)(ended))).ok()?;
    loop {
        std::thread::sleep(again.pause);
        if let Ok(source) = (again.connect)() {
            to.send(Arrival::Back).ok()?;
            return Some(source);
        }
        // Somebody must still want it.
        to.send(Arrival::Bytes { arrival_ns: clock.now_ns(), bytes: Vec::new() }).ok()?;
    }
}
