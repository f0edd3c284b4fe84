//! What is being written and not complete, so that an interrupted program leaves none of it.

use std::io;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The temporary files and folders that exist now.
static PATHS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn paths() -> MutexGuard<'static, Vec<PathBuf>> {
    // A list of paths is whole whenever a thread stops.
    PATHS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A temporary file or folder that is removed when the program is interrupted.
#[derive(Debug)]
pub(crate) struct Unfinished(PathBuf);

impl Unfinished {
    /// Makes something temporary and notes where it is. No signal comes in between.
    pub(crate) fn create<T>(
        make: impl FnOnce() -> io::Result<(T, PathBuf)>,
    ) -> io::Result<(T, Self)> {
        let mut paths = paths();
        let (made, path) = make()?;
        paths.push(path.clone());
        Ok((made, Self(path)))
    }

    /// Puts it in its place, where it is no longer temporary. No signal comes in between.
    pub(crate) fn settle<T>(self, put: impl FnOnce() -> T) -> T {
        let paths = paths();
        let done = put();
        drop(paths);
        done
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        paths().retain(|path| path != &self.0);
    }
}

/// From now on an interruption (Ctrl-C) or a request to end (SIGTERM) removes what is unfinished, and
/// ends the program with the customary exit code, 130 or 143. Where there are no such signals
/// nothing happens.
pub fn clean_up_on_signals() {
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGINT, SIGTERM};
        let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) else {
            return; // The system keeps its own way of ending programs.
        };
        std::thread::spawn(move || {
            if let Some(signal) = signals.forever().next() {
                // Nobody makes or settles anything while this lock is held, to the end.
                let paths = paths();
                remove(&paths);
                std::process::exit(128 + signal);
            }
        });
    }
}

#[cfg(unix)]
fn remove(paths: &[PathBuf]) {
    use std::fs;
    // What was made last goes first, so that folders are empty when their turn comes.
    for path in paths.iter().rev() {
        // Whatever cannot be removed stays, such as a folder that holds something by now: there is
        // nobody to tell.
        let _ = if path.is_dir() { fs::remove_dir(path) } else { fs::remove_file(path) };
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_is_unfinished_is_removed_and_what_is_settled_stays() {
        let folder = tempfile::tempdir().unwrap();
        let make = |name: &str| {
            let path = folder.path().join(name);
            Unfinished::create(|| {
                fs::write(&path, name)?;
                Ok(((), path.clone()))
            })
        };
        let ((), settled) = make("settled").unwrap();
        let ((), left) = make("left").unwrap();
        settled.settle(|| ());
        let mine: Vec<_> =
            paths().iter().filter(|path| path.starts_with(folder.path())).cloned().collect();
        assert_eq!(mine, [folder.path().join("left")]);
        remove(&mine);
        assert!(folder.path().join("settled").exists() && !folder.path().join("left").exists());
        drop(left);
        assert!(!paths().iter().any(|path| path.starts_with(folder.path())));
    }
}
