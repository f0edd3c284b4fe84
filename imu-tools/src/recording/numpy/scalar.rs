//! Numbers as NumPy stores them.

use std::str::FromStr as _;

use crate::recording::TimeUnit;

/// A type of number: `<f8`, `>i4`, `<M8[ns]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scalar {
    kind: Kind,
    /// Bytes of one.
    pub size: usize,
    big_endian: bool,
    /// The unit that the type itself says.
    pub unit: Option<TimeUnit>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Float,
    Signed,
    Unsigned,
}

impl Scalar {
    /// From NumPy's name; `None` for what is no number, or has a size of its own.
    pub fn named(name: &str) -> Option<Self> {
        let (order, rest) = name.split_at_checked(1)?;
        let (letter, rest) = rest.split_at_checked(1)?;
        let (size, unit) = match rest.split_once('[') {
            Some((size, unit)) => (size, Some(TimeUnit::from_str(unit.strip_suffix(']')?).ok()?)),
            None => (rest, None),
        };
        let size: usize = size.parse().ok()?;
        let kind = match (letter, size, unit) {
            ("f", 4 | 8, None) => Kind::Float,
            ("i", 1 | 2 | 4 | 8, None) | ("M" | "m", 8, Some(_)) => Kind::Signed,
            ("u", 1 | 2 | 4 | 8, None) => Kind::Unsigned,
            _ => return None,
        };
        let big_endian = match order {
            "<" | "|" | "=" => false,
            ">" => true,
            _ => return None,
        };
        Some(Self { kind, size, big_endian, unit })
    }

    /// The bytes of the number at `at`, the lowest first.
    #[inline]
    fn bytes(self, record: &[u8], at: usize) -> Option<[u8; 8]> {
        let bytes = record.get(at..at.checked_add(self.size)?)?;
        let mut little = [0; 8];
        if self.big_endian {
            little.iter_mut().zip(bytes.iter().rev()).for_each(|(to, from)| *to = *from);
        } else {
            little.get_mut(..self.size)?.copy_from_slice(bytes);
        }
        Some(little)
    }

    /// The whole number at `at`; `None` for a float, or beyond 2^63.
    #[inline]
    fn whole(self, record: &[u8], at: usize) -> Option<i64> {
        let bits = u64::from_le_bytes(self.bytes(record, at)?);
        match self.kind {
            Kind::Float => None,
            Kind::Unsigned => i64::try_from(bits).ok(),
            Kind::Signed => {
                let unused = 64 - 8 * u32::try_from(self.size).ok()?;
                Some((bits as i64).wrapping_shl(unused).wrapping_shr(unused))
            }
        }
    }

    /// The number at `at`.
    #[inline]
    pub fn value(self, record: &[u8], at: usize) -> Option<f64> {
        match (self.kind, self.size) {
            (Kind::Float, 8) => Some(f64::from_le_bytes(self.bytes(record, at)?)),
            (Kind::Float, _) => {
                let [a, b, c, d, ..] = self.bytes(record, at)?;
                Some(f64::from(f32::from_le_bytes([a, b, c, d])))
            }
            (Kind::Unsigned, _) => Some(u64::from_le_bytes(self.bytes(record, at)?) as f64),
            (Kind::Signed, _) => self.whole(record, at).map(|whole| whole as f64),
        }
    }

    /// The time at `at` in nanoseconds, from units of 10^`exponent` ns; `None` where it is no time
    /// or beyond 292 years.
    #[inline]
    pub fn nanoseconds(self, record: &[u8], at: usize, exponent: u32) -> Option<i64> {
        let scale = 10_i64.checked_pow(exponent)?;
        if self.kind != Kind::Float {
            return self.whole(record, at)?.checked_mul(scale);
        }
        // Whole units and the rest apart: their sum in one float would lose nanoseconds.
        let value = self.value(record, at)?;
        let (whole, part) = (value.trunc(), value.fract());
        if !value.is_finite() || whole.abs() >= 9.2e18 {
            return None;
        }
        (whole as i64).checked_mul(scale)?.checked_add((part * scale as f64).round() as i64)
    }

    /// The number at `at` as it would be written, a float with a point or an exponent.
    pub fn text(self, record: &[u8], at: usize) -> Option<String> {
        match self.kind {
            Kind::Float => self.value(record, at).map(|value| format!("{value:?}")),
            _ => self.whole(record, at).map(|whole| whole.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_both_byte_orders() {
        for (name, bytes, value) in [
            ("<f8", 1.5_f64.to_le_bytes().to_vec(), 1.5),
            (">f8", 1.5_f64.to_be_bytes().to_vec(), 1.5),
            ("<f4", (-0.25_f32).to_le_bytes().to_vec(), -0.25),
            (">f4", (-0.25_f32).to_be_bytes().to_vec(), -0.25),
            (">i4", (-7_i32).to_be_bytes().to_vec(), -7.0),
            ("<i2", (-7_i16).to_le_bytes().to_vec(), -7.0),
            ("|i1", vec![0xff], -1.0),
            ("|u1", vec![0xff], 255.0),
            ("<u8", u64::MAX.to_le_bytes().to_vec(), 1.8446744073709552e19),
        ] {
            let record = [&[9, 9][..], &bytes].concat();
            assert_eq!(Scalar::named(name).unwrap().value(&record, 2), Some(value), "{name}");
            assert_eq!(Scalar::named(name).unwrap().value(&record, 3), None, "{name}");
        }
        for name in ["", "<", "<f", "<f2", "<c8", "|S5", "|O", "<M8[min]", "é"] {
            assert_eq!(Scalar::named(name), None, "{name}");
        }
    }

    #[test]
    fn times_keep_their_nanoseconds() {
        let stamp = 1_700_000_000_123_456_789_i64;
        let of = |name: &str, bytes: &[u8], exponent| {
            Scalar::named(name).unwrap().nanoseconds(bytes, 0, exponent)
        };
        assert_eq!(of("<i8", &stamp.to_le_bytes(), 0), Some(stamp));
        assert_eq!(of("<M8[ns]", &stamp.to_le_bytes(), 0), Some(stamp));
        assert_eq!(of("<i8", &5_i64.to_le_bytes(), 3), Some(5000));
        assert_eq!(of("<i8", &i64::MAX.to_le_bytes(), 3), None);
        assert_eq!(of("<f8", &100_000.123_456_f64.to_le_bytes(), 9), Some(100_000_123_456_000));
        assert_eq!(of("<f8", &(-0.5_f64).to_le_bytes(), 9), Some(-500_000_000));
        assert_eq!(of("<f8", &f64::NAN.to_le_bytes(), 9), None);
        assert_eq!(of("<f8", &1e300_f64.to_le_bytes(), 9), None);
    }
}
