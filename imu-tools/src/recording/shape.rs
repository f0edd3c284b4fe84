//! The shape that the messages of a topic repeat: found once, then only compared.
//!
//! Their records differ in stamps and readings alone, as long as the name of the frame keeps its length.
//! Comparing words with what is fixed is several times faster than reading the fields of each header
//! anew.

use std::ops::Range;

/// Fixed bytes are among so many first ones.
const LONGEST: usize = 96;

/// Length and fixed bytes of a record.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    len: usize,
    /// The fixed bits of the first words, and which ones are fixed. Two lists, and not one of pairs: several words are
    /// compared at once.
    bits: [u64; LONGEST / 8],
    fixed: [u64; LONGEST / 8],
}

impl Shape {
    /// The shape of `record`, of which these bytes are fixed; `None` where the record or its head is
    /// of an uncommon length.
    pub fn of(record: &[u8], fixed: &[Range<usize>]) -> Option<Self> {
        let head = record.first_chunk::<LONGEST>()?.as_chunks().0;
        if fixed.iter().any(|range| range.end > LONGEST) {
            return None;
        }
        let (mut bits, mut masks) = ([0; LONGEST / 8], [0; LONGEST / 8]);
        for (k, ((bits, mask), bytes)) in bits.iter_mut().zip(&mut masks).zip(head).enumerate() {
            let is_fixed = |at: usize| fixed.iter().any(|range| range.contains(&at));
            let byte = |byte: usize| if is_fixed(8 * k + byte) { 0xff } else { 0 };
            *mask = u64::from_ne_bytes([0, 1, 2, 3, 4, 5, 6, 7].map(byte));
            *bits = u64::from_ne_bytes(*bytes) & *mask;
        }
        Some(Self { len: record.len(), bits, fixed: masks })
    }

    /// Length of the whole record.
    pub fn len(&self) -> usize {
        self.len
    }

    /// The next record, if it has this shape and `bytes` hold all of it.
    #[inline]
    pub fn next<'a>(&self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        let record = bytes.get(..self.len)?;
        let head = record.first_chunk::<LONGEST>()?.as_chunks().0;
        let fixed = self.bits.iter().zip(&self.fixed);
        let other = fixed.zip(head).fold(0, |other, ((bits, fixed), bytes)| {
            other | ((u64::from_ne_bytes(*bytes) ^ bits) & fixed)
        });
        (other == 0).then_some(record)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_fixed_is_compared_and_nothing_else() {
        let record: Vec<u8> = (0..120).collect();
        let fixed = [0..3, 7..9, 50..96];
        let shape = Shape::of(&record, &fixed).unwrap();
        assert_eq!(shape.len(), 120);
        for at in 0..120 {
            let mut other = record.clone();
            other[at] ^= 1;
            let is_fixed = fixed.iter().any(|range| range.contains(&at));
            assert_eq!(shape.next(&other).is_none(), is_fixed, "{at}");
        }
        assert!(shape.next(&record[..119]).is_none());
        assert!(Shape::of(&record[..95], &fixed).is_none());
        assert!(Shape::of(&record, &[0..1, 90..97]).is_none());
    }
}
