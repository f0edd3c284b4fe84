//! Where a scene file is wrong: the line and the key of an error, and a known key near an unknown one.

use toml::de::{DeTable, DeValue};

use super::check::Bad;
use crate::error::Error;

/// The line, from 1, of a byte of `text`.
fn line(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|&byte| byte == b'\n').count()
}

/// What the parser refuses, in one sentence.
pub(super) fn refused(text: &str, name: &str, error: &toml::de::Error) -> Error {
    let at = error.span().map_or(0, |span| span.start);
    let message = error.message().lines().collect::<Vec<_>>().join(" ");
    let message = unknown(&message).unwrap_or_else(|| plain(&message));
    let key = DeTable::parse(text).ok().and_then(|table| key_of_value(table.get_ref(), at));
    let key = key.map_or_else(String::new, |key| format!("{key}: "));
    Error::data(format!("scene {name}, line {}: {key}{message}", line(text, at)))
}

/// A number that cannot be, with its line if the file has it.
pub(super) fn impossible(text: &str, name: &str, bad: Bad) -> Error {
    let at = DeTable::parse(text).ok().and_then(|table| place(table.get_ref(), &bad.key));
    let line = at.map_or_else(String::new, |at| format!(", line {}", line(text, at)));
    Error::data(format!("scene {name}{line}: {}", Error::from(bad)))
}

/// The key, with its tables, in whose value (other than a table) the byte `at` is.
fn key_of_value(table: &DeTable<'_>, at: usize) -> Option<String> {
    table.iter().find_map(|(key, value)| match value.get_ref() {
        DeValue::Table(inner) => {
            key_of_value(inner, at).map(|rest| format!("{}.{rest}", key.get_ref()))
        }
        _ => value.span().contains(&at).then(|| key.get_ref().to_string()),
    })
}

/// Where the key that is named with its tables stands.
fn place(table: &DeTable<'_>, key: &str) -> Option<usize> {
    let (first, rest) =
        key.split_once('.').map_or((key, None), |(first, rest)| (first, Some(rest)));
    let (key, value) = table.iter().find(|(key, _)| key.get_ref().as_ref() == first)?;
    match (value.get_ref(), rest) {
        (DeValue::Table(inner), Some(rest)) => place(inner, rest),
        _ => Some(key.span().start),
    }
}

/// The parser's words for people who write scenes and not programs.
fn plain(message: &str) -> String {
    if let Some(key) = message.strip_prefix("missing field ") {
        return format!("{key} is missing in this table");
    }
    if message.contains("must be quoted") {
        return "this is no value: give a plain number, or text in quotes".into();
    }
    let Some((found, expected)) = message.split_once(", expected ") else {
        return message.to_owned();
    };
    let expected = match expected {
        "f64" => "a number",
        "u64" => "a whole number from 0 on",
        "i64" => "a whole number",
        "an array of length 2" => "two numbers, [a, b]",
        "an array of length 3" => "three in brackets, [x, y, z]",
        name if name.starts_with("struct ") => "a table",
        other => other,
    };
    format!("{found}, expected {expected}")
}

/// The complaint about an unknown name, with the known one that was meant, or all of them.
fn unknown(message: &str) -> Option<String> {
    let what = [("unknown field ", "key"), ("unknown variant ", "word")];
    let (rest, what) =
        what.into_iter().find_map(|(start, what)| Some((message.strip_prefix(start)?, what)))?;
    // Names are in backticks: the unknown one, then those that are known.
    let mut names = rest.split('`').skip(1).step_by(2);
    let wrong = names.next()?;
    let known: Vec<&str> = names.collect();
    let far = |name: &&str| strsim::damerau_levenshtein(wrong, name);
    let typo = known.iter().copied().min_by_key(far).filter(|near| 3 * far(near) <= near.len());
    let short = |name: &&str| wrong.len() > 2 && name.starts_with(wrong);
    Some(match typo.or_else(|| known.iter().copied().find(short)) {
        Some(near) => format!("there is no {what} `{wrong}`; `{near}` is meant?"),
        None => format!("there is no {what} `{wrong}`; there are `{}`", known.join("`, `")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_near_name_is_told_and_else_all_of_them() {
        let unknown =
            |name| unknown(&format!("unknown field `{name}`, expected `seed` or `clock`"));
        assert_eq!(unknown("sede").unwrap(), "there is no key `sede`; `seed` is meant?");
        assert_eq!(unknown("x").unwrap(), "there is no key `x`; there are `seed`, `clock`");
        assert_eq!(unknown("clo").unwrap(), "there is no key `clo`; `clock` is meant?");
        assert_eq!(super::unknown("invalid type"), None);
    }

    #[test]
    fn no_word_is_a_programmers() {
        for (said, words) in [
            (
                "invalid type: string \"x\", expected f64",
                "invalid type: string \"x\", expected a number",
            ),
            ("missing field `x`", "`x` is missing in this table"),
            (
                "invalid type: integer `3`, expected struct X",
                "invalid type: integer `3`, expected a table",
            ),
            ("duplicate key", "duplicate key"),
        ] {
            assert_eq!(plain(said), words);
        }
    }
}
