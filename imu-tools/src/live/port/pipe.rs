//! The standard input, or a named pipe: bytes of a sensor until whoever writes them ends.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;
use std::sync::mpsc::SyncSender;

use super::{Arrival, HostClock, pump};
use crate::error::Error;

/// Begins to read.
pub(super) fn open(path: &Path, to: SyncSender<Arrival>) -> Result<(), Error> {
    let file = match path.to_str() {
        Some("-") => None,
        _ => Some(File::open(path).map_err(|e| Error::io("read", path, e))?),
    };
    let path = path.to_owned();
    std::thread::spawn(move || {
        let clock = HostClock::new();
        let ended = match file {
            Some(mut file) => pump(|buffer| file.read(buffer), &clock, &to),
            None => pump(|buffer| io::stdin().read(buffer), &clock, &to),
        };
        let told = match ended {
            None => return,
            Some(Ok(())) => Arrival::End,
            Some(Err(source)) => Arrival::Failed(Error::io("read", &path, source)),
        };
        // Nobody may listen any more.
        let _ = to.send(told);
    });
    Ok(())
}
