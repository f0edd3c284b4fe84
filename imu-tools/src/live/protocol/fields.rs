//! Numbers at fixed places of a checked frame, in either order of bytes.
//!
//! A place outside of the frame reads as zeros: [`check`](super::framer::Wire::check) has made sure
//! that there is none.

/// So many bytes from `at` on.
fn bytes<const N: usize>(frame: &[u8], at: usize) -> [u8; N] {
    frame.get(at..).and_then(|rest| rest.first_chunk()).copied().unwrap_or([0; N])
}

/// A byte.
pub fn u8(frame: &[u8], at: usize) -> u8 {
    u8::from_le_bytes(bytes(frame, at))
}

/// Little-endian numbers.
pub mod le {
    use super::bytes;

    pub fn u16(frame: &[u8], at: usize) -> u16 {
        u16::from_le_bytes(bytes(frame, at))
    }

    pub fn i16(frame: &[u8], at: usize) -> i16 {
        i16::from_le_bytes(bytes(frame, at))
    }

    pub fn u32(frame: &[u8], at: usize) -> u32 {
        u32::from_le_bytes(bytes(frame, at))
    }

    pub fn u64(frame: &[u8], at: usize) -> u64 {
        u64::from_le_bytes(bytes(frame, at))
    }

    pub fn f32(frame: &[u8], at: usize) -> f32 {
        f32::from_le_bytes(bytes(frame, at))
    }

    /// Three singles in a row.
    pub fn vector(frame: &[u8], at: usize) -> [f64; 3] {
        [0, 4, 8].map(|axis| f32(frame, at + axis).into())
    }

    /// Three whole numbers of 16 bits in a row, times `unit`.
    pub fn scaled(frame: &[u8], at: usize, unit: f64) -> [f64; 3] {
        [0, 2, 4].map(|axis| f64::from(i16(frame, at + axis)) * unit)
    }
}

/// Big-endian numbers.
pub mod be {
    use super::bytes;

    pub fn u16(frame: &[u8], at: usize) -> u16 {
        u16::from_be_bytes(bytes(frame, at))
    }

    pub fn u32(frame: &[u8], at: usize) -> u32 {
        u32::from_be_bytes(bytes(frame, at))
    }

    pub fn i32(frame: &[u8], at: usize) -> i32 {
        i32::from_be_bytes(bytes(frame, at))
    }

    pub fn i16(frame: &[u8], at: usize) -> i16 {
        i16::from_be_bytes(bytes(frame, at))
    }

    pub fn f32(frame: &[u8], at: usize) -> f32 {
        f32::from_be_bytes(bytes(frame, at))
    }

    pub fn f64(frame: &[u8], at: usize) -> f64 {
        f64::from_be_bytes(bytes(frame, at))
    }
}
