//! Lengths of time as people write them: `4h`, `90s`, `1h30m`, `250ms`, or a number of seconds.

use crate::error::Error;

/// Units and their nanoseconds. The longer names are matched first.
const UNITS: [(&str, f64); 11] = [
    ("hours", 3.6e12),
    ("hour", 3.6e12),
    ("min", 6e10),
    ("ms", 1e6),
    ("us", 1e3),
    ("ns", 1.0),
    ("d", 8.64e13),
    ("h", 3.6e12),
    ("m", 6e10),
    ("s", 1e9),
    ("", 1e9),
];

/// Ten years, the longest that is simulated.
const LONGEST_NS: f64 = 3650.0 * 8.64e13;

/// Nanoseconds of a length of time such as `4h`, `1h30m`, `90` (seconds) or `0.5s`.
///
/// # Errors
/// When it cannot be read, is not above zero, or is longer than ten years.
pub fn parse_duration(text: &str) -> Result<u64, Error> {
    let refuse = |why: &str| {
        Error::usage(format!("a duration of '{text}' {why}: write it as 4h, 1h30m, 90s or 250ms"))
    };
    let mut rest = text.trim();
    if rest.starts_with('-') {
        return Err(refuse("is negative"));
    }
    if rest.is_empty() {
        return Err(refuse("is empty"));
    }
    let mut total = 0.0;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let (number, tail) = rest.split_at(digits);
        let number: f64 = number.parse().map_err(|_| refuse("cannot be read"))?;
        let tail = tail.trim_start();
        let end = tail.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(tail.len());
        let (name, tail) = tail.split_at(end);
        let (_, unit) =
            UNITS.iter().find(|(unit, _)| *unit == name).ok_or_else(|| refuse("cannot be read"))?;
        total += number * unit;
        rest = tail.trim_start();
    }
    if total < 1.0 {
        return Err(refuse("is zero"));
    }
    if total > LONGEST_NS {
        return Err(refuse("is longer than ten years"));
    }
    Ok(total.round() as u64)
}

/// A length of time in words: `4 h`, `1 h 30 min`, `12.5 s`.
#[must_use]
pub fn display_duration(ns: u64) -> String {
    let (hours, ns) = (ns / 3_600_000_000_000, ns % 3_600_000_000_000);
    let (minutes, ns) = (ns / 60_000_000_000, ns % 60_000_000_000);
    let mut parts = Vec::new();
    if hours > 0 {
        parts.push(format!("{hours} h"));
    }
    if minutes > 0 {
        parts.push(format!("{minutes} min"));
    }
    if ns > 0 || parts.is_empty() {
        parts.push(format!("{} s", ns as f64 / 1e9));
    }
    parts.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_read_as_written() {
        for (text, seconds) in [
            ("4h", 14_400.0),
            ("1h30m", 5_400.0),
            ("1h 30min", 5_400.0),
            ("1 h 30 min", 5_400.0),
            ("90", 90.0),
            ("0.5s", 0.5),
            ("250ms", 0.25),
            ("2d", 172_800.0),
        ] {
            assert_eq!(parse_duration(text).unwrap(), (seconds * 1e9) as u64, "{text}");
        }
    }

    #[test]
    fn nonsense_is_one_sentence() {
        for (text, word) in [
            ("-4h", "negative"),
            ("0", "zero"),
            ("", "empty"),
            ("4 parsecs", "cannot be read"),
            ("h", "cannot be read"),
            ("1.2.3s", "cannot be read"),
            ("4hé", "cannot be read"),
            ("1e9d", "cannot be read"),
            ("9999999d", "ten years"),
        ] {
            let error = parse_duration(text).unwrap_err();
            assert!(error.to_string().contains(word), "{text}: {error}");
            assert_eq!(error.exit_code(), 2);
        }
    }

    #[test]
    fn lengths_are_said_in_words() {
        assert_eq!(display_duration(14_400_000_000_000), "4 h");
        assert_eq!(display_duration(5_412_500_000_000), "1 h 30 min 12.5 s");
        assert_eq!(display_duration(0), "0 s");
    }
}
