//! Times written as dates: ISO 8601 and what loggers make of it, into nanoseconds since 1970.
//!
//! `2024-05-01T12:00:00.005Z`, `2024/05/01 12:00:00,005+02:00`, `01.05.2024 12:00`, or one half of
//! it; UTC where no zone is given. Days are counted by the proleptic Gregorian calendar (Hinnant 2013, "chrono-compatible
//! low-level date algorithms").

use super::number::nanoseconds;

const SECOND: i64 = 1_000_000_000;
const DAY: i64 = 86_400 * SECOND;

/// Nanoseconds since 1970 of a date with or without a time of day; since midnight of a time of day
/// alone.
pub fn stamp(text: &[u8]) -> Option<i64> {
    let text = text.trim_ascii();
    let split = text.iter().position(|b| matches!(b, b'T' | b't' | b' ' | b'_'));
    match split {
        Some(at) => {
            let clock = clock(text.get(at + 1..)?.trim_ascii())?;
            midnight(text.get(..at)?)?.checked_add(clock)
        }
        None => midnight(text).or_else(|| clock(text)),
    }
}

/// Whether a person would take this for a date or a time of day, and [`stamp`] does not.
pub fn is_unknown(text: &[u8]) -> bool {
    let digits = |text: &[u8]| (1..=4).contains(&text.len()) && text.iter().all(u8::is_ascii_digit);
    let day = text.split(|b| matches!(b, b' ' | b'T')).next().unwrap_or_default();
    let of_three = |mark: u8| {
        let parts: Vec<&[u8]> = day.split(|&b| b == mark).collect();
        parts.len() == 3 && parts.iter().all(|part| digits(part))
    };
    let is_date = [b'/', b'-', b'.'].into_iter().any(of_three);
    let half = text.len().checked_sub(2).map(|at| text.split_at(at));
    let is_half = |(clock, half): (&[u8], &[u8])| {
        let half = half.to_ascii_uppercase();
        (half == b"AM" || half == b"PM") && self::clock(clock.trim_ascii()).is_some()
    };
    stamp(text).is_none() && (is_date || half.is_some_and(is_half))
}

/// Midnight of `2024-05-01`, `2024/05/01` or `01.05.2024`.
fn midnight(text: &[u8]) -> Option<i64> {
    let mut parts = text.split(|b| matches!(b, b'-' | b'/' | b'.'));
    let (first, month, last) = (parts.next()?, parts.next()?, parts.next()?);
    // With points the day comes first all over the world; with dashes and strokes it may be second.
    let points = !text.iter().any(|b| matches!(b, b'-' | b'/'));
    let (year, day) = match (first.len(), last.len()) {
        (4, _) => (first, last),
        (1 | 2, 4) if points => (last, first),
        _ => return None,
    };
    if parts.next().is_some() {
        return None;
    }
    let (year, month, day) = (whole(year)?, whole(month)?, whole(day)?);
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    // The year begins with March, so that the leap day is its last.
    let year = if month <= 2 { year - 1 } else { year };
    let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let days = era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468;
    days.checked_mul(DAY)
}

/// `12:00:00.005Z`, with a zone or without, as nanoseconds since midnight UTC.
fn clock(text: &[u8]) -> Option<i64> {
    let zone = text.iter().position(|b| matches!(b, b'Z' | b'z' | b'+' | b'-'));
    let (text, zone) = text.split_at(zone.unwrap_or(text.len()));
    let mut parts = text.trim_ascii().split(|&b| b == b':');
    let (hours, minutes) = (whole(parts.next()?)?, whole(parts.next()?)?);
    let seconds = parts.next().unwrap_or(b"0");
    if hours > 24 || minutes > 59 || parts.next().is_some() {
        return None;
    }
    let seconds = match memchr::memchr(b',', seconds) {
        Some(_) => nanoseconds(&super::dialect::pointed(seconds), 9)?,
        None => nanoseconds(seconds, 9)?,
    };
    // A leap second is a second like any other.
    if !(0..=61 * SECOND).contains(&seconds) {
        return None;
    }
    Some((hours * 60 + minutes) * 60 * SECOND + seconds - offset(zone)?)
}

