//! VectorNav's two protocols, `$VN…` in ASCII and the binary frames that begin with 0xFA.
//!
//! Sources: VectorNav UM001, VN-100 User Manual, firmware v2.1.0.0, revision 2.22, and UM004, VN-200
//! User Manual, revision 2.23.

pub mod ascii;
pub mod binary;
mod groups;

/// CRC-16 of CCITT's polynomial 0x1021 started from 0, as UM001 defines it: over a frame and its own
/// CRC, high byte first, it is 0.
fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0_u16, |crc, byte| {
        let crc = crc ^ (u16::from(*byte) << 8);
        (0..8).fold(crc, |crc, _| if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ 0x1021 })
    })
}
