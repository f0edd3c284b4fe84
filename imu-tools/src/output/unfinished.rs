//! What is being written and not complete, so that an interrupted program leaves none of it.

use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
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

/// The signal that asks the program to end, once it does; 0: none did.
static ASKED: AtomicI32 = AtomicI32::new(0);

/// Whether somebody looks at [`ASKED`].
static HEEDED: AtomicBool = AtomicBool::new(false);

/// From now on the first signal that asks the program to end is only noted: whoever calls this ends it in
/// good time ([`end_is_asked`]). A second one ends it at once.
pub fn heed_signals() {
    HEEDED.store(true, Ordering::SeqCst);
}

/// The number of the signal that asks the program to end, if one does.
#[must_use]
pub fn end_is_asked() -> Option<i32> {
    Some(ASKED.load(Ordering::SeqCst)).filter(|signal| *signal != 0)
}

/// From now on an interruption (Ctrl-C), a request to end (SIGTERM) or a terminal that is closed
/// (SIGHUP) removes what is unfinished, and ends the program with the customary exit code, 130, 143
/// or 129. Where there are no such signals nothing happens.
pub fn clean_up_on_signals() {
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        let mut signals = vec![SIGINT, SIGTERM];
        if !hangups_are_ignored() {
            signals.push(SIGHUP);
        }
        let Ok(mut signals) = signal_hook::iterator::Signals::new(signals) else {
            return; // The system keeps its own way of ending programs.
        };
        std::thread::spawn(move || {
            for signal in signals.forever() {
                if HEEDED.load(Ordering::SeqCst) && ASKED.swap(signal, Ordering::SeqCst) == 0 {
                    continue;
                }
                // Nobody makes or settles anything while this lock is held, to the end.
                let paths = paths();
                remove(&paths);
                std::process::exit(128 + signal);
            }
        });
    }
}

/// Whether the program was started by `nohup`, to go on when the terminal is closed. Where the
/// system does not tell (elsewhere than on Linux), it might have been.
#[cfg(unix)]
fn hangups_are_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_none_or(|mask| mask & 1 != 0)
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
