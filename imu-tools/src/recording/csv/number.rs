//! Numbers from bytes: values by the shortest exact way, time without ever becoming a float.

/// Powers of ten that a double holds exactly.
const TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// The double nearest to a decimal number; `nan` and `inf` count as numbers.
///
/// Where the digits fit 53 bits and the power of ten is exact, one multiplication or division of
/// two exact doubles rounds once and is right (Clinger 1990); all else goes to the standard
/// library.
#[inline]
pub fn value(bytes: &[u8]) -> Option<f64> {
    short(bytes).or_else(|| std::str::from_utf8(bytes).ok()?.parse().ok())
}

fn short(bytes: &[u8]) -> Option<f64> {
    let (negative, digits) = match bytes {
        [b'-', rest @ ..] => (true, rest),
        rest => (false, rest),
    };
    if digits.len() > 19 {
        return None;
    }
    let (mut mantissa, mut places, mut seen, mut point) = (0_u64, 0_usize, false, false);
    for &byte in digits {
        match byte {
            b'0'..=b'9' => {
                // At most 19 digits: below 10^19, which fits.
                mantissa = mantissa * 10 + u64::from(byte - b'0');
                places += usize::from(point);
                seen = true;
            }
            b'.' if !point => point = true,
            _ => return None,
        }
    }
    if !seen || mantissa > 1 << 53 {
        return None;
    }
    let value = mantissa as f64 / TEN.get(places)?;
    Some(if negative { -value } else { value })
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
        fn any_stamp_survives_as_decimal_seconds(stamp in any::<i64>()) {
            let (sign, size) = (if stamp < 0 { "-" } else { "" }, stamp.unsigned_abs());
            let text = format!("{sign}{}.{:09}", size / 1_000_000_000, size % 1_000_000_000);
            // The most negative stamp is read as a magnitude first, which i128 holds.
            prop_assert_eq!(nanoseconds(text.as_bytes(), 9), Some(stamp));
        }
    }
}
