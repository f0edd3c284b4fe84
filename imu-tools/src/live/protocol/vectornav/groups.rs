//! The fields that a binary frame may have, by group and bit, and how long each is.
//!
//! Source: UM001 and UM004, "Binary Output": groups 1 (common), 2 (time), 3 (IMU), 4 (GPS), 5 (attitude),
//! 6 (INS), 7 (second GPS, as 4). Bits of later firmware whose length those do not tell have none here: a frame
//! with one is not read.

/// Bytes of the field of each bit, from bit 0.
const LENGTHS: [&[u8]; 7] = [
    &[8, 8, 8, 12, 16, 12, 24, 12, 12, 24, 20, 28, 2, 4, 8],
    &[8, 8, 8, 2, 8, 8, 8, 4, 4, 1],
    &[2, 12, 12, 12, 4, 4, 16, 12, 12, 12, 12, 2],
    &[8, 8, 2, 1, 1, 24, 24, 12, 12, 12, 4, 4],
    &[2, 12, 16, 36, 12, 12, 12, 12, 12],
    &[2, 24, 24, 12, 12, 12, 12, 12, 12, 4, 4],
    &[8, 8, 2, 1, 1, 24, 24, 12, 12, 12, 4, 4],
];

/// Bytes of all fields together.
pub const LONGEST: usize = {
    let (mut sum, mut group) = (0, 0);
    while group < LENGTHS.len() {
        let mut bit = 0;
        while bit < LENGTHS[group].len() {
            sum += LENGTHS[group][bit] as usize;
            bit += 1;
        }
        group += 1;
    }
    sum
};

/// How many groups there may be.
pub const GROUPS: usize = LENGTHS.len();

/// Bytes of the fields in `mask` of a group counted from 0; `None` if one of them is not known.
pub fn length(group: usize, mask: u16) -> Option<usize> {
    let lengths = LENGTHS.get(group)?;
    if u32::from(mask) >> lengths.len() != 0 {
        return None;
    }
    let fields = lengths.iter().enumerate().filter(|(bit, _)| mask >> bit & 1 == 1);
    Some(fields.map(|(_, length)| usize::from(*length)).sum())
}
