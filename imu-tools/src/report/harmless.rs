//! What a file is called, or calls its columns and topics, may hold control characters: a terminal would obey them, a
//! page cannot hold them, and a comment of YAML would end at some. JSON stays JSON, in which they can stand within a
//! string only.

use std::borrow::Cow;
use std::fmt::Write as _;

/// The text with control characters and what else ends a line as `\u001b`, but for those `kept`.
pub(crate) fn harmless<'a>(text: &'a str, kept: &str) -> Cow<'a, str> {
    let harmful =
        |c: char| (c.is_control() || matches!(c, '\u{2028}' | '\u{2029}')) && !kept.contains(c);
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
        assert_eq!(harmless("a\u{85}b\u{2028}c\u{2029}", ""), "a\\u0085b\\u2028c\\u2029");
        assert_eq!(harmless("µ\n\x7f\n", "\n"), "µ\n\\u007f\n");
    }
}
