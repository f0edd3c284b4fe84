//! The serial line of the MPS2 boards: Arm's CMSDK UART (Cortex-M System Design Kit r1p1, technical reference manual,
//! section 4.3), the first of them at 0x4000_4000.

const DATA: *mut u32 = 0x4000_4000 as *mut u32;
const STATE: *mut u32 = 0x4000_4004 as *mut u32;
const CONTROL: *mut u32 = 0x4000_4008 as *mut u32;
const DIVIDER: *mut u32 = 0x4000_4010 as *mut u32;
const FULL: u32 = 1;
const SENDS: u32 = 1;
/// The least that there is: 25 MHz/16, 1.6 Mbit/s.
const FASTEST: u32 = 16;

/// The line, switched on for sending.
#[derive(Debug)]
pub struct Uart(());

impl Uart {
    /// Switches the line on.
    #[must_use]
    pub fn new() -> Self {
        // SAFETY: registers of the UART, used by nothing else in this image.
        unsafe {
            DIVIDER.write_volatile(FASTEST);
            CONTROL.write_volatile(SENDS);
        }
        Self(())
    }

    /// Sends bytes; waits where the line is slower.
    pub fn send(&mut self, bytes: &[u8]) {
        for byte in bytes {
            // SAFETY: as above.
            unsafe {
                while STATE.read_volatile() & FULL != 0 {}
                DATA.write_volatile(u32::from(*byte));
            }
        }
    }
}

impl Default for Uart {
    fn default() -> Self {
        Self::new()
    }
}