/// What a zone such as `+02:00`, `-0530` or `Z` is ahead of UTC.
fn offset(zone: &[u8]) -> Option<i64> {
    let (sign, digits) = match zone {
        [] | [b'Z' | b'z'] => return Some(0),
        [b'+', digits @ ..] => (1, digits),
        [b'-', digits @ ..] => (-1, digits),
        _ => return None,
    };
    let (hours, minutes) = match digits {
        [_, _] => (whole(digits)?, 0),
        [a, b, b':', c, d] | [a, b, c, d] => (whole(&[*a, *b])?, whole(&[*c, *d])?),
        _ => return None,
    };
    Some(sign * (hours * 60 + minutes) * 60 * SECOND)
}

/// A short number of digits alone.
fn whole(digits: &[u8]) -> Option<i64> {
    let short = (1..=4).contains(&digits.len()) && digits.iter().all(u8::is_ascii_digit);
    short.then(|| digits.iter().fold(0, |sum, digit| 10 * sum + i64::from(digit - b'0')))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_that_loggers_write() {
        // 2024-05-01T12:00:00Z, as `date -u -d … +%s` prints it.
        let noon = 1_714_564_800 * SECOND;
        for (text, expected) in [
            ("2024-05-01T12:00:00Z", noon),
            ("2024-05-01T12:00:00.005Z", noon + 5_000_000),
            ("2024-05-01 12:00:00.123456789", noon + 123_456_789),
            ("2024-05-01 12:00:00,005", noon + 5_000_000),
            ("2024/05/01 14:00:00+02:00", noon),
            ("2024-05-01T06:30:00-0530", noon),
            ("2024-05-01T13+01", i64::MIN),
            ("2024-05-01", noon - DAY / 2),
            ("01.05.2024 12:00:00.5", noon + SECOND / 2),
            ("1.5.2024", noon - DAY / 2),
            ("12:00:00.5", DAY / 2 + SECOND / 2),
            ("12:30", DAY / 2 + 1800 * SECOND),
            ("1970-01-01T00:00:00Z", 0),
            ("1969-12-31T23:59:59.5Z", -SECOND / 2),
            ("2000-02-29 00:00:00", 951_782_400 * SECOND),
            ("2016-12-31T23:59:60Z", 1_483_228_800 * SECOND),
        ] {
            let expected = (expected > i64::MIN).then_some(expected);
            assert_eq!(stamp(text.as_bytes()), expected, "{text}");
        }
    }

    /// 05/01 is in May for half of the world.
    #[test]
    fn dates_of_two_meanings_are_known_to_be_dates() {
        for text in [
            "12/31/2024",
            "05/01/2024 12:00:00 PM",
            "31-12-2024",
            "1/2/24",
            "2024-13-01T10:00:00",
            "12:00:00.5 PM",
        ] {
            assert!(is_unknown(text.as_bytes()), "{text}");
        }
        for text in ["2024-12-31", "31.12.2024", "1.5", "-1-2", "PM", "", "today", "12:00:00"] {
            assert!(!is_unknown(text.as_bytes()), "{text}");
        }
    }

    #[test]
    fn what_is_no_date_is_refused() {
        for text in ["", "-", "T", "2024-13-01", "2024-05-32", "24-05-01", "2024-05-01T", "1:2:3:4"]
        {
            assert_eq!(stamp(text.as_bytes()), None, "{text}");
        }
        for text in ["25:00:00", "12:60", "12:00:62", "9999-12-31", "oops", "1.5", "12:0x:00"] {
            assert_eq!(stamp(text.as_bytes()), None, "{text}");
        }
    }
}
