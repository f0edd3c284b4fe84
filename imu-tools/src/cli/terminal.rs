//! Words on the standard output and the standard error, and nothing that steers a terminal.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::Path;

use crate::error::Error;

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

/// The text with control characters as `\u001b`, but for those `kept`: what a file calls its columns
/// or topics may hold some, and a terminal would obey them. JSON stays JSON, in which they can stand
/// within a string only.
fn harmless<'a>(text: &'a str, kept: &str) -> Cow<'a, str> {
    let harmful = |c: char| c.is_control() && !kept.contains(c);
    if !text.contains(harmful) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::new();
    for c in text.chars() {
        if harmful(c) {
            // Writing to a string does not fail.
            let _ = write!(shown, "\\u{:04x}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use super::harmless;

    #[test]
    fn control_characters_are_shown_and_not_sent() {
        assert_eq!(harmless("a\x1b[31m\0\u{9b}b\n", ""), "a\\u001b[31m\\u0000\\u009bb\\u000a");
        assert_eq!(harmless("µ\n\x7f\n", "\n"), "µ\n\\u007f\n");
    }
}
