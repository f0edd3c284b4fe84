//! Words on the standard output and the standard error, and nothing that steers a terminal.

use std::io::{self, Write as _};
use std::path::Path;

use crate::error::Error;
use crate::report::harmless;

/// Prints a result on the standard output.
pub(super) fn print(text: &str) -> Result<(), Error> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(harmless(text, "\n").as_bytes()).and_then(|()| stdout.flush());
    written.map_err(|source| Error::io("write", Path::new("-"), source))
}

/// Says a sentence on the standard error, where that can be written.
pub(super) fn say(sentence: &str) {
    // A program that cannot complain has nobody left to tell.
    let _ = writeln!(io::stderr(), "{}", harmless(sentence, ""));
}
