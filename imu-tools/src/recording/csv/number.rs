//! Numbers from bytes: values by the shortest exact way, time without ever becoming a float.

/// The double nearest to a decimal number; `nan` and `inf` count as numbers.
#[inline]
pub fn value(bytes: &[u8]) -> Option<f64> {
    fast_float2::parse(bytes).ok()
}

/// The number with which a line begins, as [`value`], and its length.
#[inline]
pub fn leading_value(line: &[u8]) -> Option<(f64, usize)> {
    fast_float2::parse_partial(line).ok()
}

/// The time with which a line begins, as [`nanoseconds`], and its length; `None` also when it is
/// written in an uncommon way.
#[inline]
pub fn leading_nanoseconds(line: &[u8], exponent: u32) -> Option<(i64, usize)> {
    /// As many as an `i64` may have.
    const MOST_DIGITS: usize = 19;
    let digits = |from: &[u8]| from.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let whole = digits(line);
    let places = match line.get(whole) {
        Some(b'.') => digits(line.get(whole + 1..)?),
        _ => 0,
    };
    let used = if places > 0 { whole + 1 + places } else { whole };
    if whole == 0 || whole + places > MOST_DIGITS {
        return None;
    }
    let number = |from: &[u8], start: i64| {
        from.iter().try_fold(start, |sum, byte| {
            sum.checked_mul(10)?.checked_add(i64::from(byte.wrapping_sub(b'0')))
        })
    };
    let mut units = number(line.get(..whole)?, 0)?;
    if places > 0 {
        units = number(line.get(whole + 1..used)?, units)?;
    }
    let power = exponent.checked_sub(u32::try_from(places).ok()?)?;
    Some((units.checked_mul(10_i64.checked_pow(power)?)?, used))
}

/// Nanoseconds from a decimal number of units of 10^`exponent` ns, rounded to the nearest (halves
/// away from zero); `None` when it is no number or beyond 292 years.
pub fn nanoseconds(bytes: &[u8], exponent: u32) -> Option<i64> {
    let (negative, rest) = match bytes {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        rest => (false, rest),
    };
    let (digits, power) = match rest.iter().position(|b| matches!(b, b'e' | b'E')) {
        Some(at) => {
            let power = std::str::from_utf8(rest.get(at + 1..)?).ok()?.parse::<i32>().ok()?;
            (rest.get(..at)?, i64::from(power))
        }
        None => (rest, 0),
    };
    let (mut mantissa, mut places, mut seen, mut point) = (0_i128, 0_i64, false, false);
    for &byte in digits {
        match byte {
            b'0'..=b'9' => {
                seen = true;
                // Beyond 37 digits nothing is left that a nanosecond could feel.
                if mantissa < 10_i128.pow(36) {
                    mantissa = mantissa * 10 + i128::from(byte - b'0');
                    places += i64::from(point);
                } else if !point {
                    return None;
                }
            }
            b'.' if !point => point = true,
            _ => return None,
        }
    }
    if !seen {
        return None;
    }
    let power = power + i64::from(exponent) - places;
    let magnitude = if mantissa == 0 {
        0
    } else if power >= 0 {
        mantissa.checked_mul(10_i128.checked_pow(u32::try_from(power).ok()?)?)?
    } else {
        match u32::try_from(-power).ok().and_then(|p| 10_i128.checked_pow(p)) {
            Some(divisor) => (mantissa + divisor / 2) / divisor,
            None => 0,
        }
    };
    i64::try_from(if negative { -magnitude } else { magnitude }).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn seconds_become_nanoseconds_exactly() {
        for (text, exponent, expected) in [
            ("1700000000.123456789", 9, 1_700_000_000_123_456_789),
            ("1403636579763555584", 0, 1_403_636_579_763_555_584),
            ("1.700000000123456789e+09", 9, 1_700_000_000_123_456_789),
            ("1.403636579763555584000000000000000000e+18", 0, 1_403_636_579_763_555_584),
            ("-0.0000000015", 9, -2),
            (".5", 6, 500_000),
            ("5.", 3, 5_000),
            ("0", 9, 0),
            ("1e-400", 9, 0),
        ] {
            assert_eq!(nanoseconds(text.as_bytes(), exponent), Some(expected), "{text}");
        }
        for text in ["", "-", ".", "1.2.3", "nan", "1e", "12:30", "1e400", "9223372037"] {
            assert_eq!(nanoseconds(text.as_bytes(), 9), None, "{text}");
        }
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for text in ["", "-", ".", "1.2.3", "x", "1 2", "1,5", "0x10"] {
            assert_eq!(value(text.as_bytes()), None, "{text}");
        }
        assert!(value(b"NaN").unwrap().is_nan());
        assert_eq!(value(b"-inf"), Some(f64::NEG_INFINITY));
        assert_eq!(value(b"-0").unwrap().to_bits(), (-0.0_f64).to_bits());
    }

    proptest! {
        #[test]
        fn values_are_those_of_the_standard_library(
            mantissa in any::<i64>(), shift in 0_u32..60, places in 0_usize..22,
        ) {
            let number = mantissa >> shift;
            let digits = format!("{:0>1$}", number.unsigned_abs(), places + 1);
            let (whole, part) = digits.split_at(digits.len() - places);
            let text = format!("{}{whole}.{part}", if number < 0 { "-" } else { "" });
            let expected: f64 = text.parse().unwrap();
            prop_assert_eq!(value(text.as_bytes()).unwrap().to_bits(), expected.to_bits());
        }

        #[test]
        fn any_text_is_a_number_to_both_or_to_none(text in "[-+]?[0-9]{0,25}[.]?[0-9]{0,25}(e[-+]?[0-9]{1,3})?") {
            let expected = text.parse::<f64>().ok().map(f64::to_bits);
            prop_assert_eq!(value(text.as_bytes()).map(f64::to_bits), expected);
        }

        #[test]
        fn the_short_way_is_the_long_way(
            whole in 0_u64..1 << 62, shift in 0_u32..62, part in "[0-9]{0,10}", exponent in 0_u32..10,
        ) {
            let text = format!("{}.{part}", whole >> shift);
            if let Some((stamp_ns, used)) = leading_nanoseconds(format!("{text},1").as_bytes(), exponent) {
                prop_assert_eq!(Some(stamp_ns), nanoseconds(text.as_bytes(), exponent));
                prop_assert_eq!(used, text.trim_end_matches('.').len());
            }
        }

        #[test]
        fn any_stamp_survives_as_decimal_seconds(stamp in any::<i64>()) {
            let (sign, size) = (if stamp < 0 { "-" } else { "" }, stamp.unsigned_abs());
            let text = format!("{sign}{}.{:09}", size / 1_000_000_000, size % 1_000_000_000);
            // The most negative stamp is read as a magnitude first, which i128 holds.
            prop_assert_eq!(nanoseconds(text.as_bytes(), 9), Some(stamp));
        }
    }
}
