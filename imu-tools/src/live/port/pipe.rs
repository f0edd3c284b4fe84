//! The standard input, or a named pipe: bytes of a sensor until whoever writes them ends.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::mpsc::SyncSender;

use super::{Arrival, HostClock, pump};
use crate::error::Error;

/// Begins to read. A named pipe is opened by the thread that reads it: that takes until somebody writes to it.
pub(super) fn open(path: &Path, to: SyncSender<Arrival>) {
    let path = path.to_owned();
    std::thread::spawn(move || {
        let source: io::Result<Box<dyn Read>> = match path.to_str() {
            Some("-") => Ok(Box::new(io::stdin())),
            _ => File::open(&path).map(|file| Box::new(file) as _),
        };
        let ended = match source {
            Ok(mut source) => pump(|buffer| source.read(buffer), &HostClock::new(), &to),
            Err(error) => Some(Err(error)),
        };
        let told = match ended {
            None => return,
            Some(Ok(())) => Arrival::End,
            Some(Err(source)) => Arrival::Failed(Error::io("read", &path, source)),
        };
        // Nobody may listen any more.
        let _ = to.send(told);
    });
}

#[cfg(all(test, unix))]
mod tests {
    use std::io::Write as _;
    use std::sync::mpsc::sync_channel;

    use super::*;

    /// Until then the session shows that nothing comes, and can be ended.
    #[test]
    fn a_named_pipe_may_have_its_writer_later() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        let (to, arrivals) = sync_channel(8);
        open(&path, to);
        let mut writer = File::options().write(true).open(&path).unwrap();
        writer.write_all(b"123").unwrap();
        drop(writer);
        let Arrival::Bytes { bytes, .. } = arrivals.recv().unwrap() else { panic!("no bytes") };
        assert_eq!(bytes, b"123");
        assert!(matches!(arrivals.recv().unwrap(), Arrival::End));
    }

    #[test]
    fn one_that_cannot_be_read_is_told_of() {
        let (to, arrivals) = sync_channel(8);
        open(Path::new("/no/such/pipe"), to);
        let Arrival::Failed(error) = arrivals.recv().unwrap() else { panic!("no error") };
        assert!(error.to_string().contains("/no/such/pipe"), "{error}");
    }
}
